"""RS232 frames of the EPOS2: maxon serial protocol V1 ("MAXON_RS232").

Source: maxon EPOS Communication Guide, October 2006, document 573055-05, section 6.2.4.
"""

import binascii
import struct
from dataclasses import dataclass

ANSWER = 0x00
NMT = 0x0E
READ_OBJECT = 0x10
WRITE_OBJECT = 0x11
OKAY = b"O"
FAILED = b"F"
FRAME_TIMEOUT_S = 0.5


class FrameError(ValueError):
    """Bytes that are no frame: wrong length or checksum."""


@dataclass(frozen=True)
class Entry:
    """An entry of the object dictionary: where it is, and what kind of number it holds."""

    index: int
    subindex: int
    size_bytes: int
    signed: bool = False

    def __str__(self) -> str:
        return f"0x{self.index:04X}/{self.subindex}"

    def encode(self, value: int) -> int:
        """The DWORD that carries `value`: its own bytes, the others zero."""
        bits = 8 * self.size_bytes
        low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if self.signed else (0, (1 << bits) - 1)
        if not low <= value <= high:
            raise ValueError(f"{self} takes {low} to {high}, not {value}")
        return value & ((1 << bits) - 1)

    def decode(self, dword: int) -> int:
        """The value in an answer's DWORD, whose bytes beyond the entry's size mean nothing."""
        bits = 8 * self.size_bytes
        value = dword & ((1 << bits) - 1)
        return value - (1 << bits) if self.signed and value >> (bits - 1) else value


def crc(opcode: int, data: bytes) -> int:
    """CRC-16/XMODEM over opcode, Len-1, then each 16-bit word high byte first."""
    swapped = bytearray(data)
    swapped[0::2], swapped[1::2] = data[1::2], data[0::2]
    return binascii.crc_hqx(bytes([opcode, len(data) // 2 - 1]) + swapped, 0)


def frame_body(opcode: int, data: bytes) -> bytes:
    """What follows the opcode on the line: Len-1, data, CRC (low byte first)."""
    return bytes([len(data) // 2 - 1]) + data + struct.pack("<H", crc(opcode, data))


def bytes_after_length(length_byte: int) -> int:
    """How many bytes (data and CRC) follow the byte Len-1."""
    return 2 * (length_byte + 1) + 2


def frame_data(opcode: int, body: bytes) -> bytes:
    """The data of a frame's body (Len-1, data, CRC); FrameError where length or CRC don't fit."""
    if len(body) < 5 or len(body) != 1 + bytes_after_length(body[0]):
        raise FrameError(f"a frame of {len(body)} bytes doesn't fit its length byte")
    data, (sent,) = body[1:-2], struct.unpack("<H", body[-2:])
    if sent != crc(opcode, data):
        raise FrameError(f"checksum 0x{sent:04X} where 0x{crc(opcode, data):04X} was expected")
    return data


def read_request(entry: Entry, node: int) -> bytes:
    """Data of a ReadObject request."""
    return struct.pack("<HBB", entry.index, entry.subindex, node)


def write_request(entry: Entry, node: int, value: int) -> bytes:
    """Data of a WriteObject request; ValueError where the entry can't hold the value."""
    return read_request(entry, node) + struct.pack("<I", entry.encode(value))


def read_answer(data: bytes) -> tuple[int, int]:
    """(error code, DWORD) of the answer to a ReadObject request."""
    if len(data) != 8:
        raise FrameError(f"an answer to a read has 8 bytes of data, not {len(data)}")
    error, dword = struct.unpack("<II", data)
    return error, dword


def write_answer(data: bytes) -> int:
    """The error code of the answer to a WriteObject request."""
    if len(data) != 4:
        raise FrameError(f"an answer to a write has 4 bytes of data, not {len(data)}")
    (error,) = struct.unpack("<I", data)
    return int(error)
