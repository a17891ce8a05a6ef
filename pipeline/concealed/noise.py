"""What blurs a measurement: noise, a zero that jumps or wanders, lost frames, mistaken markers."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Noise:
    """Sizes of the disturbances [deg]; shares are of the frames."""

    sigma_deg: float
    correlation: float = 0.0
    jitter_deg: float = 0.0
    walk_deg: float = 0.0
    lost_share: float = 0.0
    mistaken_share: float = 0.0
    mistaken_deg: float = 0.0
    decoy: bool = False


def disturbance(noise: Noise, cycle: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Noise, jitter of each cycle's zero and random walk [deg], shape (n,).

    `walk_deg` is the deviation that the walk has reached, on average, after the recording.
    """
    n = len(cycle)
    shocks = rng.standard_normal(n)
    blur = np.empty(n)
    blur[0] = shocks[0]
    keep = np.sqrt(1.0 - noise.correlation**2)
    for i in range(1, n):
        blur[i] = noise.correlation * blur[i - 1] + keep * shocks[i]
    zero = rng.standard_normal(int(cycle.max()) + 1)[cycle]
    walk = np.cumsum(rng.standard_normal(n)) / np.sqrt(n)
    return np.asarray(noise.sigma_deg * blur + noise.jitter_deg * zero + noise.walk_deg * walk)


def mistaken(noise: Noise, n: int, rng: np.random.Generator) -> np.ndarray:
    """Error of the frames in which another thing was taken for the marker [deg], else 0, (n,)."""
    error = np.zeros(n)
    count = round(noise.mistaken_share * n)
    rows = rng.choice(np.arange(5, n - 5), size=count, replace=False)
    sign = np.ones(count) if noise.decoy else rng.choice([-1.0, 1.0], count)
    error[rows] = sign * noise.mistaken_deg * rng.uniform(0.8, 1.2, count)
    return error


def lost(noise: Noise, n: int, rng: np.random.Generator) -> np.ndarray:
    """Which frames were lost, singly and in bursts, bool (n,)."""
    gone = np.zeros(n, dtype=bool)
    wanted = noise.lost_share * n
    while gone.sum() < wanted:
        start, length = int(rng.integers(0, n)), int(rng.choice([1, 1, 1, 3, 8]))
        gone[start : start + length] = True
    return gone
