"""Frames that are mistaken several in a row: a hand before the camera, a glare that stays."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.fitting.fit import evaluate
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement import mistaken
from pipeline.discrepancy.judgement.mistaken import (
    after_other_steps,
    after_some,
    on_their_way,
    share_and_size,
)
from pipeline.discrepancy.judgement.structure import RARE, RINGS
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.outliers import bursts, isolated, longest_burst
from pipeline.discrepancy.search.counted import between_slips
from pipeline.discrepancy.search.weighing import Choice
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.lost_steps import LostSteps
from pipeline.physics.piece import Piece
from pipeline.physics.play_operator import play
from pipeline.recording import Recording
from tests.discrepancy.made import (
    ANGLE,
    NOISE,
    SIMULATED,
    STEPS,
    changed,
    chosen,
    diagnosed,
    explanation_of,
    names,
    posed,
    recorded,
)

RUNS = ((45, 4), (170, 2), (400, 5), (530, 3), (240, 12))
EVERY = np.ones(600, dtype=bool)
CYCLE = np.arange(600) // 200
LONGEST = longest_burst(CYCLE)


def noise() -> np.ndarray:
    return 0.1 * np.random.default_rng(2).standard_normal(600)


def marked(runs: Sequence[tuple[int, int]]) -> np.ndarray:
    rows = np.zeros(600, dtype=bool)
    for first, count in runs:
        rows[first : first + count] = True
    return rows


def test_a_few_in_a_row_that_leap_off_and_back_are_found_whole() -> None:
    residual, rows = noise(), marked(RUNS)
    residual[rows] += 2.0 * np.repeat([1.0, -1.0, 1.0, 3.0, -2.0], [count for _, count in RUNS])
    assert np.array_equal(bursts(residual, EVERY, 1e-6, CYCLE), rows)


@pytest.mark.parametrize(
    "shape",
    [
        2.0 * (np.arange(600) > 300),
        2.0 * ((np.arange(600) > 300) & (np.arange(600) <= 301 + LONGEST)),
        0.05 * np.abs(np.arange(600) - 300),
        2.0 * np.exp(-np.abs(np.arange(600) - 300) / 4.0),
        np.where(np.arange(600) < 300, 0.0, 2.0 * np.exp((300.0 - np.arange(600)) / 6.0)),
    ],
    ids=["a slip", "a longer stay", "a corner", "a hump", "a leap that fades"],
)
def test_what_stays_or_comes_and_goes_slowly_is_no_burst(shape: np.ndarray) -> None:
    assert not bursts(noise() + shape, EVERY, 1e-6, CYCLE).any()


def test_what_most_cycles_show_at_the_same_steps_is_no_burst() -> None:
    residual = noise()
    rows = marked([(37 + 100 * k, 4) for k in range(6)])
    residual[rows | marked([(270, 3)])] += 2.0
    found = bursts(residual, EVERY, 1e-6, CYCLE, [np.arange(600).reshape(6, 100)])
    assert np.flatnonzero(found).tolist() == [270, 271, 272]


@pytest.mark.parametrize("hidden", [{}, {"backlash": {"width": 4.0}}], ids=["nothing", "play"])
def test_a_diagnosis_names_frames_that_were_mistaken_in_a_row(
    hidden: dict[str, dict[str, float]],
) -> None:
    recording = recorded(hidden)
    angle = recording.values(ANGLE).copy()
    for cycle, step, count, size in ((0, 70, 4, 30.0), (1, 20, 5, -60.0), (3, 95, 2, 15.0),
                                     (4, 31, 5, 40.0), (2, 50, 3, -20.0)):  # fmt: skip
        first = cycle * STEPS + step
        angle[first : first + count] += size * NOISE
    found = diagnosed(changed(recording, **{ANGLE: angle}))
    assert names(found) == {*hidden, "marker_outliers"}
    assert found.diagnoses[0].noise == pytest.approx(NOISE, rel=0.15)
    assert found.diagnoses[0].after.heldout_rmse < 1.15 * NOISE


def standing_off(
    after_long_steps: bool, size: float = 5.0, width: float = 0.0
) -> tuple[Recording, np.ndarray]:
    """Steps of three lengths, and samples (n,) that are off, after long steps only or anywhere.

    Behind play of some width.
    """
    rng, plain = np.random.default_rng(6), recorded({})
    n = len(plain.samples)
    steps = rng.choice([1.0, 2.0, 4.0], n, p=[0.6, 0.3, 0.1])
    command = 55.0 * (2.0 / np.pi) * np.arcsin(np.sin(np.cumsum(steps) / 50.0))
    off = np.zeros(n)
    some = np.flatnonzero(steps == 4.0) if after_long_steps else n
    off[rng.choice(some, 12, replace=False)] = size
    curve = CubicCurve(0.7, 1e-5)
    angle, behind = curve(command), curve(play(command, 0.5 * width, 0.0))
    measured = behind + off + NOISE * rng.standard_normal(n)
    columns = {"pitch_command_deg": command, SIMULATED: angle, ANGLE: measured}
    return changed(plain, **columns), off


@pytest.mark.parametrize("ringing", [True, False])
def test_what_stands_off_after_some_steps_only_was_not_mistaken(ringing: bool) -> None:
    recording, off = standing_off(ringing)
    problem = posed(recording)
    ground = ground_of(problem, NoiseModel(NOISE), problem.train & (off == 0.0))
    explanation = replace(explanation_of([chosen(ground, 0.0)]), outliers=off > 0.0)
    steps = np.abs(np.diff(explanation.problem.motion.drive))
    assert after_some(steps, explanation) == ringing


@pytest.mark.parametrize("ringing", [True, False])
def test_what_goes_on_standing_off_after_a_jump_was_not_mistaken(ringing: bool) -> None:
    rng, plain = np.random.default_rng(6), recorded({})
    n = len(plain.samples)
    jumps = np.arange(100, n, 200)
    command = 20.0 * np.sin(0.1 * np.arange(n)) + 15.0 * (np.arange(n) % 400 // 200)
    rows = jumps[:, None] + np.array([3, 5, 8, 11]) if ringing else rng.choice(n, 16, replace=False)
    off = np.zeros(n)
    off[rows] = 5.0
    command += np.cumsum(np.isin(np.arange(n), jumps) * 8.0 * (-1.0) ** (np.arange(n) // 200))
    angle = CubicCurve(0.7, 1e-5)(command)
    measured = angle + off + NOISE * rng.standard_normal(n)
    columns = {"pitch_command_deg": command, SIMULATED: angle, ANGLE: measured}
    problem = posed(changed(plain, **columns))
    ground = ground_of(problem, NoiseModel(NOISE), problem.train & (off == 0.0))
    explanation = replace(explanation_of([chosen(ground, 0.0)]), outliers=off > 0.0)
    assert (after_other_steps(explanation) < RARE) == ringing


@pytest.mark.parametrize("ringing", [True, False])
def test_what_rings_after_some_steps_is_told_as_that_and_not_as_mistaken(ringing: bool) -> None:
    (found,) = diagnosed(standing_off(ringing)[0]).diagnoses
    assert {p.name for p in found.physics} == (set() if ringing else {"marker_outliers"})
    assert (found.unexplained.where == RINGS) == ringing
    assert found.verdict == ("unknown_physics" if ringing else "explained")


@pytest.mark.parametrize("ringing", [True, False])
def test_what_rings_beside_wide_play_is_not_mistaken_either(ringing: bool) -> None:
    found = diagnosed(standing_off(ringing, size=2.0, width=18.0)[0])
    assert names(found) == {"backlash"} | (set() if ringing else {"marker_outliers"})


def test_two_that_follow_each_other_are_found_whole_to_whichever_sides() -> None:
    residual, rows = noise(), marked([(100, 8), (300, 7)])
    residual[100:105] += 5.0
    residual[105:108] -= 4.0
    residual[300:303] += 5.0
    residual[304:307] += 2.0
    assert np.array_equal(bursts(residual, EVERY, 1e-6, CYCLE), rows)


def test_three_mistakes_that_meet_at_one_step_of_six_cycles_are_mistakes() -> None:
    residual = noise()
    residual[[52, 252, 452]] -= 20.0
    cycle = np.arange(600) // 100
    found = isolated(residual, EVERY, 1e-6, cycle, [np.arange(600).reshape(6, 100)])
    assert np.flatnonzero(found).tolist() == [52, 252, 452]


@pytest.mark.parametrize(("rows", "mistaken"), [(5, True), (60, False)])
def test_a_slip_that_is_taken_back_at_once_is_a_mistake(rows: int, mistaken: bool) -> None:
    problem = posed(recorded({}))
    time_s = problem.motion.time_s
    values = np.array([2.0, time_s[130], -1.9, time_s[130 + rows]])
    fit = evaluate(ground_of(problem, NoiseModel(NOISE), problem.train), [])
    slips = replace(fit, pieces=(Piece(LostSteps("twice"), values),))
    found = np.flatnonzero(between_slips(problem, Choice(slips, (0, 0, 0), 0.0)))
    assert found.tolist() == (list(range(130, 130 + rows)) if mistaken else [])


@pytest.mark.parametrize(("size", "named"), [(30.0, {"marker_outliers"}), (8.0, set())])
def test_two_mistaken_frames_are_named_where_they_are_far_off(size: float, named: set[str]) -> None:
    recording = recorded({})
    angle = recording.values(ANGLE).copy()
    angle[[STEPS + 70, 3 * STEPS + 31]] += size * NOISE
    assert names(diagnosed(changed(recording, **{ANGLE: angle}))) == named


@pytest.mark.parametrize("jitter", [0.0, 20.0 * NOISE])
def test_the_first_frames_of_cycles_whose_zero_jumps_are_not_mistaken(jitter: float) -> None:
    recording, zeros = recorded({}), 20.0 * NOISE * np.array([1.0, -1.0, 0.0, 1.0, -1.0, 0.0])
    angle = recording.values(ANGLE) + zeros[recording.values("cycle").astype(int)]
    problem = posed(changed(recording, **{ANGLE: angle}))
    ground = ground_of(problem, NoiseModel(NOISE, jitter=jitter), problem.train)
    first = problem.train & (np.arange(len(problem.train)) % STEPS == 0)
    found = share_and_size(replace(explanation_of([chosen(ground, 0.0)]), outliers=first))
    assert (found is None) == (jitter > 0.0)


def test_a_shaft_that_takes_some_samples_to_slip_was_not_mistaken() -> None:
    plain = recorded({}, cycles=9, seed=2)
    drive = plain.values("pitch_command_deg")
    slipped = np.interp(np.arange(len(drive)), [400, 410], [0.0, 6.0])
    curve = CubicCurve(0.7, 1e-5)
    angle = curve(drive + slipped) - curve(drive)
    found = diagnosed(changed(plain, **{ANGLE: plain.values(ANGLE) + angle}))
    assert names(found) == {"lost_steps"}


def test_what_stands_off_after_waits_of_one_length_was_on_its_way() -> None:
    rng, plain = np.random.default_rng(8), recorded({})
    n = len(plain.samples)
    waits = rng.uniform(0.8, 6.0, n)
    off = np.zeros(n)
    brief = np.flatnonzero((waits > 1.1) & (waits < 1.5))
    off[rng.choice(brief, 10, replace=False)] = 2.0
    problem = posed(changed(plain, time_s=np.cumsum(waits)))
    problem = replace(problem, measured=problem.measured + off)
    ground = ground_of(problem, NoiseModel(NOISE), problem.train & (off == 0.0))
    explanation = replace(explanation_of([chosen(ground, 0.0)]), outliers=off > 0.0)
    assert after_some(np.diff(problem.motion.time_s), explanation)
    assert not after_some(np.abs(np.diff(problem.motion.drive)), explanation)


@pytest.mark.parametrize("between", [True, False])
def test_what_lies_between_two_poses_beside_an_old_frame_was_not_mistaken(between: bool) -> None:
    problem = posed(recorded({}))
    rows = np.flatnonzero(problem.train)[20:420:40]
    moved = np.diff(problem.motion.drive, prepend=0.0)[rows] * problem.curve.slope
    off = np.zeros(len(problem.motion))
    off[rows] = (-0.6 if between else 0.6) * moved
    fine = replace(problem, measured=problem.simulated + off)
    ground = ground_of(fine, NoiseModel(0.02), fine.train & (off == 0.0))
    late = chosen(ground, 0.0, frame_lag=[1e-6])
    explanation = replace(explanation_of([late]), outliers=off != 0.0)
    assert on_their_way(explanation) == between
    assert not on_their_way(replace(explanation, choices=[chosen(ground, 0.0)]))


@pytest.mark.long
def test_noise_with_heavy_tails_is_no_mistaken_marker(monkeypatch: pytest.MonkeyPatch) -> None:
    """One sample of four is 2.2 times as noisy, as where light flickers."""
    play = recorded({"backlash": {"width": 3.0}}, noise=0.0, cycles=20)
    rng, values = np.random.default_rng(1), play.values(ANGLE)
    spread = NOISE * rng.choice([1.0, 1.0, 1.0, 2.2], len(values))
    heavy = changed(play, **{ANGLE: values + spread * rng.standard_normal(len(values))})
    assert names(diagnosed(heavy)) == {"backlash"}
    monkeypatch.setattr(mistaken, "of_heavy_tails", lambda *_: False)
    assert names(diagnosed(heavy)) == {"backlash", "marker_outliers"}


@pytest.mark.parametrize("freedom", [4.0, 8.0])
def test_tails_are_told_from_what_is_left_of_them(freedom: float) -> None:
    values = np.random.default_rng(3).standard_t(freedom, 4000)
    found, scale = mistaken.tails_of(values[np.abs(values) < 5.0], 5.0)
    assert found == pytest.approx(freedom, rel=0.3)
    assert scale == pytest.approx(1.0, abs=0.1)


def test_a_gaussian_that_is_cut_off_has_no_heavy_tails() -> None:
    values = np.random.default_rng(4).standard_normal(4000)
    assert mistaken.tails_of(values[np.abs(values) < 3.0], 3.0) == (np.inf, 1.0)


def test_a_drive_that_stands_and_then_steps_is_on_its_way_and_not_mistaken() -> None:
    """A servo of 0.2 s that steps every 3 s: what stands off in each sixth sample is no mistake."""
    command = np.repeat(np.random.default_rng(4).uniform(-9.0, 9.0, 40), 30)
    angle = command.copy()
    for k in range(1, len(angle)):
        angle[k] = angle[k - 1] + 0.4 * (command[k - 1] - angle[k - 1])
    off = np.round(angle - command, 1)
    every, cycle = np.ones(len(off), dtype=bool), np.zeros(len(off), dtype=int)
    assert not isolated(off, every, 1e-3, cycle).any()
    alone = np.where(np.arange(len(off)) % 97 == 5, 3.0, 0.0)
    assert isolated(alone, every, 1e-3, cycle).sum() == np.sum(alone > 0.0)


@pytest.mark.parametrize(("first", "named"), [(0, set()), (40, {"marker_outliers"})])
def test_how_a_mechanism_lay_before_a_recording_is_no_mistake(first: int, named: set[str]) -> None:
    recording = recorded({}, seed=3)
    seen = recording.values(ANGLE).copy()
    seen[[first, STEPS + 20, STEPS + 55]] += 8.0 * NOISE
    assert names(diagnosed(changed(recording, **{ANGLE: seen}))) == named
