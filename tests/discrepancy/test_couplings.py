"""Another axis that changes a joint's gain, drags it along by its speed, or turns its weight."""

import numpy as np
import pytest
from scipy.signal import lfilter

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.model.result import Diagnosis
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import ANGLE, NOISE, SIMULATED, changed, motion_of, recorded

YAW = "yaw_command_deg"


def diagnosed(hidden: dict[str, dict[str, float]], two_axes: bool = True) -> Diagnosis:
    (diagnosis,) = diagnose(
        DiagnosisConfig(), recorded(hidden, seed=4, two_axes=two_axes)
    ).diagnoses
    return diagnosis


PLAIN = {f"coupling/{YAW}": {"gain": 0.1}}


@pytest.mark.parametrize(
    ("form", "values", "name", "verdict"),
    [
        ("lever", {"lever": 0.002, "lever_bend": 0.0}, "lever", "partly_explained"),
        ("lever", {"lever": 0.0, "lever_bend": -1e-4}, "lever_bend", "partly_explained"),
        ("rate", {"damping": 0.15}, "damping", "explained"),
    ],
)
def test_what_another_axis_does_is_told_by_its_own_law(form, values, name, verdict):
    found = diagnosed({f"coupling/{YAW}/{form}": values})
    (physics,) = found.physics
    assert (physics.name, found.verdict) == ("coupling", verdict)
    value = next(p.value for p in physics.parameters if p.name == name)
    assert value == pytest.approx(values[name], rel=0.15)
    assert found.after.heldout_rmse < 1.1 * NOISE


def test_a_gain_that_changes_beside_a_push_is_the_same_coupling():
    found = diagnosed({f"coupling/{YAW}": {"gain": 0.1}, f"coupling/{YAW}/lever": {"lever": 0.002}})
    (physics,) = found.physics
    assert (physics.name, found.verdict) == ("coupling", "explained")
    told = {p.name: p.value for p in physics.parameters}
    assert told[f"gain of {YAW}"] == pytest.approx(0.102, rel=0.1)
    assert told[f"lever of {YAW}"] == pytest.approx(0.002, rel=0.15)


def test_a_gain_that_pivots_where_the_simulation_is_off_is_no_push():
    """About the joint's own zero: to a simulation that is off by 1.8 deg, it pushes as well."""
    seen = recorded({}, two_axes=True)
    pose, other = seen.values(SIMULATED), seen.values(YAW)
    noise = NOISE * np.random.default_rng(5).standard_normal(len(pose))
    measured = (1.0 + 0.006 * other) * pose + noise
    off = changed(seen, **{ANGLE: measured, SIMULATED: pose - 1.8})
    (found,) = diagnose(DiagnosisConfig(), off).diagnoses
    (physics,) = found.physics
    assert f"gain of {YAW}" in {p.name for p in physics.parameters}
    assert (physics.name, found.verdict) == ("coupling", "partly_explained")


def test_wires_that_another_axis_pulls_are_told_by_what_they_do_at_home():
    """Where the curve has a slope of 0.7, as steep again by a quarter as it is on the whole."""
    seen = recorded({}, two_axes=True)
    drive, other = (seen.values(c) for c in ("pitch_command_deg", YAW))

    def curve(at):
        return at * (0.7 - 5e-5 * at**2)

    pulled = 1.02 * curve(drive + 0.1 / 0.7 * other)
    noise = NOISE * np.random.default_rng(8).standard_normal(len(drive))
    bent = changed(seen, **{ANGLE: pulled + noise, SIMULATED: curve(drive)})
    (found,) = diagnose(DiagnosisConfig(), bent).diagnoses
    (physics,) = found.physics
    assert physics.name == "coupling"
    gain = physics.parameters[0]
    assert gain.low < 0.102 < gain.high
    assert gain.high - gain.low < 0.01


def test_a_coupling_that_comes_late_draws_no_other_name():
    late = {"gain": 0.15, "drag": -0.15, "time_constant": 30.0}
    found = diagnosed({f"coupling/{YAW}/late": late})
    assert [p.name for p in found.physics] == ["coupling"]
    assert found.verdict == "explained"
    assert found.after.heldout_rmse < 1.1 * NOISE


def test_a_weight_that_another_axis_turns_away_is_gravity_and_no_other_bend():
    hidden = {f"gravity/{YAW}/turned": {"deflection": 6.0, "zero": 0.7, "turn": 0.0175}}
    found = diagnosed(hidden)
    (physics,) = found.physics
    assert (physics.name, found.verdict) == ("gravity", "explained")
    assert physics.alternatives == ()
    assert {p.name: p.value for p in physics.parameters}["turn"] == pytest.approx(0.0175, rel=0.15)


def test_where_no_other_axis_moves_a_weight_is_as_any_bend():
    found = diagnosed({"gravity": {"deflection": 6.0, "zero": 0.7}}, two_axes=False)
    assert "coupling" in found.not_excited
    assert found.verdict == "ambiguous"


def test_a_wave_in_step_with_another_axis_is_its_coupling_and_no_drift():
    """Beside a drift one wave that rises tells both, in fewer names: by coincidence alone."""
    seen, motion = recorded({}, noise=0.0, cycles=9), motion_of(9)
    slow = 30.0 * np.sin(2.0 * np.pi * motion.time_s / 1100.0)
    white = NOISE * np.random.default_rng(6).standard_normal(len(slow))
    noise = lfilter([1.0], [1.0, -0.8], white)
    warming = 2.0 * motion.time_s / motion.time_s[-1]
    measured = seen.values(ANGLE) + 0.1 * slow + warming + noise
    moved = changed(seen, **{ANGLE: measured, YAW: slow})
    (found,) = diagnose(DiagnosisConfig(), moved).diagnoses
    assert {p.name for p in found.physics} == {"coupling", "drift"}
    assert found.after.heldout_rmse < 1.1 * np.std(noise)
