"""What the benchmarks share: a plant with play, and times of rivals taken in turn."""

import time
from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

from pipeline.physics.play_operator import play
from pipeline.recording import Channel, Recording

ROUNDS = 7


def best_s(rivals: Mapping[str, Callable[[], object]]) -> dict[str, float]:
    """Best time [s] of each rival; they take turns, so that a busy machine hurts all alike."""
    found = dict.fromkeys(rivals, float("inf"))
    for _ in range(ROUNDS):
        for name, work in rivals.items():
            began = time.perf_counter()
            work()
            found[name] = min(found[name], time.perf_counter() - began)
    return found


def pitch_recording(cycles: int = 6, steps: int = 200) -> Recording:
    """Cycles of a pitch axis with +-2 deg of play and 0.45 deg of noise."""
    phase = np.arange(cycles * steps) / steps % 1.0
    command = 60.0 * np.interp(phase, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    shaft = play(command, 2.0, 0.0)
    angle = 0.7 * shaft + 1e-5 * shaft**3
    angle += 0.45 * np.random.default_rng(0).standard_normal(len(angle))
    samples = pd.DataFrame(
        {
            "time_s": 3.0 * np.arange(len(command)),
            "cycle": np.repeat(np.arange(cycles), steps),
            "step": np.tile(np.arange(steps), cycles),
            "pitch_command_deg": command,
            "pitch_angle_deg": angle,
        }
    )
    channels = (
        Channel("pitch_command_deg", "command", "deg"),
        Channel("pitch_angle_deg", "measurement", "deg"),
    )
    return Recording(samples, channels, "simulated")
