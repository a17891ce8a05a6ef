"""A diagnosis of recordings whose hidden physics is known."""

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.config import HeldoutConfig
from pipeline.discrepancy.model.result import as_json
from pipeline.discrepancy.problem.known_rows import held_out_rows
from pipeline.physics.motion import Motion
from pipeline.recording import Channel, Recording, with_context
from tests.discrepancy.made import (
    ANGLE,
    CHANNELS,
    NOISE,
    SIMULATED,
    changed,
    diagnosed,
    names,
    recorded,
    value_of,
)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_nothing_hidden_is_no_mismatch(seed):
    result = diagnosed(recorded({}, seed=seed))
    assert result.diagnoses[0].verdict == "no_mismatch"
    assert result.diagnoses[0].calibration.gain == pytest.approx(1.02, abs=0.005)
    assert result.diagnoses[0].noise == pytest.approx(NOISE, rel=0.1)


@pytest.mark.parametrize(
    ("hidden", "parameter", "truth"),
    [
        ({"backlash": {"width": 4.0}}, "width", 4.0),
        ({"lost_steps": {"jump": 2.0, "time": 1300.0}}, "jump", 2.0),
        ({"transmission_ripple": {"amplitude": 1.2, "period": 14.0, "phase": 1.0}}, "period", 14.0),
        ({"slack": {"width": 6.0, "stiffness": 0.02, "rounding": 0.2}}, "width", 6.0),
        ({"creep": {"share": 0.2, "time_constant": 40.0}}, "time_constant", 40.0),
        ({"drift/linear": {"rate": 3.0}}, "rate", 3.0),
        ({"drift/wave": {"amplitude": 0.9, "period": 1900.0, "phase": 1.0}}, "period", 1900.0),
        ({"contact/upper": {"stiffness": 0.8, "angle": 18.0, "skin": 0.3}}, "angle", 18.0),
    ],
    ids=lambda x: next(iter(x)) if isinstance(x, dict) else "",
)
@pytest.mark.long
def test_one_hidden_term_is_named_with_its_parameter(hidden, parameter, truth):
    result = diagnosed(recorded(hidden, seed=6))
    name = next(iter(hidden)).partition("/")[0]
    assert names(result) == {name}
    estimate = value_of(result, name, parameter)
    assert estimate.low <= estimate.value <= estimate.high
    assert estimate.value == pytest.approx(truth, rel=0.08)
    diagnosis = result.diagnoses[0]
    assert diagnosis.after.heldout_rmse < 1.1 * NOISE
    assert diagnosis.physics[0].heldout_rmse_without > 1.3 * diagnosis.after.heldout_rmse


def test_a_wire_that_is_loose_off_home_is_neither_slack_nor_a_ripple():
    loose = {"softness": 0.2, "reach": 6.0, "stretch": 0.0, "stiffness": 0.2, "centre": 9.0}
    assert names(diagnosed(recorded({"compliance/off home": loose}, seed=4))) == {"compliance"}


def test_two_hidden_terms_are_both_named():
    hidden = {"backlash": {"width": 3.0}, "contact/lower": {"stiffness": 1.0, "angle": -16.0}}
    assert names(diagnosed(recorded(hidden, seed=2))) == {"backlash", "contact"}


def test_a_ripple_draws_no_bend_where_the_zero_was_not_taken_at_home():
    ripple = {"transmission_ripple/first afloat": {"amplitude": 3.0, "period": 22.0, "phase": 1.5}}
    assert names(diagnosed(recorded(ripple, seed=11))) == {"transmission_ripple"}


def test_a_ripple_with_flat_tops_draws_no_other_name():
    flat = {"amplitude": 3.0, "period": 22.0, "phase": 1.5, "amplitude_3": 0.6, "phase_3": 4.5}
    (found,) = diagnosed(recorded({"transmission_ripple/third afloat": flat}, seed=11)).diagnoses
    (physics,) = found.physics
    assert (physics.name, found.verdict) == ("transmission_ripple", "explained")


