"""Whether what an explanation leaves can be noise, by what repeats say of that."""

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.explain import explain, refuted, searched_wide
from pipeline.discrepancy.problem import pose_problem
from tests.discrepancy.made import recorded


def test_a_rest_that_repeats_is_no_noise_and_a_search_without_shortcuts_explains_it():
    hidden = {
        "slack": {"width": 6.0, "rounding": 0.3, "stiffness": 0.1},
        "friction": {"width": 3.0, "reach": 3.0},
    }
    recording = recorded(hidden, seed=1)
    simulated = recording.values("pitch_angle_sim_deg")
    found = explain(pose_problem(DiagnosisConfig(), recording, "pitch_angle_deg", simulated))
    search, best = found.search, found.choices[0]
    alone = [c for c in found.choices if len(c.fit.pieces) < 2]
    assert not refuted(search, best)
    assert all(refuted(search, choice) for choice in alone)
    again = searched_wide(search, sorted(alone, key=lambda c: c.score))
    assert set(again[0].fit.names) == set(best.fit.names)
    assert len({c.fit.key for c in again}) == len(again)
