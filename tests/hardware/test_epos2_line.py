"""The handshake when all is well and when it isn't: noise, silence, wrong speed, no port."""

import os
import pty
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import serial
from lossy_emulator import FRAME_TIMEOUT_S, LossyEmulator, spoil_once

from pipeline.clock import SimulatedClock
from pipeline.errors import LoopgapError, UsageError
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2_frames import Entry
from pipeline.hardware.epos2_line import Epos2Line

RELATIVE_NOW = 0x7F


@pytest.fixture
def emulator() -> Iterator[LossyEmulator]:
    with LossyEmulator(SimulatedClock()) as emulator:
        yield emulator


@pytest.fixture
def line(emulator: LossyEmulator) -> Iterator[Epos2Line]:
    line = Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S)
    yield line
    line.close()


def count_writes(emulator: LossyEmulator, node: int) -> list[int]:
    """The controlwords that arrive at a node from now on."""
    arrived: list[int] = []
    write = emulator.nodes[node].write

    def counted(index: int, subindex: int, dword: int) -> int:
        if index == objects.CONTROLWORD.index:
            arrived.append(dword)
        return write(index, subindex, dword)

    emulator.nodes[node].write = counted  # type: ignore[method-assign]
    return arrived


def test_official_version_request_is_answered(emulator: LossyEmulator) -> None:
    with serial.Serial(emulator.port, 115200, timeout=1.0) as port:
        for said, expected in (("10", "4F"), ("01 03 20 01 02 88 A8", "4F 00")):
            port.write(bytes.fromhex(said))
            assert port.read(len(bytes.fromhex(expected))) == bytes.fromhex(expected)
        port.write(b"O")
        answer = port.read(11)
        port.write(b"O")
    assert answer[:7] == bytes.fromhex("03 00 00 00 00 10 21")
    assert answer[7:9] != b"\0\0", "the word without meaning must not look like a zero"


def test_junk_never_reaches_a_value(line: Epos2Line) -> None:
    assert {line.read(2, objects.SOFTWARE_VERSION) for _ in range(50)} == {0x2110}
    line.write(1, objects.MODE, -1)
    assert {line.read(1, objects.MODE_DISPLAY) for _ in range(50)} == {-1}


def test_wrong_checksum_and_opcode_get_f(emulator: LossyEmulator) -> None:
    with serial.Serial(emulator.port, 115200, timeout=1.0) as port:
        port.write(b"\x55")
        assert port.read(1) == b"F"
        port.write(b"\x10")
        assert port.read(1) == b"O"
        port.write(bytes.fromhex("01 03 20 01 02 88 A9"))
        assert port.read(1) == b"F"


def test_controller_forgets_half_a_frame_after_its_timeout(
    emulator: LossyEmulator, line: Epos2Line
) -> None:
    with open(emulator.port, "wb", buffering=0) as half:
        half.write(b"\x10\x01\x03")
    time.sleep(3 * FRAME_TIMEOUT_S)
    assert line.read(1, objects.SOFTWARE_VERSION) == 0x2110


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data[:-1] + bytes([data[-1] ^ 0x40]),
        lambda data: data[:5],
        lambda data: b"",
        lambda data: b"\xfe" + data,
    ],
    ids=["flipped bit", "cut short", "lost", "noise before"],
)
def test_one_damaged_answer_is_asked_for_again(
    emulator: LossyEmulator, line: Epos2Line, damage: object
) -> None:
    emulator.disturb = spoil_once(damage)  # type: ignore[arg-type]
    begun = time.monotonic()
    assert line.read(1, objects.SOFTWARE_VERSION) == 0x2110
    assert time.monotonic() - begun >= FRAME_TIMEOUT_S


def test_start_of_a_relative_move_is_never_sent_again(
    emulator: LossyEmulator, line: Epos2Line
) -> None:
    arrived = count_writes(emulator, 1)
    emulator.disturb = spoil_once(lambda data: b"")
    with pytest.raises(LoopgapError, match=r"no answer within 0.1 s \(1 tries\)"):
        line.write(1, objects.CONTROLWORD, RELATIVE_NOW)
    assert arrived == [RELATIVE_NOW]
    emulator.disturb = spoil_once(lambda data: b"")
    line.write(1, objects.CONTROLWORD, objects.START_ABSOLUTE_NOW)
    assert arrived[1:] == [objects.START_ABSOLUTE_NOW] * 2


