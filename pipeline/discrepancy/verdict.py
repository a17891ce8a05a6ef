"""The verdict: is what the chosen terms leave still structured, and how many names does it bear?"""

from dataclasses import dataclass, replace

import numpy as np

from pipeline.discrepancy.calibration import FAR_OFF
from pipeline.discrepancy.choose import SLOW, Choice, wanders
from pipeline.discrepancy.explain import Explanation
from pipeline.discrepancy.fit import evaluate, improve
from pipeline.discrepancy.noise import NoiseModel
from pipeline.discrepancy.noise_family import WALKS, Place
from pipeline.discrepancy.rest import repeated_rest, structured_rest, two_valued
from pipeline.discrepancy.ties import names

CHANCE = 1e-5
SMALLEST_SIZE, REPEATED = 0.2, 0.5
SLOW_CORRELATION = 0.87
ENOUGH = 0.7
MOST_LEFT = 0.1
UNFOLLOWED = 0.7
FORM_ERROR = 0.05
LOUD = 0.25
ODDS = 5.0


@dataclass(frozen=True)
class Structure:
    """Whether a residual is more than noise, where it shows, its share and how likely by chance.

    wandering: how the noise and the structure together wander, where that was looked at.
    """

    found: bool
    where: str | None
    share: float
    p_value: float
    wandering: NoiseModel | None = None


def intolerable(choice: Choice) -> bool:
    """Whether gain or offset is off by more than FAR_OFF of its declared tolerances."""
    tolerance = choice.fit.ground.problem.tolerance
    gain, offset = np.abs(choice.fit.nuisance[:2] - [1.0, 0.0])
    return bool(gain > FAR_OFF * tolerance.gain or offset > FAR_OFF * tolerance.offset)


def follows(explanation: Explanation, choice: Choice) -> bool:
    """Whether the explanation tells the measurement's variation better than its mean would."""
    measured = explanation.problem.measured[explanation.used]
    noisy = explanation.prior.model.deviation > 0.5 * float(np.std(measured))
    if noisy and not choice.fit.pieces:
        return True
    return mean_square(explanation, choice) < UNFOLLOWED * float(np.var(measured))


def sure_of_slow(explanation: Explanation, best: Choice) -> Choice:
    """The best choice, without its drift and slips where they may be noise that wanders.

    Where cycles repeat, such a zero is nothing to be named: the odds against it must be 5 to 1.
    """
    quiet = {n for n in best.fit.names if n not in SLOW}
    if explanation.prior.repeats == 0 or len(quiet) == len(names(best)):
        return best
    fewer_slow = [c for c in explanation.choices if quiet <= names(c) < names(best)]
    rivals = [c for c in fewer_slow if wanders(c.place)]
    rival = min(rivals, key=lambda c: c.score, default=best)
    return rival if rival.score < best.score + 2.0 * np.log(ODDS) else best


def structure_of(explanation: Explanation, choice: Choice) -> Structure:
    """What is still structured in the residual of a choice, on training rows.

    It shows in flexible curves of what was commanded that chance does not explain (likelihood
    ratio, Bonferroni over the families of curves), in noise that varies as slowly as physics does,
    in what cycles have in common at each step, or in noise with two humps. What is surely there but
    much smaller than the noise is the form of a term, no physics.
    """
    noise = choice.fit.ground.noise
    if noise.deviation <= 2.0 * explanation.prior.finest:
        return Structure(False, None, 0.0, 1.0)
    rests = structured_rest(choice, explanation.search.family)
    p_value = min(min((r.p_value for r in rests), default=1.0) * len(rests), 1.0)
    large = [r for r in rests if r.size > SMALLEST_SIZE * noise.deviation]
    sure = [r for r in large if r.p_value * len(rests) < CHANCE]
    where = sure[0].where if sure else None
    size = max((r.size for r in sure), default=0.0)
    if where is None and slow(explanation, choice):
        where, size, p_value = "slow changes", noise.correlated, min(p_value, CHANCE)
    again = repeated_rest(choice, explanation.prior)
    if where is None and again.p_value < CHANCE and again.size > REPEATED * noise.deviation:
        where, size, p_value = again.where, again.size, again.p_value
    if where is None and two_valued(choice.fit):
        where, size, p_value = "two zeros by turns", noise.deviation, min(p_value, CHANCE)
    if where is None and explanation.problem.derivatives is None:
        share, period = hum(choice)
        if share > LOUD:
            where = f"a hum in time, again and again every {period:.3g} samples"
            size, p_value = float(np.sqrt(share)) * noise.deviation, min(p_value, CHANCE)
    share = min(size**2 / mismatch_variance(explanation), 1.0)
    return Structure(where is not None, where, share, p_value)


