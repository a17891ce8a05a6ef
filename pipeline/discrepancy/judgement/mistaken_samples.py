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
from pipeline.discrepancy.problem.lone_samples import about_reversals
from pipeline.discrepancy.problem.outliers import robust_deviation
from pipeline.discrepancy.search.counted import INCREDIBLE
from pipeline.physics.catalogue import term
from pipeline.physics.marker_outliers import MarkerOutliers
from pipeline.physics.term import Surroundings


def mistaken_samples(evidence: Evidence, around: Surroundings) -> NamedPhysics | None:
    """The samples that stand alone, with their share and size; None where few do.

    Nor where noise with heavy tails throws some as far: what any law of friction leaves where the
    motion turns is none.
    """
    left = evidence.residual_after
    others = left[evidence.train & evidence.used & ~about_reversals(evidence.motion.drive)]
    deviation = robust_deviation(others)
    rows = evidence.mistaken & evidence.train & (np.abs(left) > INCREDIBLE * deviation)
    if alone(rows) < FEWEST:
        return None
    off = np.abs(left[rows])
    if thrown_as_far(off / deviation, others / deviation):
        return None
    found = share_of(int(rows.sum()), int(evidence.train.sum())), size_of(off, around.angle_unit)
    name = MarkerOutliers.name
    return NamedPhysics(
        name=name,
        site="sensor",
        probability=SURELY,
        parameters=found,
        heldout_rmse_without=root_mean((left**2)[np.isfinite(left) & evidence.heldout]),
        alternatives=(),
        says=term(name).sentence(np.array([e.value for e in found]), around),
    )
