"""Names that explain so little of a mismatch that they are the form of the others."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement import form
from pipeline.discrepancy.judgement.form import form_note, names_of_form, one_for_many
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.weighing import Choice, names
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import (
    NOISE,
    SIMULATED,
    changed,
    explained,
    explanation_of,
    followed,
    posed,
    recorded,
)

RIPPLE = term("transmission_ripple")


def formal_beside_play(amplitude: float, noise: float) -> set[str]:
    """The names of form where a ripple [deg] stands beside play of 12 deg in the best choice."""
    ripple = {"amplitude": amplitude, "period": 30.0, "phase": 1.0}
    hidden = {"backlash": {"width": 12.0}, RIPPLE.name: ripple}
    found = explained(recorded(hidden, noise=noise, seed=1))
    ground = next(c for c in found.choices if "backlash" in c.fit.names).fit.ground
    play = Piece(term("backlash"), np.array([12.0]))
    both = improve(evaluate(ground, [play, Piece(RIPPLE, np.array([amplitude, 30.0, 1.0]))]))
    return set(names_of_form(found, replace(found.choices[0], fit=both)))


@pytest.mark.parametrize(("amplitude", "formal"), [(0.05, {RIPPLE.name}), (0.2, set())])
def test_what_explains_less_than_a_hundredth_of_a_mismatch_is_its_form(amplitude, formal):
    assert formal_beside_play(amplitude, noise=0.01) == formal


@pytest.mark.parametrize(("noise", "formal"), [(0.25, {RIPPLE.name}), (0.05, set())])
def test_a_fiftieth_is_form_where_it_is_small_beside_the_noise(noise, formal):
    assert formal_beside_play(0.1, noise) == formal


@pytest.mark.parametrize(("moves", "formal"), [(True, {RIPPLE.name}), (False, set())])
@pytest.mark.long
def test_more_is_form_beside_a_simulation_that_moves_by_itself(moves, formal, monkeypatch):
    monkeypatch.setattr(form, "moves_by_itself", lambda _: moves)
    assert formal_beside_play(0.25, noise=0.4) == formal


def test_the_only_name_is_no_form_however_little_it_explains():
    found = explained(recorded({"backlash": {"width": 12.0}}, seed=1))
    assert not names_of_form(found, found.choices[0])


@pytest.mark.parametrize(("beyond", "formal"), [(True, {RIPPLE.name}), (False, set())])
@pytest.mark.parametrize("snaps", [True, False])
def test_beside_what_has_no_name_all_but_one_name_are_its_form(snaps, beyond, formal):
    hidden = {"backlash": {"width": 12.0},
              RIPPLE.name: {"amplitude": 2.0, "period": 30.0, "phase": 1.0}}  # fmt: skip
    snap = {"friction/snapping": {"height": 4.0, "middle": 2.0, "apart": 20.0}} if snaps else {}
    problem = posed(recorded(hidden | snap, seed=1))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    pieces = [Piece(term("backlash"), np.array([12.0])), Piece(RIPPLE, np.array([2.0, 30.0, 1.0]))]
    if snaps:
        pieces.append(Piece(term("friction", "snapping"), np.array([4.0, 2.0, 20.0, 3.0])))
    base, best = (Choice(improve(evaluate(ground, p)), (0, 0, 0), 0.0) for p in ((), pieces))
    found = explanation_of([best, base])
    assert best.fit.but_for("friction") == best.fit.pieces[:2]
    assert set(names_of_form(found, best, beyond)) == formal
    (note,) = form_note({RIPPLE.name: 0.3}, (), beyond)
    assert ("beside what has no name" in note) == beyond


def test_without_friction_a_snap_beside_it_stays():
    problem = posed(recorded({}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    snap = Piece(term("friction", "snapping"), np.array([4.0, 2.0, 20.0, 3.0]))
    rubs = Piece(term("friction"), np.array([2.0, 5.0, 0.7]))
    assert evaluate(ground, (rubs, snap)).but_for("friction") == (snap,)
    assert evaluate(ground, (snap,)).but_for("friction") == ()


def test_a_name_of_form_is_told_in_the_notes_and_stays_in_the_corrected_simulation():
    ripple = {"amplitude": 0.05, "period": 30.0, "phase": 1.0}
    seen = recorded({"backlash": {"width": 12.0}, RIPPLE.name: ripple}, noise=0.01, seed=1)
    (found,) = diagnose(DiagnosisConfig(), seen).diagnoses
    assert [p.name for p in found.physics] == ["backlash"]
    assert any(RIPPLE.name in note and "form of what is named" in note for note in found.notes)
    assert found.after.heldout_rmse < 1.1 * 0.01


@pytest.mark.parametrize(("amplitude", "alone"), [(0.04, True), (1.0, False)])
@pytest.mark.long
def test_one_name_that_leaves_hardly_more_is_told_instead_of_a_pile(amplitude, alone):
    ripple = {"amplitude": amplitude, "period": 30.0, "phase": 1.0}
    hidden = {"backlash": {"width": 12.0}, RIPPLE.name: ripple}
    found = explained(recorded(hidden, noise=0.01, seed=1))
    single = next(c for c in found.choices if c.fit.names == ("backlash",))
    pieces = [
        *single.fit.pieces,
        Piece(RIPPLE, np.array([amplitude, 30.0, 1.0])),
        Piece(term("drift"), np.array([1e-3])),
    ]
    pile = replace(single, fit=improve(evaluate(single.fit.ground, pieces)), score=-1e6)
    told = one_for_many(replace(found, choices=[pile, *found.choices]), pile)
    assert told is (single if alone else pile)
    both = replace(pile, fit=evaluate(single.fit.ground, pieces[:2]))
    assert one_for_many(found, both) is both


@pytest.mark.parametrize(("moves", "late_s", "formal"), [
    (True, 0.004, {"frame_lag"}), (True, 0.03, set()), (False, 0.004, set()),
], ids=["moving", "moving, later", "a curve"])  # fmt: skip
@pytest.mark.long
def test_a_little_lag_is_form_beside_a_simulation_that_moves_by_itself(moves, late_s, formal):
    time_s = 0.02 * np.arange(1500)
    drive = 30.0 * np.sin(np.pi * time_s)
    told = 29.0 * np.sin(np.pi * time_s - 0.3) if moves else drive
    play = Piece(term("backlash"), np.array([6.0]))
    late = Piece(term("frame_lag", "time"), np.array([late_s]))
    seen = np.interp(time_s - late_s, time_s, held_back(told, 3.0))
    seen += 0.3 * np.random.default_rng(5).standard_normal(len(seen))
    found = explained(changed(followed(time_s, drive, seen, 0.5), **{SIMULATED: told}))
    assert found.problem.static is not moves
    found = replace(found, choices=[c for c in found.choices if names(c) != {"backlash"}])
    fit = improve(evaluate(found.choices[0].fit.ground, [play, late]))
    assert set(names_of_form(found, replace(found.choices[0], fit=fit))) == formal


def held_back(signal, half):
    out, last = np.empty_like(signal), signal[0]
    for k, value in enumerate(signal):
        out[k] = last = min(max(last, value - half), value + half)
    return out
