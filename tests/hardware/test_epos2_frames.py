"""Frames against the maker's own examples, and numbers in the junk that surrounds them."""

import pytest

from pipeline.hardware import epos2_frames as frames
from pipeline.hardware.epos2_frames import Entry

VERSION = Entry(0x2003, 1, 2)
CURRENT = Entry(0x2027, 0, 2, signed=True)


def test_request_is_the_communication_guides() -> None:
    body = frames.frame_body(frames.READ_OBJECT, frames.read_request(VERSION, 2))
    assert body == bytes.fromhex("01 03 20 01 02 88 A8")


def test_guides_answer_is_read_without_its_meaningless_word() -> None:
    body = bytes.fromhex("03 00 00 00 00 10 20 10 62 10 26")
    error, dword = frames.read_answer(frames.frame_data(frames.ANSWER, body))
    assert (error, dword) == (0, 0x62102010)
    assert VERSION.decode(dword) == 0x2010


def test_answer_of_a_real_controller_to_a_write_is_no_error() -> None:
    body = bytes.fromhex("01 00 00 00 00 51 AA")
    assert frames.write_answer(frames.frame_data(frames.ANSWER, body)) == 0


def test_minus_twenty_milliampere_is_sign_extended_from_its_own_word() -> None:
    assert CURRENT.decode(0x1234FFEC) == -20
    assert CURRENT.encode(-20) == 0x0000FFEC


@pytest.mark.parametrize(
    ("size_bytes", "signed", "value"),
    [(1, True, -1), (1, False, 255), (2, True, -32768), (4, True, -8192), (4, False, 2**32 - 1)],
)
def test_a_value_comes_back_whatever_stands_beyond_its_bytes(
    size_bytes: int, signed: bool, value: int
) -> None:
    entry = Entry(0x6060, 0, size_bytes, signed)
    junk = 0xDEADBEEF << 8 * size_bytes & 0xFFFFFFFF
    assert entry.decode(entry.encode(value) | junk) == value


def test_a_value_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ValueError, match=r"0x2027/0 takes -32768 to 32767, not 40000"):
        frames.write_request(CURRENT, 1, 40000)


@pytest.mark.parametrize("bit", range(8 * 10))
def test_every_flipped_bit_is_noticed(bit: int) -> None:
    body = bytearray(frames.frame_body(frames.WRITE_OBJECT, bytes.fromhex("7A600001 6606 0000")))
    body[1 + bit // 8] ^= 1 << bit % 8
    with pytest.raises(frames.FrameError, match="checksum"):
        frames.frame_data(frames.WRITE_OBJECT, bytes(body))


def test_a_frame_of_the_wrong_length_is_refused() -> None:
    with pytest.raises(frames.FrameError, match="length byte"):
        frames.frame_data(frames.ANSWER, bytes.fromhex("03 00 00 00 00 51 AA"))
