"""Force against motion: recovery with noise and directions, honesty, prediction, detection."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import CubicSpline

from pipeline.config import Config, DiagnosisConfig, SimulationConfig, ToleranceConfig
from pipeline.discrepancy.model.model import as_json, from_json
from pipeline.discrepancy.problem.force_problem import top_of
from pipeline.errors import UsageError
from pipeline.physics.force_motion import position_of
from pipeline.recording import Channel, Recording, with_context
from pipeline.runners.diagnosis import with_simulations
from pipeline.stages.diagnosis import diagnose
from pipeline.stages.prediction import predict
from pipeline.stages.simulation import simulate

RATE = 200.0
PLAN = ((0.02, 0.25), (0.02, 1.0), (0.006, 0.5), (0.02, 2.0))


def motion(seed=0):
    """Time [s] and position [m]: two sines of each amplitude [m] and frequency [Hz]."""
    rng = np.random.default_rng(seed)
    x = np.concatenate(
        [a * np.sin(2 * np.pi * f * np.arange(int(2 * RATE / f)) / RATE) for a, f in PLAN]
    )
    return np.arange(len(x)) / RATE, x, rng


def recording(x, force, unit="N", position_unit="m"):
    names = f"position_{position_unit.lower()}", f"force_{unit.lower()}"
    channels = (Channel(names[0], "command", position_unit), Channel(names[1], "measurement", unit))
    table = pd.DataFrame({"time_s": np.arange(len(x)) / RATE, names[0]: x, names[1]: force})
    return Recording(with_context(table, channels), channels, "simulated")


def dahl(t, x, force, reach, rising=0.0):
    """Dahl's own differential equation, stepped finely: no bank of sliders as in the term."""
    out, z = np.zeros(len(x)), 0.0
    for k in range(1, len(x)):
        for _ in range(40):
            dx = (x[k] - x[k - 1]) / 40
            z += dx / reach * (1.0 - z * np.sign(dx))
        out[k] = force * z * (1.0 + rising * np.sign(z))
    return out


@pytest.fixture(scope="module")
def damper():
    """Dry friction 30 N, 20 % more rising; viscous 80 N s/m, 15 % less rising; noise 0.5 N."""
    t, x, rng = motion()
    v = np.gradient(x, t)
    force = dahl(t, x, 30.0, 4e-4, 0.2) + 80.0 * v * (1.0 - 0.15 * np.sign(v))
    measured = force + rng.normal(0.0, 0.5, len(t))
    return diagnose(DiagnosisConfig(), seen_in_steps(x, measured))


def seen_in_steps(x, measured):
    seen = np.round(x / 2e-6) * 2e-6
    return simulate(SimulationConfig("mechanism"), recording(seen, measured))


def parameters(diagnosis):
    return {f"{p.name}.{e.name}": e for p in diagnosis.physics for e in p.parameters}


@pytest.mark.long
def test_noise_is_no_more_than_the_terms_leave():
    t, x, rng = motion(3)
    force = dahl(t, x, 50.0, 2e-3) + 400.0 * x + rng.normal(0.0, 0.1, len(t))
    (found,) = diagnose(DiagnosisConfig(), seen_in_steps(x, force)).diagnoses
    assert found.noise == pytest.approx(0.1, rel=0.02)
    assert found.noise <= 1.001 * found.after.train_rmse


def test_friction_that_differs_by_direction_is_named_and_measured(damper):
    diagnosis = damper.diagnoses[0]
    assert {p.name for p in diagnosis.physics} == {"coulomb_friction", "viscous_friction"}
    found = parameters(diagnosis)
    for name, value, within in (
        ("coulomb_friction.force", 30.0, 0.3),
        ("coulomb_friction.asymmetry", 0.2, 0.01),
        ("coulomb_friction.reach", 4e-4, 4e-5),
        ("viscous_friction.damping", 80.0, 2.5),
        ("viscous_friction.asymmetry", -0.15, 0.05),
    ):
        assert found[name].value == pytest.approx(value, abs=within), name
    assert found["viscous_friction.damping"].unit == "N s/m"
    assert diagnosis.noise == pytest.approx(0.5, rel=0.25)
    assert diagnosis.after.heldout_rmse < 0.65 < 20.0 < diagnosis.before.heldout_rmse
    assert "rising and" in diagnosis.physics[0].says
    assert found["coulomb_friction.force rising"].value == pytest.approx(36.0, abs=0.5)
    assert found["coulomb_friction.force falling"].value == pytest.approx(24.0, abs=0.5)
    assert "backlash" in diagnosis.not_excited
    assert "viscous_friction" not in diagnosis.not_excited


