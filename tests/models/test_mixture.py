import json
from dataclasses import replace

import numpy as np
import pytest
from gmr import GMM
from play_loop import curve, play, triangle

from pipeline.config import TrainingConfig
from pipeline.models.mixture import MixtureError, MixtureRegression
from pipeline.recording import branch_of

CONFIG = TrainingConfig(n_init=2)


def known_mixture() -> MixtureRegression:
    """Three components that lean differently; the second is narrow."""
    return MixtureRegression(
        weights=np.array([0.5, 0.2, 0.3]),
        means_deg=np.array([[-20.0, -15.0], [0.0, 3.0], [25.0, 14.0]]),
        covariances_deg2=np.array(
            [[[80.0, 50.0], [50.0, 35.0]], [[4.0, -1.0], [-1.0, 2.0]], [[60.0, 30.0], [30.0, 16.0]]]
        ),
        range_deg=(-40.0, 45.0),
        gain=0.65,
        samples=1000,
    )


def play_samples(cycles: int = 3, noise: float = 0.4) -> tuple[np.ndarray, np.ndarray]:
    command = triangle(cycles, 60.0, 200)
    angle = curve(play(command, 1.5))
    return command, angle + noise * np.random.default_rng(1).standard_normal(len(angle))


@pytest.mark.parametrize("k", [1, 4, 9])
def test_mean_is_that_of_the_gmr_package(k: int) -> None:
    mixture = MixtureRegression.fit(*play_samples(), k, CONFIG, seed=0)
    peer = GMM(k, mixture.weights, mixture.means_deg, mixture.covariances_deg2)
    command = np.linspace(-60.0, 60.0, 500)
    theirs = peer.predict(np.array([0]), command[:, None])[:, 0]
    np.testing.assert_allclose(mixture.predict(command)[0], theirs, rtol=0, atol=1e-9)


def test_mean_and_variance_are_those_of_the_density() -> None:
    mixture = known_mixture()
    angle = np.linspace(-150.0, 150.0, 60001)
    for command in (-39.0, -7.3, 0.2, 11.0, 44.0):
        points = np.column_stack([np.full_like(angle, command), angle])
        density = sum(
            w * np.exp(-0.5 * np.einsum("ni,ij,nj->n", points - m, np.linalg.inv(c), points - m))
            / np.sqrt(np.linalg.det(c))
            for w, m, c in zip(
                mixture.weights, mixture.means_deg, mixture.covariances_deg2, strict=True
            )
        )  # fmt: skip
        density /= density.sum()
        mean = (density * angle).sum()
        deviation = np.sqrt((density * (angle - mean) ** 2).sum())
        found = mixture.predict(np.array([command]))
        assert found[0][0] == pytest.approx(mean, abs=1e-7)
        assert found[1][0] == pytest.approx(deviation, abs=1e-7)


def test_one_gaussian_is_linear_regression() -> None:
    rng = np.random.default_rng(3)
    command = rng.uniform(-30, 30, 400)
    angle = 0.8 * command + 2.0 + 0.3 * rng.standard_normal(400)
    mixture = MixtureRegression.fit(command, angle, 1, replace(CONFIG, reg_covar=0.0), seed=0)
    slope, offset = np.polyfit(command, angle, 1)
    rest = np.sqrt(np.mean((angle - slope * command - offset) ** 2))
    mean, deviation = mixture.predict(command)
    np.testing.assert_allclose(mean, slope * command + offset, atol=1e-9)
    np.testing.assert_allclose(deviation, rest, atol=1e-9)
    assert mixture.gain == pytest.approx(slope, abs=1e-9)


def test_total_variance_covers_the_samples_of_a_branch() -> None:
    command, angle = play_samples(cycles=12)
    rising = branch_of(command) > 0
    command, angle = command[rising], angle[rising]
    mean, deviation = MixtureRegression.fit(command, angle, 6, CONFIG, seed=0).predict(command)
    assert np.mean(np.abs(angle - mean) <= 1.96 * deviation) == pytest.approx(0.95, abs=0.015)


