"""Structure: is what a choice of terms leaves more than noise, and where does it show?"""

from dataclasses import dataclass, replace

import numpy as np

from pipeline.discrepancy.judgement.alike import NOTHING, Alike, alike
from pipeline.discrepancy.judgement.force_rest import (
    after_reversals,
    changing,
    left_by,
    mean_square,
    too_slow,
)
from pipeline.discrepancy.judgement.holding import held_by_chance
from pipeline.discrepancy.judgement.hum import hum
from pipeline.discrepancy.judgement.mistaken import (
    FEWEST,
    MOST_MISTAKEN,
    after_other_steps,
    errors_of,
    incredible,
    late_by,
)
from pipeline.discrepancy.judgement.recurrence import foretold_share
from pipeline.discrepancy.judgement.rest import (
    CHANGING,
    Rest,
    common_size,
    repeated_rest,
    structured_rest,
    two_valued,
)
from pipeline.discrepancy.judgement.sticking import sticks
from pipeline.discrepancy.judgement.swinging import swings
from pipeline.discrepancy.noise.family import WALKS, Place
from pipeline.discrepancy.noise.learning import FINEST
from pipeline.discrepancy.noise.noise import SLOW_CORRELATION, NoiseModel
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.refuted import refuted
from pipeline.discrepancy.search.weighing import Choice, piled
from pipeline.number_words import worded
from pipeline.recording import branch_of

CHANCE, RARE, SELDOM = 1e-5, 1e-4, 1e-3
SMALLEST_SIZE, REPEATED, OF_PILE = 0.2, 0.5, 0.25
ROUNDED = 1.1
LEAST_ALIKE, AGAIN = 0.2, "what comes again where the motion does"
LEAST_CHANGE, CHANGES = 0.1, "how it resists or springs, which changes with time"
RINGS = "samples far off after other steps than the rest: it rings there"
SWINGS = "samples far off to one side and the other by turns: it swings there"
RECURS = "swings that go on from sample to sample, as noise does not"
MOST_OF_REST, FEWEST_PERIODS = 0.5, 8.0
JERKY, STICKY, JERKS = 4.4, 12.0, "jerks, each time elsewhere: it sticks and slips"
HOLDS = "samples that stay where the one before was as long as it is near: it is held, and lets go"
TWO_ZEROS = "two zeros by turns"
ASIDE = "{percent} % of the samples, which stand off from the others: too many for mistakes"
NO_FORM = frozenset((SWINGS, JERKS, HOLDS, TWO_ZEROS))  # what terms of a wrong form don't leave
UNSTEADY = CHANGING | {RINGS}  # which terms that stay as they are follow on average only


@dataclass(frozen=True)
class Structure:
    """Whether a residual is more than noise, where it shows, its share and how likely by chance.

    wandering: how the noise and the structure together wander, where that was looked at.
    alike: how much of a force's residual comes again where its motion does.
    """

    found: bool
    where: str | None
    share: float
    p_value: float
    wandering: NoiseModel | None = None
    alike: Alike = NOTHING


@dataclass(frozen=True)
class Sign:
    """A sure sign of structure: where it shows, its size (RMS) [measurement's unit], p-value."""

    where: str
    size: float
    p_value: float


def structure_of(explanation: Explanation, choice: Choice) -> Structure:
    """What is still structured in the residual of a choice, on training rows.

    It shows in flexible curves of what was commanded that chance does not explain (likelihood
    ratio, Bonferroni over the families of curves), in noise that varies as slowly as physics does,
    in what cycles have in common at each step, in noise with two humps, in outliers that swing or
    come after other steps than the rest, in a hum, in jerks, in samples that are held, in swings
    that go on, or, of a force, in what comes again where the motion does, or in a law that changes.
    What is surely there but much smaller than the noise is the form of a term, no physics.
    """
    if rounded(explanation, choice):
        return Structure(False, None, 0.0, 1.0)
    rests = structured_rest(choice, explanation.search.family)
    again = NOTHING if explanation.problem.derivatives is None else alike(choice)
    sign = (
        of_curves(rests, choice)
        or slowness(explanation, choice)
        or of_repeats(explanation, choice)
        or two_zeros(choice)
        or swinging(explanation, choice)
        or ringing(explanation, choice)
        or humming(explanation, choice)
        or jerking(explanation, choice)
        or sticking(explanation, choice)
        or holding(explanation, choice)
        or recurring(explanation, choice)
        or coming_again(again, choice)
        or fading(choice)
    )
    by_chance = min(min((r.p_value for r in rests), default=1.0) * len(rests), 1.0)
    if sign is None:
        return Structure(False, None, 0.0, by_chance, alike=again)
    share = min(sign.size**2 / mismatch_variance(explanation), 1.0)
    return Structure(True, sign.where, share, min(sign.p_value, by_chance), alike=again)


