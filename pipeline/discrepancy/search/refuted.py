"""Explanations that repeated cycles speak against."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.special import chdtrc

from pipeline.discrepancy.noise.learning import NoisePrior
from pipeline.discrepancy.search.weighing import Choice, Search

SURELY = 3.0
FEWEST_AGAIN = 2
COMMON = 1e-5
HALF = 0.5
DOUBTFUL, HOPELESS, SLOWLY = 100.0, 200.0, 0.1


def refuted(search: Search, choice: Choice) -> bool:
    """Whether a choice leaves noise of a shape or size that repeats speak against."""
    family = search.family
    prior, deviation = family.prior, choice.fit.ground.noise.deviation
    larger = np.log(deviation / prior.model.deviation) > SURELY * prior.sure
    return prior.repeats > 0 and bool(family.strained(choice.place) > SURELY**2 or larger)


def misfits(search: Search, choice: Choice) -> bool:
    """Whether a choice leaves what cycles that repeat surely have in common."""
    gain, freedom, _ = in_common(choice, search.family.prior)
    return bool(chdtrc(max(freedom, 1), gain) < COMMON)


def not_noise(search: Search, choice: Choice) -> bool:
    """Whether repeats say that what a choice leaves is no noise."""
    return refuted(search, choice) or misfits(search, choice)


def worth_a_polish(search: Search, choice: Choice, before: Choice) -> bool:
    """Whether a choice may come to explain what the one before left, and not only mop it up.

    What explains physics that was left out takes most of what repeats speak against at once; what
    leaves more than HALF of it mops up, however much it is polished. Where repeats say nothing
    against the one before, it may.
    """
    if not not_noise(search, before):
        return True
    return spoken_against(search, choice) < HALF * spoken_against(search, before)


def doubtful(search: Search, choice: Choice) -> bool:
    """Whether repeats speak so much against a choice that usual names seldom come to explain it."""
    return spoken_against(search, choice) > DOUBTFUL


def hopeless(search: Search, choice: Choice) -> bool:
    """Whether repeats speak against a choice as they do only against what no name explains."""
    return spoken_against(search, choice) > HOPELESS


def mops_up(search: Search, choice: Choice, gained: float) -> bool:
    """Whether a choice is hopeless, and what it just gained leads nowhere.

    At that pace it would take many times as many rounds to come to what may be noise as there are.
    """
    return hopeless(search, choice) and gained < SLOWLY * spoken_against(search, choice)


def spoken_against(search: Search, choice: Choice) -> float:
    """What repeats say against a choice, about as chi-square.

    By the shape and the size of its noise, and by what its innovations have in common.
    """
    family = search.family
    prior, deviation = family.prior, choice.fit.ground.noise.deviation
    larger = max(np.log(deviation / prior.model.deviation) / prior.sure, 0.0) ** 2
    gain, freedom, _ = in_common(choice, prior)
    return family.strained(choice.place) + float(larger) + max(gain - freedom, 0.0)


def in_common(choice: Choice, prior: NoisePrior) -> tuple[float, int, int]:
    """Squares that cycles that repeat have in common in a choice's innovations: see `shared`."""
    return shared(choice.fit.innovations, choice.fit.ground.used, prior.groups)


def shared(
    innovations: np.ndarray, used: np.ndarray, groups: Sequence[np.ndarray]
) -> tuple[float, int, int]:
    """Squares that repeated cycles have in common in innovations (used rows,), steps, and samples.

    used: (n,) rows that count. groups: as of `repeated_cycles`. Of the steps that are repeated
    their innovations' mean, against what is different between them: the test of lack of fit by pure
    error (Draper and Smith, Applied Regression Analysis, section 2.1). Of noise alone the squares
    are chi-square with as many degrees of freedom as steps.
    """
    found = np.full(len(used), np.nan)
    found[used] = innovations
    gain, freedom, count = 0.0, 0, 0
    for values in steps_again(found, groups):
        repeats = np.isfinite(values).sum(axis=0)
        gain += float(np.sum(repeats * np.nanmean(values, axis=0) ** 2))
        freedom += values.shape[1]
        count += int(repeats.sum())
    return gain, freedom, count


def steps_again(series: np.ndarray, groups: Sequence[np.ndarray]) -> Iterator[np.ndarray]:
    """Of each group of cycles the steps (cycles, steps) of a series (n,) that come again.

    NaN where the series is. groups: as of `repeated_cycles`.
    """
    for rows in groups:
        values = np.where(rows >= 0, series[rows], np.nan)
        yield values[:, np.isfinite(values).sum(axis=0) >= FEWEST_AGAIN]
