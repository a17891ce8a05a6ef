"""What a search once missed although it fits best: from where its own form is reached."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.noise.family import WHITE
from pipeline.discrepancy.search.elsewhere import Key
from pipeline.discrepancy.search.polish import Tried, swap
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import BENDS, instead, term
from pipeline.physics.creep import Creep
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings, values_of
from tests.discrepancy.made import ANGLE, SIMULATED, explained, posed, recorded

WITHIN = 3.0


@pytest.mark.parametrize(
    ("key", "parameters"),
    [
        ("slack/", {"width": 2.6, "centre": 24.0, "rounding": 0.05}),
        (
            "friction/pretensioned",
            {"wrap": 0.004, "reach": 0.004, "spread": 0.5, "pretension": 100.0},
        ),
        ("lens_distortion/second", {"distortion": 1.8e-4, "centre": -8.0, "distortion_2": -1e-7}),
    ],
)
def test_a_search_is_no_worse_than_a_fit_that_begins_at_the_truth(key, parameters):
    found = explained(recorded({key: parameters}, noise=0.15))
    best, name = found.choices[0], key.partition("/")[0]
    hidden = term(name, key.partition("/")[2])
    around = found.problem.around
    true = Piece(hidden, values_of(hidden, around, parameters))
    fit = improve(evaluate(best.fit.ground, [true]))
    assert best.fit.names == (name,)
    assert best.score < found.search.weighed(fit, best.place).score + WITHIN


def test_slack_off_the_middle_is_found_beside_what_was_found_first():
    hidden = {
        "end_stop/lower": {"angle": -30.0},
        "camera_tilt/": {"tilt": 0.44, "direction": -0.22},
        "slack/": {"width": 1.3, "centre": 3.0, "rounding": 0.05},
    }
    best = explained(recorded(hidden, noise=0.15)).choices[0]
    slack = next(p for p in best.fit.pieces if p.term.name == "slack")
    assert set(best.fit.names) == {"end_stop", "camera_tilt", "slack"}
    np.testing.assert_allclose(slack.values[:2], [1.3, 3.0], atol=0.3)


def test_what_correlated_noise_took_over_of_two_slips_is_theirs():
    slips = {"jump": 1.64, "time": 313.46, "jump_2": 1.97, "time_2": 1499.93}
    best = explained(recorded({"lost_steps/twice": slips}, noise=0.15, seed=39)).choices[0]
    (piece,) = best.fit.pieces
    assert best.place[0] == WHITE
    np.testing.assert_allclose(piece.values[[0, 2]], [1.64, 1.97], rtol=0.05)


def test_friction_that_the_drive_bends_is_found_beside_the_stop_that_holds_the_joint():
    hidden = {
        "friction/driven": {"width": 3.8, "reach": 5.0, "release": 0.0},
        "end_stop/upper": {"angle": 24.0},
    }
    best = explained(recorded(hidden, noise=0.2)).choices[0]
    friction = next((p for p in best.fit.pieces if p.term.name == "friction"), None)
    assert set(best.fit.names) == {"friction", "end_stop"}
    assert friction is not None
    np.testing.assert_allclose(friction.values[0], 3.8, rtol=0.05)


@pytest.mark.parametrize(
    ("key", "late"),
    [
        ("response_lag/whole", {"time_constant": 8.0}),
        ("creep/whole", {"share": 0.3, "time_constant": 30.0}),
    ],
)
@pytest.mark.long
def test_what_follows_a_slack_joint_late_is_found_beside_the_slack(key, late):
    hidden = {"slack/home": {"width": 4.0, "rounding": 0.1}, key: late}
    best = explained(recorded(hidden, noise=0.15)).choices[0]
    found = {p.term.name: p for p in best.fit.pieces}
    name = key.partition("/")[0]
    assert set(found) == {"slack", name}
    assert found[name].term.form in ("whole", "running") or found["slack"].term.form == "driven"
    np.testing.assert_allclose(found[name].values, list(late.values()), rtol=0.1)
    np.testing.assert_allclose(found["slack"].values[0], 4.0, rtol=0.08)


def bent(bend: Callable[[np.ndarray], np.ndarray], **made: float) -> list[str]:
    """The names told of a joint of which a static bend of its angle (n,) is left out."""
    recording = recorded({}, noise=0.15, **made)
    simulated = recording.samples[SIMULATED].to_numpy(float)
    measured = recording.samples[ANGLE] + bend(simulated) - simulated
    samples = recording.samples.assign(**{ANGLE: measured})
    return sorted(explained(replace(recording, samples=samples)).choices[0].fit.names)


def test_a_gain_that_falls_with_the_bend_is_no_ripple():
    assert bent(lambda angle: angle / (1.0 + 0.004 * np.abs(angle))) == ["compliance"]


def test_a_settling_zero_is_no_second_time_of_a_creep():
    around = Surroundings(start_s=0.0, end_s=900.0, cycles=9)
    slower = np.array([0.1, 20.0, 0.02, 301.0])
    assert Creep("two").slight(slower, around)
    assert not Creep("two").slight(slower - [0.0, 0.0, 0.0, 2.0], around)
    assert not Creep("two").slight(slower, replace(around, cycles=1))


@pytest.mark.parametrize(
    "bend",
    [
        {"camera_tilt": {"tilt": 0.75}},
        {"lens_distortion/first": {"distortion": 1.1e-4}},
    ],
)
def test_a_contact_beside_a_bend_is_no_long_ripple(bend):
    contact = {"contact/upper": {"stiffness": 0.3, "angle": 7.0}}
    best = explained(recorded(contact | bend, noise=0.15)).choices[0]
    name = next(iter(bend)).partition("/")[0]
    assert set(best.fit.names) <= {"contact", *BENDS}
    assert "contact" in best.fit.names
    assert name in best.fit.names


def test_play_may_be_a_wire_that_rubs_as_wide_at_the_joint():
    problem = posed(recorded({}))
    told = instead(term("backlash"), np.array([4.0]), problem.motion, problem.around)
    slope = problem.around.angle_span / problem.around.drive_span
    assert [[t.name for t, _ in some] for some in told] == [["friction"], ["friction"]]
    np.testing.assert_allclose([some[0][1][0] for some in told], 4.0 * slope)
    at_joint = instead(term("backlash", "pin"), np.array([4.0]), problem.motion, problem.around)
    np.testing.assert_allclose([some[0][1][0] for some in at_joint], 4.0)


def test_a_swap_is_tried_again_only_where_the_best_has_moved_and_the_rest_does_better():
    found = explained(recorded({"backlash": {"width": 3.0}, "drift/linear": {"rate": 1.5}}))
    best = found.choices[0]
    tried: Tried = {}
    swap(found.search, best, {}, tried)
    assert len(tried) == len(best.fit.pieces)
    again: dict[Key, Choice] = {}
    swap(found.search, best, again, tried)
    assert not again
    worse = {key: (then + 100.0, least + 100.0) for key, (then, least) in tried.items()}
    swap(found.search, best, again, worse)
    assert again.keys() >= tried.keys()
    as_good = {key: (then + 100.0, least) for key, (then, least) in tried.items()}
    still: dict[Key, Choice] = {}
    swap(found.search, best, still, as_good)
    assert not still


def test_a_slip_before_nearly_all_rows_makes_room_for_a_bend():
    hidden = {
        "backlash": {"width": 1.1},
        "gravity": {"deflection": 7.0, "zero": 3.9},
        "lost_steps/once": {"jump": -7.3, "time": 1500.0},
    }
    best = explained(recorded(hidden, noise=0.2, cycles=6)).choices[0]
    (slips,) = (p for p in best.fit.pieces if p.term.name == "lost_steps")
    np.testing.assert_allclose(slips.values[0::2], [-7.3], rtol=0.1)


def test_creep_over_decades_of_time_is_no_drift_besides():
    values = {"share": 0.4, "time_constant": 60.0, "breadth": 1.2}
    best = explained(recorded({"creep/spread": values}, noise=0.1, cycles=9)).choices[0]
    (piece,) = best.fit.pieces
    assert (piece.term.name, piece.term.form) == ("creep", "spread")
    np.testing.assert_allclose(piece.values[0], 0.4, rtol=0.2)
