"""Forces of another form than a plain damper's: each is named, and told as it is."""

import numpy as np
import pytest

from pipeline.config import DiagnosisConfig, SimulationConfig
from pipeline.discrepancy.judgement.structure import CHANGES
from pipeline.recording import Channel, Recording
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


def test_a_valve_makes_a_damper_go_by_a_power_of_the_speed():
    t, x, rng = motion(11)
    v = np.gradient(x, t)
    found = diagnosed(x, 60.0 * np.sign(v) * np.abs(v) ** 0.5, rng)
    assert_told(found, {"viscous_friction"}, {"viscous_friction.exponent": 0.5})
    (said,) = [p.says for p in found.physics]
    assert "to the power of 0.5" in said


def test_friction_may_fall_with_the_speed_as_tustin_says():
    t, x, rng = motion(12)
    v = np.gradient(x, t)
    force = np.tanh(v / 2e-3) * (15.0 + 25.0 * np.exp(-np.abs(v) / 0.05))
    found = diagnosed(x, force, rng)
    sizes = {"stribeck_friction.force": 25.0, "stribeck_friction.speed": 0.05}
    assert_told(found, {"coulomb_friction", "stribeck_friction"}, sizes)


def sliders(x, reaches):
    """The share of the friction of equal sliders on springs, each free at first (n,)."""
    held, at, out = np.zeros(len(reaches)), x[0], np.empty(len(x))
    for k, now in enumerate(x):
        held = np.clip(held + (now - at) / reaches, -1.0, 1.0)
        at, out[k] = now, held.mean()
    return out


def test_sliders_whose_reaches_lie_evenly_are_one_friction():
    """As in Iwan's first model: a Stribeck effect or play would mop up what wider tails miss."""
    _, x, rng = motion(11)
    found = diagnosed(x, 12.0 * sliders(x, np.linspace(5e-4, 6e-3, 40)), rng)
    sizes = {"coulomb_friction.force": 12.0, "coulomb_friction.reach": 3.25e-3}
    assert_told(found, {"coulomb_friction"}, sizes)


@pytest.mark.parametrize(("reach", "others"), [(2e-3, ("friction",)), (1e-4, ())])
@pytest.mark.long
def test_dry_friction_that_is_seen_to_turn_gradually_has_the_name_of_a_displacements_too(
    reach: float, others: tuple[str, ...]
):
    t, x, rng = motion(11)
    found = diagnosed(x, dahl(t, x, 12.0, reach), rng)
    assert [(p.name, p.alternatives) for p in found.physics] == [("coulomb_friction", others)]
    assert found.verdict == "explained"


def test_magnets_may_pull_with_a_second_wave():
    t, x, rng = motion(13)
    turned = 2.0 * np.pi * x / 0.004
    force = 9.0 * np.sin(turned + 0.6) + 4.0 * np.sin(2.0 * turned) + 80.0 * np.gradient(x, t)
    sizes = {"transmission_ripple.amplitude": 9.0, "transmission_ripple.second": 4.0}
    assert_told(diagnosed(x, force, rng), {"transmission_ripple", "viscous_friction"}, sizes)


def test_magnets_may_come_again_less_than_three_times():
    t, x, rng = motion(13)
    force = 9.0 * np.sin(2.0 * np.pi * x / 0.016 + 0.6) + 80.0 * np.gradient(x, t)
    sizes = {"transmission_ripple.amplitude": 9.0, "transmission_ripple.period": 0.016}
    assert_told(diagnosed(x, force, rng), {"transmission_ripple", "viscous_friction"}, sizes)


@pytest.mark.long
def test_one_spring_that_differs_for_its_sides_is_no_two_buffers():
    t, x, rng = motion(15)
    force = 1500.0 * np.maximum(x, 0.0) + 4000.0 * np.minimum(x, 0.0) + dahl(t, x, 6.0, 4e-4)
    found = diagnosed(x, force, rng)
    assert_told(found, {"stiffness", "coulomb_friction"}, {"coulomb_friction.force": 6.0})


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.long
def test_a_gas_that_is_pressed_harder_and_harder_is_no_buffer(way: float):
    """Boyle's law with the exponent of quick changes in air: another one than the term has."""
    t, x, rng = motion(15)
    room, area_force = 0.045, 60.0
    pressed = area_force * way * ((room / (room - way * x)) ** 1.4 - 1.0)
    found = diagnosed(x, pressed + dahl(t, x, 6.0, 4e-4), rng)
    sizes = {"coulomb_friction.force": 6.0, "stiffness.stiffness": 1.4 * area_force / room}
    assert_told(found, {"stiffness", "coulomb_friction"}, sizes)
    assert ("rises" if way > 0.0 else "falls") in next(
        p.says for p in found.physics if p.name == "stiffness"
    )


def test_a_zero_that_differs_a_little_from_cycle_to_cycle_is_no_drift_of_a_force():
    t, x, rng = motion(15)
    zero = 0.25 * NOISE * np.sin(2.0 * np.pi * t / t[-1])
    found = diagnosed(x, 80.0 * np.gradient(x, t) + zero, rng)
    assert {p.name for p in found.physics} == {"viscous_friction"}
    assert found.verdict == "explained"


