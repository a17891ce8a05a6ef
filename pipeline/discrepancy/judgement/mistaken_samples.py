"""Mistaken samples of a force: which stand alone, whatever the law of the others."""

import numpy as np

from pipeline.discrepancy.judgement.mistaken import (
    FEWEST,
    SURELY,
    alone,
    share_of,
    size_of,
    thrown_as_far,
)
from pipeline.discrepancy.model.result import Evidence, NamedPhysics, root_mean
from pipeline.discrepancy.problem.outliers import robust_deviation
from pipeline.discrepancy.problem.spikes import NEIGHBOURS
from pipeline.discrepancy.problem.travelled import about_reversals
from pipeline.discrepancy.search.counted import INCREDIBLE
from pipeline.number_words import worded
from pipeline.physics.marker_outliers import MarkerOutliers

ALONE = (
    "{share:.2g} of the samples stand alone, about {size} {unit} off: the sensor or its line "
    "mistook them."
)


def mistaken_samples(evidence: Evidence, unit: str) -> NamedPhysics | None:
    """The samples that stand alone, with their share and size; None where few do.

    Nor where noise with heavy tails throws some as far: what any law of friction leaves where the
    motion turns is none.
    """
    left = evidence.residual_after
    turning = about_reversals(evidence.motion.drive, NEIGHBOURS)
    others = left[evidence.train & evidence.used & ~turning]
    deviation = robust_deviation(others)
    rows = evidence.mistaken & evidence.train & (np.abs(left) > INCREDIBLE * deviation)
    if alone(rows) < FEWEST:
        return None
    off = np.abs(left[rows])
    if thrown_as_far(off / deviation, others / deviation):
        return None
    share, size = share_of(int(rows.sum()), int(evidence.train.sum())), size_of(off, unit)
    return NamedPhysics(
        name=MarkerOutliers.name,
        site="sensor",
        probability=SURELY,
        parameters=(share, size),
        heldout_rmse_without=root_mean((left**2)[np.isfinite(left) & evidence.heldout]),
        alternatives=(),
        says=ALONE.format(share=share.value, size=worded(size.value), unit=unit),
    )
