"""The verdict: is what the chosen terms leave still structured, and how many names does it bear?"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import kurtosis, norm, skew

from pipeline.discrepancy.choose import Choice
from pipeline.discrepancy.explain import Explanation
from pipeline.discrepancy.fit import evaluate, improve
from pipeline.discrepancy.rest import Rest, structured_rest
from pipeline.recording import branch_of

SURE, CERTAIN = 5.5, 9.0
SMALLEST_SIZE = 0.2
HEAVY, LIGHT, LOPSIDED, UNEVEN = 1.5, -0.45, 0.45, 40.0
SLOW, SLOW_SHARE = 0.87, 0.5
SWOLLEN, STRAINED = 1.3, 8.0
ENOUGH = 0.7
CHANCE = 4.0  # deviations of what chance gives, which few samples exceed the limits with
INTOLERABLE = 5.0
UNFOLLOWED = 0.7
BINS = 8


@dataclass(frozen=True)
class Structure:
    """Whether a residual is more than noise, where it shows, its share and how likely by chance."""

    found: bool
    where: str | None
    share: float
    p_value: float


def beyond_tolerance(choice: Choice) -> str | None:
    """Which part of the calibration is so far off that it can be no calibration, in words."""
    ground, nuisance = choice.fit.ground, choice.fit.nuisance
    off = np.abs(nuisance - ground.nuisances.expected) / ground.nuisances.deviations
    if off[0] > INTOLERABLE:
        return f"the gain, which is {nuisance[0]:.3g}"
    if off[1] > INTOLERABLE:
        return f"the offset, which is {nuisance[1]:.3g} {ground.problem.around.angle_unit}"
    return None


def follows(explanation: Explanation, choice: Choice) -> bool:
    """Whether the explanation tells the measurement's variation better than its mean would."""
    measured = explanation.problem.measured[explanation.used]
    moves = float(np.std(explanation.problem.simulated[explanation.used])) > 0.0
    noisy = explanation.prior.model.deviation > 0.5 * float(np.std(measured))
    if not moves or (noisy and not choice.fit.pieces):
        return True
    return mean_square(explanation, choice) < UNFOLLOWED * float(np.var(measured))


def structure_of(explanation: Explanation, choice: Choice) -> Structure:
    """What is still structured in the residual of a choice, on training rows.

    It shows in flexible curves of what was commanded, in innovations that are no Gaussian noise
    (their tails, their lean with the direction, their size along the command), in noise that is
    much larger than repeats differ, or in noise that varies as slowly as physics does.
    """
    rests = structured_rest(choice, explanation.search.family)
    noise = choice.fit.ground.noise
    large = SMALLEST_SIZE * noise.deviation
    certain = [r for r in rests if sureness(r) > CERTAIN or (sureness(r) > SURE and r.size > large)]
    signs = odd_signs(explanation, choice)
    if noise.deviation <= 2.0 * explanation.prior.finest:
        return Structure(False, None, 0.0, 1.0)
    where = certain[0].where if certain else next(iter(signs), None)
    size = max([r.size for r in certain], default=0.0)
    if signs:
        size = max(size, excess_size(explanation, choice))
    p_value = min(min((r.p_value for r in rests), default=1.0) * len(rests), 1.0)
    if signs:
        p_value = min(p_value, float(2.0 * norm.sf(SURE)))
    share = min(size**2 / mismatch_variance(explanation), 1.0)
    return Structure(where is not None, where, share, p_value)


def sureness(rest: Rest) -> float:
    """Gain beyond what chance gives, in its deviations."""
    return (rest.gain - rest.freedom) / np.sqrt(2.0 * rest.freedom)