def test_known_components_are_recovered() -> None:
    truth = known_mixture()
    rng = np.random.default_rng(0)
    which = rng.choice(3, size=6000, p=truth.weights)
    points = np.array(
        [rng.multivariate_normal(truth.means_deg[i], truth.covariances_deg2[i]) for i in which]
    )
    fitted = MixtureRegression.fit(*points.T, 3, CONFIG, seed=0)
    order = np.argsort(fitted.means_deg[:, 0])
    np.testing.assert_allclose(fitted.weights[order], truth.weights, atol=0.03)
    np.testing.assert_allclose(fitted.means_deg[order], truth.means_deg, atol=0.8)
    np.testing.assert_allclose(
        fitted.covariances_deg2[order], truth.covariances_deg2, rtol=0.15, atol=0.5
    )


def test_shares_survive_commands_far_from_every_component() -> None:
    mixture = replace(
        known_mixture(),
        means_deg=np.array([[-20.0, -15.0], [0.0, 3.0], [1e4, 14.0]]),
        covariances_deg2=np.tile(np.eye(2) * 1e-4, (3, 1, 1)),
        range_deg=(-1e5, 1e5),
    )
    mean, deviation = mixture.predict(np.array([-5e4, 4000.0, 9e4]))
    np.testing.assert_allclose(mean, [-15.0, 3.0, 14.0])
    np.testing.assert_allclose(deviation, 1e-2)


def test_beyond_the_range_it_goes_straight_on_and_says_less() -> None:
    mixture = known_mixture()
    command = np.array([45.0, 50.0, 100.0, -60.0])
    mean, deviation = mixture.predict(command)
    low_edge = mixture.predict(np.array([-40.0]))[0][0]
    np.testing.assert_allclose(mean[1:3], mean[0] + 0.65 * np.array([5.0, 55.0]))
    assert mean[3] == pytest.approx(low_edge - 0.65 * 20.0)
    assert deviation[0] < deviation[1] < deviation[2]
    assert deviation[2] >= 0.65 * 55.0
    assert mixture.outside(command).tolist() == [False, True, True, True]


def test_slope_is_the_derivative_of_the_mean() -> None:
    mixture = known_mixture()
    command = np.linspace(-39.0, 44.0, 200)
    step = 1e-5
    numeric = (mixture.predict(command + step)[0] - mixture.predict(command - step)[0]) / (2 * step)
    np.testing.assert_allclose(mixture.slope(command), numeric, atol=1e-6)
    np.testing.assert_allclose(mixture.slope(np.array([-41.0, 70.0])), 0.65)


def test_chunks_change_nothing() -> None:
    mixture = known_mixture()
    command = np.linspace(-50.0, 50.0, 20_000)
    whole = mixture.predict(command)
    pieces = [mixture.predict(part) for part in np.array_split(command, 7)]
    np.testing.assert_allclose(whole[0], np.concatenate([p[0] for p in pieces]), rtol=1e-13)
    np.testing.assert_allclose(whole[1], np.concatenate([p[1] for p in pieces]), rtol=1e-13)
    assert mixture.predict(np.array([]))[0].shape == (0,)


def test_unit_of_the_samples_does_not_matter() -> None:
    command, angle = play_samples()
    in_deg = MixtureRegression.fit(command, angle, 5, CONFIG, seed=0)
    in_rad = MixtureRegression.fit(np.radians(command), np.radians(angle), 5, CONFIG, seed=0)
    mean, deviation = in_rad.predict(np.radians(command))
    np.testing.assert_allclose(np.degrees(mean), in_deg.predict(command)[0], atol=1e-6)
    np.testing.assert_allclose(np.degrees(deviation), in_deg.predict(command)[1], atol=1e-6)


