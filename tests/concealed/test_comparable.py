"""The quantities of the truth are what the plant really does."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.concealed.cases import clean_deg
from pipeline.concealed.comparable import comparable
from pipeline.concealed.draw import Case, Hidden, draw_case
from pipeline.concealed.effects import Effect, Settings
from pipeline.concealed.motions import RECORDED_CYCLES
from pipeline.concealed.noise import Noise
from pipeline.concealed.plant import WIRE_STIFFNESS, Nominal


def case_of(
    name: str, settings: Settings, scaled: tuple[str, ...], size: float, excitation: str = "plain"
) -> Case:
    bare = draw_case(3, "case-000", "none", excitation, None)
    hidden = Hidden(Effect(name, settings, scaled, 100.0), size, 5.0, 5.0)
    return replace(
        bare, hidden=(hidden,), noise=Noise(0.2), nominal=Nominal(0.7), gain_error=0.0,
        offset_deg=0.0, bend_deg=(0.0, 0.0, 0.0), homing_deg=0.0,
    )  # fmt: skip


def quantities(case: Case) -> dict[tuple[str, str], float]:
    return {(str(q["name"]), str(q["unit"])): q["value"] for q in comparable(case, case.hidden[0])}


def rest(case: Case) -> np.ndarray:
    motion = case.motion.head(RECORDED_CYCLES)
    return clean_deg(case, motion) - 0.7 * motion.pitch_deg


def test_friction_is_as_wide_as_its_loop_is_high():
    settings: Settings = {
        "sheath_torque": 2 * WIRE_STIFFNESS,
        "presliding_low_deg": 0.5,
        "presliding_high_deg": 5.0,
        "sheath_asymmetry": 0.3,
        "capstan": 0.0,
    }
    case = case_of("friction", settings, ("sheath_torque",), 2.0)
    assert quantities(case) == {("width", "deg"): pytest.approx(np.ptp(rest(case)), rel=1e-3)}


def test_a_knee_is_where_the_straight_part_begins():
    settings: Settings = {
        "pad_stiffness": 1.0, "pad_deg": 20.0, "pad_side": -1.0, "pad_skin_deg": 1.0,
    }  # fmt: skip
    case = case_of("contact", settings, ("pad_stiffness",), 40.0)
    motion = case.motion.head(RECORDED_CYCLES)
    far = motion.pitch_deg < -40
    slope, start = np.polyfit(0.7 * motion.pitch_deg[far], rest(case)[far], 1)
    assert quantities(case)["angle", "deg"] == pytest.approx(-start / slope, abs=0.01)


def test_a_lag_counts_frames_too_where_they_are_equally_far_apart():
    plain = case_of("frame_lag", {"stale_s": 1.0}, ("stale_s",), 5.04)
    assert quantities(plain) == {("lag", "s"): 5.04, ("lag", "frames"): pytest.approx(1.5)}
    rich = case_of("frame_lag", {"stale_frames": 2}, (), 1.0, "rich")
    assert quantities(rich) == {("lag", "frames"): 2.0}


def test_a_steady_drift_has_a_rate_and_wear_a_growth():
    case = case_of("drift", {"wander_deg": -1.0, "wander_kind": "linear"}, ("wander_deg",), 2.0)
    recorded = case.motion.time_s[:1800]
    found = quantities(case)
    assert found["total", "deg"] == pytest.approx(rest(case)[-1])
    hours = (recorded[-1] - recorded[0]) / 3600
    assert found["rate", "deg/h"] == pytest.approx(-2.0 / hours)
    settings: Settings = {"clearance_deg": 0.0, "wear_per_deg": 0.001}
    worn = case_of("tension_loss", settings, ("clearance_deg", "wear_per_deg"), 2.0)
    assert quantities(worn) == {("growth", "deg/deg"): pytest.approx(0.002)}


def test_time_constants_beside_softer_wires_are_left_out():
    creeping = case_of("creep", {"dashpot_share": 1.0, "dashpot_s": 20.0}, ("dashpot_share",), 0.1)
    assert quantities(creeping) == {("time_constant", "s"): pytest.approx(20.0 * 1.07)}
    soft = Hidden(Effect("compliance", {}, (), 5.0), 2.0, 2.0, 2.0)
    assert quantities(replace(creeping, hidden=(creeping.hidden[0], soft))) == {}


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("slack", {"pretension_deg": -1.0, "straightening_deg": 0.2}),
        ("creep", {"dashpot_s": 20.0, "second_dashpot_s": 200.0}),
        ("drift", {"wander_deg": 1.0, "wander_kind": "stairs"}),
        ("end_stop", {"stop_sides": "high+low", "stop_reach_deg": 40.0, "stop_skin_deg": 0.1}),
        ("gravity", {"weight": 1.0, "mounting_rad": 1.5}),
    ],
)
def test_what_has_no_single_value_is_left_out(name, settings):
    assert quantities(case_of(name, settings, (), 1.0)) == {}
