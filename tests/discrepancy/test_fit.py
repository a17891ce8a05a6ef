"""Fits: recovery, intervals that cover, ties, outliers."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig, ToleranceConfig
from pipeline.discrepancy.fitting.charge import TERM_COST, VOID, absurd_calibration, complexity
from pipeline.discrepancy.fitting.effects import effects_of
from pipeline.discrepancy.fitting.fit import evaluate, improve, jacobian, slopes_beside, spanned
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.fitting.screen import screen, started
from pipeline.discrepancy.judgement.verdict import intolerable
from pipeline.discrepancy.model.intervals import covariance_of, estimates, wide_covariance
from pipeline.discrepancy.noise.family import noise_family
from pipeline.discrepancy.noise.learning import learn_noise
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.driven import static_misfit
from pipeline.discrepancy.problem.outliers import alike, isolated, returning
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.thinning import sparser, thinned
from pipeline.discrepancy.search.explain import explain
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from tests.discrepancy.made import ANGLE, NOISE, SIMULATED, changed, posed, recorded

HIDDEN = {"backlash": {"width": 4.0}, "transmission_ripple": {"amplitude": 1.0, "period": 20.0}}
BEGUN = (
    Piece(term("backlash"), np.array([2.5])),
    Piece(term("transmission_ripple"), np.array([0.6, 20.5, 0.2])),
)


def fitted(seed: int, hidden=HIDDEN, begun=BEGUN, **how):
    problem = posed(recorded(hidden, seed=seed, **how))
    return improve(evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), begun), 30)


def widened(fit):
    problem = fit.ground.problem
    family = noise_family(learn_noise(problem), problem, fit.ground.used)
    return wide_covariance(fit, (0, 0, 0), family)


def test_a_fit_finds_what_was_hidden():
    fit = fitted(1)
    assert fit.pieces[0].values[0] == pytest.approx(4.0, abs=0.1)
    assert fit.pieces[1].values[:2] == pytest.approx([1.0, 20.0], abs=0.1)
    assert fit.nuisance == pytest.approx([1.02, 0.4], abs=0.05)
    assert np.var(fit.innovations) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(("gain", "expected"), [(1.0, 1.0), (1.3, 1.11)])
def test_the_gain_of_a_simulation_may_have_been_fitted_to_what_gives_way(gain, expected):
    """A ninth more: what it gives way by over all its range."""
    stiffening = Piece(term("compliance", "joint"), np.array([1e-4, 0.05]))
    hidden = {"compliance/joint": {"hardening": 1e-4, "stretch": 0.05}}
    fit = fitted(3, hidden, (stiffening,), gain=gain)
    assert fit.nuisance[0] == pytest.approx(gain, abs=0.04)
    assert fit.expected[0] == pytest.approx(expected, abs=0.02)
    assert not intolerable(Choice(fit, (0, 0, 0), 0.0))
    play = fitted(3, gain=gain)
    assert play.expected[0] == 1.0
    assert intolerable(Choice(play, (0, 0, 0), 0.0)) == (gain > 1.2)


def test_every_parameter_has_a_slope():
    slopes = jacobian(fitted(2))
    assert np.all(np.sum(slopes**2, axis=0) > 1.0)


def test_parameters_that_say_the_same_span_no_direction_of_chance():
    """Of any lengths: a slope by the time and one by the count of an encoder stand side by side."""
    rng = np.random.default_rng(0)
    one, other, unlike = rng.standard_normal((3, 200))
    off = [1e-12 * rng.standard_normal(200) for _ in range(2)]
    bases = [
        spanned(np.column_stack([one, 1e5 * other, np.zeros(200), 1e-3 * (one + other) + rounding]))
        for rounding in off
    ]
    along = [basis @ (basis.T @ unlike) for basis in bases]
    assert bases[0].shape == bases[1].shape == (200, 2)
    np.testing.assert_allclose(along[0], along[1], atol=1e-9)


def test_slopes_beside_another_fit_are_taken_over_for_the_pieces_of_both():
    fit = fitted(2)
    play, ripple = fit.pieces
    wider = evaluate(fit.ground, (Piece(play.term, play.values + 0.5), ripple))
    taken = slopes_beside(wider, fit)
    np.testing.assert_allclose(taken[:, 0], wider.slopes[:, 0], rtol=0.0, atol=1e-12)
    assert np.max(np.abs(fit.slopes[:, 0] - wider.slopes[:, 0])) > 1e-3
    assert np.array_equal(taken[:, 1:], fit.slopes[:, 1:])
    assert not np.array_equal(taken[:, 1:], wider.slopes[:, 1:])


def test_a_trial_begun_beside_a_fit_comes_as_far_as_from_its_own_slopes():
    fit = fitted(2)
    play, ripple = fit.pieces
    wider = evaluate(fit.ground, (Piece(play.term, play.values + 0.5), ripple))
    assert wider.cost > fit.cost + 100.0
    assert improve(wider, begun=fit).cost == pytest.approx(fit.cost, abs=0.2)
    assert improve(wider).cost == pytest.approx(fit.cost, abs=0.2)


def test_a_ripple_behind_a_late_answer_is_screened_at_its_period():
    behind = {"response_lag": {"time_constant": 6.0}, **HIDDEN}
    fit = fitted(3, behind, (Piece(term("response_lag"), np.array([5.0])), BEGUN[0]))
    ripple = term("transmission_ripple")
    effects = effects_of(fit.ground.problem, [ripple])
    kept = effects.promising(fit, [ripple], 4)
    assert len(kept) == 16 < len(effects.places) / 5
    assert min(abs(values[1] - 20.0) for _, values in kept) < 1.0


def test_a_slip_in_strongly_correlated_noise_is_screened_at_its_own_sample():
    plain, slip = recorded({}, cycles=15, noise=0.02), term("lost_steps")
    time_s = plain.values("time_s")
    tried_s = np.array([v[1] for _, v in effects_of(posed(plain), [slip]).places])
    row = int(np.argmax([np.min(np.abs(tried_s - t)) for t in time_s[20:-20]])) + 20
    slipped = changed(plain, **{ANGLE: plain.values(ANGLE) + 2.0 * (time_s >= time_s[row])})
    problem = posed(slipped)
    fit = evaluate(ground_of(problem, NoiseModel(0.02, 0.5, 0.98), problem.train), ())
    (best, *_) = screen(fit, effects_of(problem, [slip]), [slip])
    assert time_s[row - 1] < best.values[1] <= time_s[row]


def test_no_lead_needs_a_size_beyond_its_bounds():
    hidden = {"contact/upper": {"stiffness": 0.4, "angle": 6.0}, "camera_tilt": {"tilt": 0.7}}
    fit = fitted(5, hidden, (Piece(term("camera_tilt"), np.array([0.9, 0.1])),))
    candidates = [term("contact", side) for side in ("upper", "lower")]
    leads = screen(fit, effects_of(fit.ground.problem, candidates), candidates)
    assert {lead.term.form for lead in leads} == {"upper"}
    assert all(lead.values[0] > 0.0 for lead in leads)


@pytest.mark.parametrize(("tolerances", "promised"), [(0.5, False), (8.0, True)])
def test_a_bend_is_screened_beyond_what_a_declared_smooth_error_may_be(tolerances, promised):
    """A smooth error of the fit takes any curve, at the cost of how far it is off."""
    bent = recorded({"lens_distortion": {"distortion": 2e-5}})
    size = float(np.std(bent.values(ANGLE) - recorded({}).values(ANGLE)))
    tolerance = ToleranceConfig(shape=size / tolerances)
    problem = pose_problem(DiagnosisConfig(tolerance), bent, ANGLE, bent.values(SIMULATED))
    fit = evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), ())
    lens = term("lens_distortion", "first")
    leads = screen(fit, effects_of(problem, [lens]), [lens])
    assert (max((lead.gain for lead in leads), default=0.0) > TERM_COST) == promised
    assert fit.mean_square < 1.1 * NOISE**2


def test_a_lead_is_begun_beside_terms_that_make_room_for_it():
    hidden = {"contact/upper": {"stiffness": 0.4, "angle": 6.0}, "camera_tilt": {"tilt": 0.7}}
    fit = fitted(5, hidden, (Piece(term("camera_tilt"), np.array([0.9, 0.1])),))
    contact = term("contact", "upper")
    lead = screen(fit, effects_of(fit.ground.problem, [contact]), [contact])[0]
    beside = evaluate(fit.ground, (*fit.pieces, Piece(contact, lead.values)))
    begun = started(fit, [lead], room=True)
    assert beside.cost > fit.cost
    assert begun.cost < beside.cost - 100.0
    assert begun.values[-3:] == pytest.approx(lead.values)


def test_a_slip_before_the_first_fitted_sample_explains_nothing():
    ground = fitted(3).ground
    first, later = (int(np.argmax(ground.used)) + k for k in (0, 1))
    slips = [
        evaluate(ground, (Piece(term("lost_steps"), np.array([1.0, time_s])),))
        for time_s in ground.problem.motion.time_s[[first, later]]
    ]
    assert complexity(slips[0]) == complexity(slips[1]) + VOID


def test_intervals_cover():
    truth = {"width": 4.0, "amplitude": 1.0, "period": 20.0}
    covered = []
    for seed in range(40):
        fit = fitted(seed)
        for _, own in estimates(fit, covariance_of(fit)):
            covered += [e.low <= truth[e.name] <= e.high for e in own if e.name in truth]
    assert 0.91 <= np.mean(covered) <= 1.0


def test_a_drift_is_told_in_the_unit_of_what_is_measured():
    begun = (Piece(term("drift", "linear"), np.array([1.0])),)
    covered = []
    for seed in range(12):
        fit = fitted(seed, {"drift/linear": {"rate": 5.0}}, begun, gain=1.1)
        rate = estimates(fit, widened(fit))[0][1][0]
        assert rate.value == pytest.approx(5.5, abs=0.5)
        covered.append(rate.low <= 5.5 <= rate.high)
    assert np.mean(covered) > 0.8


def test_a_wrong_form_widens_what_it_tells():
    begun = (Piece(term("backlash"), np.array([4.0])),)
    right = fitted(3, {"backlash": {"width": 4.0}}, begun)
    friction = {"width": 4.0, "reach": 8.0, "spread": 0.7}
    wrong = fitted(3, {"friction": friction}, begun)
    ratio = [np.sqrt(widened(f)[-1, -1] / covariance_of(f)[-1, -1]) for f in (right, wrong)]
    assert ratio[0] < 1.5
    assert ratio[1] > 2.0 * ratio[0]


def test_lone_samples_are_isolated_but_corners_are_not():
    rng = np.random.default_rng(0)
    residual = 0.1 * rng.standard_normal(300) + np.abs(np.arange(300) - 150) * 0.02
    residual[[40, 200]] += 3.0
    found = isolated(residual, np.ones(300, dtype=bool), 1e-6, np.zeros(300))
    assert np.flatnonzero(found).tolist() == [40, 200]


def test_what_stands_off_in_each_repeat_is_no_outlier():
    residual = 0.1 * np.random.default_rng(0).standard_normal(400)
    residual[[17, 117, 217, 317, 140]] += 2.0
    found = returning(residual, [np.arange(400).reshape(4, 100)])
    lone = isolated(residual, np.ones(400, dtype=bool), 1e-6, np.zeros(400)) & ~found
    assert np.flatnonzero(lone).tolist() == [140]


def test_two_mistakes_that_meet_at_one_step_of_three_cycles_are_mistakes():
    residual = 0.1 * np.random.default_rng(0).standard_normal(300)
    residual[[52, 252]] -= 20.0
    assert not returning(residual, [np.arange(300).reshape(3, 100)])[[52, 252]].any()


def test_arrivals_are_judged_among_themselves():
    residual = np.random.default_rng(0).normal(0.0, 0.1, 400)
    arrivals = np.zeros(400, dtype=bool)
    arrivals[5::20] = True
    residual[arrivals] += np.where(np.arange(arrivals.sum()) % 2 == 0, 2.0, -2.0)
    residual[[105, 250]] = 30.0
    mistaken = isolated(residual, np.ones(400, dtype=bool), 1e-6, np.zeros(400))
    assert mistaken[arrivals].all()
    mistaken &= ~alike(residual, arrivals, 1e-6)
    assert np.flatnonzero(mistaken).tolist() == [105, 250]


def test_a_static_simulation_is_told_from_a_dynamic_one():
    command = np.sin(np.arange(400) / 20.0) * 50.0
    assert static_misfit(command, 0.7 * command - 1e-5 * command**3) < 1e-3
    assert static_misfit(command, np.roll(0.7 * command, 5)) > 0.01


def test_long_recordings_are_thinned_at_their_reversals_and_say_so():
    recording = recorded({}, cycles=120)
    problem = posed(recording)
    small, every = thinned(problem)
    assert every == 5
    assert len(small.motion) < 6000
    assert small.motion.drive.max() == problem.motion.drive.max()


def test_a_search_takes_few_of_the_samples_behind_its_rows_and_the_last_fit_all():
    recording = recorded({"backlash": {"width": 4.0}}, cycles=150)
    problem = posed(recording)
    small = thinned(problem)[0]
    sparse = sparser(small)
    assert small.picked
    assert sparse.picked
    assert len(sparse.picked.motion) < 13000 < len(small.picked.motion)
    assert np.array_equal(sparse.picked.motion.time_s[sparse.picked.rows], small.motion.time_s)
    found = explain(small)
    assert found.problem is small
    assert all(choice.fit.ground.problem is small for choice in found.choices)


def test_cycles_still_repeat_in_a_thinned_recording_with_lost_frames():
    recording = recorded({}, cycles=60)
    lost = np.random.default_rng(0).random(len(recording.samples)) < 0.03
    recording.samples.loc[lost, "pitch_angle_deg"] = np.nan
    problem = posed(recording)
    small, every = thinned(problem)
    assert every == 3
    assert learn_noise(small).repeats == 40
    steps = recording.samples["step"].to_numpy()[small.picked.rows] if small.picked else []
    assert np.bincount(steps).min() >= 5


def test_a_robot_that_steps_and_waits_is_fitted_whole_up_to_twice_as_many_rows():
    problem = posed(recorded({}, cycles=45))
    assert thinned(problem)[1] == 1
    running = replace(problem, around=replace(problem.around, dwell_s=0.02))
    assert thinned(running)[1] == 2


def test_play_answers_in_thinned_rows_as_in_all():
    """A command that turns back between two of them has been farther than they say."""
    recording = recorded({}, cycles=60)
    steps = 2.0 * np.random.default_rng(3).standard_normal(len(recording.samples))
    command = np.abs((np.cumsum(steps) + 50.0) % 200.0 - 100.0) - 50.0
    recording.samples["pitch_command_deg"] = command
    problem = pose_problem(DiagnosisConfig(), recording, "pitch_angle_deg", 0.7 * command)
    play = [Piece(term("backlash"), np.array([3.0]))]
    small, every = thinned(problem)
    assert every == 3
    assert small.picked
    assert len(small.picked.behind(play).motion) < 3 * len(small.motion)
    off = small.trace(play).seen - problem.trace(play).seen[small.picked.rows]
    assert np.abs(off).max() < 0.08
    alone = replace(small, picked=replace(small.picked, turned=np.zeros(0, dtype=int)))
    off = alone.trace(play).seen - problem.trace(play).seen[small.picked.rows]
    assert np.abs(off).max() > 0.4


def test_an_offset_is_judged_where_the_simulation_moves():
    """A line of gain 0.4 through pulls of 95 to 105 N stands 60 N off where nothing pulls."""
    problem = posed(recorded({}))
    around = replace(problem.around, angle_low=98.0, angle_span=4.0, angle_unit="N")
    tolerance = ToleranceConfig(gain=3.0, offset=2.0)
    problem = replace(problem, around=around, tolerance=tolerance)
    fit = evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), ())
    assert absurd_calibration(replace(fit, nuisance=np.array([2.5, -150.0]))) is None
    assert "offset" in absurd_calibration(replace(fit, nuisance=np.array([1.0, -50.0])))