def test_a_ripple_of_three_harmonics_leaves_no_rest():
    teeth = {"amplitude": 3.0, "period": 22.0, "phase": 1.5, "amplitude_2": 1.2, "phase_2": 0.5,
             "amplitude_3": 0.9, "phase_3": 4.0}  # fmt: skip
    (found,) = diagnosed(recorded({"transmission_ripple/both afloat": teeth}, seed=11)).diagnoses
    (physics,) = found.physics
    assert (physics.name, found.verdict) == ("transmission_ripple", "explained")
    assert found.after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize("sizes", [(2.0, 1.2), (0.9, 2.0)])
@pytest.mark.long
def test_two_waves_of_periods_of_their_own_are_one_ripple_beside_play(sizes):
    waves = {"amplitude": sizes[0], "period": 37.0, "phase": 1.5,
             "other_amplitude": sizes[1], "other_period": 11.4, "other_phase": 4.0}  # fmt: skip
    hidden = {"transmission_ripple/two afloat": waves, "backlash": {"width": 3.0}}
    result = diagnosed(recorded(hidden, seed=11))
    assert names(result) == {"transmission_ripple", "backlash"}
    assert result.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


def test_two_wheels_that_beat_hardly_more_than_once_are_one_ripple():
    recording = recorded({}, seed=12)
    drive = recording.samples["pitch_command_deg"]
    wheels = 2.0 * np.sin(2.0 * np.pi * drive / 20.0) + 1.5 * np.sin(2.0 * np.pi * drive / 24.0)
    simulated = recording.values(SIMULATED)
    slope = np.polyfit(drive, simulated, 1)[0]
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + slope * wheels}))
    assert names(result) == {"transmission_ripple"}
    assert result.diagnoses[0].after.heldout_rmse < 1.1 * NOISE


@pytest.mark.parametrize("form", ["dragged", "cycle dragged"])
def test_friction_that_grows_is_a_wire_that_slackens_and_nothing_beside(form):
    growth = {"growth_a_cycle": 0.5} if "cycle" in form else {"growth": 0.0022}
    dragged = {"width": 0.6, "reach": 4.0, **growth}
    assert names(diagnosed(recorded({f"tension_loss/{form}": dragged}, seed=3))) == {"tension_loss"}


def test_friction_beside_play_that_grows_keeps_its_name():
    hidden = {
        "friction": {"width": 1.6, "reach": 4.0, "spread": 0.9},
        "tension_loss/cycle": {"growth_a_cycle": 0.6, "width": 0.0},
    }
    (found,) = diagnosed(recorded(hidden, seed=3)).diagnoses
    told = [{p.name, *p.alternatives} for p in found.physics]
    assert len(told) == 2
    assert all(any(name in few for few in told) for name in ("friction", "tension_loss"))


def with_wave(form, seed):
    """A recording with 1.6 deg times `form` of the command on top of its measurement."""
    recording = recorded({}, seed=seed)
    wave = form(recording.values("pitch_command_deg"))
    return changed(recording, **{ANGLE: recording.values(ANGLE) + 1.6 * wave})


def test_teeth_that_seat_and_snap_over_leave_no_rest():
    result = diagnosed(with_wave(lambda u: 2.0 * ((u + 3.0) / 24.0 % 1.0) - 1.0, seed=5))
    assert names(result) == {"transmission_ripple"}
    assert result.diagnoses[0].verdict == "explained"


@pytest.mark.parametrize("seed", [5, 17])
@pytest.mark.long
def test_one_edge_each_way_is_no_ripple_nor_a_pile_of_names(seed):
    def snapped(command):
        out, side = np.empty(len(command)), -1.0
        for i, u in enumerate(command):
            side = 1.0 if u > 18.0 else -1.0 if u < -18.0 else side
            out[i] = side
        return out

    result = diagnosed(with_wave(snapped, seed))
    assert "transmission_ripple" not in names(result)
    assert len(names(result)) <= 1
    assert result.diagnoses[0].verdict in ("unknown_physics", "partly_explained")


