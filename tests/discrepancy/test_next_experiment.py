from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pipeline.commands import read_commands
from pipeline.discrepancy.blocks import blocks, exploring, habit_of, path
from pipeline.discrepancy.model.model import Hypothesis
from pipeline.discrepancy.model.result import Evidence
from pipeline.discrepancy.next_experiment import (
    Drive,
    Proposal,
    apart,
    next_experiment,
    power_of,
    reading_of,
    rivals_of,
)
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings, values_of
from pipeline.recording import Channel, Recording, cycles_from_reversals

NOISE = NoiseModel(white=0.15, correlated=0.1, correlation=0.5, jitter=0.05)
CREEP = Piece(term("creep", "one"), np.array([0.1, 15.0]))
FRICTION = Piece(term("friction", "symmetric"), np.array([0.65, 2.0, 0.7]))
BACKLASH = Piece(term("backlash"), np.array([6.0]))
COUPLING = "yaw_command_deg"


def plain(dwell_s: float = 3.36, yaw: float = 0.0) -> pd.DataFrame:
    turn = np.arange(1, 201) / 200
    cycle = 60.0 * np.interp(turn, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    drive = np.tile(cycle, 9)
    other = yaw * np.sin(np.arange(len(drive)) / 50.0)
    return pd.DataFrame({
        "time_s": dwell_s * np.arange(1, len(drive) + 1), "cycle": np.repeat(np.arange(9), 200),
        "step": np.tile(np.arange(200), 9), "pitch_command_deg": drive, COUPLING: other,
        "pitch_angle_deg": 0.7 * drive,
    })  # fmt: skip


def evidence_of(
    hypotheses: list[Hypothesis], samples: pd.DataFrame, static: bool = True
) -> Evidence:
    channels = (
        Channel("pitch_command_deg", "command", "deg"),
        Channel(COUPLING, "command", "deg"),
        Channel("pitch_angle_deg", "measurement", "deg"),
    )
    recording = Recording(samples, channels)
    drive = samples["pitch_command_deg"].to_numpy()
    motion = Motion(drive, samples["time_s"].to_numpy(), samples["cycle"].to_numpy(),
                    {COUPLING: samples[COUPLING].to_numpy()})  # fmt: skip
    if not static:
        motion = replace(motion, drive=0.5 * drive + 3.0)
    rows = np.ones(len(samples), dtype=bool)
    angle = 0.7 * drive
    return Evidence(
        recording, "pitch_angle_deg", "pitch_command_deg" if static else "pitch_sim_deg", static,
        motion, angle, rows, ~rows, rows, ~rows, angle, angle, np.ones(len(samples)), NOISE,
        tuple(hypotheses),
    )  # fmt: skip


def usual(name: str) -> Piece:
    around = Surroundings(other_span={COUPLING: 80.0})
    found = term(name, "", [COUPLING])
    return Piece(found, values_of(found, around, {}))


def rival(probability: float, *pieces: Piece) -> Hypothesis:
    names = tuple(piece.term.name for piece in pieces)
    return Hypothesis(names, probability, Mechanism(pieces=pieces))


def proposed(*hypotheses: Hypothesis, verdict: str = "ambiguous", yaw: float = 0.0) -> Proposal:
    found = next_experiment(evidence_of(list(hypotheses), plain(yaw=yaw)), verdict)
    assert found is not None
    return found


def test_creep_and_friction_are_separated_by_another_step_or_dwell() -> None:
    found = proposed(rival(0.6, CREEP), rival(0.4, FRICTION))
    assert found.why.startswith("would separate creep from friction: usual cycles with ")
    assert found.power is not None
    assert found.power > 0.95
    assert found.commands is not None
    steps = found.commands["pitch_command_deg"].diff().abs().round(6)
    dwells = found.commands["time_s"].diff().round(3)
    assert steps[steps > 0].nunique() > 1 or dwells.nunique() > 1


def test_late_frames_are_told_from_play_by_stops_and_without_leaps() -> None:
    """A quick cycle would do for a lag in seconds; frames that are late by a count need a stop."""
    late = Piece(term("frame_lag", "time"), np.array([1.7]))
    play = Piece(term("backlash"), np.array([1.2]))
    found = proposed(rival(0.6, play), rival(0.4, late))
    assert found.power is not None
    assert found.power > 0.95
    assert found.commands is not None
    steps = found.commands["pitch_command_deg"].diff().abs()
    assert (steps < 1e-9).any()
    assert steps.max() < 6.1


def test_a_block_that_would_hardly_decide_runs_twice() -> None:
    """Play and late frames differ by a ninth of the noise, or by a third."""
    few, many = (
        proposed(
            rival(0.6, Piece(term("backlash"), np.array([width]))),
            rival(0.4, Piece(term("frame_lag", "time"), np.array([1.4 * width]))),
        )
        for width in (0.2, 0.06)
    )
    assert few.commands is not None
    assert many.commands is not None
    assert many.power is not None
    assert many.power > 0.95
    assert len(many.commands) == 2 * len(few.commands)
    drive = many.commands["pitch_command_deg"].to_numpy()
    assert np.array_equal(drive[: len(drive) // 2], drive[len(drive) // 2 :])
    assert "all of it twice" in many.why


def test_commands_run_as_they_are_and_keep_to_the_recorded_range(tmp_path: Path) -> None:
    found = proposed(rival(0.6, CREEP), rival(0.4, FRICTION))
    assert found.commands is not None
    assert list(found.commands) == ["time_s", "pitch_command_deg", COUPLING]
    assert found.commands["pitch_command_deg"].abs().max() <= 60.0
    assert (found.commands[COUPLING] == 0.0).all()
    assert found.commands["pitch_command_deg"].iloc[-1] == 0.0
    found.commands.to_csv(tmp_path / "next_commands.csv", index=False)
    read = read_commands(tmp_path / "next_commands.csv", ["yaw", "pitch"])
    assert read["cycle"].nunique() >= 6
    assert len(read) == len(found.commands)


def test_the_separation_holds_in_noise_that_refitting_meets() -> None:
    """A likelihood ratio of refitted rivals on the proposed block picks the true one."""
    pair = [rival(0.6, CREEP), rival(0.4, FRICTION)]
    found = proposed(*pair)
    assert found.commands is not None
    evidence = evidence_of(pair, plain())
    drive = Drive.of(evidence)
    assert drive.habit is not None
    block = next(b for b in blocks(drive.habit) if b.says in found.why)
    motion = drive.motion(block)
    truth, other = (h.mechanism.respond(motion)[0] for h in pair)
    rng = np.random.default_rng(2)
    used = np.ones(len(motion), dtype=bool)
    wins = 0
    for _ in range(40):
        noise = 0.18 * rng.standard_normal(len(motion))
        fits = []
        for answer in (truth, other):
            free = np.column_stack([answer, np.ones(len(motion))])
            columns = np.column_stack([truth + noise, free])
            white = NOISE.whiten(columns, motion.cycle, used, motion.stands)
            fits.append(np.linalg.lstsq(white[:, 1:], white[:, 0], rcond=None)[1][0])
        wins += fits[1] - fits[0] > 9.0
    assert wins >= 38


def test_a_repeat_separates_nothing_that_one_dwell_hides() -> None:
    pair = [rival(0.5, CREEP), rival(0.5, Piece(CREEP.term, np.array([0.1, 15.0])))]
    found = next_experiment(evidence_of(pair, plain()), "ambiguous")
    assert found is not None
    assert found.commands is None
    assert found.power == 0.0
    assert "no motion within the recorded range would separate" in found.why


def test_what_bends_one_curve_asks_for_another_view() -> None:
    found = proposed(*(rival(0.5, usual(name)) for name in ("camera_tilt", "lens_distortion")))
    assert found.commands is None
    assert found.why.endswith("turn the camera or change the load")


def test_three_rivals_name_the_pair_that_stays_together() -> None:
    twin = Hypothesis(("response_lag",), 0.2, Mechanism(pieces=(CREEP,)))
    found = proposed(rival(0.5, CREEP), rival(0.3, FRICTION), twin)
    assert "would separate creep from friction, friction from response_lag" in found.why
    assert found.why.endswith("No motion would separate creep from response_lag")
    assert found.commands is not None


def test_rivals_that_only_add_a_name_do_not_compete() -> None:
    extra = rival(0.1, CREEP, BACKLASH)
    assert [h.names for h in rivals_of([rival(0.9, CREEP), extra])] == [("creep",)]
    one = [rival(0.9, CREEP), extra]
    assert next_experiment(evidence_of(one, plain()), "explained") is None


def test_the_likelier_of_a_rival_and_what_only_adds_to_it_stands_for_both() -> None:
    drift = Piece(term("drift", "cycle"), np.array([0.1]))
    fuller, plainer = rival(0.6, CREEP, drift), rival(0.1, CREEP)
    both = rival(0.25, CREEP, FRICTION)
    assert rivals_of([fuller, plainer]) == [fuller]
    assert rivals_of([fuller, both, rival(0.05, FRICTION), plainer]) == [
        fuller, rival(0.05, FRICTION)
    ]  # fmt: skip


def test_a_block_has_to_decide_between_all_forms_of_its_rivals() -> None:
    """Creep that the stress helps is nearly as indifferent to dwell as friction."""
    helped = Piece(term("creep", "activated"), np.array([0.1, 5000.0, 0.2]))
    creep = rival(0.6, CREEP)
    forms = replace(creep, forms=(Mechanism(pieces=(helped,)),))
    friction = rival(0.4, Piece(FRICTION.term, np.array([0.3, 1.4, 0.7])))
    plainly, wholly = proposed(creep, friction), proposed(forms, friction)
    assert plainly.power is not None
    assert wholly.power is not None
    assert wholly.power < plainly.power
    assert wholly.commands is not None
    assert plainly.commands is not None
    assert len(wholly.commands) > len(plainly.commands)


def test_that_nothing_may_be_left_out_silences_no_rival() -> None:
    hypotheses = [rival(0.4, CREEP), rival(0.35, FRICTION), rival(0.25)]
    assert [h.names for h in rivals_of(hypotheses)] == [("creep",), ("friction",)]


def test_another_axis_moves_where_that_is_what_separates() -> None:
    pair = [rival(0.5, usual("coupling")), rival(0.5, BACKLASH)]
    found = proposed(*pair, yaw=40.0)
    assert found.power is not None
    assert found.power > 0.9
    assert found.commands is not None


def test_a_structured_rest_is_explored() -> None:
    found = proposed(rival(0.9, CREEP), verdict="unknown_physics", yaw=40.0)
    assert found.why.startswith("would show what the unexplained rest depends on")
    assert found.power is None
    assert found.commands is not None
    assert found.commands[COUPLING].abs().max() > 30.0


def test_nothing_is_proposed_where_nothing_is_open_or_moves() -> None:
    pair = [rival(0.6, CREEP), rival(0.4, FRICTION)]
    assert next_experiment(evidence_of(pair, plain()), "no_mismatch") is None
    still = plain().assign(pitch_command_deg=0.0)
    assert next_experiment(evidence_of(pair, still), "ambiguous") is None


def test_a_trace_that_drives_is_followed_through_the_commands() -> None:
    drive = Drive.of(evidence_of([], plain(), static=False))
    assert drive.habit is not None
    block = next(iter(blocks(drive.habit)))
    command = drive.table(block)["pitch_command_deg"].to_numpy()
    assert drive.motion(block).drive == pytest.approx(0.5 * command + 3.0, abs=1e-6)


def test_every_block_goes_home_and_parts_into_cycles() -> None:
    samples = plain(yaw=40.0)
    habit = habit_of(samples["time_s"].to_numpy(), samples["pitch_command_deg"].to_numpy(),
                     {COUPLING: samples[COUPLING].to_numpy()})  # fmt: skip
    assert habit is not None
    for block in [*blocks(habit), exploring(habit)]:
        drive = np.concatenate([s.drive for s in block.segments])
        assert drive[-1] == pytest.approx(0.0)
        assert np.abs(drive).max() <= 60.0 + 1e-9
        assert cycles_from_reversals(drive)[-1] >= 5
        for segment in block.segments:
            assert len(segment.drive) == len(segment.dwell_s)
            assert segment.dwell_s.min() > 0.0


def test_fast_continuous_recordings_are_not_driven_faster() -> None:
    time_s = np.arange(20000) * 1e-3
    habit = habit_of(time_s, 0.1 * np.sin(time_s), {})
    assert habit is not None
    fastest = habit.step / habit.dwell_s
    for block in blocks(habit):
        drive = np.concatenate([[habit.home], *(s.drive for s in block.segments)])
        dwell_s = np.concatenate([s.dwell_s for s in block.segments])
        assert np.max(np.abs(np.diff(drive)) / dwell_s) <= fastest * (1 + 1e-9)


def test_a_path_keeps_its_corners() -> None:
    found = path([0.0, 1.0, -0.5], 0.4, 2.0)
    assert found.drive == pytest.approx([1 / 3, 2 / 3, 1.0, 0.625, 0.25, -0.125, -0.5])
    assert (found.dwell_s == 2.0).all()


def test_samples_within_a_millisecond_keep_their_times() -> None:
    time_s = np.arange(2000) * 2e-4
    command = 1e-4 * np.sin(2.0 * np.pi * 5.0 * time_s)
    habit = habit_of(time_s, command, {})
    assert habit is not None
    drive = Drive("position_m", habit, ["position_m"], {"position_m": 0.0}, {"position_m": 1.0},
                  0.0, [], 1.0, {}, 0.4, 1, True, "m")  # fmt: skip
    for block in blocks(habit):
        table = drive.table(block)
        assert np.diff(table["time_s"]) == pytest.approx(
            np.concatenate([s.dwell_s for s in block.segments])[1:], rel=1e-3
        )
        written = np.concatenate([s.drive for s in block.segments])
        assert table["position_m"].to_numpy() == pytest.approx(written, abs=1e-9)
        assert len(drive.motion(block).kinetics.acceleration) == len(table)


def test_power_is_the_chance_of_a_decisive_likelihood_ratio() -> None:
    rng = np.random.default_rng(0)
    for distance in (2.0, 4.0, 6.0):
        ratio = 0.5 * distance**2 + distance * rng.standard_normal(100_000)
        assert power_of(distance) == pytest.approx(np.mean(ratio > 4.5), abs=0.01)
    assert power_of(0.0) == 0.0


def test_what_refitting_can_follow_does_not_separate() -> None:
    motion = Motion(np.arange(200.0), np.arange(200.0), np.zeros(200, dtype=np.int64))
    ramp = np.linspace(-1.0, 1.0, 200)
    slopes = np.column_stack([100.0 * ramp, 100.0 * np.ones(200)])
    still = reading_of(np.zeros(200), slopes, NOISE, motion)
    followed, _ = apart(still, reading_of(ramp + 0.3, slopes, NOISE, motion))
    bent, rms = apart(still, reading_of(ramp**2, slopes, NOISE, motion))
    assert followed < 0.1
    assert bent > 5.0
    assert rms == pytest.approx(np.std(ramp**2), rel=0.05)


def test_where_one_rival_has_only_more_names_the_question_is_whether_they_are_there() -> None:
    """A rival whose superset is the one other: nothing is separated from nothing."""
    found = proposed(rival(0.5, CREEP), rival(0.45, CREEP, BACKLASH))
    assert found.why.startswith("would show whether backlash is there, too: usual cycles with ")
