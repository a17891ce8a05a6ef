"""What a simulated force lacks: a spring with slack or play, and what comes late."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pipeline.config import DiagnosisConfig
from pipeline.recording import Channel
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.test_force import RATE, motion, parameters, recording

NOISE, SPRING = 0.3, 3000.0


def beside(x, force, simulated, seed=5):
    """The diagnosis of a force with noise beside what is simulated of it."""
    noise = np.random.default_rng(seed).normal(0.0, NOISE, len(x))
    channel = Channel("force_sim_n", "simulation", "N", of="force_n")
    seen = recording(x, force + noise).with_channel(channel, simulated)
    return diagnose(DiagnosisConfig(), seen).diagnoses[0]


def told(diagnosis, name, tolerance, **sizes):
    assert {p.name for p in diagnosis.physics} == {name}
    for parameter, value in sizes.items():
        found = parameters(diagnosis)[f"{name}.{parameter}"].value
        assert found == pytest.approx(value, rel=tolerance), parameter
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE


def test_a_spring_that_does_not_pull_about_home_has_slack():
    _, x, _ = motion(2)
    pulled = x - np.clip(x, -0.002, 0.002)
    found = beside(x, SPRING * pulled, SPRING * x)
    told(found, "slack", 0.05, stiffness=SPRING, width=0.004)


def test_a_spring_that_hangs_in_a_gap_has_play():
    _, x, _ = motion(2)
    at, pulled = x[0], np.empty(len(x))
    for k, here in enumerate(x):
        at = min(max(at, here - 0.0015), here + 0.0015)
        pulled[k] = at
    found = beside(x, SPRING * pulled, SPRING * x)
    told(found, "backlash", 0.05, stiffness=SPRING, width=0.003)


def slid(x, gap, sticks, friction=25.0, reach=4e-4):
    """The force of a slider that a pin pushes through a gap [m], stepped finely.

    sticks: whether it stays in the gap; else it springs back there until nothing bends it.
    """
    out, bent, at = np.empty(len(x)), 0.0, x[0]
    before = x[0]
    for k, here in enumerate(x):
        for pin in before + (here - before) * np.arange(1, 21) / 20:
            still = at if sticks else at - bent * reach
            new = min(max(still, pin), pin + gap)
            bent, at = np.clip(bent + (new - at) / reach, -1.0, 1.0), new
        out[k], before = friction * bent, here
    return out


@pytest.mark.parametrize(("sticks", "form"), [(True, "stays"), (False, "does not resist")])
@pytest.mark.long
def test_friction_that_a_pin_pushes_through_a_gap_has_play(sticks: bool, form: str):
    _, x, _ = motion(2)
    found = beside(x, slid(x, 0.0016, sticks), slid(x, 0.0, True))
    told(found, "backlash", 0.03, width=0.0016)
    assert form in found.physics[0].says


def test_a_piston_in_oil_whose_rod_has_play_stands_still_in_it():
    t, x, _ = motion(2)
    fine_s = np.linspace(t[0], t[-1], 50 * (len(t) - 1) + 1)
    rod = np.interp(fine_s, t, x)
    at, piston = rod[0], np.empty(len(rod))
    for k, here in enumerate(rod):
        at = min(max(at, here - 0.001), here + 0.001)
        piston[k] = at
    v = np.gradient(rod, fine_s), np.gradient(piston, fine_s)
    oil = [200.0 * np.interp(t, fine_s, w) for w in v]
    found = beside(x, oil[1] + SPRING * x, oil[0] + SPRING * x)
    assert {p.name for p in found.physics} == {"backlash"}
    assert parameters(found)["backlash.width"].value == pytest.approx(0.002, rel=0.1)
    assert "stands still" in found.physics[0].says


@pytest.mark.long
def test_friction_and_a_spring_that_no_gap_parts_from_the_pin_are_one_name():
    _, x, _ = motion(2)
    spring = 1200.0 * x
    found = beside(x, slid(x, 0.0016, False) + spring, slid(x, 0.0, True) + spring)
    told(found, "backlash", 0.03, width=0.0016, stiffness=1200.0)


@pytest.mark.long
def test_a_force_that_is_many_samples_old_is_told_by_its_age():
    t, x, _ = motion(2)
    rigid = 25.0 * np.sign(np.gradient(x, t)) + SPRING * x
    found = beside(x, np.interp(t - 0.03, t, rigid), rigid)
    told(found, "frame_lag", 0.05, lag=0.03)


@pytest.mark.long
def test_a_force_that_swings_after_rigid_friction_is_one_lag():
    t, x, _ = motion(2)
    rigid = 25.0 * np.sign(np.gradient(x, t))
    w, damping = 60.0, 0.5

    def swing(at, state):
        asked = np.interp(at, t, rigid)
        return [state[1], w * w * (asked - state[0]) - 2.0 * damping * w * state[1]]

    swung = solve_ivp(swing, (t[0], t[-1]), [rigid[0], 0.0], t_eval=t, max_step=0.5 / RATE).y[0]
    found = beside(x, swung, rigid)
    told(found, "response_lag", 0.05, natural_frequency=w, damping=damping)


def test_behind_a_command_of_its_own_unit_a_force_is_moved_as_an_angle_is():
    rng = np.random.default_rng(3)
    pull = 40.0 * np.sin(2.0 * np.pi * np.arange(1200) / 150.0) + 60.0
    at, felt = pull[0], np.empty(len(pull))
    for k, here in enumerate(pull):
        at = min(max(at, here - 4.0), here + 4.0)
        felt[k] = at
    seen = recording(pull, felt + rng.normal(0.0, 0.4, len(pull)), "N", "N")
    seen = seen.with_channel(Channel("bend_deg", "command", "deg"), np.sin(np.arange(1200) / 9.0))
    seen = seen.with_channel(Channel("sim", "simulation", "N", of="force_n"), pull)
    found = diagnose(DiagnosisConfig(), seen).diagnoses[0]
    assert {p.name for p in found.physics} == {"backlash"}
    assert parameters(found)["backlash.width"].value == pytest.approx(8.0, rel=0.05)


@pytest.mark.long
def test_a_damper_behind_a_spring_beside_simulated_friction_is_one_damper():
    t, x, _ = motion(2)
    v = np.gradient(x, t)
    rigid, drag, at = 20.0 * np.sign(v), np.empty(len(x)), 0.0
    for k, speed in enumerate(v):
        at += (speed - at) * (1.0 - np.exp(-1.0 / RATE / 0.2))
        drag[k] = 150.0 * at
    weaker = -8.0 * np.tanh(v / 0.03) - 2e3 * np.minimum(x + 0.01, 0.0)
    found = beside(x, rigid + drag + weaker, rigid)
    (damper,) = [p for p in found.physics if "creep" in (p.name, *p.alternatives)]
    assert damper.name == "viscous_friction"
    assert "response_lag" not in {p.name for p in found.physics}
    assert parameters(found)["viscous_friction.relaxation"].value == pytest.approx(0.2, rel=0.1)