def test_ctrl_c_within_a_transaction_does_not_spoil_the_next(
    emulator: LossyEmulator, line: Epos2Line
) -> None:
    operator = threading.main_thread().ident
    assert operator is not None

    def interrupt(data: bytes) -> bytes:
        signal.pthread_kill(operator, signal.SIGINT)
        return data[:4]

    emulator.disturb = spoil_once(interrupt)
    with pytest.raises(KeyboardInterrupt):
        line.read(1, objects.SOFTWARE_VERSION)
    emulator.disturb = spoil_once(lambda data: data)
    assert line.read(1, objects.SOFTWARE_VERSION) == 0x2110


@pytest.mark.parametrize("baud", [9600, 57600, 1000000])
def test_wrong_baud(emulator: LossyEmulator, baud: int) -> None:
    line = Epos2Line(emulator.port, baud, FRAME_TIMEOUT_S)
    with pytest.raises(LoopgapError, match=rf"at {baud} baud: expected.*`robot\.baud`"):
        line.read(1, objects.STATUSWORD)
    line.close()
    line = Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S)
    assert line.read(1, objects.STATUSWORD) & objects.STATE_MASK == objects.SWITCH_ON_DISABLED
    line.close()


def test_silent_line() -> None:
    far_end, near_end = pty.openpty()
    line = Epos2Line(os.ttyname(near_end), 115200, FRAME_TIMEOUT_S)
    with pytest.raises(LoopgapError, match=r"no answer within 0.1 s \(3 tries\)\. Check that the"):
        line.read(1, objects.STATUSWORD)
    line.close()
    os.close(far_end)
    os.close(near_end)


def test_absent_port_is_named() -> None:
    with pytest.raises(LoopgapError, match=r"robot\.port=/dev/ttyUSB77: .*no such port.*emulated"):
        Epos2Line("/dev/ttyUSB77", 115200)


def test_no_port_is_a_question_asked_wrongly() -> None:
    with pytest.raises(UsageError, match=r"robot\.port: expected a serial port; found none"):
        Epos2Line(None, 115200)


def test_a_file_is_no_port(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("text")
    with pytest.raises(LoopgapError, match="expected a free serial port"):
        Epos2Line(str(tmp_path / "file"), 115200)


def test_port_in_use(line: Epos2Line, emulator: LossyEmulator) -> None:
    with pytest.raises(LoopgapError, match="it is in use"):
        Epos2Line(emulator.port, 115200)


def test_impossible_speed(emulator: LossyEmulator) -> None:
    with pytest.raises(UsageError, match=r"robot\.baud: expected a serial speed; found -1"):
        Epos2Line(emulator.port, -1)


def test_unplugged_adapter(emulator: LossyEmulator) -> None:
    line = Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S)
    emulator.close()
    with pytest.raises(LoopgapError, match="expected an open serial line.*Plug the adapter in"):
        line.read(1, objects.STATUSWORD)
    with pytest.raises(LoopgapError, match="expected an open serial line"):
        line.read(1, objects.STATUSWORD)


@pytest.mark.parametrize(
    ("node", "entry", "words"),
    [
        (1, Entry(0x5555, 0, 4), "node 1, object 0x5555/0.*0x06020000, no such object"),
        (1, Entry(0x607D, 9, 4), "0x06090011, no such subindex"),
        (7, objects.STATUSWORD, "node 7, .*0x0F00FFB9, wrong CAN node.*`robot.nodes`"),
    ],
)
def test_refused_reads_are_told_in_words(
    line: Epos2Line, node: int, entry: Entry, words: str
) -> None:
    with pytest.raises(LoopgapError, match=words):
        line.read(node, entry)


def test_refused_writes_are_told_in_words(line: Epos2Line) -> None:
    line.write(1, objects.MAX_POSITION, 9000)
    with pytest.raises(LoopgapError, match="to take 9001; found error 0x06090030, value out of"):
        line.write(1, objects.TARGET_POSITION, 9001)
    with pytest.raises(LoopgapError, match="0x06010002, the object can only be read"):
        line.write(1, objects.STATUSWORD, 0)
