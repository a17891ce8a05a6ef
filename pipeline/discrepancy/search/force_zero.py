"""A force whose zero jitters from cycle to cycle, in place of a drift that follows it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pipeline.discrepancy.fitting.fit import calibrated, evaluate, improve
from pipeline.discrepancy.noise.family import JITTERS, JUDGED, NoiseFamily, Place
from pipeline.discrepancy.search.weighing import Choice, Search, best_of_each

FEWEST, SURE = 6, 2.33  # one in a hundred by chance


def jittering(search: Search, choices: Sequence[Choice]) -> list[Choice]:
    """The choices (best first), and the best one's other terms with a zero that jitters instead.

    While a force's terms are looked for, its noise does not jitter: a drift with a few parameters
    then follows the zeros of as few cycles. Zeros that come in their order drift.
    """
    best = choices[0]
    slow = [p for p in best.fit.pieces if p.term.slow]
    ground = best.fit.ground
    if not slow or len(np.unique(ground.problem.cycle[ground.used])) == 1:
        return list(choices)
    fit = improve(evaluate(ground, best.fit.without(*slow)))
    family = replace(search.family, unrepeated_jitter=JUDGED)
    residual = np.where(ground.used, ground.problem.measured - fit.predicted, 0.0)
    if in_order(residual[ground.used], ground.problem.cycle[ground.used]):
        return list(choices)
    places = [(0, jitter, 0) for jitter in range(1, len(JITTERS))]
    place = min(places, key=lambda p: family.weigh(p, residual)[0] + of_cycles(family, p))
    noise = family.noise_at(place, family.weigh(place, residual)[1])
    fit = improve(calibrated(ground.with_noise(noise), fit.pieces, fit.trace))
    score = replace(search, family=family).scored(fit, place) + of_cycles(family, place)
    return best_of_each([*choices, Choice(fit, place, score)])


def in_order(residual: np.ndarray, cycle: np.ndarray) -> bool:
    """Whether the means over each cycle (k,) of a residual (k,) surely follow those before.

    The mean square of their successive differences over their variance is about 2 of independent
    ones (von Neumann, Ann. Math. Stat. 12 (1941) 367).
    """
    numbers, place = np.unique(cycle, return_inverse=True)
    count = len(numbers)
    if count < FEWEST:
        return False
    means = np.bincount(place, weights=residual) / np.bincount(place)
    off = means - means.mean()
    ratio = float(np.sum(np.diff(means) ** 2)) / max(float(off @ off), 1e-300)
    return ratio < 2.0 - SURE * np.sqrt(4.0 * (count - 2.0) / (count**2 - 1.0))


def of_cycles(family: NoiseFamily, place: Place) -> float:
    """What a score lacks of the zeros' log variances: each cycle has one, whatever its spells are.

    Rows that count as one over a spell have a share of their log variances, and of these, too.
    """
    rows = np.unique(family.cycle[family.used], return_counts=True)[1]
    zeros = float(np.sum(np.log1p(rows * JITTERS[place[1]] ** 2)))
    return (1.0 - 1.0 / family.prior.model.spell) * zeros