def relaxed(x, arm, relaxation_s):
    """The force of a spring `arm` [N/m] that a dashpot lets go of, stepped finely."""
    out, gone = np.zeros(len(x)), x[0]
    for k in range(1, len(x)):
        for part in (np.arange(20) + 0.5) / 20:
            way = x[k - 1] + part * (x[k] - x[k - 1])
            gone += (way - gone) / relaxation_s / RATE / 20
        out[k] = arm * (x[k] - gone)
    return out


def test_a_damper_behind_a_spring_is_no_dry_friction():
    t, x, rng = motion(4)
    force = 2000.0 * x + relaxed(x, 1500.0, 0.06) + rng.normal(0.0, 0.3, len(t))
    (diagnosis,) = diagnose(DiagnosisConfig(), seen_in_steps(x, force)).diagnoses
    assert {p.name for p in diagnosis.physics} == {"stiffness", "viscous_friction"}
    assert diagnosis.verdict == "ambiguous"
    found = parameters(diagnosis)
    assert found["stiffness.stiffness"].value == pytest.approx(2000.0, rel=0.02)
    assert found["viscous_friction.relaxation"].value == pytest.approx(0.06, rel=0.1)
    assert found["viscous_friction.damping"].value == pytest.approx(90.0, rel=0.1)
    assert diagnosis.after.heldout_rmse < 0.33
    (damper,) = [p for p in diagnosis.physics if p.name == "viscous_friction"]
    assert "behind a spring" in damper.says
    assert set(damper.alternatives) == {"creep", "response_lag"}


@pytest.mark.parametrize(("dry", "mass"), [(0.0, 3.0), (20.0, 0.0)])
@pytest.mark.long
def test_a_damper_that_is_simulated_as_rigid_comes_late(dry, mass):
    t, x, rng = motion(5)
    spline = CubicSpline(t, x)
    force = relaxed(x, 1500.0, 0.06) + mass * spline(t, 2) + rng.normal(0.0, 0.3, len(t))
    measured = recording(x, force + dahl(t, x, dry, 4e-4, 0.2))
    channel = Channel("sim", "simulation", "N", of="force_n")
    samples = measured.samples.assign(sim=1500.0 * 0.06 * spline(t, 1))
    rigid = Recording(samples, (*measured.channels, channel), "simulated")
    (diagnosis,) = diagnose(DiagnosisConfig(), rigid).diagnoses
    beside = "inertia" if mass else "coulomb_friction"
    assert {p.name for p in diagnosis.physics} == {"response_lag", beside}
    assert diagnosis.verdict in ("explained", "ambiguous")
    found = parameters(diagnosis)
    assert found["response_lag.relaxation"].value == pytest.approx(0.06, rel=0.1)
    size = "inertia.mass" if mass else "coulomb_friction.force"
    assert found[size].value == pytest.approx(mass or dry, rel=0.05)
    assert diagnosis.after.heldout_rmse < 0.4


@pytest.mark.long
def test_a_damper_behind_a_spring_is_found_beside_a_contact_that_learns_late_of_its_speed():
    t, x, rng = motion(7)
    force = lugre(x, 10.0, 0.3, 0.005, 3e-4) + relaxed(x, 1000.0, 0.1)
    force += 20.0 * CubicSpline(t, x)(t, 1) + rng.normal(0.0, 0.3, len(t))
    (diagnosis,) = diagnose(DiagnosisConfig(), seen_in_steps(x, force)).diagnoses
    assert {"viscous_friction", "coulomb_friction"} <= {p.name for p in diagnosis.physics}
    found = parameters(diagnosis)
    assert found["viscous_friction.relaxation"].value == pytest.approx(0.1, rel=0.25)
    assert found["coulomb_friction.force"].value == pytest.approx(10.0, rel=0.15)
    assert diagnosis.after.heldout_rmse < 0.6


