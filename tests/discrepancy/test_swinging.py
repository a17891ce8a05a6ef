"""A joint that swings after each step."""

import numpy as np
import pytest

from tests.discrepancy.made import ANGLE, changed, diagnosed, followed, names, recorded


@pytest.mark.parametrize(
    "beside",
    [{}, {"drift/exponential": {"amplitude": 2.0, "time_constant": 500.0}}],
    ids=["alone", "drift"],
)
@pytest.mark.parametrize(
    ("frequency", "damping"), [(0.16, 0.25), (0.7, 0.2)], ids=["slow", "quick"]
)
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