def test_friction_and_creep_of_one_dwell_list_each_other():
    result = diagnosed(recorded({"friction": {"width": 3.0, "reach": 3.0}}, seed=4))
    physics = result.diagnoses[0].physics
    assert {physics[0].name, *physics[0].alternatives} >= {"friction", "creep"}


def test_each_alternative_of_a_play_competes_and_none_is_that_play_in_disguise():
    result = diagnosed(recorded({"backlash": {"width": 1.2}}, seed=1))
    single = {h.names[0] for h in result.evidence[0].hypotheses if len(h.names) == 1}
    alternatives = set(result.diagnoses[0].physics[0].alternatives)
    assert "friction" in alternatives
    assert single == {"backlash", *alternatives} - {"friction"}


def test_what_bends_the_curve_lists_all_that_could():
    hidden = {"lens_distortion": {"distortion": 6e-5, "centre": 12.0}}
    diagnosis = diagnosed(recorded(hidden, seed=3)).diagnoses[0]
    bends = {"lens_distortion", "camera_tilt", "gravity", "compliance"}
    assert {diagnosis.physics[0].name, *diagnosis.physics[0].alternatives} == bends
    assert diagnosis.verdict == "ambiguous"


def test_a_coupling_needs_the_other_axis_to_move():
    hidden = {"coupling": {"gain": 0.08}}
    moved = diagnosed(recorded(hidden, seed=1, two_axes=True))
    assert names(moved) == {"coupling"}
    assert value_of(moved, "coupling", "gain").value == pytest.approx(0.08 * 1.02, rel=0.05)
    still = diagnosed(recorded(hidden, seed=1))
    assert "coupling" in still.diagnoses[0].not_excited
    assert still.diagnoses[0].verdict == "no_mismatch"


def test_a_small_coupling_is_not_passed_over():
    small = diagnosed(recorded({"coupling": {"gain": 0.005}}, two_axes=True, seed=19))
    assert names(small) == {"coupling"}
    assert value_of(small, "coupling", "gain").value == pytest.approx(0.005, abs=0.002)


def test_mistaken_frames_are_named_and_do_not_spoil_the_fit():
    recording = recorded({"backlash": {"width": 4.0}}, seed=7)
    angle = recording.values(ANGLE).copy()
    angle[::37] += 9.0
    result = diagnosed(changed(recording, **{ANGLE: angle}))
    assert names(result) == {"backlash", "marker_outliers"}
    assert value_of(result, "marker_outliers", "size").value == pytest.approx(9.0, abs=0.4)
    assert result.diagnoses[0].after.heldout_rmse < 1.15 * NOISE


def test_mistaken_frames_are_named_beside_a_name_that_leaves_a_rest():
    recording = recorded({"backlash": {"width": 9.0}}, seed=6)
    odd = np.where(recording.values("cycle") % 2 == 1, 1.0, -1.0)
    angle = recording.values(ANGLE) + 0.7 * odd * np.sin(recording.values("pitch_command_deg") / 4)
    angle[::37] += 15.0
    (found,) = diagnosed(changed(recording, **{ANGLE: angle})).diagnoses
    assert found.verdict == "partly_explained"
    assert [p.name for p in found.physics] == ["backlash", "marker_outliers"]


def test_what_is_left_without_a_name_is_measured_against_the_noise_of_repeats():
    recording = recorded({}, seed=19)
    command = recording.values("pitch_command_deg")
    jump = np.where((np.gradient(command) > 0) & (command > 10.0), 3.0, 0.0)
    (found,) = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + jump})).diagnoses
    assert (found.verdict, found.physics) == ("unknown_physics", ())
    assert found.noise == pytest.approx(NOISE, rel=0.1)
    assert found.unexplained.share > 0.6


def test_stale_frames_are_told_from_mistaken_ones():
    recording = recorded({}, seed=18)
    angle = recording.values(ANGLE)
    late = np.random.default_rng(18).random(len(angle)) < 0.04
    late[0] = False
    (found,) = diagnosed(
        changed(recording, **{ANGLE: np.where(late, np.roll(angle, 1), angle)})
    ).diagnoses
    (physics,) = found.physics
    assert (physics.name, found.verdict) == ("frame_lag", "explained")
    assert physics.parameters[0].low < late[1:].mean() < physics.parameters[0].high