def test_at_one_speed_a_bristle_and_a_damper_behind_a_spring_are_each_others_alternative():
    rng = np.random.default_rng(3)
    t = np.arange(2000) / RATE
    x = 0.02 * np.arcsin(np.sin(np.pi * t)) * 2.0 / np.pi
    force = relaxed(x, 1500.0, 0.2) + rng.normal(0.0, 0.3, len(t))
    (diagnosis,) = diagnose(DiagnosisConfig(), seen_in_steps(x, force)).diagnoses
    (only,) = diagnosis.physics
    either = {"coulomb_friction", "viscous_friction"}
    assert {only.name, *only.alternatives} == either | {"creep", "response_lag"}
    assert diagnosis.verdict == "ambiguous"


def lugre(x, force, more, speed, reach):
    """LuGre's bristle, stepped finely: z' = v - |v| z / (reach (1 + more exp(-(v/speed)^2)))."""
    out, z, v = np.zeros(len(x)), 0.0, np.gradient(x) * RATE
    for k in range(1, len(x)):
        for part in (np.arange(40) + 0.5) / 40:
            now = v[k - 1] + part * (v[k] - v[k - 1])
            limit = 1.0 + more * np.exp(-((now / speed) ** 2))
            z += (now - abs(now) * z / limit / reach) / RATE / 40
        out[k] = force / reach * z
    return out


@pytest.mark.long
def test_a_contact_that_learns_late_of_its_speed_is_named_whole_and_no_mass_beside_it():
    t, x, rng = motion(5)
    fine = CubicSpline(t, x)
    v = fine(t, 1)
    force = lugre(x, 30.0, 0.4, 0.005, 3e-4) + 120.0 * v + rng.normal(0.0, 0.3, len(t))
    (diagnosis,) = diagnose(DiagnosisConfig(), seen_in_steps(x, force)).diagnoses
    assert {p.name for p in diagnosis.physics} == {
        "coulomb_friction", "viscous_friction", "stribeck_friction"
    }  # fmt: skip
    found = parameters(diagnosis)
    assert found["coulomb_friction.force"].value == pytest.approx(30.0, rel=0.03)
    assert found["viscous_friction.damping"].value == pytest.approx(120.0, rel=0.05)
    assert found["stribeck_friction.force"].value == pytest.approx(12.0, rel=0.15)
    assert found["stribeck_friction.speed"].value == pytest.approx(0.005, rel=0.15)
    assert diagnosis.after.heldout_rmse < 0.36


@pytest.mark.parametrize("asymmetry", [0.0, 0.5])
@pytest.mark.long
def test_both_directions_are_told_where_the_zero_is_trusted(asymmetry):
    t, x, rng = motion(2)
    v = np.gradient(x, t)
    force = dahl(t, x, 30.0, 4e-4) + 80.0 * v * (1.0 - asymmetry * np.sign(v))
    force[rng.random(len(t)) < 0.1] = np.nan
    trusted = DiagnosisConfig(tolerance=ToleranceConfig(offset=0.01))
    measured = force + rng.normal(0.0, 0.5, len(t))
    (diagnosis,) = diagnose(trusted, seen_in_steps(x, measured)).diagnoses
    found = parameters(diagnosis)
    for way, sign in (("rising", 1.0), ("falling", -1.0)):
        damping = found[f"viscous_friction.damping {way}"]
        assert damping.low < 80.0 * (1.0 - sign * asymmetry) < damping.high < damping.low + 20.0
        dry = found[f"coulomb_friction.force {way}"]
        assert dry.value == pytest.approx(30.0, abs=0.3)
        assert dry.low < dry.high < dry.low + 3.0
    alike = [p.name for p in diagnosis.physics if "explains nothing more" in p.says]
    assert ("viscous_friction" in alike) == (asymmetry == 0.0)
    assert abs(diagnosis.calibration.offset) < 0.1


def test_too_much_friction_in_a_simulation_is_said_as_such():
    t, x, rng = motion(5)
    v = np.gradient(x, t)
    given = recording(x, dahl(t, x, 30.0, 4e-4) + rng.normal(0.0, 0.5, len(t)))
    simulated = given.with_channel(
        Channel("force_sim_n", "simulation", "N", of="force_n"), dahl(t, x, 30.0, 4e-4) + 60.0 * v
    )
    (diagnosis,) = diagnose(DiagnosisConfig(), simulated).diagnoses
    (found,) = [p for p in diagnosis.physics if p.name == "viscous_friction"]
    assert found.parameters[0].value == pytest.approx(-60.0, abs=3.0)
    assert "The simulation has that much too much of it." in found.says


