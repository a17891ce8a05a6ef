"""Samples by the dozen that stand off are no mistakes of the sensor."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.discrepancy.made import ANGLE, SIMULATED, changed, diagnosed, followed, names, recorded

COUNT, TICK_S = 360.0 / 4096.0, 1e-3
Command = Callable[[np.ndarray], np.ndarray]


def servo(
    time_s: np.ndarray, command: Command, late_s: float, forth: float, back: float
) -> np.ndarray:
    """What a servo reads that hears of its command late and has a top speed, each way its own."""
    ticks_s = np.arange(-late_s, time_s[-1] + TICK_S, TICK_S)
    course = [float(command(time_s[:1])[0])]
    for target in command(ticks_s - late_s)[1:]:
        course.append(
            course[-1] + float(np.clip(target - course[-1], -back * TICK_S, forth * TICK_S))
        )
    return COUNT * np.round(np.interp(time_s, ticks_s, course) / COUNT)


def pulses(time_s: np.ndarray) -> np.ndarray:
    """Half a second at 35 deg each six seconds, none of them at the same samples."""
    return np.where(np.mod(time_s - 0.4, 6.037) < 0.5, 35.0, 0.0)


def test_a_servo_that_answers_short_pulses_is_no_sensor_that_mistakes_them():
    time_s = 0.1 * np.arange(270)
    asked = pulses(time_s)
    recording = followed(time_s, asked, servo(time_s, pulses, 0.15, 160.0, 160.0), 0.1)
    found = diagnosed(changed(recording, **{SIMULATED: 0.3 * asked + 1.0}))
    assert names(found) >= {"frame_lag", "response_lag"}
    assert "marker_outliers" not in names(found)


@pytest.mark.parametrize(("share", "told"), [(0.03, True), (0.16, False)])
def test_a_sensor_that_mistakes_each_sixth_sample_is_none(share, told):
    recording = recorded({"backlash": {"width": 4.0}}, seed=3)
    rng = np.random.default_rng(0)
    n = len(recording.samples)
    wrong = rng.permutation(n)[: int(share * n)]
    seen = recording.values(ANGLE).copy()
    seen[wrong] += 15.0 * rng.choice([-1.0, 1.0], len(wrong))
    found = diagnosed(changed(recording, **{ANGLE: seen}))
    assert ("marker_outliers" in names(found)) == told
    assert (found.diagnoses[0].verdict == "partly_explained") != told
    assert ("stand off" in str(found.diagnoses[0].unexplained.where)) != told
    assert "backlash" in names(found)
