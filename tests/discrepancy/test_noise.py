"""Noise: exact whitening, and what is learnt from repeats."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from pipeline.discrepancy.noise.family import WALKS, noise_family
from pipeline.discrepancy.noise.learning import NoisePrior, fit_noise, learn_noise, unmistaken
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.search.explain import explain, refuted
from pipeline.recording import Recording
from tests.discrepancy.made import ANGLE, NOISE, changed, posed, recorded


def covariance(model: NoiseModel, cycle: np.ndarray, stands: np.ndarray) -> np.ndarray:
    i = np.arange(len(cycle))
    moves = np.cumsum(~(stands & model.settles))
    return (
        model.white**2 * np.eye(len(i))
        + model.correlated**2 * model.correlation ** np.abs(moves[:, None] - moves)
        + model.jitter**2 * (cycle[:, None] == cycle)
        + model.walk**2 * np.minimum(i[:, None], i)
    )


@pytest.mark.parametrize("settles", [False, True])
def test_likelihood_is_that_of_the_full_covariance_with_rows_missing(settles):
    rng = np.random.default_rng(0)
    cycle = np.arange(60) // 20
    used, stands = rng.random(60) > 0.2, rng.random(60) > 0.4
    model = NoiseModel(0.2, 0.3, 0.7, 0.4, 0.1, settles=settles)
    y = rng.normal(size=60)
    full = covariance(model, cycle, stands)[np.ix_(used, used)]
    exact = multivariate_normal(np.zeros(int(used.sum())), full).logpdf(y[used])
    assert model.log_likelihood(y, cycle, used, stands) == pytest.approx(exact, rel=1e-9)


def test_whitened_noise_is_white():
    rng = np.random.default_rng(1)
    cycle = np.arange(400) // 100
    model = NoiseModel(0.1, 0.3, 0.8, 0.2, 0.02)
    moving = np.zeros(400, dtype=bool)
    noise = np.linalg.cholesky(covariance(model, cycle, moving)) @ rng.normal(size=(400, 40))
    white = model.whiten(noise, cycle, np.ones(400, dtype=bool), moving)
    assert np.var(white) == pytest.approx(1.0, abs=0.03)
    assert abs(np.mean(white[1:] * white[:-1])) < 0.02


@pytest.mark.parametrize(("white", "correlated", "phi"), [(0.2, 0.0, 0.0), (0.1, 0.2, 0.85)])
def test_noise_is_learnt_from_series(white, correlated, phi):
    rng = np.random.default_rng(2)
    cycle = np.zeros(200, dtype=int)
    moving = np.zeros(200, dtype=bool)
    root = np.linalg.cholesky(covariance(NoiseModel(white, correlated, phi), cycle, moving))
    series = [s - s.mean() for s in (root @ rng.normal(size=(200, 5))).T]
    assert fit_noise(series).deviation == pytest.approx(np.hypot(white, correlated), rel=0.15)


@pytest.mark.parametrize(
    "hidden",
    [
        {"backlash": {"width": 8.0}},
        {"drift/linear": {"rate": 4.0}},
        {"creep": {"share": 0.3}},
        {"lost_steps": {"jump": 5.0, "time": 650.0}},
    ],
    ids=lambda h: next(iter(h)),
)
def test_physics_is_no_noise(hidden):
    prior = learn_noise(posed(recorded(hidden, noise=0.2, seed=3)))
    assert prior.repeats == 4
    assert prior.model.deviation == pytest.approx(0.2, rel=0.12)
    assert prior.model.walk < 0.01


def test_mistaken_samples_are_no_noise():
    rng = np.random.default_rng(7)
    recording = recorded({"backlash": {"width": 4.0}}, noise=0.2, seed=3)
    angle = recording.samples["pitch_angle_deg"].to_numpy()
    mistaken = 3.0 * rng.choice([-1.0, 1.0], len(angle)) * (rng.random(len(angle)) < 0.05)
    samples = recording.samples.assign(pitch_angle_deg=angle + mistaken)
    prior = learn_noise(posed(Recording(samples, recording.channels, "simulated")))
    assert prior.repeats == 4
    assert prior.model.deviation == pytest.approx(0.2, rel=0.1)


@pytest.mark.parametrize("repeats", [2, 3, 6])
def test_the_tails_of_noise_are_no_mistakes_however_few_repeat(repeats):
    values = np.random.default_rng(8).normal(size=(repeats, 400))
    assert np.isnan(unmistaken(values, 1e-9)).mean() < 0.001


def test_a_walk_is_picked_from_any_level():
    rng = np.random.default_rng(4)
    problem = posed(recorded({}, cycles=10))
    prior = NoisePrior(NoiseModel(0.2), 4, 0.08, ())
    family = noise_family(prior, problem, np.ones(1200, dtype=bool))
    residual = 0.2 * rng.normal(size=1200) + np.cumsum(0.2 * 0.03 * rng.normal(size=1200))
    noise, place = family.pick(residual - residual.mean(), (0, 0, 0))
    assert WALKS[place[2]] == pytest.approx(0.03, rel=0.7)
    assert family.pick(residual + 3.0, (0, 0, 0))[1] == place
    assert noise.walk == pytest.approx(0.2 * 0.03, rel=0.7)


def test_a_walk_in_repeats_is_no_slow_correlation():
    rng = np.random.default_rng(5)
    walks = np.cumsum(0.2 * 0.08 * rng.normal(size=(200, 6)), axis=0)
    series = [s - s.mean() for s in (0.2 * rng.normal(size=(200, 6)) + walks).T]
    prior = NoisePrior(NoiseModel(0.2), 6, 0.08, tuple(series))
    walking = min(prior.strain((0.0, 0.0, False), w) for w in WALKS)
    assert walking < prior.strain((0.0, 0.0, False), 0.0) - 10.0
    assert walking < min(prior.strain((s, 0.95, False), 0.0) for s in (0.03, 0.1, 0.3)) + 3.0


def test_cycles_that_lack_rows_still_repeat():
    whole = recorded({"backlash": {"width": 4.0}}, seed=3)
    left = np.random.default_rng(3).random(len(whole.samples)) > 0.05
    lacking = Recording(whole.samples[left].reset_index(drop=True), whole.channels, "simulated")
    for recording in (whole, lacking):
        prior = learn_noise(posed(recording))
        assert prior.repeats == 4
        assert prior.model.deviation == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize("two_axes", [False, True])
def test_a_few_targets_a_cycle_repeat_too(two_axes):
    """As in a test of positioning: what is rough there is the targets' own errors, not noise."""
    hidden = {"transmission_ripple": {"amplitude": 3.0, "period": 9.0}}
    whole = recorded(hidden, seed=3, two_axes=two_axes)
    samples = whole.samples.iloc[::8].reset_index(drop=True)
    prior = learn_noise(posed(Recording(samples, whole.channels, "simulated")))
    assert prior.repeats == 4
    assert prior.model.deviation == pytest.approx(NOISE, rel=0.3)
    assert 0.08 < prior.sure < 0.2