def test_a_force_whose_zero_warms_up_is_foretold():
    t, x, rng = motion(14)
    force = 800.0 * x - 6.0 * np.expm1(-t / (0.3 * t[-1]))
    found = diagnosed(x, force, rng)
    assert_told(found, {"stiffness", "drift"}, {"stiffness.stiffness": 800.0})


@pytest.mark.long
def test_a_buffer_is_met_at_its_position():
    t, x, rng = motion(12)
    force = 800.0 * x + 9000.0 * np.maximum(x - 0.012, 0.0) + dahl(t, x, 6.0, 4e-4)
    found = diagnosed(x, force, rng)
    sizes = {"contact.stiffness": 9000.0, "contact.position": 0.012, "stiffness.stiffness": 800.0}
    assert_told(found, {"stiffness", "contact", "coulomb_friction"}, sizes)


@pytest.mark.long
def test_magnets_pull_again_and_again_and_a_weight_once_a_turn():
    t, x, rng = motion(13)
    angle = 150.0 * x
    torque = 8.0 * np.sin(angle + 0.4) + 1.5 * np.sin(14.0 * angle) + dahl(t, angle, 6.0, 0.05)
    found = diagnosed(angle, torque, rng, 1e-4, ("Nm", "rad"))
    names = {"gravity", "transmission_ripple", "coulomb_friction"}
    sizes = {"gravity.moment": 8.0, "transmission_ripple.period": 2.0 * np.pi / 14.0}
    assert_told(found, names, sizes)


@pytest.mark.long
def test_a_filter_of_the_force_is_no_spring_behind_a_damper():
    t, x, rng = motion(14)
    force = dahl(t, x, 30.0, 4e-4) + 80.0 * np.gradient(x, t)
    late = np.zeros(len(t))
    for k in range(1, len(t)):
        late[k] = late[k - 1] + (force[k] - late[k - 1]) * -np.expm1(-1.0 / RATE / 0.03)
    found = diagnosed(x, late, rng)
    sizes = {"viscous_friction.damping": 80.0, "coulomb_friction.force": 30.0}
    assert_told(found, {"viscous_friction", "coulomb_friction", "response_lag"}, sizes)


@pytest.mark.long
def test_what_wanders_slowly_hides_no_friction():
    t, x, rng = motion(15)
    force = dahl(t, x, 10.0, 4e-4) + 40.0 * np.gradient(x, t) + 5.0 * np.sin(0.35 * t)
    found = diagnosed(x, force, rng)
    sizes = {"viscous_friction.damping": 40.0, "coulomb_friction.force": 10.0}
    assert_told(found, {"viscous_friction", "coulomb_friction", "drift"}, sizes)


@pytest.mark.long
def test_friction_that_gives_before_it_slides_is_one_name():
    """A magnetorheological damper: a spring before a slider that resists by its speed."""
    t, x, rng = motion(31)
    v, share, force = np.gradient(x, t), 0.0, np.zeros(len(x))
    for k in range(len(x)):
        for _ in range(40):
            held = np.arctanh(np.clip(share, -1 + 1e-12, 1 - 1e-12))
            share += (v[k] - 0.02 * held) / 1e-3 / (40 * RATE)
        force[k] = 40.0 * share
    found = diagnosed(x, force, rng)
    sizes = {"coulomb_friction.force": 40.0, "coulomb_friction.onset": 0.02}
    assert_told(found, {"coulomb_friction"}, sizes)
    (said,) = [p.says for p in found.physics]
    assert "before it slides" in said


def test_friction_behind_a_dashpot_is_one_name():
    """Spencer's magnetorheological damper: slow motion is the dashpot's, up to a sharp knee."""
    t, x, rng = motion(33)
    v, share, force = np.gradient(x, t), 0.0, np.zeros(len(x))
    for k in range(len(x)):
        for _ in range(40):
            bend = v[k] - 0.05 * share
            share += bend * (1.0 - share**2 if bend * share > 0.0 else 1.0) / 2e-4 / (40 * RATE)
        force[k] = 40.0 * share
    found = diagnosed(x, force, rng)
    sizes = {"coulomb_friction.force": 40.0, "coulomb_friction.onset": 0.05}
    assert_told(found, {"coulomb_friction"}, sizes)


def test_friction_that_a_wedge_presses_is_one_name():
    t, x, rng = motion(32)
    force = (20.0 + 600.0 * np.abs(x)) * dahl(t, x, 1.0, 1e-3) + 400.0 * x
    found = diagnosed(x, force, rng)
    sizes = {"coulomb_friction.force": 20.0, "coulomb_friction.growth": 600.0}
    assert_told(found, {"coulomb_friction", "stiffness"}, sizes)


