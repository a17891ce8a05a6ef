"""Names that are known to give the same data under commands of one kind."""

import numpy as np

from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.backlash import Backlash
from pipeline.physics.catalogue import BENDS, terms
from pipeline.physics.friction import Friction

SAME_AT_ONE_DWELL = (frozenset({"creep", "response_lag"}),)
SAME_AT_ONE_SPEED = (
    frozenset({"friction", "creep", "response_lag"}),
    frozenset({"backlash", "frame_lag", "response_lag"}),
)
DIFFERENT = 0.2
FEW = 0.02
IN_STEP = ("inertia", "stiffness")
ALONG = 0.99


def equivalents(name: str, problem: Problem) -> list[str]:
    """Names that are known to give the same data as `name` under such commands.

    What bends one static curve is one family in any data. Creep and lags remember time, friction
    and play remember travel: at one dwell and one step these are the same. What may be play may be
    friction, too, whose wire gives way by little.
    """
    if problem.motion.kinetics is not None:
        return [n for n in IN_STEP if name in IN_STEP and n != name and in_step(problem)]
    families = [BENDS]
    if other_dwells(problem) <= FEW:
        families += SAME_AT_ONE_DWELL
        families += SAME_AT_ONE_SPEED if other_steps(problem) <= FEW else ()
    shown = {t.name for t in terms() if t.excited(problem.motion, problem.around)}
    found = {n for family in families if name in family for n in family} - {name}
    found |= {Friction.name} if Backlash.name in found else set()
    return sorted(found & shown)


def in_step(problem: Problem) -> bool:
    """Whether acceleration follows position, as at one frequency: a mass is a negative spring.

    Jolts, as between two sines, do not count.
    """
    kinetics = problem.motion.kinetics
    if kinetics is None:
        return False
    rows = problem.train & (np.abs(kinetics.acceleration) <= problem.around.top_acceleration)
    along = np.corrcoef(problem.motion.drive[rows], kinetics.acceleration[rows])[0, 1]
    return bool(abs(along) > ALONG)


def other_dwells(problem: Problem) -> float:
    """Share of the training rows whose command had been held much longer or shorter than usual."""
    time_s, moved = problem.motion.time_s, ~problem.motion.stands
    last = np.flatnonzero(moved)[np.cumsum(moved) - 1]
    held_s = time_s - time_s[np.maximum(last - 1, 0)]
    return _unusual(held_s[1:][problem.train[1:]])


def other_steps(problem: Problem) -> float:
    """Share of the training rows to which the drive moved by another step than usual."""
    return _unusual(np.abs(np.diff(problem.motion.drive))[problem.train[1:]])


def _unusual(sizes: np.ndarray) -> float:
    middle = float(np.median(sizes)) if len(sizes) else 0.0
    return float(np.mean(np.abs(sizes - middle) > DIFFERENT * middle)) if len(sizes) else 0.0
