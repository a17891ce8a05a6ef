"""Forces of another form than a plain damper's: each is named, and told as it is."""

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig, SimulationConfig
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.simulation import simulate
from tests.discrepancy.test_force import RATE, dahl, motion, parameters, recording

NOISE = 0.3


def diagnosed(x, force, rng, step=2e-6, units=("N", "m")):
    """The diagnosis of a force with noise, its position (n,) seen in steps."""
    seen = recording(np.round(x / step) * step, force + rng.normal(0.0, NOISE, len(x)), *units)
    return diagnose(DiagnosisConfig(), simulate(SimulationConfig("mechanism"), seen)).diagnoses[0]


def assert_told(diagnosis, names, sizes):
    """These names and no other, these sizes within 5 %, and no more than noise left."""
    assert {p.name for p in diagnosis.physics} == names
    found = parameters(diagnosis)
    for name, value in sizes.items():
        assert found[name].value == pytest.approx(value, rel=0.05), name
    assert diagnosis.after.heldout_rmse < 1.2 * NOISE


def test_oil_in_an_orifice_holds_back_by_the_square_of_the_speed():
    t, x, rng = motion(11)
    v = np.gradient(x, t)
    found = diagnosed(x, 900.0 * v * np.abs(v) + dahl(t, x, 12.0, 4e-4), rng)
    sizes = {"viscous_friction.square": 900.0, "coulomb_friction.force": 12.0}
    assert_told(found, {"viscous_friction", "coulomb_friction"}, sizes)
    (said,) = [p.says for p in found.physics if p.name == "viscous_friction"]
    assert "with its square" in said


def test_a_buffer_is_met_at_its_position():
    t, x, rng = motion(12)
    force = 800.0 * x + 9000.0 * np.maximum(x - 0.012, 0.0) + dahl(t, x, 6.0, 4e-4)
    found = diagnosed(x, force, rng)
    sizes = {"contact.stiffness": 9000.0, "contact.position": 0.012, "stiffness.stiffness": 800.0}
    assert_told(found, {"stiffness", "contact", "coulomb_friction"}, sizes)


def test_magnets_pull_again_and_again_and_a_weight_once_a_turn():
    t, x, rng = motion(13)
    angle = 150.0 * x
    torque = 8.0 * np.sin(angle + 0.4) + 1.5 * np.sin(14.0 * angle) + dahl(t, angle, 6.0, 0.05)
    found = diagnosed(angle, torque, rng, 1e-4, ("Nm", "rad"))
    names = {"gravity", "transmission_ripple", "coulomb_friction"}
    sizes = {"gravity.moment": 8.0, "transmission_ripple.period": 2.0 * np.pi / 14.0}
    assert_told(found, names, sizes)


def test_a_filter_of_the_force_is_no_spring_behind_a_damper():
    t, x, rng = motion(14)
    force = dahl(t, x, 30.0, 4e-4) + 80.0 * np.gradient(x, t)
    late = np.zeros(len(t))
    for k in range(1, len(t)):
        late[k] = late[k - 1] + (force[k] - late[k - 1]) * -np.expm1(-1.0 / RATE / 0.03)
    found = diagnosed(x, late, rng)
    sizes = {"viscous_friction.damping": 80.0, "coulomb_friction.force": 30.0}
    assert_told(found, {"viscous_friction", "coulomb_friction", "response_lag"}, sizes)


def test_what_wanders_slowly_hides_no_friction():
    t, x, rng = motion(15)
    force = dahl(t, x, 10.0, 4e-4) + 40.0 * np.gradient(x, t) + 5.0 * np.sin(0.35 * t)
    found = diagnosed(x, force, rng)
    sizes = {"viscous_friction.damping": 40.0, "coulomb_friction.force": 10.0}
    assert_told(found, {"viscous_friction", "coulomb_friction", "drift"}, sizes)