@pytest.mark.long
def test_errors_of_a_force_count_the_rows_at_its_reversals():
    t, x, rng = motion(6)
    hard = 30.0 * np.tanh(np.gradient(x, t) / 5e-4) + rng.normal(0.0, 0.05, len(t))
    (evidence,) = diagnose(DiagnosisConfig(), seen_in_steps(x, hard)).evidence
    drive = evidence.motion.drive
    turns = 1 + np.flatnonzero(np.diff(np.sign(np.diff(drive))) != 0)
    assert np.all(evidence.used[turns])


def test_its_model_predicts_a_motion_that_it_has_not_seen(damper):
    model = damper.models[0]
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    x = 0.012 * np.sin(2 * np.pi * 0.7 * t) + 0.004 * np.sin(2 * np.pi * 1.9 * t)
    v = np.gradient(x, t)
    force = dahl(t, x, 30.0, 4e-4, 0.2) + 80.0 * v * (1.0 - 0.15 * np.sign(v))
    said = predict([model], recording(x, np.full(len(t), np.nan)))
    off = said["force_n_predicted"].to_numpy() - force
    # Dahl's small loops do not close, those of a bank of sliders do: 3 % of the force.
    assert np.sqrt(np.mean(off[20:] ** 2)) < 0.04 * np.sqrt(np.mean(force**2))
    assert np.all(said["force_n_std"] > 0.3)


def test_a_force_that_stands_with_its_motion_has_no_delay(damper):
    assert damper.diagnoses[0].calibration.delay_s == 0.0
    assert damper.models[0].delay_s == 0.0


@pytest.mark.parametrize("samples", [0.5, -0.5])
@pytest.mark.long
def test_a_force_recorded_beside_its_motion_is_moved_there(samples):
    """The damper again, its force recorded half a sample after or before its motion."""
    t, x, rng = motion()
    delay_s = samples / RATE
    path = CubicSpline(t, x)
    then, v = path(t - delay_s), path.derivative()(t - delay_s)
    force = dahl(t, then, 30.0, 4e-4, 0.2) + 80.0 * v * (1.0 - 0.15 * np.sign(v))
    found = diagnose(DiagnosisConfig(), seen_in_steps(x, force + rng.normal(0.0, 0.5, len(t))))
    diagnosis = found.diagnoses[0]
    assert diagnosis.verdict == "explained"
    assert diagnosis.calibration.delay_s == pytest.approx(delay_s, abs=0.1 / RATE)
    assert parameters(diagnosis)["coulomb_friction.asymmetry"].value == pytest.approx(0.2, abs=0.02)
    assert diagnosis.after.heldout_rmse < 0.65
    assert any("recorded 2." in note for note in diagnosis.notes)
    stored = json.loads(json.dumps(as_json(found.models[0])))
    said = predict([from_json(stored, [])], recording(x, np.full(len(t), np.nan)))
    off = said["force_n_predicted"].to_numpy() - force
    assert np.sqrt(np.mean(off[20:] ** 2)) < 0.5


def test_its_notes_say_how_it_was_differentiated_and_that_nothing_was_simulated(damper):
    notes = " ".join(damper.diagnoses[0].notes)
    assert "central differences of the position" in notes
    assert "Nothing simulates the force" in notes


def test_the_top_speed_of_what_hardly_ever_moves_is_that_of_its_leaps():
    leaps = np.where(np.arange(3000) % 1000 == 500, -7.0, 1e-290)
    assert top_of(leaps) == 7.0
    assert top_of(np.linspace(0.0, 1.0, 101)) == pytest.approx(0.99)


def test_a_force_that_is_noise_alone_names_nothing():
    t, x, rng = motion(3)
    plain = recording(x, rng.normal(0.0, 0.3, len(t)))
    diagnosis = diagnose(DiagnosisConfig(), simulate(SimulationConfig("mechanism"), plain))
    assert diagnosis.diagnoses[0].verdict == "no_mismatch"
    assert diagnosis.diagnoses[0].physics == ()


