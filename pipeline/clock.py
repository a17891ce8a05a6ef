"""Time as the robot and its operator share it: real, or simulated so that pauses cost nothing."""

import threading
import time
from typing import Protocol


class Clock(Protocol):
    """What acquisition, driver and emulator need of time."""

    def now_s(self) -> float:
        """Seconds since the clock was made; never goes back."""
        ...

    def sleep_s(self, duration_s: float) -> None:
        """Let `duration_s` seconds pass on this clock."""
        ...


class RealClock:
    """The machine's monotonic clock."""

    def __init__(self) -> None:
        self._start_s = time.monotonic()

    def now_s(self) -> float:
        return time.monotonic() - self._start_s

    def sleep_s(self, duration_s: float) -> None:
        time.sleep(max(0.0, duration_s))


class SimulatedClock:
    """A clock that moves only when somebody sleeps on it. Safe to share between threads."""

    def __init__(self) -> None:
        self._now_s = 0.0
        self._lock = threading.Lock()

    def now_s(self) -> float:
        with self._lock:
            return self._now_s

    def sleep_s(self, duration_s: float) -> None:
        with self._lock:
            self._now_s += max(0.0, duration_s)