def unless_many_aside(explanation: Explanation, structure: Structure) -> Structure:
    """A structure, if any; else samples that stand off, where they are too many for mistakes.

    Old frames are none of them. The names are those of the other samples, and stay.
    """
    train, late = explanation.problem.train, late_by(explanation, explanation.choices[0]).late
    rows = train & explanation.outliers & (late == 0)
    share = float(rows.sum() / train.sum())
    if structure.found or share <= MOST_MISTAKEN:
        return structure
    off = np.where(explanation.used | rows, explanation.problem.measured, np.nan)
    off = np.nan_to_num(off - explanation.problem.simulated)
    rest = float(np.sum(errors_of(explanation)[rows] ** 2) / max(float(off @ off), 1e-300))
    where = ASIDE.format(percent=worded(100.0 * share))
    return replace(structure, found=True, where=where, share=min(rest, 1.0), p_value=CHANCE)


def rounded(explanation: Explanation, choice: Choice) -> bool:
    """Whether a choice leaves no more than the rounding of numbers, or of the sensor's levels.

    That follows the motion, but is no physics.
    """
    exact = 2.0 * FINEST * explanation.problem.around.angle_span
    least = max(exact, ROUNDED * explanation.prior.finest)
    return choice.fit.ground.noise.deviation <= least


def of_curves(rests: list[Rest], choice: Choice) -> Sign | None:
    """The surest of some rests (the surest first), where it is no matter of chance nor tiny.

    Beside a zero that walks what is left looks tiny: that takes most of it. Where no name is told,
    it is not the form of one.
    """
    noise, nameless = choice.fit.ground.noise, not choice.fit.pieces
    least = 0.0 if nameless and noise.walk > 0.0 else SMALLEST_SIZE * noise.deviation
    sure = [r for r in rests if r.size > least and r.p_value * len(rests) < CHANCE]
    if not sure:
        return None
    return Sign(sure[0].where, max(r.size for r in sure), rests[0].p_value * len(rests))


def slowness(explanation: Explanation, choice: Choice) -> Sign | None:
    """A residual that is itself, whatever repeats say, surely as slow as physics.

    It is where no noise of those that forget sooner, with a zero that walks or not, comes near the
    likelihood of the chosen one.
    """
    ground, family = choice.fit.ground, explanation.search.family
    if explanation.problem.derivatives is not None:
        return of_force(choice)
    if ground.noise.correlation <= SLOW_CORRELATION:
        return None
    residual = np.where(ground.used, ground.problem.measured - choice.fit.predicted, 0.0)

    def cost(place: Place) -> float:
        return family.weigh(place, residual)[0] - family.strained(place)

    sooner = [
        cost((k, choice.place[1], walk))
        for k, shape in enumerate(family.shapes)
        if shape[1] <= SLOW_CORRELATION
        for walk in range(len(WALKS))
    ]
    if cost(choice.place) < min(sooner, default=np.inf) + 2.0 * np.log(CHANCE):
        return Sign("slow changes", ground.noise.correlated, CHANCE)
    return None


def of_force(choice: Choice) -> Sign | None:
    """What is left of a force too slowly for noise, or for the most part after reversals."""
    slow = too_slow(choice, SLOW_CORRELATION)
    if not (slow or after_reversals(choice)):
        return None
    where = "slow changes" if slow else "after reversals"
    return Sign(where, float(np.sqrt(mean_square(left_by(choice)))), CHANCE)