def hum(choice: Choice) -> tuple[float, float]:
    """The share of a choice's innovations that one frequency holds, and its period [samples].

    Of independent ones, one of n/2 frequencies holds about 2 log(n) / n (Fisher, Proc. R. Soc. A
    125 (1929) 54); noise that depends on the sample before takes a hum for its own.
    """
    power = np.abs(np.fft.rfft(choice.fit.innovations))[1:] ** 2
    near = np.convolve(power, np.ones(3), mode="same")
    best = int(np.argmax(near))
    return float(near[best] / max(power.sum(), 1e-300)), len(choice.fit.innovations) / (best + 1.0)


def slow(explanation: Explanation, choice: Choice) -> bool:
    """Whether the residual itself, whatever repeats say, is surely as slow as physics.

    It is where no noise of those that forget sooner, with a zero that walks or not, comes near the
    likelihood of the chosen one.
    """
    ground, family = choice.fit.ground, explanation.search.family
    if ground.noise.correlation <= SLOW_CORRELATION:
        return False
    residual = np.where(ground.used, ground.problem.measured - choice.fit.predicted, 0.0)

    def cost(place: Place) -> float:
        return family.weigh(place, residual)[0] - family.strained(place)

    sooner = [
        cost((k, choice.place[1], walk))
        for k, shape in enumerate(family.shapes)
        if shape[1] <= SLOW_CORRELATION
        for walk in range(len(WALKS))
    ]
    return bool(cost(choice.place) < min(sooner, default=np.inf) + 2.0 * np.log(CHANCE))


def mismatch_variance(explanation: Explanation) -> float:
    """Variance of measurement minus simulation on training rows, about its mean."""
    problem = explanation.problem
    off = (problem.measured - problem.simulated)[explanation.used]
    return max(float(np.var(off)), 1e-300)


def fewer(explanation: Explanation, choice: Choice) -> Choice:
    """At most one name where a structured rest shows that these terms only mop it up.

    Where that rest is less than a twentieth of the mismatch (RMS), all names stay that explain more
    than they leave together: then it is the form of a term. Else the best single term stays if it
    alone explains most of the mismatch, and nine tenths of its structure, which the noise that was
    learnt from repeats may hide; otherwise none does.
    """
    if not choice.fit.pieces:
        return choice
    if explanation.problem.motion.kinetics is not None:
        return weightier(explanation, choice)
    base = next(c for c in explanation.choices if not c.fit.pieces)
    noise = explanation.prior.model.deviation**2
    before = mean_square(explanation, base) - noise
    if rest_of(choice, explanation) ** 2 < FORM_ERROR**2 * before:
        return weightier(explanation, choice)
    single = min(singles(explanation, choice), key=lambda c: c.score)
    left = mean_square(explanation, single) - noise
    enough = left < (1.0 - ENOUGH) * before
    return single if enough and rest_of(single, explanation) ** 2 < MOST_LEFT * before else base


def rest_of(choice: Choice, explanation: Explanation) -> float:
    """Size (RMS) [measurement's unit] of the largest structure that a choice leaves."""
    rests = structured_rest(choice, explanation.search.family)
    return max((r.size for r in rests), default=0.0)


def singles(explanation: Explanation, choice: Choice) -> list[Choice]:
    """Choices of one name: those found, and each name of a choice fitted alone."""
    found = [c for c in explanation.choices if len(set(c.fit.names)) == 1]
    for name in dict.fromkeys(choice.fit.names):
        own = [p for p in choice.fit.pieces if p.term.name == name]
        fit = improve(evaluate(choice.fit.ground, own))
        found.append(explanation.search.weighed(fit, choice.place))
    return found


def weightier(explanation: Explanation, choice: Choice) -> Choice:
    """Only terms that explain more than all of them together leave.

    What explains less may merely mop up the rest.
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
