"""Explanations whose noise repeated cycles speak against."""

import numpy as np

from pipeline.discrepancy.search.choose import Choice, Search

SURELY = 3.0


def refuted(search: Search, choice: Choice) -> bool:
    """Whether a choice leaves noise of a shape or size that repeats speak against."""
    family = search.family
    prior, deviation = family.prior, choice.fit.ground.noise.deviation
    larger = np.log(deviation / prior.model.deviation) > SURELY * prior.sure
    return prior.repeats > 0 and bool(family.strained(choice.place) > SURELY**2 or larger)
