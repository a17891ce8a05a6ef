"""An emulator whose line can damage or lose chosen answers."""

from collections.abc import Callable
from typing import Any

from pipeline.clock import Clock
from pipeline.hardware.epos2_emulator import Epos2Emulator

NODES = {"yaw": 1, "pitch": 2}
FRAME_TIMEOUT_S = 0.1


class LossyEmulator(Epos2Emulator):
    """`disturb` gets every transmission and gives what arrives of it."""

    def __init__(self, clock: Clock, **rest: Any) -> None:
        self.disturb: Callable[[bytes], bytes] = lambda data: data
        super().__init__(NODES, clock, frame_timeout_s=FRAME_TIMEOUT_S, **rest)

    def transmit(self, data: bytes) -> None:
        super().transmit(self.disturb(data))


def spoil_once(change: Callable[[bytes], bytes], longer_than: int = 3) -> Callable[[bytes], bytes]:
    """Change the first answer frame only."""
    left = [change]
    return lambda data: left.pop()(data) if left and len(data) > longer_than else data