def test_structure_outside_the_catalogue_is_said_so():
    recording = recorded({}, seed=6)
    odd = np.where(recording.values("cycle") % 2 == 1, 1.0, -1.0)
    wobble = odd * 1.5 * np.sin(recording.values("pitch_command_deg") / 4.0)
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + wobble}))
    assert result.diagnoses[0].verdict in ("unknown_physics", "partly_explained")
    assert len(result.diagnoses[0].physics) <= 1
    assert result.diagnoses[0].unexplained.where


def test_held_out_cycles_touch_neither_fit_nor_choice():
    recording = recorded({"backlash": {"width": 4.0}}, seed=8)
    spoilt = recording.values(ANGLE).copy()
    spoilt[np.isin(recording.values("cycle"), [2, 5])] += 7.0
    plain, other = diagnosed(recording), diagnosed(changed(recording, **{ANGLE: spoilt}))
    assert value_of(plain, "backlash", "width") == value_of(other, "backlash", "width")
    assert other.diagnoses[0].after.heldout_rmse > 6.0


def test_held_out_are_every_third_cycle_or_the_last_third():
    def held(cycle, known, kind="every_third", after_s=None):
        motion = Motion(np.arange(len(cycle), dtype=float), 100.0 + np.arange(len(cycle)), cycle)
        return np.flatnonzero(held_out_rows(HeldoutConfig(kind, after_s), motion, known)).tolist()

    nine = np.repeat(np.arange(9), 4)
    known = np.ones(36, dtype=bool)
    assert set(nine[held(nine, known)]) == {2, 5, 8}
    assert held(nine, known, "last_third") == list(range(24, 36))
    assert held(nine, known, "after_s", 30.0) == list(range(31, 36))
    assert held(np.zeros(30, dtype=int), known[:30]) == list(range(20, 30))
    hardly_a_third_cycle = np.repeat([0, 1, 2], [17, 18, 1])
    assert held(hardly_a_third_cycle, known) == list(range(24, 36))


def test_where_the_wire_lay_before_a_recording_began_bears_no_name():
    whole = recorded({"backlash": {"width": 8.0}}, cycles=4, seed=2)
    from_the_top = whole.samples.iloc[30:].drop(columns=["cycle", "step"]).reset_index(drop=True)
    result = diagnosed(replace(whole, samples=with_context(from_the_top, whole.channels)))
    assert names(result) == {"backlash"}


def test_several_measurements_give_one_entry_each_in_plain_json():
    one = recorded({"backlash": {"width": 4.0}}, seed=1)
    twin = replace(one.channels[2], name="other_deg")
    sim = replace(one.channels[3], name="other_sim_deg", of="other_deg")
    two = one.with_channel(twin, 2.0 * one.values(ANGLE)).with_channel(
        sim, 2.0 * one.values(SIMULATED)
    )
    text = json.dumps(as_json(diagnosed(two).diagnoses), allow_nan=False)
    entries = json.loads(text)["measurements"]
    assert [e["measurement"] for e in entries] == [ANGLE, "other_deg"]
    assert set(entries[0]) == {
        "measurement", "unit", "verdict", "noise", "before", "after", "location", "physics",
        "calibration", "unexplained", "not_excited", "next_experiment",
    }  # fmt: skip


def test_held_out_samples_refute_what_they_do_not_bear_out():
    recording = recorded({"backlash": {"width": 4.0}}, seed=10)
    cycle, command = recording.values("cycle"), recording.values("pitch_command_deg")
    late = np.where(cycle == 5, 6.0 * np.sin(command / 9.0), 0.0)
    diagnosis = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + late})).diagnoses[
        0
    ]
    assert diagnosis.verdict in ("unknown_physics", "partly_explained")
    assert "held-out" in diagnosis.unexplained.where


