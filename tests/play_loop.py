"""A plant whose loop is known: play, then a mild cubic, then noise. Angles in degrees."""

import numpy as np
import pandas as pd

from pipeline.recording import Channel, Recording


def triangle(cycles: int, amplitude: float, steps: int) -> np.ndarray:
    """0 -> A -> 0 -> -A -> 0, `steps` a cycle, shape (cycles * steps,)."""
    phase = np.arange(cycles * steps) / steps % 1.0
    return amplitude * np.interp(phase, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])


def curve(shaft: np.ndarray) -> np.ndarray:
    return 0.7 * shaft + 1e-5 * shaft**3


def play(command: np.ndarray, half_width: float) -> np.ndarray:
    state, states = 0.0, []
    for q in command:
        state = min(max(state, q - half_width), q + half_width)
        states.append(state)
    return np.array(states)


def play_recording(
    axis: str, half_width: float, noise: float, seed: int, cycles: int = 9, steps: int = 200
) -> Recording:
    command = triangle(cycles, 60.0, steps)
    clean = curve(play(command, half_width))
    angle = clean + noise * np.random.default_rng(seed).standard_normal(len(clean))
    samples = pd.DataFrame(
        {
            "time_s": 3.0 * np.arange(len(command)),
            "cycle": np.repeat(np.arange(cycles), steps),
            "step": np.tile(np.arange(steps), cycles),
            f"{axis}_command_deg": command,
            f"{axis}_angle_deg": angle,
        }
    )
    channels = (
        Channel(f"{axis}_command_deg", "command", "deg"),
        Channel(f"{axis}_angle_deg", "measurement", "deg"),
    )
    return Recording(samples, channels, "simulated")