def odd_signs(explanation: Explanation, choice: Choice) -> dict[str, float]:
    """What about the innovations no noise of ours would show, with its size."""
    fit = choice.fit
    apart = slice(None, None, int(fit.ground.noise.spell))
    drive = explanation.problem.motion.drive
    used = np.flatnonzero(fit.ground.used)[apart]
    e, direction = fit.innovations[apart], branch_of(drive)[used]
    noise, learnt = fit.ground.noise, explanation.prior.model.deviation
    tails = float(kurtosis(e))
    heavy, lopsided = CHANCE * np.sqrt(24.0 / len(e)), CHANCE * np.sqrt(6.0 / len(e))
    out: dict[str, float] = {}
    if tails > max(HEAVY, heavy) or tails < min(LIGHT, -heavy):
        out["single samples"] = tails
    if abs(float(skew(e * direction))) > max(LOPSIDED, lopsided):
        out["the direction"] = float(skew(e * direction))
    if np.ptp(drive) > 0 and unevenness(e, drive[used], direction) > UNEVEN:
        out["the command"] = UNEVEN
    share = noise.correlated**2 / noise.deviation**2
    if noise.correlation > SLOW and share > SLOW_SHARE:
        out["slow changes"] = share
    strained = explanation.search.family.strain[choice.place[0]] > STRAINED
    if strained and noise.deviation > SWOLLEN * learnt and explanation.prior.repeats > 0:
        out["every cycle alike"] = noise.deviation / learnt
    return out


def unevenness(e: np.ndarray, drive: np.ndarray, direction: np.ndarray) -> float:
    """Chi-square of the innovations' mean size over bins of command and direction."""
    size = np.abs(e) / np.mean(np.abs(e))
    edges = np.quantile(drive, np.linspace(0, 1, BINS + 1)[1:-1])
    place = 2 * np.digitize(drive, edges) + (direction > 0)
    total = 0.0
    for k in np.unique(place):
        own = size[place == k]
        total += (own.mean() - 1.0) ** 2 * len(own) / max(float(size.var()), 1e-12)
    return total


def excess_size(explanation: Explanation, choice: Choice) -> float:
    """Root mean square of a residual beyond what is rough in it [measurement's unit]."""
    problem = explanation.problem
    residual = np.where(choice.fit.ground.used, problem.measured - choice.fit.predicted, np.nan)
    bend = (residual[2:] - 2.0 * residual[1:-1] + residual[:-2]) / np.sqrt(6.0)
    rough = 1.4826 * float(np.nanmedian(np.abs(bend)))
    return float(np.sqrt(max(np.nanmean(residual**2) - rough**2, 0.0)))


def mismatch_variance(explanation: Explanation) -> float:
    """Variance of measurement minus simulation on training rows, about its mean."""
    problem = explanation.problem
    off = (problem.measured - problem.simulated)[explanation.used]
    return max(float(np.var(off)), 1e-300)


def fewer(explanation: Explanation, choice: Choice) -> Choice:
    """At most one name where a structured rest shows that these terms only mop it up.

    The best single term stays if it alone explains most of the mismatch; otherwise none does.
    """
    if not choice.fit.pieces:
        return choice
    if explanation.problem.motion.kinetics is not None:
        return weightier(explanation, choice)
    base = next(c for c in explanation.choices if not c.fit.pieces)
    singles = [c for c in explanation.choices if len(set(c.fit.names)) == 1]
    if not singles:
        return base
    single = min(singles, key=lambda c: c.score)
    noise = explanation.prior.model.deviation**2
    left, before = (mean_square(explanation, c) - noise for c in (single, base))
    return single if left < (1.0 - ENOUGH) * before else base


def weightier(explanation: Explanation, choice: Choice) -> Choice:
    """Only terms of force that explain more than all of them together leave.

    What explains less may merely mop up the rest. Forces add, so that the others need not go.
    """
    left = mean_square(explanation, choice)
    for piece in choice.fit.pieces:
        rest = [p for p in choice.fit.pieces if p is not piece]
        fit = improve(evaluate(choice.fit.ground, rest))
        if mean_square(explanation, replace(choice, fit=fit)) < 2.0 * left:
            return weightier(explanation, explanation.search.weighed(fit, choice.place))
    return choice


def mean_square(explanation: Explanation, choice: Choice) -> float:
    """Mean square of a choice's residual on the rows fitted."""
    residual = explanation.problem.measured - choice.fit.predicted
    return float(np.mean(residual[explanation.used] ** 2))