def test_a_calibration_beyond_its_tolerance_is_still_calibration():
    recording = recorded({}, seed=13, gain=1.3, offset=12.0)
    diagnosis = diagnosed(recording).diagnoses[0]
    assert diagnosis.verdict == "no_mismatch"
    assert diagnosis.calibration.gain == pytest.approx(1.3, abs=0.01)
    assert any("tolerance" in note for note in diagnosis.notes)


@pytest.mark.parametrize("form", ["coarse", "two zeros"])
def test_a_sensor_that_no_term_describes_is_unknown_physics(form):
    recording = recorded({}, noise=0.05, seed=4)
    angle = recording.values(ANGLE)
    coarse = np.round(recording.values(SIMULATED) / 3.0) * 3.0 - recording.values(SIMULATED)
    turns = np.where(np.random.default_rng(4).random(len(angle)) < 0.5, 0.0, 0.5)
    result = diagnosed(
        changed(recording, **{ANGLE: angle + (coarse if form == "coarse" else turns)})
    )
    assert result.diagnoses[0].verdict == "unknown_physics"
    assert not names(result)


def test_two_slips_are_one_name_with_both_jumps():
    recording = recorded({"lost_steps": {"jump": 3.0, "time": 400.0}}, seed=17)
    back = np.where(recording.values("time_s") >= 1500.0, -1.4, 0.0)
    result = diagnosed(changed(recording, **{ANGLE: recording.values(ANGLE) + back}))
    assert names(result) == {"lost_steps"}
    assert value_of(result, "lost_steps", "jump").value == pytest.approx(3.0, abs=0.2)
    assert value_of(result, "lost_steps", "time_2").value == pytest.approx(1500.0, abs=10.0)


def test_a_lag_of_a_dense_recording_is_found_on_every_sample():
    """Fits see every 7th sample at 1 kHz; the lag is shorter than from one of these to the next."""
    time_s = np.arange(20_000) * 1e-3
    command = 40.0 * np.sin(2.0 * np.pi * 0.5 * time_s)
    frequency = 2.0 * np.pi * 0.5 * 0.005
    late = 40.0 / np.hypot(1.0, frequency) * np.sin(np.pi * time_s - np.arctan(frequency))
    rng = np.random.default_rng(18)
    samples = pd.DataFrame(
        {
            "time_s": time_s,
            "cycle": (time_s // 2.0).astype(int),
            "step": np.arange(20_000) % 2000,
            "motor_deg": command,
            "load_deg": late + 0.05 * rng.standard_normal(20_000),
            "load_sim_deg": command,
        }
    )
    channels = (
        Channel("motor_deg", "command", "deg"),
        Channel("load_deg", "measurement", "deg"),
        Channel("load_sim_deg", "simulation", "deg", of="load_deg"),
    )
    result = diagnosed(Recording(samples, channels, "simulated"))
    (physics,) = result.diagnoses[0].physics
    assert "response_lag" in (physics.name, *physics.alternatives)
    assert result.diagnoses[0].after.heldout_rmse == pytest.approx(0.05, rel=0.05)


def test_an_axis_that_moves_in_held_out_cycles_alone_could_not_be_seen_to_couple() -> None:
    recording = recorded({"backlash": {"width": 6.0}}, two_axes=True)
    still = recording.samples["cycle"] % 3 != 2
    samples = recording.samples.assign(
        yaw_command_deg=recording.samples["yaw_command_deg"].where(~still, 0.0)
    )
    found = diagnosed(Recording(samples, CHANNELS)).diagnoses[0]
    assert "coupling" in found.not_excited
    assert [p.name for p in found.physics] == ["backlash"]


def test_a_joint_that_does_not_move_at_all_is_said_in_numbers():
    recording = recorded({})
    still = changed(recording, **{ANGLE: np.ones(len(recording.samples))})
    (found,) = diagnosed(still).diagnoses
    assert (found.verdict, found.physics) == ("unknown_physics", ())
    assert found.unexplained.where.startswith("the gain")
    assert found.after.heldout_rmse < 1e-6 < found.before.heldout_rmse
    assert found.calibration.offset == pytest.approx(1.0)