def test_a_rounded_loop_of_another_form_is_dry_friction_and_the_rest_is_said():
    """A Bouc-Wen damper [mm, kN]: no bank of sliders and no slip at a constant force."""
    t, x, rng = motion(5)
    x = 1000.0 * x
    z, zs = 0.0, np.zeros(len(x))
    for k in range(1, len(x)):
        for _ in range(20):
            dx = (x[k] - x[k - 1]) / 20
            z += dx * (0.8 - abs(z) ** 1.5 * (0.4 * np.sign(dx * z) + 0.4))
        zs[k] = z
    force = 25.0 * zs / np.abs(zs).max() + rng.normal(0.0, 0.4, len(t))
    plain = simulate(SimulationConfig("mechanism"), recording(x, force, "kN", "mm"))
    diagnosis = diagnose(DiagnosisConfig(), plain).diagnoses[0]
    assert [p.name for p in diagnosis.physics] == ["coulomb_friction"]
    force_found = parameters(diagnosis)["coulomb_friction.force"]
    assert force_found.value == pytest.approx(25.0, rel=0.1)
    assert force_found.unit == "kN"
    assert diagnosis.after.heldout_rmse < 0.08 * diagnosis.before.heldout_rmse


@pytest.mark.long
def test_a_spring_that_hardens_is_named_beside_one_that_is_simulated():
    t, x, rng = motion()
    force = 8e3 * x * (1.0 + (x / 0.012) ** 2) + dahl(t, x, 30.0, 2e-3)
    table = recording(x, force + rng.normal(0.0, 0.5, len(t)))
    spring = Channel("force_sim_n", "simulation", "N", of="force_n")
    channels = (*table.channels, spring)
    samples = table.samples.assign(force_sim_n=8e3 * x)
    result = diagnose(DiagnosisConfig(), Recording(samples, channels, "simulated")).diagnoses[0]
    assert {p.name for p in result.physics} == {"coulomb_friction", "stiffness"}
    assert result.after.heldout_rmse < 1.0 < result.before.heldout_rmse


def test_a_loop_pinched_in_the_middle_leaves_a_rest_that_is_said():
    """One amplitude, little noise: a flexible law leaves more than that, and as slow as physics."""
    t = np.arange(2000) / RATE
    x = 0.02 * np.sin(2.0 * np.pi * 0.8 * t)
    pinched = dahl(t, x, 30.0, 2e-3) * (1.0 - 0.7 * np.exp(-((x / 0.004) ** 2)))
    force = pinched * (1.0 - 0.4 * t / t[-1]) + np.random.default_rng(6).normal(0.0, 0.3, len(t))
    plain = simulate(SimulationConfig("mechanism"), recording(x, force))
    diagnosis = diagnose(DiagnosisConfig(), plain).diagnoses[0]
    assert diagnosis.verdict == "partly_explained"
    assert "coulomb_friction" in [p.name for p in diagnosis.physics]


def test_play_before_the_damper_is_said_as_a_rest_and_leaves_no_deviation_without_end():
    t, x, rng = motion()
    end, force = np.zeros(len(x)), np.zeros(len(x))
    for k in range(1, len(x)):
        end[k] = np.clip(end[k - 1], x[k] - 1e-3, x[k] + 1e-3)
        force[k] = np.clip(force[k - 1] + 4e4 * (end[k] - end[k - 1]), -30.0, 30.0)
    result = diagnose(DiagnosisConfig(), seen_in_steps(x, force + rng.normal(0.0, 0.5, len(t))))
    diagnosis = result.diagnoses[0]
    assert diagnosis.verdict == "partly_explained"
    assert "coulomb_friction" in [p.name for p in diagnosis.physics]
    assert np.all(result.evidence[0].deviation < 60.0)


def test_a_velocity_command_is_integrated():
    t, x, rng = motion()
    v = CubicSpline(t, x)(t, 1)
    force = dahl(t, x, 30.0, 4e-4) + rng.normal(0.0, 0.5, len(t))
    channels = (
        Channel("velocity_mm_s", "command", "mm/s"),
        Channel("force_n", "measurement", "N"),
    )
    table = pd.DataFrame({"time_s": t, "velocity_mm_s": 1e3 * v, "force_n": force})
    plain = Recording(with_context(table, channels), channels, "simulated")
    result = diagnose(DiagnosisConfig(), simulate(SimulationConfig("mechanism"), plain))
    assert [p.name for p in result.diagnoses[0].physics] == ["coulomb_friction"]
    found = parameters(result.diagnoses[0])
    assert found["coulomb_friction.force"].value == pytest.approx(30.0, abs=0.3)
    reach = found["coulomb_friction.reach"]
    assert (reach.unit, reach.value) == ("mm", pytest.approx(0.4, abs=0.04))
    said = predict(result.models, plain)["force_n_predicted"].to_numpy()
    assert np.sqrt(np.mean((said - force)[20:-20] ** 2)) < 0.6


