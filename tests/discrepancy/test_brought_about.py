"""What other names bring about, or leave out as well, is no name of its own."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.brought_about import (
    MUCH_MORE,
    brought_about,
    by_giving_way,
    explained_by,
    follows_from_others,
    more_of_its_own,
)
from pipeline.discrepancy.judgement.verdict import without
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.weighing import RIVAL_GAP, Choice
from pipeline.physics.catalogue import term
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.own_amount import OwnCreep, OwnFriction, OwnLag
from pipeline.physics.piece import Piece
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    changed,
    diagnosed,
    explanation_of,
    motion_of,
    names,
    posed,
    recorded,
    value_of,
)
from tests.discrepancy.test_force import motion
from tests.discrepancy.test_simulated_force import beside

SOFT = Piece(term("compliance", "wire"), np.array([0.4, 12.0, 0.1, 0.2]))
LATE = Piece(term("creep"), np.array([0.2, 20.0]))


@pytest.mark.parametrize(
    ("own", "amount", "other", "brought"),
    [
        (OwnFriction(), 1.0, SOFT, True),
        (OwnFriction(), -1.0, SOFT, True),
        (OwnFriction(), -1.0, LATE, False),
        (OwnLag(), -1.0, LATE, True),
        (OwnLag(), 1.0, LATE, False),
        (OwnCreep(), -0.1, SOFT, True),
        (term("friction"), 1.0, SOFT, False),
    ],
)
def test_a_loop_of_its_own_is_wider_or_narrower_because_of_another_name(
    own, amount, other, brought
):
    values = np.array([amount, 2.0, 0.7])[: 3 if own.form == "symmetric" else 1]
    problem = posed(recorded({}))
    fit = evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), ())
    choice = Choice(replace(fit, pieces=(Piece(own, values), other)), (0, 0, 0), 0.0)
    assert follows_from_others(own.name, choice) == brought
    assert not follows_from_others(other.term.name, choice)


@pytest.mark.parametrize(("stretch", "sure"), [(0.4, True), (0.001, False)])
def test_only_a_wire_that_surely_gives_way_brings_about_more(stretch, sure):
    wire = Piece(SOFT.term, np.array([stretch, 12.0, 0.1, 0.2]))
    seen = Mechanism(CubicCurve(0.7, 1e-5), [wire]).respond(motion_of())[0]
    noise = NOISE * np.random.default_rng(3).standard_normal(len(seen))
    problem = posed(changed(recorded({}), **{ANGLE: seen + noise}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    choice = Choice(evaluate(ground, [wire]), (0, 0, 0), 0.0)
    explanation = explanation_of([choice])
    wire_alone = explained_by(explanation, choice, "compliance")
    most = by_giving_way(explanation, choice)
    assert most == pytest.approx(MUCH_MORE**2 * wire_alone if sure else 0.0)


@pytest.mark.parametrize(("times", "brought"), [(0.9, {"friction"}), (1.1, set())])
def test_far_more_of_a_loop_than_a_wire_does_is_a_name_of_its_own(monkeypatch, times, brought):
    """times: how much the loop explains (RMS) over the most that a wire brings about."""
    problem = posed(recorded({}))
    fit = evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), ())
    pieces = (Piece(OwnFriction(), np.array([1.0])), SOFT)
    choice = Choice(replace(fit, pieces=pieces), (0, 0, 0), 0.0)
    explains = {"compliance": NOISE**2, "friction": (times * MUCH_MORE * NOISE) ** 2}
    monkeypatch.setattr(
        "pipeline.discrepancy.judgement.brought_about.explained_by",
        lambda explanation, choice, name: explains[name],
    )
    assert brought_about(explanation_of([choice]), choice) == brought


def test_a_name_that_the_simulation_has_itself_is_more_of_that():
    asked, curve = motion_of(), CubicCurve(0.7, 1e-5)
    late = Mechanism(curve, [Piece(term("response_lag"), np.array([4.0]))]).respond(asked)[0]
    problem = posed(changed(recorded({}), **{SIMULATED: late}))
    assert [p.term.name for p in problem.course.pieces] == ["response_lag"]
    assert more_of_its_own("response_lag", problem)
    assert more_of_its_own("creep", problem)
    assert not more_of_its_own("backlash", problem)
    assert not more_of_its_own("response_lag", posed(recorded({})))


def test_a_lag_that_a_simulation_has_lasts_longer_under_a_load():
    asked, curve = motion_of(), CubicCurve(0.7, 1e-5)
    lag = Piece(term("response_lag"), np.array([4.0]))
    weight = Piece(term("gravity"), np.array([12.0, 2.2]))
    simulated = Mechanism(curve, [lag]).respond(asked)[0]
    seen = Mechanism(curve, [lag, weight]).respond(asked)[0]
    noise = NOISE * np.random.default_rng(2).standard_normal(len(seen))
    recording = changed(recorded({}), **{SIMULATED: simulated, ANGLE: 1.02 * seen + 0.4 + noise})
    assert posed(recording).loaded.course.joint[0].term.form == "first"
    result = diagnosed(recording)
    assert names(result) <= {"gravity", "compliance", "camera_tilt", "lens_distortion"}
    assert len(names(result)) == 1
    assert result.diagnoses[0].after.heldout_rmse < 1.05 * NOISE


def test_friction_that_a_softer_wire_shows_less_of_is_no_name():
    asked, curve = motion_of(), CubicCurve(0.7, 1e-5)
    rubs = Piece(term("friction"), np.array([4.0, 3.0, 0.7]))
    less = Piece(term("friction"), np.array([2.2, 3.0, 0.7]))
    simulated = Mechanism(curve, [rubs]).respond(asked)[0]
    seen = Mechanism(curve, [less, SOFT]).respond(asked)[0]
    noise = NOISE * np.random.default_rng(2).standard_normal(len(seen))
    found = diagnosed(
        changed(recorded({}), **{SIMULATED: simulated, ANGLE: 1.02 * seen + 0.4 + noise})
    )
    (told,) = found.diagnoses
    assert names(found) == {"compliance"}
    assert any("friction" in note and "bring about" in note for note in told.notes)
    assert told.after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize("behind", [-1.0, 1.0])
def test_without_a_name_counts_what_was_found_if_it_is_as_likely(behind):
    problem = posed(recorded({"backlash/pin": {"width": 12.0}}, seed=1))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    play, pin = (Piece(term("backlash", form), np.array([12.0])) for form in ("", "pin"))
    lag = Piece(term("response_lag"), np.array([2.0]))
    best = Choice(evaluate(ground, [play, lag]), (0, 0, 0), 0.0)
    other = Choice(evaluate(ground, [pin]), (0, 0, 0), RIVAL_GAP + behind)
    told = without(explanation_of([best, other]), best, lag.term.name)
    assert [p.term.form for p in told.fit.pieces] == ["pin" if behind < 0.0 else ""]


def test_slip_elements_beside_dry_friction_are_that_friction():
    _, x, _ = motion(4)
    stiff, most = np.array([9e4, 1.7e5, 6e4, 1.4e4]), np.array([1.8, 11.0, 12.0, 9.0])
    bent, dry = np.zeros(4), np.zeros(len(x))
    for k in range(1, len(x)):
        bent = np.clip(bent + stiff * (x[k] - x[k - 1]), -most, most)
        dry[k] = bent.sum()
    found = beside(x, dry, 0.0 * x)
    assert {p.name for p in found.physics} == {"coulomb_friction"}


def test_a_piece_is_found_among_others_whatever_numbers_they_have():
    alike = Piece(LATE.term, LATE.values.copy())
    assert LATE in (SOFT, LATE)
    assert LATE not in (SOFT, alike)


def test_a_ripple_of_few_samples_is_found():
    waves = {"amplitude": 1.2, "period": 6.4, "phase": 1.0}
    found = diagnosed(recorded({"transmission_ripple": waves, "backlash": {"width": 4.0}}, seed=5))
    assert names(found) == {"transmission_ripple", "backlash"}
    assert value_of(found, "transmission_ripple", "period").value == pytest.approx(6.4, rel=0.01)
