from dataclasses import replace

import numpy as np
import pytest
from play_loop import play_recording

from pipeline.config import TrainingConfig
from pipeline.control.monotone import MonotoneBranch, monotone_branch
from pipeline.errors import LoopgapError
from pipeline.models.loop_model import branch_samples
from pipeline.models.mixture import MixtureRegression


def two_lines(gap: float) -> MixtureRegression:
    """Two components of slope 0.5, the second one lower by `gap`: the mean falls between them."""
    lean = [[100.0, 50.0], [50.0, 26.0]]
    return MixtureRegression(
        weights=np.array([0.5, 0.5]),
        means_deg=np.array([[-20.0, -10.0], [20.0, 10.0 - gap]]),
        covariances_deg2=np.array([lean, lean]),
        range_deg=(-40.0, 40.0),
        gain=0.5,
        samples=100,
    )


def test_rising_mean_is_left_as_it_is() -> None:
    mixture = two_lines(0.0)
    branch = monotone_branch(mixture)
    for command in np.linspace(-40.0, 40.0, 321):
        at = np.array([command])
        angle, slope = branch.at(command)
        assert angle == pytest.approx(mixture.predict(at)[0][0], abs=1e-9)
        assert slope == pytest.approx(mixture.slope(at)[0], abs=1e-6)
    assert branch.changed_deg < 1e-12
    assert branch.bounds_deg == (-40.0, 40.0)


def test_falling_stretch_is_made_to_rise_and_the_change_is_said() -> None:
    mixture = two_lines(8.0)
    command = np.linspace(-40.0, 40.0, 4001)
    mean = mixture.predict(command)[0]
    assert np.diff(mean).min() < 0.0
    branch = monotone_branch(mixture)
    angle, slope = np.array([branch.at(q) for q in command]).T
    assert np.diff(angle).min() > 0.0
    assert slope.min() >= 0.0
    fall = np.max(np.maximum.accumulate(mean) - mean)
    assert 0.4 * fall < branch.changed_deg < fall
    np.testing.assert_allclose(np.abs(angle - mean).max(), branch.changed_deg, rtol=1e-2)


@pytest.mark.parametrize("k", [9, 20])
def test_fitted_branches_rise_everywhere(k: int) -> None:
    recording = play_recording("pitch", 1.57, 0.45, seed=4)
    for samples in branch_samples(recording, "pitch", range(6)).values():
        mixture = MixtureRegression.fit(
            samples.command_deg, samples.angle_deg, k, TrainingConfig(n_init=1), seed=0
        )
        branch = monotone_branch(mixture)
        angles = [branch.at(q)[0] for q in np.linspace(*mixture.range_deg, 7001)]
        assert np.diff(angles).min() > 0.0
        assert branch.changed_deg < 0.5


def test_slope_is_the_derivative_of_the_angle() -> None:
    branch = MonotoneBranch(
        np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 3.0]), np.array([1.0, 1.5, 0.1])
    )
    for command in (0.2, 0.9, 1.1, 2.7):
        numeric = (branch.at(command + 1e-6)[0] - branch.at(command - 1e-6)[0]) / 2e-6
        assert branch.at(command)[1] == pytest.approx(numeric, abs=1e-6)
    assert [branch.at(q)[0] for q in (0.0, 1.0, 3.0)] == [0.0, 2.0, 3.0]


def test_angle_that_falls_with_the_command_is_refused() -> None:
    mixture = replace(
        two_lines(0.0),
        covariances_deg2=np.tile([[100.0, -50.0], [-50.0, 26.0]], (2, 1, 1)),
        means_deg=np.array([[-20.0, 10.0], [20.0, -10.0]]),
    )
    with pytest.raises(
        LoopgapError, match=r"rises with the command; found a slope of -0\.\d+ over"
    ):
        monotone_branch(mixture)