@pytest.mark.parametrize("walk", [0.0, 0.3])
@pytest.mark.parametrize("moves", [False, True])
def test_cycles_repeat_beside_another_axis_where_that_moves_nothing(walk, moves):
    hidden = {"backlash": {"width": 4.0}}
    if moves:
        hidden["coupling/yaw_command_deg"] = {"gain": 0.01}
    whole = recorded(hidden, seed=3, cycles=9, two_axes=True)
    steps = np.random.default_rng(7).standard_normal(len(whole.samples))
    walked = changed(whole, **{ANGLE: whole.values(ANGLE) + walk * NOISE * np.cumsum(steps) / 9.0})
    prior = learn_noise(posed(walked))
    assert prior.repeats == (0 if moves else 6)
    if not moves:
        assert prior.model.deviation == pytest.approx(NOISE, rel=0.1)


def test_a_joint_that_comes_to_rest_anew_with_each_move_is_noise():
    rng = np.random.default_rng(6)
    recording = recorded({}, noise=0.0, gain=1.0)
    stairs = [c.name for c in recording.channels] + ["step"]
    samples = recording.samples.copy()
    samples[stairs] = samples[stairs].to_numpy()[np.arange(len(samples)) // 5 * 5]
    beside = np.repeat(rng.normal(size=len(samples) // 5), 5)
    samples["pitch_angle_deg"] += 0.2 * beside + 0.03 * rng.normal(size=len(samples))
    problem = posed(Recording(samples, recording.channels, "simulated"))
    family = noise_family(learn_noise(problem), problem, problem.train)
    noise, _ = family.pick(problem.measured - problem.simulated - 0.4, (0, 0, 0))
    assert noise.settles
    assert (noise.correlated, noise.white) == pytest.approx((0.2, 0.03), rel=0.2)


def test_a_slip_before_a_dead_zone_is_no_noise_once_it_is_explained():
    """Shifted by it, each later cycle differs where the curve bends: by no constant."""
    slip = 4.0 + 3.36 * (2 * 120 + 40)
    problem = posed(
        recorded({"lost_steps": {"jump": 3.0, "time": slip}, "slack": {"width": 14.0}}, cycles=9)
    )
    before, found = learn_noise(problem), explain(problem)
    assert before.model.deviation > 1.1 * NOISE
    assert before.model.correlated > 0.5 * NOISE
    assert set(found.choices[0].fit.names) == {"lost_steps", "slack"}
    assert found.prior.model.deviation == pytest.approx(NOISE, rel=0.05)
    assert not refuted(found.search, found.choices[0])


def test_without_contrasts_nothing_says_how_far_repeats_differ():
    assert NoisePrior(NoiseModel(white=0.2), 0, 0.3, ()).differing == np.inf
    assert NoisePrior(NoiseModel(0.2), 2, 0.3, (np.array([0.3, -0.3]),)).differing == 0.3