def test_samples_without_an_angle_are_left_out_and_counted() -> None:
    command, angle = play_samples()
    holes = angle.copy()
    holes[::7] = np.nan
    fitted = MixtureRegression.fit(command, holes, 3, CONFIG, seed=0)
    kept = np.isfinite(holes)
    without = MixtureRegression.fit(command[kept], angle[kept], 3, CONFIG, seed=0)
    assert fitted.left_out == np.count_nonzero(~kept)
    assert fitted.samples == np.count_nonzero(kept)
    assert without.left_out == 0
    np.testing.assert_array_equal(fitted.means_deg, without.means_deg)


def test_criteria_are_in_the_units_of_the_samples() -> None:
    rng = np.random.default_rng(0)
    points = rng.multivariate_normal([1.0, 2.0], [[9.0, 3.0], [3.0, 4.0]], 500)
    fitted = MixtureRegression.fit(*points.T, 1, replace(CONFIG, reg_covar=0.0), seed=0)
    covariance = np.cov(points.T, bias=True)
    log_likelihood = -0.5 * 500 * (2 * np.log(2 * np.pi) + np.log(np.linalg.det(covariance)) + 2)
    assert fitted.aic() == pytest.approx(2 * 5 - 2 * log_likelihood, rel=1e-9)
    assert fitted.bic() == pytest.approx(5 * np.log(500) - 2 * log_likelihood, rel=1e-9)


def test_same_seed_same_model() -> None:
    first, second = (MixtureRegression.fit(*play_samples(), 6, CONFIG, seed=5) for _ in range(2))
    np.testing.assert_array_equal(first.means_deg, second.means_deg)


def test_json_keeps_every_number() -> None:
    mixture = MixtureRegression.fit(*play_samples(), 4, CONFIG, seed=0)
    again = MixtureRegression.from_json(json.loads(json.dumps(mixture.as_json())))
    command = np.linspace(-70.0, 70.0, 50)
    np.testing.assert_array_equal(mixture.predict(command), again.predict(command))
    assert again.as_json() == mixture.as_json()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"means_deg": [[1.0, 2.0]]}, r"expected shapes \(K,\), \(K, 2\), \(K, 2, 2\)"),
        ({"weights": ["heavy"]}, "expected lists of numbers"),
        ({"range_deg": [1.0]}, "expected lists of numbers"),
    ],
)
def test_misshapen_json_is_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(MixtureError, match=message):
        MixtureRegression.from_json(known_mixture().as_json() | change)


def test_incomplete_json_is_refused() -> None:
    entry = known_mixture().as_json()
    del entry["gain"]
    with pytest.raises(MixtureError, match="found no gain"):
        MixtureRegression.from_json(entry)


def test_more_gaussians_than_the_samples_allow_are_refused() -> None:
    command = np.linspace(0.0, 1.0, 20)
    angle = np.where(np.arange(20) < 5, np.nan, command)
    with pytest.raises(
        MixtureError,
        match=r"at least 18 measured samples for K = 6; found 15 \(5 more .*K of at most 5",
    ):
        MixtureRegression.fit(command, angle, 6, CONFIG, seed=0)


def test_no_gaussian_is_refused() -> None:
    with pytest.raises(MixtureError, match="at least one Gaussian; found K = 0"):
        MixtureRegression.fit(*play_samples(), 0, CONFIG, seed=0)


def test_command_that_stands_still_is_refused() -> None:
    with pytest.raises(MixtureError, match="a command that moves; found 2 deg in all 30 samples"):
        MixtureRegression.fit(np.full(30, 2.0), np.arange(30.0), 1, CONFIG, seed=0)


def test_angle_that_stands_still_is_no_error() -> None:
    mixture = MixtureRegression.fit(np.arange(30.0), np.full(30, 4.0), 1, CONFIG, seed=0)
    np.testing.assert_allclose(mixture.predict(np.array([3.0, 40.0]))[0], 4.0)
