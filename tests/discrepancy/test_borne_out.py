"""Where held-out rows are off, names that they don't bear out go."""

import numpy as np

from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.borne_out import borne_out
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.choose import names
from tests.discrepancy.made import NOISE, chosen, explanation_of, posed, recorded


def test_play_that_held_out_rows_show_stays_and_a_drift_of_the_others_goes():
    problem = posed(recorded({"backlash": {"width": 4.0}}, cycles=9))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    both = chosen(ground, 0.0, backlash=[4.0], drift=[0.3])
    assert names(borne_out(problem, explanation_of([both]), both)) == {"backlash"}


def test_nothing_stays_of_what_held_out_rows_know_nothing_of():
    recording = recorded({}, cycles=9)
    problem = posed(recording)
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    slips = chosen(ground, 0.0, lost_steps=[0.5, 900.0])
    kept = borne_out(problem, explanation_of([slips]), slips)
    assert kept.fit.pieces == ()
    assert np.isfinite(kept.fit.cost)