@pytest.mark.parametrize(
    ("force", "position", "is_one"),
    [("N", "m", True), ("kN", "mm", True), ("Nm", "rad", True), ("A", "deg", True),
     ("V", "m", True), ("N", "m/s", True), ("A", "rpm", True),
     ("N", "N", False), ("deg", "deg", False), ("m", "N", False)],
)  # fmt: skip
def test_a_force_against_motion_is_known_by_its_units(force, position, is_one):
    plain = recording(np.arange(9.0), np.arange(9.0), force, position)
    name = plain.with_role("measurement")[0].name
    assert (position_of(plain, name) is not None) == is_one


def test_a_simulated_mass_is_asked_for_again_when_predicting(damper):
    t, x, _ = motion()
    bare = recording(x, np.full(len(t), np.nan))
    model = replace(damper.models[0], simulated=True)
    config = Config()
    config.simulation = SimulationConfig("mechanism")
    with pytest.raises(UsageError, match="the one that the diagnosis had"):
        with_simulations(config, bare, [model])


def test_a_spring_and_dashpot_that_were_already_moving_are_one_damper():
    t, x, rng = motion(9)
    force = relaxed(x, 1500.0, 0.5)[800:] + rng.normal(0.0, 0.3, len(t) - 800)
    (found,) = diagnose(DiagnosisConfig(), seen_in_steps(x[800:], force)).diagnoses
    assert [p.name for p in found.physics] == ["viscous_friction"]
    assert {"creep", "response_lag"} <= set(found.physics[0].alternatives)
    told = parameters(found)
    assert told["viscous_friction.relaxation"].value == pytest.approx(0.5, rel=0.1)
    assert found.after.heldout_rmse < 0.33


@pytest.mark.parametrize("hidden", [False, True])
def test_a_hum_in_a_force_is_no_noise(hidden):
    t, x, rng = motion(6)
    simulated = 900.0 * x
    noise = rng.normal(0.0, 0.5, len(t))
    seen = simulated + noise + (0.8 * np.sin(2.0 * np.pi * 19.7 * t) if hidden else 0.0)
    channel = Channel("force_sim_n", "simulation", "N", of="force_n")
    recorded = recording(x, seen).with_channel(channel, simulated)
    (found,) = diagnose(DiagnosisConfig(), recorded).diagnoses
    assert found.verdict == ("unknown_physics" if hidden else "no_mismatch")
    assert not found.physics
    if hidden:
        assert "a hum in time, again and again every 0.0508" in found.unexplained.where


def test_a_slow_hum_that_is_most_of_a_rest_is_no_noise_that_lasts():
    t, x, rng = motion(6)
    simulated = 900.0 * x
    turn = 2.0 * np.pi * 1.7 * t
    seen = simulated + 1.6 * np.sin(turn + 1.0) ** 3 + rng.normal(0.0, 0.5, len(t))
    channel = Channel("force_sim_n", "simulation", "N", of="force_n")
    recorded = recording(x, seen).with_channel(channel, simulated)
    (found,) = diagnose(DiagnosisConfig(), recorded).diagnoses
    assert (found.verdict, found.physics) == ("unknown_physics", ())
    assert "a hum in time, again and again every 0.58" in found.unexplained.where


@pytest.mark.parametrize("seed", [1, 3, 4])
def test_noise_that_lasts_is_no_mismatch_of_a_short_recording(seed):
    rng = np.random.default_rng(seed)
    t = np.arange(640) / RATE
    x = 0.005 * (1.0 + t) * np.sin(2.0 * np.pi * 1.25 * t)
    noise = np.zeros(len(t))
    for k in range(1, len(t)):
        noise[k] = 0.8 * noise[k - 1] + rng.normal(0.0, 0.6)
    simulated = 900.0 * x
    channel = Channel("force_sim_n", "simulation", "N", of="force_n")
    seen = recording(x, simulated + noise).with_channel(channel, simulated)
    (found,) = diagnose(DiagnosisConfig(), seen).diagnoses
    assert found.verdict == "no_mismatch"
