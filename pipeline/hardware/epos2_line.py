"""Transactions with EPOS2 controllers over one serial port."""

import errno
import termios
import time

import serial
from serial.tools import list_ports

from pipeline.errors import UsageError, refusal
from pipeline.hardware import epos2_frames as frames
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2_frames import Entry
from pipeline.hardware.robot import HardwareError

TRIES = 3
PORT_ERRORS = (serial.SerialException, OSError, termios.error)


class _FailedTryError(Exception):
    """One try of a transaction went wrong: what was found instead of what was expected."""


class Epos2Line:
    """Reads and writes objects of the nodes behind one port.

    A failed try is followed by the wait after which the controller listens for an opcode again,
    then the whole transaction is repeated. The start of a relative move never is: the controller
    may have begun it although its answer was lost.
    """

    def __init__(
        self, port: str | None, baud: int, timeout_s: float = frames.FRAME_TIMEOUT_S
    ) -> None:
        self._timeout_s = timeout_s
        self._port = _open(port, baud, timeout_s)
        self._settled = True

    def read(self, node: int, entry: Entry) -> int:
        """The value of an object, freed of the junk around it."""
        answer = self._transact(node, frames.READ_OBJECT, frames.read_request(entry, node))
        error, dword = frames.read_answer(answer)
        _check(error, node, entry, "its value")
        return entry.decode(dword)

    def write(self, node: int, entry: Entry, value: int) -> None:
        """Set an object; HardwareError where the controller refuses the value."""
        relative = objects.START_BIT | objects.RELATIVE_BIT
        once = entry == objects.CONTROLWORD and value & relative == relative
        data = frames.write_request(entry, node, value)
        answer = self._transact(node, frames.WRITE_OBJECT, data, 1 if once else TRIES)
        _check(frames.write_answer(answer), node, entry, f"to take {value}")

    def close(self) -> None:
        """Give the port back."""
        self._port.close()

    def _transact(self, node: int, opcode: int, data: bytes, tries: int = TRIES) -> bytes:
        where = f"EPOS2 node {node} on {self._port.port} at {self._port.baudrate} baud"
        failure = _FailedTryError()
        try:
            for _ in range(tries):
                self._settle()
                try:
                    return self._try(opcode, data)
                except _FailedTryError as failed:
                    failure = failed
        except PORT_ERRORS as error:
            raise HardwareError(
                refusal(where, "an open serial line", f"{error}",
                        "Plug the adapter in again and check its cable; home the robot anew.")
            ) from error  # fmt: skip
        raise HardwareError(
            refusal(where, "the controller's handshake", f"{failure} ({tries} tries)",
                    "Check that the controller is on, its cable, and that `robot.baud` is the "
                    "controller's own speed (115200 unless object 0x2002 was changed).")
        )  # fmt: skip

    def _settle(self) -> None:
        if not self._settled:
            time.sleep(self._timeout_s)
            self._port.reset_input_buffer()
            self._port.reset_output_buffer()

    def _try(self, opcode: int, data: bytes) -> bytes:
        self._settled = False
        self._port.write(bytes([opcode]))
        self._expect(frames.OKAY)
        self._port.write(frames.frame_body(opcode, data))
        self._expect(frames.OKAY)
        self._expect(bytes([frames.ANSWER]))
        self._port.write(frames.OKAY)
        length = self._receive(1)
        body = length + self._receive(frames.bytes_after_length(length[0]))
        try:
            answer = frames.frame_data(frames.ANSWER, body)
        except frames.FrameError as error:
            self._port.write(frames.FAILED)
            raise _FailedTryError(f"a damaged frame: {error}") from error
        self._port.write(frames.OKAY)
        self._settled = True
        return answer

    def _expect(self, wanted: bytes) -> None:
        found = self._receive(1)
        if found == frames.FAILED:
            raise _FailedTryError("'F', the controller's refusal of a damaged request")
        if found != wanted:
            raise _FailedTryError(f"byte 0x{found[0]:02X} instead of 0x{wanted[0]:02X}: garbage")

    def _receive(self, count: int) -> bytes:
        found = self._port.read(count)
        if len(found) < count:
            raise _FailedTryError(f"no answer within {self._timeout_s:g} s")
        return found


def _open(port: str | None, baud: int, timeout_s: float) -> serial.Serial:
    if not port:
        raise UsageError(
            refusal("robot.port", "a serial port", "none", f"Name one ({_present_ports()}), or "
                    "choose `robot=emulated`.")
        )  # fmt: skip
    try:
        return serial.Serial(port, baud, timeout=timeout_s, write_timeout=timeout_s, exclusive=True)
    except ValueError as error:
        raise UsageError(
            refusal("robot.baud", "a serial speed", f"{baud}", "115200 is the EPOS2's own.")
        ) from error
    except PORT_ERRORS as error:
        found, remedy = _why_closed(error)
        raise HardwareError(
            refusal(f"robot.port={port}", "a free serial port", found, remedy)
        ) from error


def _why_closed(error: BaseException) -> tuple[str, str]:
    cause = error.errno if isinstance(error, OSError) else None
    if cause == errno.ENOENT:
        return "no such port", (
            f"Plug the adapter in and name its port ({_present_ports()}), or choose "
            "`robot=emulated`."
        )
    if cause == errno.EACCES:
        return "no permission to open it", (
            "Join the group that owns the port (often `dialout`) and log in again."
        )
    if cause in (errno.EBUSY, errno.EAGAIN):
        return "it is in use", "End the other program that holds it."
    return f"{error}", "Name a port that an EPOS2 is connected to."


def _present_ports() -> str:
    present = sorted(p.device for p in list_ports.comports())
    return f"present: {', '.join(present)}" if present else "none is present"


def _check(error: int, node: int, entry: Entry, expected: str) -> None:
    if error:
        words = objects.ABORT_WORDS.get(error, "an error this program doesn't know")
        raise HardwareError(
            refusal(f"EPOS2 node {node}, object {entry}", expected,
                    f"error 0x{error:08X}, {words}",
                    "Check `robot.nodes` and the controller's state in EPOS Studio.")
        )  # fmt: skip