def coming_again(again: Alike, choice: Choice) -> Sign | None:
    """What of a force's residual surely comes again where its motion does, if it is not small."""
    if not (again.sure and again.share > LEAST_ALIKE):
        return None
    return Sign(AGAIN, float(np.sqrt(again.share * mean_square(left_by(choice)))), CHANCE)


def fading(choice: Choice) -> Sign | None:
    """What a law of force leaves because it changes with time, if that is much of it."""
    if choice.fit.ground.problem.derivatives is None:
        return None
    share, p_value = changing(choice)
    if share < LEAST_CHANGE or p_value > CHANCE:
        return None
    return Sign(CHANGES, float(np.sqrt(share * mean_square(left_by(choice)))), p_value)


def of_repeats(explanation: Explanation, choice: Choice) -> Sign | None:
    """What cycles surely have in common at each step, where it is not much less than the noise.

    A pile of names may leave less. Where repeats speak against a zero that walks, it has walked
    alike in each cycle.
    """
    noise = choice.fit.ground.noise
    again = repeated_rest(choice, explanation.prior)
    least = (OF_PILE if piled(choice) else REPEATED) * noise.deviation
    if again.p_value < CHANCE and again.size > least:
        return Sign(again.where, again.size, again.p_value)
    if noise.walk > 0.0 and refuted(explanation.search, choice):
        size = common_size(choice, explanation.prior)
        return Sign(again.where, size, CHANCE) if size > least else None
    return None


def two_zeros(choice: Choice) -> Sign | None:
    """Noise with two humps."""
    if two_valued(choice.fit):
        return Sign(TWO_ZEROS, choice.fit.ground.noise.deviation, CHANCE)
    return None


def humming(explanation: Explanation, choice: Choice) -> Sign | None:
    """A frequency that holds much of the innovations: in time; of an angle in travel or itself.

    Of a force, whose noise is correlated, much of what each sample does not have of the one before,
    or most of a rest that it takes for noise.
    """
    problem, ground = explanation.problem, choice.fit.ground
    used, drive = ground.used, problem.motion.drive
    rest = choice.fit.innovations
    if problem.derivatives is not None:
        time_s = problem.motion.time_s[used]
        _, share, period_s = hum(rest, time_s)
        if share > MOST_OF_REST and period_s * FEWEST_PERIODS < np.ptp(time_s):
            return of_hum("in time", "s", period_s, share, ground.noise.deviation)
        rest = forgetting(rest)
    travel = np.cumsum(np.abs(np.diff(drive, prepend=drive[:1])))[used]
    places = (
        ("in time", "s", problem.motion.time_s[used]),
        ("along the command's way", problem.around.drive_unit, travel),
        ("in the angle", problem.around.angle_unit, choice.fit.predicted[used]),
    )
    for where, unit, along in places if problem.derivatives is None else places[:1]:
        loud, share, period = hum(rest, along)
        if loud:
            return of_hum(where, unit, period, share, ground.noise.deviation)
    return None


def of_hum(where: str, unit: str, period: float, share: float, deviation: float) -> Sign:
    """The sign of a hum with a period [unit] that holds a share of a rest of a deviation."""
    told = f"a hum {where}, again and again every {worded(period)} {unit}"
    return Sign(told, float(np.sqrt(share)) * deviation, CHANCE)


def forgetting(rest: np.ndarray) -> np.ndarray:
    """A rest (k,) without what each sample has of the one before: a force's noise is correlated."""
    before = np.concatenate([[0.0], rest[:-1]])
    return rest - float(before @ rest) / max(float(before @ before), 1e-300) * before


def recurring(explanation: Explanation, choice: Choice) -> Sign | None:
    """An angle's innovations that are foretold by those before, as no noise that forgets leaves."""
    if explanation.problem.derivatives is not None:
        return None
    foretold, share = foretold_share(choice.fit.innovations)
    size = float(np.sqrt(share)) * choice.fit.ground.noise.deviation
    return Sign(RECURS, size, CHANCE) if foretold else None


