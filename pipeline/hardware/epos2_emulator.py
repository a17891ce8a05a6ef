"""EPOS2 controllers behind a pseudo-terminal: the bytes of the real ones, for any serial client."""

import os
import random
import select
import struct
import termios
import threading
import tty
from collections.abc import Callable, Mapping
from types import TracebackType

from pipeline.clock import Clock
from pipeline.hardware import epos2_frames as frames
from pipeline.hardware.epos2_node import EmulatedNode, seeded_junk

WRONG_NODE = 0x0F00FFB9
RESETS = (0x81, 0x82)
QC_PER_TURN = 65536


class _SilenceError(Exception):
    """The rest of a frame did not come within the frame timeout."""


class _ClosedError(Exception):
    """The emulator is being closed, or its line was cut."""


class Epos2Emulator:
    """Two motors (one for each axis) that a driver reaches at `port`, at one speed only.

    Segmented transfers are refused as unknown opcodes. Close it, or use it as a context manager.
    """

    def __init__(
        self,
        nodes: Mapping[str, int],
        clock: Clock,
        baud: int = 115200,
        qc_per_turn: float = QC_PER_TURN,
        frame_timeout_s: float = frames.FRAME_TIMEOUT_S,
        seed: int = 0,
        junk: Callable[[], int] | None = None,
    ) -> None:
        self._axes = dict(nodes)
        self._qc_per_deg = qc_per_turn / 360.0
        self._speed = getattr(termios, f"B{baud}")
        self._frame_timeout_s = frame_timeout_s
        self._noise = random.Random(seed)
        junk = junk or seeded_junk(seed)
        self.nodes = {number: EmulatedNode(clock, junk) for number in nodes.values()}
        self._lock = threading.Lock()
        self._line, self._far_end = os.openpty()
        tty.setraw(self._far_end)
        self.port = os.ttyname(self._far_end)
        self._wake, self._alarm = os.pipe()
        self._pending = b""
        self._closed = False
        self._thread = threading.Thread(target=self._serve, name="epos2-emulator", daemon=True)
        self._thread.start()

    def shaft_deg(self) -> dict[str, float]:
        """Where each axis' output shaft truly is, counted from where it was switched on."""
        with self._lock:
            return {
                axis: self.nodes[number].motor_qc() / self._qc_per_deg
                for axis, number in self._axes.items()
            }

    def close(self) -> None:
        """End the thread and cut the line."""
        if self._closed:
            return
        self._closed = True
        os.write(self._alarm, b"x")
        self._thread.join()
        for descriptor in (self._line, self._far_end, self._wake, self._alarm):
            os.close(descriptor)

    def __enter__(self) -> "Epos2Emulator":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def transmit(self, data: bytes) -> None:
        """Put bytes on the line."""
        os.write(self._line, data)

    def _serve(self) -> None:
        while True:
            try:
                self._converse()
            except _SilenceError:
                self._pending = b""
            except (_ClosedError, OSError):
                return

    def _converse(self) -> None:
        """One transaction, from its opcode to its last acknowledgement."""
        opcode = self._receive(1, timeout_s=None)[0]
        if opcode not in (frames.READ_OBJECT, frames.WRITE_OBJECT, frames.NMT):
            self.transmit(frames.FAILED)
            return
        self.transmit(frames.OKAY)
        patience_s = self._frame_timeout_s
        length = self._receive(1, patience_s)
        body = length + self._receive(frames.bytes_after_length(length[0]), patience_s)
        try:
            data = frames.frame_data(opcode, body)
        except frames.FrameError:
            self.transmit(frames.FAILED)
            return
        if opcode == frames.NMT:
            if data[2] not in RESETS:
                self.transmit(frames.OKAY)
            return
        self.transmit(frames.OKAY + bytes([frames.ANSWER]))
        answer = self._answer(opcode, data)
        if self._receive(1, patience_s) == frames.OKAY:
            self.transmit(frames.frame_body(frames.ANSWER, answer))
            self._receive(1, patience_s)

    def _answer(self, opcode: int, data: bytes) -> bytes:
        index, subindex, number = struct.unpack("<HBB", data[:4])
        with self._lock:
            node = self.nodes.get(number)
            if opcode == frames.READ_OBJECT:
                read = node.read(index, subindex) if node else (WRONG_NODE, 0)
                return struct.pack("<II", *read)
            (dword,) = struct.unpack("<I", data[4:8])
            written = node.write(index, subindex, dword) if node else WRONG_NODE
            return struct.pack("<I", written)

    def _receive(self, count: int, timeout_s: float | None) -> bytes:
        """The next bytes; None waits for ever."""
        while len(self._pending) < count:
            ready, _, _ = select.select([self._line, self._wake], [], [], timeout_s)
            if self._wake in ready:
                raise _ClosedError
            if not ready:
                raise _SilenceError
            heard = os.read(self._line, 4096)
            if not heard:
                raise _ClosedError
            if termios.tcgetattr(self._line)[5] == self._speed:
                self._pending += heard
            else:
                self._mishear(heard)
        wanted, self._pending = self._pending[:count], self._pending[count:]
        return wanted

    def _mishear(self, heard: bytes) -> None:
        """At another speed than its own the controller hears nonsense, and its refusals are too."""
        nonsense = bytes(self._noise.randrange(0x80, 0x100) for _ in heard)
        if self._noise.random() < 0.5:
            self.transmit(nonsense)
