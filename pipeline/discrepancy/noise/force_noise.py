"""The noise of a force against motion: what a flexible law of force leaves."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.noise.hats import hats
from pipeline.discrepancy.noise.noise import SLOW_CORRELATION, NoiseModel
from pipeline.discrepancy.noise.serial import fit_serial_noise
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.rows import Averaged, averaged_evenly
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Kinetics
from pipeline.physics.pre_sliding import sliding

REACHES = (1e-5, 1e-3, 0.01, 0.05, 0.3)
SLOW, BENDS = 5, 12
LONGEST_SHARE = 0.1
LEAST_SPELL, CROWDED = 1.0 + 1e-9, 0.2
MEDIAN_SQUARE = 0.4549  # of a standard normal: the median does not count corners and outliers


def noise_of_force(problem: Problem, kinetics: Kinetics) -> NoiseModel:
    """White noise of the size that a flexible law leaves on training rows, and its spell.

    The law is linear in powers of position, velocity and acceleration, in BENDS hats over position
    and velocity, in SLOW polynomials of time, and in dry friction of several pre-sliding travels,
    each with a part that differs by direction. What it leaves is as
    much the drive's own unevenness as noise, and varies slowly: weighing it by its spectrum would
    make all of the fit's say rest on its quickest moments. So rows weigh alike, and count as one in
    a spell, the sum of the residual's autocorrelations up to the first that is not positive (Geyer,
    Stat. Sci. 7 (1992) 473). Where so large a law follows much of the noise as well (CROWDED), the
    spell is that of the likeliest noise around it, which accounts for that (`serial.py`), unless
    that is as slow as physics.
    """
    rows = np.flatnonzero(problem.train & np.isfinite(problem.measured))
    columns = _law(problem, kinetics)[rows]
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    measured = problem.measured[rows]
    weights = np.linalg.lstsq(columns / size, measured, rcond=1e-9)[0]
    left = measured - columns / size @ weights
    freedom = max(len(rows) - columns.shape[1], 1)
    spell = max(spell_of(left, rows), LEAST_SPELL)
    if columns.shape[1] * spell > CROWDED * len(rows):
        around = fit_serial_noise(measured, rows, columns)
        spell = max(spell, around.spell if around.correlation <= SLOW_CORRELATION else spell)
    return NoiseModel(white=float(np.sqrt(left @ left / freedom)), spell=spell)


def noise_of_samples(
    noise: NoiseModel, problem: Problem, blocks: Averaged, mechanism: Mechanism
) -> NoiseModel:
    """The noise of one sample, given that of block means: what varies within a block comes on top.

    problem: with all samples; its training rows within `blocks` tell. Block means are no noisier
    than what a mechanism leaves of them: terms may fit a force better than a flexible law does.
    """
    left = problem.measured - mechanism.respond(problem.motion)[0]
    means = blocks.mean(left)[:, None]
    within = (left[blocks.samples] - means) ** 2
    wanted = problem.train[blocks.samples] & np.isfinite(within)
    if not wanted.any():
        return noise
    inside = float(np.median(within[wanted])) / MEDIAN_SQUARE
    between = min(noise.white**2, float(np.mean(np.broadcast_to(means, wanted.shape)[wanted] ** 2)))
    return replace(noise, white=float(np.sqrt(between + inside)))


def _law(problem: Problem, kinetics: Kinetics) -> np.ndarray:
    around = problem.around
    x = (problem.motion.drive - around.drive_low) / max(around.drive_span, 1e-300) - 0.5
    v = kinetics.velocity / max(around.top_speed, 1e-300)
    a = kinetics.acceleration
    blocks = problem.averaged or averaged_evenly(problem.motion, 1)
    reaches = np.array(REACHES) * around.drive_span
    way, rows = blocks.motion.way
    banks = [sliding(way, r, 1.0, None)[0][rows] for r in reaches]
    own = [np.ones_like(x), x, x**2, x**3, v, v * np.abs(v), v**3, a, np.abs(a)]
    sided = [blocks.mean(z) for bank in banks for z in (bank, np.abs(bank))]
    t = problem.motion.time_s
    u = 2.0 * (t - t[0]) / max(t[-1] - t[0], 1e-300) - 1.0
    slow = np.polynomial.legendre.legvander(u, SLOW)[:, 1:]
    bends = np.column_stack([hats(np.clip(v, -1, 1), BENDS), hats(x, BENDS)])
    return np.column_stack([kinetics.simulated, *own, *sided, slow, bends])


def spell_of(values: np.ndarray, rows: np.ndarray) -> float:
    """How many neighbouring values, (m,) at rising row numbers, say the same on average."""
    whole = np.zeros(int(rows[-1] - rows[0]) + 1)
    there = np.zeros_like(whole)
    whole[rows - rows[0]] = values
    there[rows - rows[0]] = 1.0
    square = float(values @ values)
    if square == 0.0:
        return 1.0
    total = 1.0
    for lag in range(1, int(LONGEST_SHARE * len(values))):
        pairs = float(there[lag:] @ there[:-lag])
        if pairs == 0.0:
            break
        correlation = float(whole[lag:] @ whole[:-lag]) / pairs / (square / len(values))
        if correlation <= 0.0:
            break
        total += 2.0 * correlation
    return total
