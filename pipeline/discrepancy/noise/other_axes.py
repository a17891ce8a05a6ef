"""What other axes, whose commands repeat nothing, may do to a joint whose own command repeats."""

import numpy as np

from pipeline.discrepancy.noise.contrast import few, free_of, numbered
from pipeline.physics.motion import Motion


def ways_of_others(motion: Motion) -> np.ndarray:
    """Four columns (n, 4) for the command of each other axis, one after the other.

    It moves the joint in proportion, by its square, beside the joint's own command, or by its pace.
    """
    own = motion.drive - motion.drive.mean()
    columns = []
    for other in motion.others.values():
        moved = other - other.mean()
        columns += [moved, moved**2, moved * own, np.diff(other, prepend=other[:1])]
    found = np.column_stack(columns)
    return np.asarray(found / np.maximum(np.std(found, axis=0), 1e-12))


def contrasted(values: np.ndarray, rows: np.ndarray, ways: np.ndarray) -> list[np.ndarray]:
    """Contrasts of values (repeats, steps) and, beside each, of ways (n, m): (k, 1 + m) each.

    As `learning.contrasts`, of the steps alone at which each repeat of `rows` was measured.
    """
    steps = np.isfinite(values).all(axis=0)
    if len(rows) < 3 or few(steps):
        return []
    free = free_of(numbered(rows), 1)
    beside = np.concatenate([values[:, steps, None], ways[rows[:, steps]]], axis=2)
    found = np.einsum("rj,rsm->jsm", free, beside)
    return list(found - found.mean(axis=1, keepdims=True))


def without_ways(series: list[np.ndarray]) -> list[np.ndarray]:
    """The values of contrasts (k, 1 + m) without what a line in the ways explains of all."""
    every = np.vstack(series)
    factors = np.linalg.lstsq(every[:, 1:], every[:, 0], rcond=None)[0]
    return [s[:, 0] - s[:, 1:] @ factors for s in series]
