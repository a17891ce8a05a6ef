"""How the plant is driven: the paper's plain cycles, and richer ones."""

from dataclasses import dataclass

import numpy as np

STEPS_PER_CYCLE = 200
RECORDED_CYCLES = 9
LATER_CYCLES = 6
CYCLES = RECORDED_CYCLES + LATER_CYCLES
MOVE_S = 0.36
RICH_SHAPES = ("full", "full", "half", "slow", "cross", "minor", "cross", "minor", "full")
HELD_OUT = (2, 5, 8)


@dataclass(frozen=True)
class Motion:
    """Commands of every sample, shape (n,); the frame of a sample is taken at `time_s`."""

    time_s: np.ndarray
    cycle: np.ndarray
    step: np.ndarray
    pitch_deg: np.ndarray
    yaw_deg: np.ndarray

    def head(self, cycles: int) -> "Motion":
        """The first cycles only."""
        keep = self.cycle < cycles
        return Motion(
            self.time_s[keep], self.cycle[keep], self.step[keep], self.pitch_deg[keep],
            self.yaw_deg[keep],
        )  # fmt: skip


def plain_motion(rng: np.random.Generator) -> Motion:
    """The paper's protocol: 15 equal triangles, one dwell, the other axis at rest."""
    amplitude = rng.uniform(50.0, 60.0)
    pitch = np.tile(amplitude * triangle(STEPS_PER_CYCLE), CYCLES)
    dwell = np.full(len(pitch), 3.0)
    return _motion(rng, pitch, np.zeros(len(pitch)), dwell)


def rich_motion(rng: np.random.Generator) -> Motion:
    """Full and smaller cycles, slow ones, minor loops, and the other axis moving in some.

    The shapes of the nine recorded cycles are shuffled but for the first two, so that each kind
    stands in a cycle that is not held out; the later cycles start over with the first six.
    """
    amplitude = rng.uniform(50.0, 60.0)
    shapes: list[str] = []
    while not {"slow", "cross", "minor"} <= {s for i, s in enumerate(shapes) if i not in HELD_OUT}:
        shapes = [*RICH_SHAPES[:2], *(str(s) for s in rng.permutation(RICH_SHAPES[2:]))]
    parts = [_rich_cycle(rng, shape, amplitude) for shape in shapes]
    parts += parts[:LATER_CYCLES]
    pitch, yaw, dwell = (np.concatenate([part[i] for part in parts]) for i in range(3))
    return _motion(rng, pitch, yaw, dwell)


def triangle(steps: int) -> np.ndarray:
    """One period 0, +1, 0, -1, 0 (the last excluded) in equal steps, shape (steps,)."""
    phase = np.arange(steps) / steps
    return np.asarray(1.0 - 4.0 * np.abs((phase + 0.25) % 1.0 - 0.5))


def _rich_cycle(
    rng: np.random.Generator, shape: str, amplitude: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    n = STEPS_PER_CYCLE
    pitch = amplitude * triangle(n)
    yaw, dwell = np.zeros(n), np.full(n, 3.0)
    if shape == "half":
        pitch = pitch * rng.uniform(0.35, 0.65)
    elif shape == "slow":
        dwell[:] = rng.uniform(9.0, 16.0)
    elif shape == "cross":
        pitch = pitch * rng.choice([0.75, 1.0])
        phase = rng.uniform(0.0, 2 * np.pi)
        turns = rng.integers(2, 5)
        swing = np.sin(2 * np.pi * turns * np.arange(n) / n + phase)
        yaw = rng.uniform(30.0, 45.0) * swing * np.minimum(1.0, np.arange(n) / 10.0)
    elif shape == "minor":
        pitch = _minor_loops(rng, amplitude)
        dwell[:] = rng.choice([3.0, 9.0])
    return pitch, yaw, dwell


def _minor_loops(rng: np.random.Generator, amplitude: float) -> np.ndarray:
    """Out and home on both sides with turns on the way, in one cycle."""
    high, low = rng.uniform(0.5, 0.9), rng.uniform(0.1, 0.4)
    middle = rng.uniform(low + 0.05, high - 0.05)
    corners = amplitude * np.array(
        [0.0, middle, low, high, middle, high, 0.0, -middle, -low, -high, -middle, -high, 0.0]
    )
    travel = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(corners)))])
    where = np.linspace(0.0, travel[-1], STEPS_PER_CYCLE, endpoint=False)
    return np.asarray(np.interp(where, travel, corners))


def _motion(
    rng: np.random.Generator, pitch: np.ndarray, yaw: np.ndarray, dwell_s: np.ndarray
) -> Motion:
    n = len(pitch)
    interval = MOVE_S + dwell_s + rng.uniform(-0.01, 0.01, n)
    cycle, step = np.divmod(np.arange(n), STEPS_PER_CYCLE)
    return Motion(
        np.round(np.cumsum(interval), 3), cycle, step, np.round(pitch, 4), np.round(yaw, 4)
    )
