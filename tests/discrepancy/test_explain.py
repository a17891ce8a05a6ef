"""Whether what an explanation leaves can be noise, by what repeats say of that."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.outliers import at_commands, returning
from pipeline.discrepancy.search import polish
from pipeline.discrepancy.search.choose import allowed, choose
from pipeline.discrepancy.search.contested import contested, levelled, rival_names
from pipeline.discrepancy.search.disguise import as_itself, plain_fit, undisguised, with_plain
from pipeline.discrepancy.search.exchange import exchanged
from pipeline.discrepancy.search.explain import (
    fitted_with_all,
    grown_last,
    refuted,
    searched_wide,
)
from pipeline.discrepancy.search.growth import simpler
from pipeline.discrepancy.search.moves import merged
from pipeline.discrepancy.search.refuted import (
    hopeless,
    mops_up,
    not_noise,
    spoken_against,
    worth_a_polish,
)
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.recording import branch_of
from tests.discrepancy.made import ANGLE, NOISE, changed, explained, posed, recorded


def test_a_rest_that_repeats_is_no_noise():
    hidden = {
        "slack": {"width": 6.0, "rounding": 0.3, "stiffness": 0.1},
        "friction": {"width": 3.0, "reach": 3.0},
    }
    found = explained(recorded(hidden, seed=1))
    alone = [c for c in found.choices if len(c.fit.pieces) < 2]
    assert not refuted(found.search, found.choices[0])
    assert all(refuted(found.search, choice) for choice in alone)


def test_only_what_takes_most_of_what_repeats_speak_against_is_polished():
    hidden = {"backlash": {"width": 3.0}, "gravity": {"deflection": 5.0, "zero": 0.6}}
    found = explained(recorded(hidden, seed=3))
    search, best = found.search, found.choices[0]
    ground = next(c for c in found.choices if not c.fit.pieces).fit.ground

    def fitted(name: str, form: str, values: list[float]) -> Choice:
        piece = Piece(term(name, form), np.array(values))
        return search.weighed(improve(evaluate(ground, [piece])), (0, 0, 0))

    empty = search.weighed(evaluate(ground, ()), (0, 0, 0))
    ripple = fitted("transmission_ripple", "first", [0.1, 7.0, 0.0])
    assert not_noise(search, empty)
    assert not worth_a_polish(search, ripple, empty)
    assert worth_a_polish(search, best, empty)
    assert worth_a_polish(search, ripple, best)


def test_a_weight_that_hangs_level_and_bends_its_joint_at_home_is_gravity():
    sags = {"gravity/sagging": {"deflection": 8.0, "zero": -1.35}}
    found = explained(recorded(sags, seed=5, noise=0.3, offset=-0.7))
    best = found.choices[0]
    assert best.fit.names == ("gravity",)
    assert best.fit.nuisance[1] == pytest.approx(-0.7, abs=1.0)
    other = min((c for c in found.choices if "gravity" not in c.fit.names), key=lambda c: c.score)
    assert best.score < other.score - 15.0


@pytest.mark.long
def test_a_pile_of_names_is_searched_again_without_shortcuts(monkeypatch):
    hidden = {"backlash": {"width": 3.0}, "creep": {"share": 0.1, "time_constant": 40.0}}
    found = explained(recorded(hidden, seed=2))
    best, piled = found.choices[0], []
    spare = [("drift", "linear", [0.2]), ("contact", "upper", [0.01, 30.0, 1.0])]
    for count in (1, 2):
        more = [Piece(term(name, form), np.array(values)) for name, form, values in spare[:count]]
        fit = evaluate(best.fit.ground, (*best.fit.pieces, *more))
        piled.append(replace(best, fit=fit, score=best.score + 30.0))
    three, four = ([choice] for choice in piled)
    assert not refuted(found.search, piled[1])
    assert searched_wide(found.search, three, three) is three
    again = searched_wide(found.search, four, four)
    assert set(again[0].fit.names) == set(hidden)
    assert len({c.fit.key for c in again}) == len(again)
    begun = choose(replace(found.search, wide=True, vain={}), best.fit.ground)
    monkeypatch.setattr("pipeline.discrepancy.search.explain.polished", pytest.fail)
    assert {c.fit.key for c in begun} <= {
        c.fit.key for c in searched_wide(found.search, begun, four)
    }


@pytest.fixture
def lost():
    """A search, what explains nothing, the best, and how much repeats hold against nothing."""
    found = explained(recorded({"backlash": {"width": 20.0}}, seed=3))
    empty = next(c for c in found.choices if not c.fit.pieces)
    return found.search, empty, found.choices[0], spoken_against(found.search, empty)


def test_what_gains_little_of_what_repeats_hold_against_it_mops_up(lost):
    search, empty, best, against = lost
    assert hopeless(search, empty)
    assert mops_up(search, empty, 0.05 * against)
    assert not mops_up(search, empty, 0.2 * against)
    assert not hopeless(search, best)
    assert not mops_up(search, best, 0.0)


def test_a_polish_that_mops_up_ends_after_a_round(lost, monkeypatch: pytest.MonkeyPatch):
    search, empty, _, _ = lost
    rounds = []
    monkeypatch.setattr(polish, "swap", lambda *_: rounds.append(1))
    monkeypatch.setattr(polish, "MOVES", (lambda _, c: replace(c, score=c.score - 2.0),))
    monkeypatch.setattr(polish, "furthered", lambda *_: [])
    polish.polished(search, [empty])
    assert len(rounds) == 1
    monkeypatch.setattr(polish, "mops_up", lambda *_: False)
    polish.polished(search, [empty])
    assert len(rounds) > 2


def test_a_search_without_shortcuts_is_not_begun_from_what_is_hopeless(lost, monkeypatch):
    search, empty, _, _ = lost
    monkeypatch.setattr("pipeline.discrepancy.search.explain.piled", lambda _: True)
    monkeypatch.setattr("pipeline.discrepancy.search.explain.choose", pytest.fail)
    assert searched_wide(search, [empty], [empty]) == [empty]


@pytest.mark.long
def test_a_rival_that_lacks_a_name_is_looked_for_from_the_beginning():
    hidden = {"backlash": {"width": 3.0}, "creep": {"share": 0.1, "time_constant": 40.0}}
    recording = recorded(hidden, seed=2)
    found = explained(recording)
    best = found.choices[0]
    drift = Piece(term("drift", "linear"), np.array([0.2]))
    fit = evaluate(best.fit.ground, (*best.fit.pieces, drift))
    more = found.search.weighed(fit, best.place)
    base = next(c for c in found.choices if not c.fit.pieces)
    stuck = replace(best, score=more.score + 5.0)
    assert rival_names([more, stuck, base]) == [frozenset(hidden)]
    assert contested(found.search, [more, stuck, base])[0].score < more.score
    assert rival_names([replace(more, score=best.score - 100.0), best, base]) == []


def test_a_weight_that_unloads_a_wire_is_no_lens_with_a_ripple():
    hidden = {"gravity/unloading": {"deflection": 14.0, "zero": 2.1, "pretension": 8.0}}
    recording = recorded(hidden, seed=3)
    found = explained(recording)
    (piece,) = found.choices[0].fit.pieces
    assert (piece.term.name, piece.term.form) == ("gravity", "unloading")
    np.testing.assert_allclose(piece.values, [14.0, 2.1, 8.0], rtol=0.1)


def test_a_lens_that_bends_less_towards_its_edge_draws_no_second_name():
    hidden = {
        "lens_distortion/second": {"distortion": -1.2e-4, "centre": -2.0, "distortion_2": 4e-8}
    }
    recording = recorded(hidden, seed=5)
    found = explained(recording)
    assert len(found.choices[0].fit.pieces) == 1


@pytest.mark.parametrize(
    "hidden",
    [
        {"friction/wrapped": {"width": 2.0, "reach": 3.0, "spread": 0.7, "growth": 0.03}},
        {"friction/wrapped": {"width": 0.4, "reach": 0.5, "spread": 0.3, "growth": 0.2}},
        {"contact/upper hardening": {"stiffness": 0.0, "angle": 12.0, "hardening": 0.012}},
    ],
)
def test_a_load_that_grows_with_the_bend_draws_no_second_name(hidden):
    recording = recorded(hidden, seed=8)
    found = explained(recording)
    (piece,) = found.choices[0].fit.pieces
    assert f"{piece.term.name}/{piece.term.form}" in hidden


def test_what_a_choice_is_in_disguise_is_fitted_anew_where_a_search_fitted_it_badly():
    recording = recorded({"backlash": {"width": 3.0}}, seed=9)
    found = explained(recording)
    search, ground = found.search, found.choices[0].fit.ground
    play = Piece(term("tension_loss"), np.array([1e-5, 2.9]))
    growing = search.weighed(improve(evaluate(ground, (play,))), (0, 0, 0))
    bad = replace(found.choices[0], score=growing.score + 10.0)
    assert undisguised([growing, bad]) is bad
    assert undisguised(with_plain(search, [growing, bad])).score < growing.score


def test_a_play_that_does_not_grow_is_backlash_as_wide_beside_what_else_was_fitted():
    hidden = {"backlash": {"width": 30.0}, "slack": {"width": 6.0, "stiffness": 0.1}}
    found = explained(recorded(hidden, seed=12))
    best = found.choices[0]
    assert set(best.fit.names) == set(hidden)
    pieces = [
        Piece(term("tension_loss"), np.array([0.0, *p.values])) if p.term.name == "backlash" else p
        for p in best.fit.pieces
    ]
    again = plain_fit(found.search, evaluate(best.fit.ground, pieces))
    assert again.names == best.fit.names
    assert again.cost < best.fit.cost + 0.1


def test_what_was_far_behind_on_fewer_samples_stays_so_on_all():
    found = explained(recorded({"backlash": {"width": 3.0}}, seed=9))
    best = found.choices[0]
    shifted = [replace(c, score=c.score - 1000.0) for c in found.choices]
    again = fitted_with_all(found.problem, replace(found, choices=shifted))
    assert again.choices[0].fit.names == best.fit.names
    assert again.choices[0].score < best.score + 0.1
    far = max((c for c in found.choices if c.fit.pieces), key=lambda c: c.score).fit.key
    gaps = [
        next(c for c in e.choices if c.fit.key == far).score - e.choices[0].score
        for e in (found, again)
    ]
    assert gaps[1] == pytest.approx(gaps[0], abs=0.5)


def test_friction_alone_leaves_a_part_of_its_loop_to_slack():
    hidden = {
        "friction": {"width": 2.9, "reach": 2.3},
        "slack/home": {"width": 2.0, "rounding": 0.2, "stiffness": 0.02},
    }
    recording = recorded(hidden, seed=4)
    found = explained(recording)
    search, ground = found.search, found.choices[0].fit.ground
    begun = evaluate(ground, (Piece(term("friction"), np.array([4.3, 4.1, 0.1])),))
    alone = search.weighed(improve(begun), (0, 0, 0), 12)
    both = exchanged(search, alone)
    assert set(both.fit.names) == {"friction", "slack"}
    assert both.score < alone.score - 20.0
    assert exchanged(search, both) is both


def test_slack_in_whose_middle_the_wires_still_pull_is_a_toe():
    toe = {"softness": 0.35, "reach": 6.0, "stretch": 0.1, "stiffness": 0.2}
    recording = recorded(
        {"compliance/toe": toe, "friction": {"width": 9.0, "reach": 4.0}}, cycles=8, seed=6
    )
    found = explained(recording)
    search, ground = found.search, found.choices[0].fit.ground
    held = Piece(term("friction"), np.array([9.0, 4.0, 0.7]))

    def beside(width: float, rounding: float):
        slack = Piece(term("slack", "home"), np.array([width, rounding, 0.1]))
        return search.weighed(improve(evaluate(ground, (held, slack))), (0, 0, 0), 12)

    soft = beside(4.0, 1.5)
    taut = exchanged(search, soft)
    assert set(taut.fit.names) == {"friction", "compliance"}
    assert taut.score < soft.score - 20.0
    assert exchanged(search, taut) is taut


def test_a_contact_that_is_as_stiff_as_can_be_is_an_end_stop():
    stop = {"angle": 20.0, "softness": 0.05, "give": 0.02}
    recording = recorded({"end_stop/upper": stop, "backlash": {"width": 3.0}}, seed=7)
    found = explained(recording)
    search, ground = found.search, found.choices[0].fit.ground
    play = Piece(term("backlash"), np.array([3.0]))
    touched = Piece(term("contact", "upper"), np.array([4.0, 19.0, 0.3]))
    fit = improve(evaluate(ground, (touched, play)), 40)
    harder = search.weighed(fit, (0, 0, 0))
    best = exchanged(search, harder)
    assert as_itself(harder, harder)
    assert not as_itself(harder, best)
    assert set(best.fit.names) == {"end_stop", "backlash"}
    assert best.score < harder.score
    assert exchanged(search, best) is best


def test_a_near_rival_is_weighed_in_the_form_that_suits_it():
    recording = recorded({"response_lag/second": {"natural_frequency": 0.15, "damping": 0.3}})
    found = explained(recording)
    search, best = found.search, found.choices[0]

    def alone(name: str, value: float):
        begun = evaluate(best.fit.ground, (Piece(term(name), np.array([value])),))
        return search.weighed(improve(begun), best.place)

    late, first = alone("frame_lag", 3.0), alone("response_lag", 2.0)
    near = replace(first, score=late.score + 20.0)
    again = levelled(search, [late, near])
    assert again[0].fit.names == ("response_lag",)
    assert again[0].fit.key != near.fit.key
    assert again[0].score < late.score
    assert levelled(search, [late, replace(first, score=late.score + 100.0)])[0] is late


@pytest.mark.parametrize("period", [3.0, 7.0])
def test_where_what_is_left_is_no_noise_no_name_is_contested(monkeypatch, period):
    recording = recorded({}, seed=2)
    command = recording.values("pitch_command_deg")
    toothed = 0.8 * np.sign(np.sin(command / period)) * branch_of(command)
    asked = []

    def told(_, found):
        asked.append(len(found))
        return found

    monkeypatch.setattr("pipeline.discrepancy.search.explain.contested", told)
    found = explained(changed(recording, **{ANGLE: recording.values(ANGLE) + toothed}))
    assert refuted(found.search, found.choices[0])
    assert not asked
    explained(recorded({"backlash": {"width": 4.0}}, seed=2))
    assert asked


def test_one_name_fewer_is_weighed_in_the_forms_that_it_has_without_that():
    found = explained(recorded({"tension_loss/cycle": {"growth_a_cycle": 0.5, "width": 2.0}}))
    search, true = found.search, found.choices[0]
    assert true.fit.names == ("tension_loss",)
    begun = Piece(term("tension_loss", "cycle dragged"), np.array([0.5, 0.0, 1.9]))
    late = Piece(term("response_lag", "whole"), np.array([4.5]))
    alone, both = (evaluate(true.fit.ground, p) for p in ((begun,), (begun, late)))
    best, rubbing = (search.weighed(improve(fit), true.place) for fit in (both, alone))
    assert rubbing.score > true.score + 3.0
    again = levelled(search, [best, replace(rubbing, score=best.score + 60.0)])
    assert min(c.score for c in again if len(c.fit.pieces) == 1) < true.score + 3.0


def test_two_names_in_the_place_of_one_are_weighed_in_plainer_forms_too():
    hidden = {"backlash": {"width": 4.5}, "friction": {"width": 2.0, "reach": 4.0, "spread": 0.7}}
    found = explained(recorded(hidden, cycles=9))
    search, true = found.search, found.choices[0]
    assert {(p.term.name, p.term.form) for p in true.fit.pieces} >= {("friction", "symmetric")}
    play, driven = Piece(term("backlash"), np.array([3.0])), term("friction", "driven")
    begun = (play, Piece(driven, np.array([5.0, 8.0, 0.5])))
    rival = search.weighed(improve(evaluate(true.fit.ground, begun)), true.place)
    late = Piece(term("response_lag"), np.array([5.0]))
    best = search.weighed(improve(evaluate(true.fit.ground, (late,))), true.place)
    again = levelled(search, [best, replace(rival, score=best.score + 30.0)])
    assert min(c.score for c in again) < true.score + 3.0


@pytest.mark.long
def test_a_near_rival_is_weighed_beside_the_bend_that_suits_it():
    stop = {"angle": -27.0, "softness": 0.3, "give": 0.02}
    hidden = {"compliance": {}, "end_stop/lower": stop, "backlash": {"width": 3.0}}
    found = explained(recorded(hidden, seed=5))
    search, best = found.search, found.choices[0]
    assert set(best.fit.names) == {"compliance", "end_stop", "backlash"}
    touched = Piece(term("contact", "lower"), np.array([6.0, -24.5, 0.2]))
    lens = Piece(term("lens_distortion", "second"), np.zeros(3))
    begun = evaluate(best.fit.ground, (lens, touched, Piece(term("backlash"), np.array([3.0]))))
    rival = search.weighed(improve(begun), best.place)
    again = levelled(search, [best, replace(rival, score=best.score + 40.0)])
    wanted = {"compliance", "contact", "backlash"}
    assert min(c.score for c in again if set(c.fit.names) == wanted) < best.score + 30.0


def test_a_form_tried_in_vain_is_tried_again_once_a_choice_has_moved_far():
    found = explained(recorded({"backlash": {"width": 3.0}}))
    search, choice = replace(found.search, vain={}), found.choices[0]
    key = frozenset([("friction", "symmetric")])
    search.vain[key] = choice.score, 30.0
    assert search.tried_in_vain(key, choice)
    assert search.tried_in_vain(key, replace(choice, score=choice.score - 8.0))
    assert not search.tried_in_vain(key, replace(choice, score=choice.score - 12.0))
    search.vain[key] = choice.score, 1.0
    assert search.tried_in_vain(key, replace(choice, score=choice.score - 0.9))
    assert not search.tried_in_vain(key, replace(choice, score=choice.score - 1.1))


def test_what_was_weighed_on_the_way_stands_among_the_choices():
    """A lag is weighed in place of a late frame, beside the slack; no search keeps it."""
    slack = {"width": 6.0, "rounding": 0.3, "stiffness": 0.1}
    recording = recorded({"slack": slack, "frame_lag/time": {"lag": 2.0}}, seed=4)
    found = explained(recording)
    sets = [set(c.fit.names) for c in found.choices]
    assert sets[0] == {"slack", "frame_lag"}
    assert all(set(own) in sets for own in found.search.seen)
    weighed = found.search.weighed(evaluate(found.choices[0].fit.ground, ()), (0, 0, 0))
    assert found.search.seen[frozenset()].score <= weighed.score


def test_slack_off_home_is_found_beside_a_ripple():
    hidden = {
        "slack": {"width": 8.0, "centre": -11.0, "rounding": 0.6, "stiffness": 0.09},
        "transmission_ripple": {"amplitude": 1.2, "period": 45.0, "phase": 1.0},
    }
    recording = recorded(hidden, seed=1)
    found = explained(recording)
    assert set(found.choices[0].fit.names) == set(hidden)


def test_a_second_name_is_grown_before_a_third_is_looked_for():
    hidden = {"coupling": {}, "slack": {"width": 4.0, "centre": 3.0}}
    recording = recorded(hidden, seed=1, two_axes=True)
    found = explained(recording)
    begun = choose(found.search, found.choices[0].fit.ground)
    assert len(begun[0].fit.pieces) == 2


def test_what_was_grown_beside_a_lag_of_another_form_is_made_plain_again():
    hidden = {"response_lag/motor": {}, "creep/wire": {"share": 0.4, "time_constant": 12.0}}
    found = explained(recorded(hidden, cycles=9))
    search, best = found.search, found.choices[0]
    starts = {
        ("creep", "wire two"): [0.7, 3.5, 0.7, -5.5, 0.4, 12.3],
        ("response_lag", "second"): [0.7, 0.4, 0.35],
    }
    pieces = [Piece(term(*name), np.array(values)) for name, values in starts.items()]
    grown = search.weighed(improve(evaluate(best.fit.ground, pieces), 30), best.place)
    other = merged(search, grown)
    assert other.fit.key == {("response_lag", "motor"), ("creep", "one")}
    assert other.score < grown.score - 10.0


def test_play_and_an_old_frame_are_one_lag_of_second_order():
    hidden = {
        "response_lag/second": {"natural_frequency": 0.62, "damping": 1.0, "moving": 1.0},
        "slack": {"width": 4.5, "centre": 2.5},
    }
    recording = recorded(hidden, seed=1)
    found = explained(recording)
    assert set(found.choices[0].fit.names) == {"response_lag", "slack"}


def test_what_stands_off_wherever_the_command_is_the_same_is_no_mistake():
    short, long = np.r_[0:9, 8:-9:-1, -8:0], np.r_[0:6, 5:-9:-1, -8:9, 8:0:-1]
    drive = np.concatenate([short, long, short[::-1], long]).astype(float)
    off = 0.1 * np.random.default_rng(0).standard_normal(len(drive))
    met = np.flatnonzero(drive == -8.0)
    off[met] += 2.0
    off[60] += 2.0
    again = returning(off, [at_commands(drive, 0.5)])
    assert np.all(again[met])
    assert not again[60]


def test_a_drive_that_never_moves_is_at_one_command():
    again = at_commands(np.full(7, 5.0), 0.0)
    assert sorted(again[again >= 0]) == list(range(7))


def test_a_name_stands_once_on_each_side():
    problem = posed(recorded({}))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train)
    lower = term("contact", "lower")
    start = [p.start for p in lower.parameters(problem.around)]
    fit = evaluate(ground, [Piece(lower, np.array(start))])
    terms = [term("contact", f) for f in ("upper", "lower", "lower unloading")]
    beside = allowed([*terms, term("end_stop", "lower")], fit)
    assert [(t.name, t.form) for t in beside] == [("contact", "upper"), ("end_stop", "lower")]


def test_a_form_that_was_grown_too_far_is_made_plain_again():
    found = explained(recorded({"creep/one": {"share": 0.3, "time_constant": 12.0}}))
    search, plain = found.search, next(c for c in found.choices if c.fit.key == {("creep", "one")})
    arms = np.array([0.28, 12.0, 0.05, 14.0])
    fit = improve(evaluate(plain.fit.ground, [Piece(term("creep", "two"), arms)]))
    again = simpler(search, search.weighed(fit, plain.place))
    assert again.fit.key == plain.fit.key
    assert again.score == pytest.approx(plain.score, abs=1.0)


def test_a_best_that_was_left_in_a_plainer_form_grows_at_last():
    waves = {"amplitude": 1.5, "period": 24.0, "phase": 0.5, "amplitude_2": 0.9, "phase_2": 1.0}
    found = explained(recorded({"transmission_ripple/second": waves}))
    search, best = found.search, found.choices[0]
    assert grown_last(replace(search, seen={}), [best]) == [best]
    ripple = term("transmission_ripple")
    fit = improve(evaluate(best.fit.ground, [Piece(ripple, np.array([1.5, 24.0, 0.5]))]))
    plainer = replace(search, vain={}, seen={}).weighed(fit, best.place)
    fresh = replace(search, vain={}, seen={})
    choices = grown_last(fresh, [plainer])
    assert choices[0].score < plainer.score - 20.0
    assert choices[0].fit.pieces[0].term.overtones == (2,)
    assert {frozenset(c.fit.names) for c in choices} >= set(fresh.seen)
