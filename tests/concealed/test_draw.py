"""Cases are drawn as the benchmark says, the same for a seed, each effect as large as stated."""

from collections import Counter

import numpy as np
import pytest

from pipeline.concealed.cases import clean_deg, follow_up, realise, recordings_of
from pipeline.concealed.draw import (
    LARGEST,
    SMALLEST,
    SMALLEST_OUTSIDE,
    Case,
    draw_cases,
)
from pipeline.concealed.effects import CATALOGUE
from pipeline.concealed.motions import HELD_OUT, RECORDED_CYCLES, plain_motion, rich_motion
from pipeline.concealed.names import (
    BENDS,
    EFFECTS_BESIDE_KNOWN,
    EFFECTS_OF,
    EXCLUSIVE,
    KINDS,
    KNOWN,
)
from pipeline.concealed.noise import Noise, disturbance, lost, mistaken
from pipeline.concealed.outside import OUTSIDE
from pipeline.concealed.sizing import stands_out
from pipeline.recording import load_recording, save_recording

COUNTS = {
    "none": 6, "walk": 4, "one": 34, "two": 12, "three": 8, "outside": 18, "small": 6,
    "known_none": 4, "known_one": 12,
}  # fmt: skip


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return draw_cases(7, COUNTS)


def names_of(case: Case) -> list[str]:
    return [h.effect.name for h in case.hidden]


def test_counts_are_kept_and_half_is_plain(cases):
    assert Counter(c.kind for c in cases) == COUNTS
    for kind in KINDS:
        plain = sum(c.kind == kind and c.excitation == "plain" for c in cases)
        assert plain == COUNTS[kind] // 2
    assert [c.name for c in cases] == [f"case-{i:03d}" for i in range(len(cases))]


def test_every_name_is_drawn(cases):
    single = {names_of(c)[0] for c in cases if c.kind == "one"}
    assert single == {*CATALOGUE, "marker_outliers"}
    assert {names_of(c)[0] for c in cases if c.kind == "outside"} >= set(OUTSIDE) - {
        "step_resonance"
    }


def test_a_case_hides_as_many_effects_as_its_kind_says(cases):
    for case in cases:
        names = names_of(case)
        assert len(set(names)) == len(names)
        if case.kind != "outside":
            assert len(names) == {**EFFECTS_OF, **EFFECTS_BESIDE_KNOWN}[case.kind]
        else:
            assert names[0] in OUTSIDE
        assert all(len(set(names) & group) <= 1 for group in EXCLUSIVE)
        assert (case.noise.walk_deg > 0) == (case.kind == "walk")


def test_effects_stand_out_as_stated(cases):
    checked = 0
    for case in cases:
        if case.kind != "one" or "marker_outliers" in names_of(case):
            continue
        motion = case.motion.head(RECORDED_CYCLES)
        simulated = case.nominal.angle_deg(motion.pitch_deg)
        bare = clean_deg(case, motion)
        bends = case.tolerance_shape_deg > 0
        rms = stands_out(bare - simulated, simulated, bends) / np.hypot(
            case.noise.sigma_deg, case.noise.jitter_deg
        )
        if not bends:
            assert rms == pytest.approx(case.hidden[0].beside_over_noise, rel=0.05)
            checked += 1
        assert SMALLEST <= case.hidden[0].beside_over_noise <= 1.05 * LARGEST
    assert checked > 10
    for case in cases:
        if case.kind == "outside":
            assert case.hidden[0].alone_over_noise >= 0.97 * SMALLEST_OUTSIDE
        if case.kind == "small":
            assert case.hidden[0].alone_over_noise <= 1.05 * SMALLEST


def test_a_simulation_that_knows_an_effect_runs_its_loop_and_lacks_what_is_hidden(cases):
    checked = 0
    for case in cases:
        assert bool(case.known) == (case.kind in EFFECTS_BESIDE_KNOWN)
        if not case.known:
            assert np.array_equal(
                case.simulated_deg(case.motion), case.nominal.angle_deg(case.motion.pitch_deg)
            )
            continue
        own = [h.effect.name for h in case.known]
        assert len(own) == 1
        assert own[0] in KNOWN
        assert own[0] not in names_of(case)
        motion = case.motion.head(RECORDED_CYCLES)
        simulated = case.simulated_deg(motion)
        total = np.hypot(case.noise.sigma_deg, case.noise.jitter_deg)
        nominal = case.nominal.angle_deg(motion.pitch_deg)
        assert stands_out(simulated - nominal, nominal) > 0.8 * total
        later = motion.cycle > 0
        apart = clean_deg(case, motion) - simulated
        rms = stands_out(apart[later], simulated[later], case.tolerance_shape_deg > 0) / total
        unseen = not case.hidden or "marker_outliers" in names_of(case)
        checked += 1
        assert rms < 0.1 if unseen else rms > 0.5 * SMALLEST
    assert checked == COUNTS["known_none"] + COUNTS["known_one"]