def jerking(explanation: Explanation, choice: Choice) -> Sign | None:
    """An angle that falls behind and leaps after, each time elsewhere: it sticks and slips.

    Its steps are skewed along the way that the drive goes, as those of noise are to neither side.
    A sum of cubes over the root of that of their squares, by chance JERKY once in 100,000 times,
    seldomer where each error is in two steps.
    """
    if explanation.problem.derivatives is not None:
        return None
    errors, along = errors_along(explanation, choice)
    steps = (errors * branch_of(explanation.problem.motion.drive)[1:])[along]
    cubes = (steps - steps.sum() / max(len(steps), 1)) ** 3
    skewed = abs(float(np.sum(cubes))) > JERKY * float(np.sqrt(np.sum(cubes**2)))
    return Sign(JERKS, choice.fit.ground.noise.deviation, CHANCE) if skewed else None


def sticking(explanation: Explanation, choice: Choice) -> Sign | None:
    """The same of leaps that are as even as noise: some steps go nowhere.

    A sensor that reads in levels shows that of everything: of such a one nothing is said.
    """
    if explanation.problem.derivatives is not None or explanation.problem.levels is not None:
        return None
    errors, along = errors_along(explanation, choice)
    asked = np.diff(choice.fit.predicted)
    along &= asked != 0.0
    more, _ = sticks((errors * np.sign(asked))[along], np.abs(asked[along]))
    return Sign(JERKS, choice.fit.ground.noise.deviation, CHANCE) if more > STICKY else None


def errors_along(explanation: Explanation, choice: Choice) -> tuple[np.ndarray, np.ndarray]:
    """How a residual changes from row to row, and where the drive goes on, (n - 1,) each."""
    problem, drive = explanation.problem, explanation.problem.motion.drive
    way = branch_of(drive)
    errors = np.diff(np.where(explanation.used, problem.measured - choice.fit.predicted, np.nan))
    return errors, (np.diff(drive) != 0.0) & (way[1:] == way[:-1]) & np.isfinite(errors)


def holding(explanation: Explanation, choice: Choice) -> Sign | None:
    """Samples that look like late frames, but come where little is left to go: they are held."""
    problem, late = explanation.problem, late_by(explanation, choice)
    if not late.late[problem.train].any():
        return None
    p_value = held_by_chance(late, problem.measured, choice.fit.predicted, problem.train)
    rows = problem.train & (late.late > 0)
    off = (problem.measured - choice.fit.predicted)[rows]
    size = float(np.sqrt(np.sum(off**2) / problem.train.sum()))
    return Sign(HOLDS, size, p_value) if p_value < CHANCE else None


def swinging(explanation: Explanation, choice: Choice) -> Sign | None:
    """Samples of an angle that were taken for mistaken, but lie on both sides by turns."""
    if explanation.problem.derivatives is not None:
        return None
    p_value, size = swings(explanation, choice)
    return Sign(SWINGS, size, p_value) if p_value < SELDOM else None


def ringing(explanation: Explanation, choice: Choice) -> Sign | None:
    """Samples of an angle that were taken for mistaken, but come after other steps."""
    problem = explanation.problem
    if problem.derivatives is not None or not explanation.outliers.any():
        return None
    off = (problem.measured - choice.fit.predicted)[incredible(explanation)]
    if len(off) < FEWEST:
        return None
    p_value = after_other_steps(explanation)
    size = float(np.sqrt(np.sum(off**2) / problem.train.sum()))
    return Sign(RINGS, size, p_value) if p_value < RARE else None


def share_left(explanation: Explanation, choice: Choice) -> float:
    """The share of the mismatch's variance that a choice leaves beyond the noise of repeats."""
    problem = explanation.problem
    residual = (problem.measured - choice.fit.predicted)[explanation.used]
    beyond = float(np.mean(residual**2)) - explanation.prior.model.deviation**2
    return min(max(beyond, 0.0) / mismatch_variance(explanation), 1.0)


def mismatch_variance(explanation: Explanation) -> float:
    """Variance of measurement minus simulation on training rows, about its mean."""
    problem = explanation.problem
    off = (problem.measured - problem.simulated)[explanation.used]
    return max(float(np.var(off)), 1e-300)
