"""A zero that wanders smoothly and by more than the noise, whatever is commanded: a drift."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from pipeline.discrepancy.fitting.charge import complexity
from pipeline.discrepancy.fitting.fit import Fit, evaluate, improve
from pipeline.discrepancy.judgement.cycle_zero import leaves_less, told_as_drift
from pipeline.discrepancy.judgement.fanning import even_by_chance
from pipeline.discrepancy.judgement.recurrence import foretold_share
from pipeline.discrepancy.judgement.rest import curves, followed
from pipeline.discrepancy.judgement.structure import CHANCE, SMALLEST_SIZE
from pipeline.discrepancy.model.intervals import DEVIATIONS
from pipeline.discrepancy.model.result import Estimate, Evidence, NamedPhysics
from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.noise.smooth_zero import SmoothZero, likeliest_zero
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.refuted import SURELY, shared
from pipeline.discrepancy.search.weighing import Choice, by_names
from pipeline.number_words import worded
from pipeline.physics.drift import Drift
from pipeline.physics.play_operator import play

SAYS = "The zero wanders smoothly, by about {size} {unit}: no command foretells it."
FAR = 4.0  # variance of what is left, over that of the noise beside the wander
WITNESSED, FARTHER = 2.0, 3.0  # the same where cycles that repeat say what noise is
SMOOTHER, SURELY_SMOOTHER = 3.0, 8.0  # log likelihood of a smooth zero over one that walks
LEAD = 22.0  # log likelihood of a zero over all else that may wander
FASTEST_PACE, MOST_SETS = 12.0, 10  # per cycle
AS_FAST, AS_LARGE = 1.0, 0.1  # per cycle; of the motion: what a mechanism does late is both
PLAYS, PIVOTS = (0.02, 0.05, 0.1, 0.25), (-0.25, 1.25, 0.0, 0.25, 0.5, 0.75, 1.0)  # of the range
MIDDLES, ABOUT, UNEVEN = (0.3, 0.4, 0.5, 0.6, 0.7), 0.25, 0.02
SWINGS, SWUNG, FINELY = 4.0, 0.6, 0.2  # one period that holds so much, so often, is no drift
ALIKE_OVER = 2.5  # over the pace: so many rows of a smooth zero say one thing of its variance


@dataclass(frozen=True)
class Beside:
    """A fit beside a zero that wanders smoothly.

    left: (n,) what the fit leaves, refitted to first order beside such a zero, 0 where not used.
    """

    fit: Fit
    left: np.ndarray
    zero: SmoothZero
    log_likelihood: float

    @property
    def score(self) -> float:
        """-2 log evidence, as of a choice."""
        return complexity(self.fit) - 2.0 * self.log_likelihood

    @property
    def noise(self) -> NoiseModel:
        """The noise beside the zero."""
        return NoiseModel(self.zero.white, self.zero.fast, self.zero.correlation)

    @property
    def size(self) -> float:
        """Root mean square of the wander [measurement's unit]."""
        variance = float(np.var(self.left[self.fit.ground.used]))
        return float(np.sqrt(max(variance - self.zero.deviation**2, 0.0)))

    @property
    def course(self) -> np.ndarray:
        """Where the zero is in each row (n,), as the rows before foretell it."""
        used, measured = self.fit.ground.used, self.fit.ground.problem.measured
        e, _ = self.zero.innovations(self.left[:, None], np.ones(len(used)), used)
        rows = np.flatnonzero(used)
        foretold = (measured - self.fit.predicted)[rows] - self.noise.deviation * e[:, 0]
        return np.interp(np.arange(len(used)), rows, foretold)


def wandering(explanation: Explanation, best: Choice) -> tuple[Explanation, Beside] | None:
    """The explanation beside a zero that wanders smoothly, if that is what the best choice leaves.

    Its choices weighed anew, the best one first, and that beside the zero. Cycles that repeat, if
    any do, have to bear it out, and it must be the zero that wanders: nothing of what is left
    follows the commands, and what wanders is surely as large at each command and in each direction,
    not like a gain or play that wanders.
    """
    problem, prior = explanation.problem, explanation.prior
    if problem.derivatives is not None:
        return None
    first, *others = reconsidered(explanation, best)
    begun = beside(first)
    if not may_wander(begun, prior):
        return None
    found = sorted([begun, *map(beside, others)], key=lambda b: b.score)
    choices, told = [Choice(b.fit, best.place, b.score) for b in found], found[0]
    if not (may_wander(told, prior) and leaves_less(choices[0])):
        return None
    if follows_commands(explanation, told) or not (is_zero(told) and spreads_evenly(told)):
        return None
    return replace(explanation, choices=choices, zero=told.course), told


def smoother_than_a_walk(choice: Choice) -> bool:
    """Whether what a choice takes for a zero that walks is surely likelier a smooth change.

    A walk at random is as rough as it is far. The farther, the less it takes.
    """
    ground, fit = choice.fit.ground, choice.fit
    left = (ground.problem.measured - fit.predicted)[ground.used]
    far = float(np.var(left)) / ground.noise.deviation**2
    if ground.noise.walk == 0.0 or far < WITNESSED:
        return False
    walk = -0.5 * float(fit.innovations @ fit.innovations) - ground.log_scale
    smoother = beside(fit).log_likelihood - walk
    return smoother > (SURELY_SMOOTHER if far < FARTHER else SMOOTHER)


def may_wander(found: Beside, prior: NoisePrior) -> bool:
    """Whether what is left may be such a zero: far beyond the noise, slow, on no louder noise.

    Where nothing repeats, none that moves as fast as the mechanism and by much of its motion.
    """
    ground = found.fit.ground
    rows = len(ground.used) / len(np.unique(ground.problem.cycle))
    least = WITNESSED if prior.repeats > 0 else FAR
    far = np.var(found.left[ground.used]) > least * found.zero.deviation**2
    paced = found.zero.pace * rows
    if prior.repeats == 0 and paced > AS_FAST and found.size > AS_LARGE * motion_of(found):
        return False
    louder = np.log(found.zero.deviation / prior.model.deviation) > SURELY * prior.sure
    return bool(far and paced < FASTEST_PACE and not louder)


def motion_of(found: Beside) -> float:
    """Root mean square of what was measured about its mean [measurement's unit]."""
    ground = found.fit.ground
    return float(np.std(ground.problem.measured[ground.used]))


def reconsidered(explanation: Explanation, best: Choice) -> list[Fit]:
    """What may be said beside a zero that wanders: the choices' fits without drifts and slips."""
    found: dict[frozenset[str], Fit] = {}
    likely = [best, *sorted(by_names(explanation.choices), key=lambda c: c.score)]
    for choice in likely:
        pieces = choice.fit.pieces
        steady = [p for p in pieces if p.term.name != Drift.name]
        for rest in ([p for p in steady if not p.term.slow], steady):
            told = frozenset(p.term.name for p in rest)
            if told not in found and len(found) < MOST_SETS:
                found[told] = improve(evaluate(choice.fit.ground, rest))
    if frozenset() not in found:
        found[frozenset()] = evaluate(best.fit.ground, [])
    return list(found.values())


def beside(fit: Fit, carrier: np.ndarray | None = None) -> Beside:
    """The fit beside the likeliest zero that wanders smoothly.

    carrier: (n,) what wanders is multiplied with in each row, where it is no zero.
    """
    ground = fit.ground
    used, taken = ground.used, followed(fit)
    carrier = np.ones(len(used)) if carrier is None else carrier
    left = np.where(used, ground.problem.measured - fit.predicted, 0.0)
    left = left - taken @ np.linalg.lstsq(taken[used], left[used], rcond=None)[0]
    _, zero = likeliest_zero(left, carrier, used)
    white, _ = zero.innovations(np.column_stack([left, taken]), carrier, used)
    left = left - taken @ np.linalg.lstsq(white[:, 1:], white[:, 0], rcond=None)[0]
    likelihood, zero = likeliest_zero(left, carrier, used, (zero,))
    return Beside(fit, left, zero, likelihood)


def follows_commands(explanation: Explanation, found: Beside) -> bool:
    """Whether something of what is left beside the zero follows the commands, or foretells more."""
    ground = found.fit.ground
    used, steady = ground.used, np.ones(len(ground.used))
    taken = followed(found.fit)

    def white(columns: np.ndarray) -> np.ndarray:
        return found.zero.innovations(np.where(used[:, None], columns, 0.0), steady, used)[0]

    e = white(found.left[:, None])[:, 0]
    gain, freedom, _ = shared(e, used, explanation.prior.groups)
    if chdtrc(max(freedom, 1), gain) < CHANCE or foretold_share(e)[0]:
        return True
    own = np.linalg.qr(white(taken))[0]
    families = curves(ground.problem).values()
    for columns in families:
        free = white(columns)
        free = free - own @ (own.T @ free)
        basis, sizes, _ = np.linalg.svd(free, full_matrices=False)
        basis = basis[:, sizes > 1e-6 * sizes[0]]
        gain, freedom = float(np.sum((basis.T @ e) ** 2)), basis.shape[1]
        small = gain - freedom < SMALLEST_SIZE**2 * len(e)
        if chdtrc(freedom, gain) * len(families) < CHANCE and not small:
            return True
    return False


def is_zero(found: Beside) -> bool:
    """Whether a zero is surely likelier to wander than a gain or play.

    The gain about any pivot, also a quarter of the range beyond it, which moves one end five times
    as far as the other; or to either side of one, as far everywhere or the less the nearer.
    """
    least = found.log_likelihood - LEAD
    others = carriers(found.fit.ground.problem.motion.drive)
    return all(beside(found.fit, c).log_likelihood < least for c in others)


def spreads_evenly(found: Beside) -> bool:
    """Whether what is left varies alike wherever the drive is, as far as chance can tell."""
    ground = found.fit.ground
    left = np.where(ground.used, found.left, np.nan)
    return even_by_chance(ground.problem.motion.drive, left) > UNEVEN


def swing_of(found: Beside) -> str | None:
    """What swings with one period time and again, in words; None where a zero wanders at will.

    By least squares at each frequency, as cycles that are held out would come again themselves on
    the grid of a `hum` (Lomb, Astrophys. Space Sci. 39 (1976) 447).
    """
    from scipy.signal import lombscargle

    ground = found.fit.ground
    time_s, left = ground.problem.motion.time_s[ground.used], found.left[ground.used]
    most = FASTEST_PACE * len(np.unique(ground.problem.cycle))
    periods = np.arange(0.5, most, FINELY)
    span_s = float(np.ptp(time_s))
    shares = lombscargle(time_s, left - left.mean(), 2.0 * np.pi * periods / span_s, normalize=True)
    best = int(np.argmax(shares))
    if shares[best] < SWUNG or periods[best] < SWINGS:
        return None
    return f"a swing in time, again and again every {worded(span_s / periods[best])} s"


def carriers(drive: np.ndarray) -> Iterator[np.ndarray]:
    """What else may wander by a command (n,): what that is multiplied with in each row, (n,)."""
    low, span = float(drive.min()), max(float(np.ptp(drive)), 1e-300)
    place = (drive - low) / span
    yield np.abs(place - 0.5)
    for pivot in PIVOTS:
        yield place - pivot
    for middle in MIDDLES:
        yield np.tanh((place - middle) / ABOUT)
    for width in PLAYS:
        yield direction(place, width)


def direction(drive: np.ndarray, width: float) -> np.ndarray:
    """The side (n,), from -1 to 1, at which a command stands in play of +-width round it."""
    return np.asarray((drive - play(drive, width, float(drive[0]))) / width)


def zero_that_wanders(found: Beside, evidence: Evidence) -> NamedPhysics:
    """The drift of a zero that wanders smoothly: the deviation of that."""
    size, unit = found.size, found.fit.ground.problem.around.angle_unit
    apart = found.zero.pace * found.fit.ground.count / ALIKE_OVER
    spread = DEVIATIONS / float(np.sqrt(2.0 * apart))
    low, high = size * max(1.0 - spread, 0.0), size * (1.0 + spread)
    told = Estimate("deviation", size, low, high, unit)
    return told_as_drift(evidence, told, SAYS.format(size=worded(size), unit=unit))