def test_calibration_is_wrong_within_tolerance_and_bends_are_declared(cases):
    for case in cases:
        assert 0 < abs(case.gain_error) < 0.05
        assert 0 < abs(case.offset_deg) < 2.0
        assert (np.any(case.bend_deg) > 0) == (case.tolerance_shape_deg > 0)
        assert not (case.tolerance_shape_deg > 0 and set(names_of(case)) & BENDS)
    assert any(case.tolerance_shape_deg > 0 for case in cases)
    halves = [
        (c.noise.correlation > 0, c.noise.jitter_deg > 0, c.noise.lost_share > 0) for c in cases
    ]
    assert np.all(np.abs(np.mean(halves, axis=0) - 0.5) < 0.2)


def test_a_seed_draws_the_same_again():
    first, again = (draw_cases(11, {"two": 2, "one": 2}) for _ in range(2))
    for one, other in zip(first, again, strict=True):
        assert names_of(one) == names_of(other)
        assert np.array_equal(
            realise(one).measured_deg, realise(other).measured_deg, equal_nan=True
        )
    other_seed = draw_cases(12, {"two": 2, "one": 2})
    assert [c.seed for c in other_seed] != [c.seed for c in first]


def test_recordings_load_and_the_later_cycles_are_empty(cases, tmp_path):
    case = next(c for c in cases if c.noise.lost_share > 0)
    first, later = recordings_of(case, realise(case))
    save_recording(first, tmp_path / "a")
    save_recording(later, tmp_path / "b")
    read, read_later = load_recording(tmp_path / "a"), load_recording(tmp_path / "b")
    assert len(read.samples) == 1800
    assert len(read_later.samples) == 3000
    angle = read_later.values("pitch_angle_deg")
    assert np.isnan(angle[1800:]).all()
    assert 0 < np.isnan(angle[:1800]).mean() < 0.06
    assert np.array_equal(angle[:1800], read.values("pitch_angle_deg"), equal_nan=True)
    assert read.simulation_of("pitch_angle_deg") is not None


def test_a_proposed_block_is_answered_by_the_same_plant(cases):
    case = next(c for c in cases if names_of(c) == ["backlash"])
    first, _ = recordings_of(case, realise(case))
    block = first.samples[["time_s", "pitch_command_deg", "yaw_command_deg"]].iloc[200:400]
    answered = follow_up(case, block)
    before = answered.values("pitch_angle_deg")[:1800]
    assert np.array_equal(before, first.values("pitch_angle_deg"), equal_nan=True)
    assert np.all(np.diff(answered.values("time_s")) > 0)
    assert set(answered.samples["cycle"].iloc[1800:]) == {9}
    rest = (
        answered.values("pitch_angle_deg")[2000 - 200 :]
        - answered.values("pitch_angle_sim_deg")[1800:]
    )
    same = before[200:400] - first.values("pitch_angle_sim_deg")[200:400]
    noise = case.noise.sigma_deg + case.noise.jitter_deg
    assert np.nanstd(rest - same) < 2.5 * noise


def test_rich_motion_excites_every_kind_of_cycle_in_training():
    for seed in range(10):
        motion = rich_motion(np.random.default_rng(seed))
        trained = (motion.cycle < RECORDED_CYCLES) & ~np.isin(motion.cycle, HELD_OUT)
        assert np.ptp(motion.yaw_deg[trained]) > 50
        interval = np.diff(motion.time_s, prepend=0.0)[trained]
        assert interval.max() > 9.0
        assert interval.min() < 3.4
    plain = plain_motion(np.random.default_rng(0))
    assert np.array_equal(plain.pitch_deg[:200], plain.pitch_deg[2800:])


def test_noise_has_the_size_and_correlation_that_it_says():
    rng = np.random.default_rng(0)
    cycle = np.repeat(np.arange(400), 200)
    blur = disturbance(Noise(0.2, correlation=0.7), cycle, rng)
    assert blur.std() == pytest.approx(0.2, rel=0.03)
    assert np.corrcoef(blur[1:], blur[:-1])[0, 1] == pytest.approx(0.7, abs=0.02)
    zeros = disturbance(Noise(1e-9, jitter_deg=0.1), cycle, rng)
    assert zeros.reshape(400, 200).std(axis=1).max() < 1e-6
    assert zeros.std() == pytest.approx(0.1, rel=0.15)
    assert lost(Noise(0.1, lost_share=0.03), 1800, rng).mean() == pytest.approx(0.03, abs=0.006)
    wrong = mistaken(Noise(0.1, mistaken_share=0.01, mistaken_deg=3.0), 1800, rng)
    assert np.count_nonzero(wrong) == 18
    assert np.abs(wrong[wrong != 0]).min() >= 2.4
