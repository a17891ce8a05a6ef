"""A joint that swings after each step."""

import numpy as np
import pytest

from tests.discrepancy.made import (
    ANGLE,
    changed,
    diagnosed,
    followed,
    names,
    recorded,
    strokes,
    value_of,
)


@pytest.mark.parametrize(
    "beside",
    [{}, {"drift/exponential": {"amplitude": 2.0, "time_constant": 500.0}}],
    ids=["alone", "drift"],
)
@pytest.mark.parametrize(
    ("frequency", "damping"), [(0.16, 0.25), (0.7, 0.2)], ids=["slow", "quick"]
)
@pytest.mark.long
def test_what_swings_is_a_lag_though_no_first_order_lag_is_on_the_way(frequency, damping, beside):
    swing = {"natural_frequency": frequency, "damping": damping, "moving": 0.0}
    result = diagnosed(recorded({"response_lag/second": swing} | beside, cycles=9, noise=0.15))
    assert names(result) == {"response_lag", *(key.partition("/")[0] for key in beside)}
    assert result.diagnoses[0].after.heldout_rmse < 0.165


def test_what_swings_is_found_where_a_zero_that_jitters_hides_that_noise_is_not_what_is_left():
    swing = {"natural_frequency": 0.27, "damping": 0.35, "moving": 0.0}
    made = recorded({"response_lag/second": swing}, cycles=9, noise=0.24)
    jitter = 0.1 * np.random.default_rng(3).standard_normal(9)[made.samples["cycle"]]
    result = diagnosed(changed(made, **{ANGLE: made.samples[ANGLE] + jitter}))
    assert names(result) == {"response_lag"}
    assert result.diagnoses[0].after.heldout_rmse < 0.28


def test_what_swings_at_a_steady_pace_is_not_told_as_an_old_frame_alone():
    """Sines of one pace, sampled finely: how late it is says nearly all that a swing does."""
    frequency, damping, step_s = 12.0, 0.52, 0.02
    time_s = step_s * np.arange(2400)
    drive = 60.0 * np.clip(time_s / 3.0, 0.0, 1.0) * np.sin(2.0 * np.pi * 0.3 * time_s)
    at, speed, seen = 0.0, 0.0, np.empty(len(drive))
    for k, u in enumerate(drive):
        start = drive[k - 1] if k else 0.0
        for part in (np.arange(10) + 1) / 10:
            pull = frequency**2 * (start + part * (u - start) - at)
            speed += step_s / 10 * (pull - 2.0 * damping * frequency * speed)
            at += step_s / 10 * speed
        seen[k] = at
    noise = 0.3 * np.random.default_rng(6).standard_normal(len(drive))
    (found,) = diagnosed(followed(time_s, drive, seen + noise, 0.3)).diagnoses
    assert [p.name for p in found.physics] == ["response_lag"]
    assert found.after.heldout_rmse < 0.32


@pytest.mark.long
def test_what_swings_is_found_behind_play_that_grows_and_before_an_old_frame():
    """Steps of any size with pauses that differ: creep beside an old frame comes near the swing."""
    rng = np.random.default_rng(8)
    drive = strokes(rng.uniform(15.0, 55.0, 40) * (-1.0) ** np.arange(40), 30)
    time_s = np.cumsum(rng.choice([1.5, 3.0, 6.0], 40).repeat(30))
    widths = np.linspace(1.5, 4.0, len(drive))
    frequency, damping, fine = 0.35, 0.45, 40
    at, speed, held, poses = 0.0, 0.0, 0.0, np.empty(len(drive))
    for k, u in enumerate(drive):
        held = min(max(held, u - 0.5 * widths[k]), u + 0.5 * widths[k])
        step_s = (time_s[k] - time_s[k - 1] if k else 3.0) / fine
        for _ in range(fine):
            speed += step_s * (frequency**2 * (held - at) - 2.0 * damping * frequency * speed)
            at += step_s * speed
        poses[k] = at
    rows = np.arange(len(drive))
    seen = np.interp(rows - 0.8, rows, poses) + 0.15 * rng.standard_normal(len(drive))
    result = diagnosed(followed(time_s, drive, seen, 0.005))
    assert names(result) == {"tension_loss", "response_lag", "frame_lag"}
    assert result.diagnoses[0].after.heldout_rmse < 0.165
    lag = value_of(result, "response_lag", "natural_frequency")
    assert abs(lag.value - frequency) < 0.02