def test_friction_that_lets_go_by_its_own_exponent_is_one_name():
    _, x, rng = motion(33)
    share, force = 0.0, np.zeros(len(x))
    for k in range(1, len(x)):
        for _ in range(40):
            dx = (x[k] - x[k - 1]) / 40
            share += dx / 1e-3 * (1.0 - np.sign(dx) * share) ** 2
        force[k] = 40.0 * share
    found = diagnosed(x, force, rng)
    assert_told(found, {"coulomb_friction"}, {"coulomb_friction.force": 40.0})
    assert parameters(found)["coulomb_friction.curve"].value == pytest.approx(0.5, rel=0.1)


@pytest.mark.long
def test_what_a_force_leaves_again_and_again_is_no_noise():
    """A law of no term's form: tanh of the speed and of the side of zero together."""
    _, x, rng = motion(34)
    x = np.tile(x, 3)
    t = np.arange(len(x)) / RATE
    v = np.gradient(x, t)
    found = diagnosed(x, 60.0 * np.tanh(v / 0.03 + 0.7 * np.tanh(1000.0 * x)), rng)
    assert found.verdict == "partly_explained"
    assert found.noise < 0.6 * found.after.train_rmse
    plain = diagnosed(x, dahl(t, x, 20.0, 4e-4) + 60.0 * v, rng)
    assert plain.verdict == "explained"
    assert plain.noise == pytest.approx(NOISE, rel=0.1)


def beside_a_simulated_damper(damping, seed):
    """The diagnosis of a spring with dry friction, of which a damper is all that was simulated."""
    t, x, rng = motion(seed)
    seen = recording(x, dahl(t, x, 20.0, 4e-4) + 300.0 * x + rng.normal(0.0, NOISE, len(x)))
    channels = (*seen.channels, Channel("force_sim_n", "simulation", "N", of="force_n"))
    table = seen.samples.assign(force_sim_n=damping * np.gradient(x, t))
    return diagnose(DiagnosisConfig(), Recording(table, channels, "simulated")).diagnoses[0]


@pytest.mark.long
def test_a_damper_that_the_simulation_has_too_much_of_is_no_gain():
    found = beside_a_simulated_damper(40.0, 35)
    assert {p.name for p in found.physics} == {"coulomb_friction", "stiffness", "viscous_friction"}
    damping = parameters(found)["viscous_friction.damping"]
    assert damping.value == pytest.approx(-40.0, rel=0.1)
    assert found.calibration.gain == pytest.approx(1.0, abs=0.1)


@pytest.mark.long
def test_forms_that_other_terms_have_made_needless_are_plainer_again():
    """What was fitted beside a gain that took the damper's place grew forms for what that left."""
    found = beside_a_simulated_damper(15.0, 36)
    told = {p.name: {e.name for e in p.parameters} for p in found.physics}
    assert {"coulomb_friction", "stiffness", "viscous_friction"} <= set(told)
    assert not told["viscous_friction"] & {"square", "relaxation"}
    assert not told["coulomb_friction"] & {"growth", "onset"}
    assert parameters(found)["viscous_friction.damping"].value == pytest.approx(-15.0, rel=0.15)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.long
def test_a_bump_stop_pushes_less_while_it_is_let_go(side):
    """Hunt and Crossley's law, with the spring of a bumper that gets stiffer."""
    t, x, rng = motion(14)
    v = np.gradient(x, t)
    edge = side * 0.4 * np.max(side * x)
    depth = np.maximum(side * (x - edge), 0.0)
    deep, fast = float(depth.max()), float(np.abs(v).max())
    pushed = 40.0 * (depth / deep) ** 1.5 * np.maximum(1.0 + 0.4 * side * v / fast, 0.0)
    found = diagnosed(x, side * pushed, rng)
    assert_told(found, {"contact"}, {"contact.position": edge, "contact.loss": 0.4 / fast})


@pytest.mark.parametrize("fades", [0.0, 0.5])
@pytest.mark.long
def test_a_damper_that_fades_as_it_warms_up_is_no_constant_one(fades: float):
    """Its oil gets thinner: no name of the catalogue, and no noise either."""
    rates = np.tile([0.5, 1.0, 2.0], 4)
    x = np.concatenate([0.02 * np.sin(2 * np.pi * f * np.arange(int(RATE / f)) / RATE)
                        for f in rates])  # fmt: skip
    t, rng = np.arange(len(x)) / RATE, np.random.default_rng(11)
    v = np.gradient(x, t)
    warm = 1.0 - fades * -np.expm1(-t / (0.3 * t[-1]))
    found = diagnosed(x, 60.0 * v * warm + dahl(t, x, 6.0, 4e-4), rng)
    told = found.verdict, found.unexplained.where == CHANGES
    assert told == (("partly_explained", True) if fades else ("explained", False))


def test_a_spring_may_be_softer_on_one_side_and_harden_on_both():
    t, x, rng = motion(11)
    far = float(np.max(np.abs(x)))
    spring = 800.0 * (x * (1.0 - 0.3 * np.sign(x)) + 1.5 * x**3 / far**2)
    found = diagnosed(x, spring + dahl(t, x, 6.0, 4e-4), rng)
    sizes = {"stiffness.stiffness": 800.0, "stiffness.hardening": 1.5 / far**2}
    assert_told(found, {"stiffness", "coulomb_friction"}, sizes)
