"""Sensors that read in levels: readings are off by the same again wherever a motion comes again."""

from dataclasses import replace

import numpy as np
import pytest

from pipeline.discrepancy.explained import explained
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.judgement.mistaken import of_heavy_tails
from pipeline.discrepancy.judgement.structure import rounded
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.levels import (
    Levels,
    levels_read,
    likeliest_spread,
    read_off,
    step_of,
)
from pipeline.recording import Recording
from tests.discrepancy.made import (
    ANGLE,
    changed,
    chosen,
    diagnosed,
    explanation_of,
    names,
    posed,
    recorded,
)

STEP = 0.7


def read(recording: Recording, step: float = STEP) -> Recording:
    """A recording whose sensor reads in levels."""
    values = recording.values(ANGLE)
    return changed(recording, **{ANGLE: np.round(values / step) * step})


@pytest.mark.parametrize("spread", [0.05, 0.2, 0.4])
def test_what_readings_are_off_on_average_is_a_rounded_sawtooth(spread: float) -> None:
    place = np.linspace(-2.0, 3.0, 41)
    noise = spread * np.random.default_rng(1).standard_normal((40_000, 1))
    off = np.mean(np.round(place + noise) - place, axis=0)
    np.testing.assert_allclose(read_off(place, spread), off, atol=0.01)


@pytest.mark.parametrize("spread", [0.1, 0.3])
def test_readings_say_how_much_noise_was_read(spread: float) -> None:
    rng = np.random.default_rng(2)
    place = rng.uniform(-20.0, 20.0, 2000)
    off = np.round(place + spread * rng.standard_normal(2000)) - place
    assert likeliest_spread(off)[0] == pytest.approx(spread, rel=0.1)


def test_levels_are_where_nearly_all_readings_stand() -> None:
    rng = np.random.default_rng(3)
    came = rng.uniform(-30.0, 30.0, 900)
    in_levels = 0.1 + STEP * np.round(came / STEP)
    mistaken = np.where(np.arange(900) % 50 == 0, in_levels + rng.uniform(3.0, 9.0, 900), in_levels)
    taken = 0.05 * came
    for values in (in_levels, mistaken):
        found = levels_read(values, values - taken)
        assert found is not None
        assert found.step == pytest.approx(STEP)
        np.testing.assert_allclose(found.taken, taken, atol=1e-9)
    again = came.copy()
    again[[5, 70, 300]], again[[6, 71, 301]] = (0.0, 9.6, 19.2), (0.0, 9.6, 19.2)
    assert levels_read(again, again) is None


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.15])
@pytest.mark.parametrize("step", [0.3, 1.1])
@pytest.mark.parametrize("hidden", [None, "backlash"])
@pytest.mark.long
def test_levels_are_no_physics(hidden: str | None, step: float, noise: float) -> None:
    physics = {} if hidden is None else {hidden: {"width": 1.6}}
    result = diagnosed(read(recorded(physics, noise=noise), step))
    (found,) = result.diagnoses
    assert found.verdict == ("no_mismatch" if hidden is None else "ambiguous")
    told = {hidden} if hidden else set()
    assert all(told <= {p.name, *p.alternatives} for p in found.physics)
    assert len(found.physics) == len(told)
    assert found.noise == pytest.approx(np.hypot(noise, step / np.sqrt(12.0)), rel=0.4)
    assert found.after.heldout_rmse < 1.15 * found.noise


def test_what_is_read_finely_stays_as_it_is() -> None:
    problem = posed(recorded({"backlash": {"width": 1.6}}))
    fine = posed(read(recorded({"backlash": {"width": 1.6}}), 0.1))
    assert problem.levels is None
    assert explained(problem)[0] is problem
    assert fine.levels is not None
    assert explained(fine)[0] is fine


def test_none_of_the_levels_need_be_next_to_another() -> None:
    levels = 0.3 * np.cumsum([4, 4, 5, 4, 5, 5, 4])
    assert step_of(levels) == pytest.approx(0.3)
    assert step_of(np.array([0.0, 1.0, 1.0 + np.sqrt(2.0), 7.03])) == 0.0


def test_readings_without_noise_are_off_by_up_to_half_a_step() -> None:
    place = np.linspace(-3.0, 3.0, 241)
    read_as = STEP * np.round(place / STEP)
    levels = levels_read(np.tile(read_as, 3), np.tile(read_as, 3))
    assert levels is not None
    few = replace(levels, taken=np.zeros(241))
    np.testing.assert_allclose(few.off_by_reading(place, read_as, 0.03), read_as - place)
    bound = 0.5 * STEP + 1e-9
    assert np.all(np.abs(few.off_by_reading(place + 9.0, read_as, 0.03)) <= bound)


def test_what_was_read_stays_what_errors_are_told_of() -> None:
    recording = read(recorded({}, noise=0.1))
    result = diagnosed(recording)
    (evidence,) = result.evidence
    np.testing.assert_array_equal(evidence.measured, recording.values(ANGLE))
    (model,) = result.models
    (found,) = result.diagnoses
    assert any("The sensor reads in steps of 0.7 deg" in note for note in found.notes)
    assert model.noise.deviation == pytest.approx(np.hypot(0.1, STEP / np.sqrt(12.0)), rel=0.1)


@pytest.mark.parametrize("noise", [0.1, 0.15])
def test_structure_is_looked_for_beside_levels(noise: float) -> None:
    problem, explanation = explained(posed(read(recorded({}, noise=noise))))
    assert problem.read is not None
    assert not rounded(explanation, explanation.choices[0])


def test_mistaken_frames_are_told_though_levels_are_peaked() -> None:
    recording = recorded({}, noise=0.05, cycles=9)
    values, rows = recording.values(ANGLE).copy(), np.arange(20, 1080, 61)
    values[rows] += np.random.default_rng(5).choice([-1.0, 1.0], len(rows)) * 2.5
    assert names(diagnosed(read(changed(recording, **{ANGLE: values})))) == {"marker_outliers"}


def test_tails_of_what_is_read_in_levels_throw_none_far() -> None:
    """Residuals of a sensor with levels are peaked: Student's t would have them go far."""
    problem = posed(recorded({}))
    rng, n = np.random.default_rng(7), len(problem.measured)
    off = np.clip(0.05 * rng.standard_t(1.2, n), -1.2, 1.2)
    odd = problem.train & (np.arange(n) % 120 == 20)
    measured = problem.simulated + np.where(odd, 1.6, off)
    levels = Levels(0.6, 0.0, np.zeros(n), 0.1)
    for read, tails in ((None, True), (measured, False)):
        told = replace(problem, measured=measured, read=read, levels=levels)
        ground = ground_of(told, NoiseModel(0.1), problem.train & ~odd)
        explanation = replace(explanation_of([chosen(ground, 0.0)]), outliers=odd)
        assert of_heavy_tails(explanation) == tails


def test_the_places_that_a_command_comes_back_to_are_no_levels() -> None:
    rng = np.random.default_rng(4)
    places = np.tile(np.arange(15.0, 60.0, 10.0), 20)
    readings = places + 0.01 * rng.standard_normal(100)
    readings[5:10] = readings[:5]
    assert levels_read(readings, readings) is None
    assert levels_read(places, places) is not None
