"""Every term of the catalogue: bounds, effect, memory, words."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.physics.catalogue import (
    MEANINGS,
    QUEUE,
    RECURRING,
    RUBBING,
    SKIPS,
    WORN,
    force_terms,
    term,
    terms,
    with_richer,
)
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import LAST, Surroundings, Term, TermError, values_of

OTHER = "yaw_command_deg"
CURVE = CubicCurve(0.7, 1e-5)
LATE = ("response_lag", "frame_lag")
EVERY = [*with_richer(terms([OTHER])), WORN, QUEUE, *RECURRING, *SKIPS, *RUBBING]


def triangle(cycles: int = 3, amplitude: float = 60.0, steps: int = 200) -> Motion:
    phase = np.arange(cycles * steps) % steps / steps * 4.0
    shape = np.where(phase < 1, phase, np.where(phase < 3, 2 - phase, phase - 4))
    n = len(phase)
    return Motion(
        drive=amplitude * shape,
        time_s=3.0 + 3.36 * np.arange(n),
        cycle=np.arange(n) // steps,
        others={OTHER: 30.0 * np.sin(np.arange(n) / 37.0)},
    )


def around(motion: Motion) -> Surroundings:
    return Surroundings(
        start_s=float(motion.time_s[0]),
        end_s=float(motion.time_s[-1]),
        dwell_s=3.36,
        cycles=3,
        travel=720.0,
        other_span={OTHER: 60.0},
    )


def named(t: object) -> str:
    return f"{t.name}-{t.form}"


@pytest.mark.parametrize("one", EVERY, ids=lambda t: f"{t.name}/{t.form}")
def test_every_form_that_a_search_can_reach_is_known_by_its_name(one):
    known = term(one.name, one.form, [OTHER])
    assert (known.name, known.form) == (one.name, one.form)


@pytest.mark.parametrize("physics", EVERY, ids=named)
def test_every_parameter_starts_within_its_bounds_and_says_what_it_does(physics):
    motion = triangle()
    for p in physics.parameters(around(motion)):
        assert p.low <= p.start <= p.high
    values = values_of(physics, around(motion), {})
    assert "{" not in physics.sentence(values, around(motion))
    assert "Source" in type(physics).__doc__


@pytest.mark.parametrize("physics", EVERY, ids=named)
def test_every_candidate_is_within_bounds_and_some_changes_the_answer(physics):
    motion = triangle()
    plain = Mechanism(CURVE).respond(motion)[0]
    low, high = np.array([[p.low, p.high] for p in physics.parameters(around(motion))]).T
    effects = []
    for values in physics.candidates(motion, around(motion)):
        assert np.all(values >= low - 1e-9)
        assert np.all(values <= high + 1e-9)
        answer = Mechanism(CURVE, (Piece(physics, values),)).respond(motion)[0]
        effects.append(float(np.std(answer - plain)))
    assert max(effects) > 0.01


@pytest.mark.parametrize("physics", EVERY, ids=named)
def test_every_parameter_changes_the_answer(physics):
    motion = triangle()
    if physics.form in ("capstan begun", "capstan bent"):  # of a wire that is pulled from the start
        motion = replace(motion, drive=motion.drive + 70.0)
    sets = physics.candidates(motion, around(motion))
    if physics.name == "marker_outliers":
        sets = np.array([[0.05, 5.0]])
    for k, p in enumerate(physics.parameters(around(motion))):
        if not p.weak:
            assert max(change(physics, motion, v, k, p) for v in sets[:: len(sets) // 8 + 1]) > 1e-6


def change(physics, motion, values, k, p) -> float:
    """Largest change of the answer when parameter k moves by a fifth of its room."""
    other = values.copy()
    room = p.high - p.low
    other[k] += 0.2 * room if values[k] < p.low + 0.5 * room else -0.2 * room
    answers = [Mechanism(CURVE, (Piece(physics, v),)).respond(motion)[0] for v in (values, other)]
    return float(np.max(np.abs(answers[0] - answers[1])))


@pytest.mark.parametrize("physics", EVERY, ids=named)
def test_blocks_answer_as_all_at_once(physics):
    motion = triangle()
    mechanism = Mechanism(CURVE, (Piece(physics, values_of(physics, around(motion), {})),))
    whole = mechanism.respond(motion)[0]
    parts, state = [], None
    for part in (slice(0, 1), slice(1, 137), slice(137, 138), slice(138, None)):
        angle, state = mechanism.respond(motion.rows(part), state)
        parts.append(angle)
    np.testing.assert_allclose(np.concatenate(parts), whole, atol=5e-6)


@pytest.mark.parametrize("late", [t for t in EVERY if t.name in LATE], ids=named)
def test_what_comes_late_begins_where_the_drive_stands_whenever_that_is(late):
    motion = replace(triangle(), drive=triangle().drive - 35.0)
    values = values_of(late, around(motion), {})
    begun = Mechanism(CURVE, (Piece(late, values),)).respond(motion)[0][0]
    assert begun == pytest.approx(Mechanism(CURVE).respond(motion)[0][0], abs=0.01)


def test_a_term_of_no_name_is_refused_with_those_that_exist():
    with pytest.raises(TermError, match=r"one of lost_steps, .*stiffness; found 'unobtainium'"):
        term("unobtainium")


def test_a_parameter_out_of_bounds_is_refused():
    with pytest.raises(TermError, match=r"'width': expected a value from 0 to 108 deg; found 200"):
        values_of(term("backlash"), Surroundings(), {"width": 200.0})
    with pytest.raises(TermError, match=r"parameters width; found breadth"):
        values_of(term("backlash"), Surroundings(), {"breadth": 2.0})


def test_still_motion_excites_nothing_that_needs_motion():
    still = Motion(np.zeros(50), np.arange(50.0), np.zeros(50, dtype=int), {OTHER: np.zeros(50)})
    quiet = Surroundings(drive_span=0.0, step=0.0, travel=0.0, other_span={OTHER: 0.0})
    excited = {t.name for t in terms([OTHER]) if t.excited(still, quiet)}
    assert excited <= {"drift", "marker_outliers", "lost_steps"}
    assert not [
        t.name for t in force_terms() if t.adds and t.site == "body" and t.excited(still, quiet)
    ]


def test_a_pose_is_reached_in_the_same_time_however_long_the_wait():
    motion = Motion(np.array([0.0, 10.0, 20.0]), np.array([0.0, 1.0, 3.0]), np.zeros(3, dtype=int))
    late = term("frame_lag", "held")

    def seen(lag_s: float) -> float:
        return late.respond(motion.drive, motion, np.array([lag_s, 0.25]), None)[0][-1]

    assert seen(0.5) == seen(1.75) == 20.0
    assert seen(1.9) == pytest.approx(14.0)
    assert seen(2.1) == 10.0


def test_a_motor_with_a_top_speed_runs_at_it_and_then_comes_near_as_a_lag_does():
    t = np.arange(400) * 0.01
    drive = np.where(t < 1.0, 0.0, 50.0)
    motion = Motion(drive, t, np.zeros(400, dtype=int))
    values = np.array([0.1, 100.0])
    x = term("response_lag", "slewing").respond(drive, motion, values, None)[0]
    since = t - 0.99
    running = (since > 0.0) & (since < 0.4)
    np.testing.assert_allclose(x[running], 100.0 * since[running], atol=1e-9)
    later = since > 0.4
    np.testing.assert_allclose(
        x[later], 50.0 - 10.0 * np.exp(-(since[later] - 0.4) / 0.1), atol=1e-9
    )
    speeds = Surroundings(drive_span=50.0, dwell_s=0.01)
    assert term("response_lag", "slewing").excited(motion, speeds)
    assert term("response_lag", "slewing").place < term("backlash").place
    assert not term("response_lag", "slewing").excited(triangle(), around(triangle()))


def test_a_zero_that_settles_by_cycles_shows_in_some_of_them():
    settling = term("drift", "settling cycle")
    assert not settling.excited(triangle(), Surroundings(cycles=4))
    assert settling.excited(triangle(), Surroundings(cycles=5))


def test_a_force_has_no_teeth_that_could_ripple():
    motion = triangle()
    assert term("transmission_ripple").excited(motion, around(motion))
    pulled = replace(around(motion), drive_unit="N")
    assert not term("transmission_ripple").excited(motion, pulled)


@pytest.mark.parametrize("form", ["odd afloat", "all afloat"])
def test_edges_are_looked_for_where_samples_could_show_three_of_them(form):
    motion, toothed = triangle(), term("transmission_ripple", form)
    coarse, finer = (replace(around(motion), spacing=120.0 / n) for n in (9.0, 13.0))
    assert term("transmission_ripple").excited(motion, coarse)
    assert not toothed.excited(motion, coarse)
    assert toothed.excited(motion, finer)
    assert np.all(toothed.candidates(motion, finer)[:, 1] <= 40.0)
    assert len(toothed.candidates(motion, finer))


def test_of_two_waves_the_larger_one_is_told():
    around = Surroundings(drive_span=120.0, drive_unit="deg")
    said = term("transmission_ripple", "second").sentence(
        np.array([0.0, 23.0, 1.0, 0.4, 2.0]), around
    )
    assert "by 0.4 deg, again and again every 11.5 deg" in said


def test_both_of_two_waves_of_periods_of_their_own_are_told():
    around = Surroundings(drive_span=120.0, drive_unit="deg")
    waves = np.array([0.4, 23.0, 1.0, 0.9, 9.0, 2.0])
    said = term("transmission_ripple", "two afloat").sentence(waves, around)
    assert "by 0.9 deg, again and again every 9 deg" in said
    assert "by 0.4 deg, every 23 deg" in said


@pytest.mark.parametrize("amplitude", [60.0, 400.0])
def test_tabled_waves_are_what_ripple_and_tilt_say(amplitude):
    motion = triangle(1, amplitude)
    ripple, tilt = np.array([2.0, 7.0, 1.1, 0.4, 2.0]), np.array([0.7, 2.0])
    rippled = term("transmission_ripple", "second").respond(motion.drive, motion, ripple, None)[0]
    angle = 2.0 * np.pi * motion.drive / 7.0
    expected = 2.0 * (np.sin(angle + 1.1) - np.sin(1.1))
    expected += 0.4 * (np.sin(2.0 * angle + 2.0) - np.sin(2.0))
    np.testing.assert_allclose(rippled - motion.drive, expected, atol=1e-9)
    seen = term("camera_tilt").respond(motion.drive, motion, tilt, None)[0]
    turned, home = motion.drive / motion.radian - 2.0, -2.0
    arms = [np.cos(x) + 1j * np.cos(0.7) * np.sin(x) for x in (turned, home)]
    expected = np.angle(arms[0] / arms[1]) * motion.radian
    np.testing.assert_allclose(seen, expected, atol=1e-8)


def test_a_slip_comes_with_its_sample():
    motion = triangle(1)
    slipped = term("lost_steps").respond(
        motion.drive, motion, np.array([1.5, motion.time_s[7]]), None
    )[0]
    np.testing.assert_array_equal(slipped - motion.drive != 0.0, np.arange(200) >= 7)


@pytest.mark.parametrize("cycles", [1, 2, 9])
def test_a_zero_wanders_more_slowly_than_the_cycles_do(cycles):
    motion = triangle(cycles)
    there = replace(around(motion), cycles=cycles)
    shortest = term("drift", "wave").parameters(there)[1].low
    assert shortest >= min(1.4 * there.period_s, there.end_s - there.start_s)
    periods = term("drift", "wave").candidates(motion, there)[:, 1]
    assert len(periods)
    assert np.all(periods >= shortest)


def test_no_form_stands_twice_in_the_catalogue():
    forms = [(t.name, t.form) for t in terms(["yaw_command_deg"])]
    assert len(forms) == len(set(forms))


class Doubled(Term):
    """A term that nobody but its own file knows of."""

    name, site = "doubled", "sensor"

    def __init__(self, place: float) -> None:
        self.place = place

    def respond(self, signal, motion, values, state):
        return 2.0 * signal, np.zeros(0)


@pytest.mark.parametrize("first", [0, 1])
def test_a_new_term_acts_where_it_says_itself_in_whatever_order_it_is_given(first):
    motion, drift = triangle(), term("drift", "linear")
    added = values_of(drift, around(motion), {"rate": 0.01})
    alone = Mechanism(pieces=[Piece(drift, added)]).respond(motion)[0]

    def answer(place: float) -> np.ndarray:
        pieces = [Piece(drift, added), Piece(Doubled(place), np.zeros(0))]
        return Mechanism(pieces=[pieces[first], pieces[1 - first]]).respond(motion)[0]

    np.testing.assert_allclose(answer(drift.place - 1.0), alone + motion.drive, atol=1e-12)
    np.testing.assert_allclose(answer(LAST), 2.0 * alone, atol=1e-12)


def test_a_quadratic_drift_is_what_its_equation_says():
    motion, values = triangle(), np.array([2.0, -3.0])
    change = Mechanism(pieces=[Piece(term("drift", "quadratic"), values)]).respond(motion)[0]
    hours = (motion.time_s - motion.time_s[0]) / 3600.0
    np.testing.assert_allclose(change - motion.drive, 2.0 * hours - 1.5 * hours**2, atol=1e-12)


@pytest.mark.parametrize(("form", "row"), [("every top", 51), ("every bottom", 151)])
def test_steps_are_lost_once_in_each_cycle_as_it_turns(form, row):
    motion = triangle()
    slip = np.array([0.7, motion.time_s[200]])
    change = Mechanism(pieces=[Piece(term("lost_steps", form), slip)]).respond(motion)[0]
    expected = 0.7 * sum(np.arange(600) >= 200 * cycle + row for cycle in (1, 2))
    np.testing.assert_allclose(change - motion.drive, expected, atol=1e-12)


@pytest.mark.parametrize("one", [*EVERY, *with_richer(force_terms())], ids=named)
def test_what_comes_after_the_balance_says_where(one):
    assert one.before_curve or one.in_balance or one.place < LAST


@pytest.mark.parametrize("one", [*terms([OTHER]), *force_terms()], ids=named)
def test_every_name_that_a_report_may_list_says_what_it_is(one):
    assert MEANINGS[one.name][0].islower()


@pytest.mark.parametrize(
    ("name", "form", "as_usual", "at_last", "others"),
    [
        ("slack", "home", [6.0, 0.3, 0.1], [4.0, 1.5, 0.1], ["compliance/toe"]),
        ("creep", "one", [0.5, 8.0], [0.8, 8.0], ["response_lag/first"]),
        (
            "creep",
            "two",
            [0.5, 8.0, 0.1, 90.0],
            [0.8, 8.0, 0.1, 90.0],
            ["response_lag/first", "creep/one"],
        ),
        ("contact", "lower", [0.9, -20.0, 0.3], [1.1, -20.0, 0.3], ["end_stop/lower"]),
    ],
)
def test_what_a_term_may_be_instead_is_offered_where_it_comes_near_that(
    name, form, as_usual, at_last, others
):
    motion, own = triangle(), term(name, form)
    assert not own.instead(np.array(as_usual), motion, around(motion))
    offered = own.instead(np.array(at_last), motion, around(motion))
    assert len(offered) > 0
    for told in offered:
        assert [f"{t.name}/{t.form}" for t, _ in told] == others
        assert all(len(values) == len(t.parameters(around(motion))) for t, values in told)
