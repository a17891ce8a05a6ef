"""A simulation whose gain is no knowledge: a fit of the recording, or friction that is rigid."""

from dataclasses import replace

import numpy as np

from pipeline.config import ToleranceConfig
from pipeline.physics.kinematics import legendre
from pipeline.physics.motion import Motion

ORTHOGONAL = 0.02
CUBIC = 2
LOOSE_GAIN = 3.0
LEAST_JUMP, RIGID = 1e-3, 0.9
MOVING, TOP = 0.05, 0.99
LEAST_TOLD, ROUNDING = 1e-3, 1e-7


def tolerance_of_fit(
    declared: ToleranceConfig,
    measured: np.ndarray,
    simulated: np.ndarray,
    drive: np.ndarray,
    heldout: np.ndarray,
) -> ToleranceConfig:
    """The declared tolerance, or a wide one where the simulation was fitted to the measurement.

    Least squares leave a residual that neither gain nor offset lessens, and that of a curve none
    that a bend over the drive (n,) lessens. A loop in the measurement has spoilt all of these: a
    play as wide as half the range halves the gain. So none of them is held against the terms.
    Where the simulation is straight over the drive, its bend stays as declared; a shape beyond
    that declared means that its own is no knowledge either. heldout: (n,) rows that the fit may
    have left out, or have seen: this is the one question that they are asked.
    """
    known = np.isfinite(measured) & np.isfinite(simulated)
    for rows in (known, known & ~heldout):
        found = _tolerance_of_fit(declared, measured[rows], simulated[rows], drive[rows])
        if found is not declared:
            return found
    return declared


def _tolerance_of_fit(
    declared: ToleranceConfig, measured: np.ndarray, simulated: np.ndarray, drive: np.ndarray
) -> ToleranceConfig:
    off = measured - simulated
    if not np.ptp(simulated) > 0.0:
        return declared
    left = float(np.std(off))
    lines = np.column_stack([np.ones(len(off)), simulated - simulated.mean()])
    if not lessens_nothing(off, lines):
        return declared
    loose = replace(
        declared,
        gain=max(declared.gain, LOOSE_GAIN),
        offset=max(declared.offset, left),
    )
    straight = np.polyval(np.polyfit(drive, simulated, 1), drive)
    bent = float(np.std(simulated - straight))
    middle, half = 0.5 * (drive.max() + drive.min()), max(0.5 * float(np.ptp(drive)), 1e-300)
    bends = legendre((drive - middle) / half)[:, :CUBIC]
    fitted = lessens_nothing(off, bends - bends.mean(axis=0))
    if fitted and bent > ORTHOGONAL * float(np.std(simulated)):
        loose = replace(loose, shape=max(declared.shape, float(np.hypot(left, bent))))
    return loose


def tolerance_of_rigid(declared: ToleranceConfig, motion: Motion) -> ToleranceConfig:
    """The declared tolerance, or a wide gain where a simulated force jumps with the direction.

    Dry friction that turns round gradually takes the place of one that jumps; it is no addition.
    The simulation jumps where the direction tells RIGID of what is left of it beside powers of
    position, velocity and acceleration, away from standstill, where noise turns the direction.
    """
    kinetics = motion.kinetics
    assert kinetics is not None
    fast = np.abs(kinetics.velocity) > MOVING * np.quantile(np.abs(kinetics.velocity), TOP)
    simulated, v = kinetics.simulated[fast], kinetics.velocity[fast]
    if not len(v):
        return declared
    x = motion.drive[fast] - motion.drive.mean()
    acceleration = kinetics.acceleration[fast]
    law = np.column_stack([np.ones(len(x)), x, x**3, v, v * np.abs(v), acceleration])
    whole = float(np.var(simulated))
    smooth = variance_left(simulated, law)
    jumping = variance_left(simulated, np.column_stack([law, np.sign(v)]))
    rigid = smooth > LEAST_JUMP * whole and jumping < (1.0 - RIGID) * smooth
    return replace(declared, gain=max(declared.gain, LOOSE_GAIN)) if rigid else declared


def goes_by(motion: Motion) -> tuple[bool, bool]:
    """Whether some of a simulated force goes by the speed, as friction does, and by acceleration.

    Either tells LEAST_TOLD of the force's variance beside the other and powers of the position. One
    that stays the same, but for rounding, goes by neither.
    """
    kinetics = motion.kinetics
    assert kinetics is not None
    simulated, v, a = kinetics.simulated, kinetics.velocity, kinetics.acceleration
    x = motion.drive - motion.drive.mean()
    law = [np.ones(len(x)), x, x**2, x**3]
    friction, inertia = [v, v * np.abs(v), np.sign(v)], [a]
    every = variance_left(simulated, np.column_stack([*law, *friction, *inertia]))
    without = [
        variance_left(simulated, np.column_stack([*law, *rest])) for rest in (inertia, friction)
    ]
    rounding = (ROUNDING * float(np.max(np.abs(simulated)))) ** 2
    least = max(LEAST_TOLD * float(np.var(simulated)), rounding)
    return without[0] - every > least, without[1] - every > least


def variance_left(values: np.ndarray, columns: np.ndarray) -> float:
    """Variance of values (n,) that least squares in columns (n, k) leave."""
    sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    weights = np.linalg.lstsq(columns / sizes, values, rcond=1e-9)[0]
    return float(np.mean((values - columns / sizes @ weights) ** 2))


def lessens_nothing(off: np.ndarray, columns: np.ndarray) -> bool:
    """Whether each of some columns (n, k) correlates less than ORTHOGONAL with a residual (n,)."""
    sizes = np.sqrt(np.sum(columns**2, axis=0) * float(off @ off))
    return bool(np.all(np.abs(off @ columns) < ORTHOGONAL * np.maximum(sizes, 1e-300)))
