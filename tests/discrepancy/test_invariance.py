"""What changes nothing of the physics changes nothing of the diagnosis."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

from pipeline.config import DiagnosisConfig, ToleranceConfig
from pipeline.discrepancy.fitting.fit import evaluate, improve
from pipeline.discrepancy.fitting.ground import ground_of
from pipeline.discrepancy.model.intervals import covariance_of
from pipeline.discrepancy.model.result import Diagnosis
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.catalogue import term
from pipeline.physics.piece import Piece
from pipeline.recording import Channel, Recording, with_context
from pipeline.stages.diagnosis import diagnose
from tests.discrepancy.made import ANGLE, SIMULATED, STEPS, changed, recorded

COMMAND, OTHER = "pitch_command_deg", "yaw_command_deg"
TO_COUNTS, TO_METRES = 2.0**12, 2.0**-14


@dataclass(frozen=True)
class Said:
    """What of a diagnosis no unit changes; sizes in the units that the recording had before."""

    verdict: str
    names: dict[str, tuple[str, ...]]
    after: float
    noise: float


def said(diagnosis: Diagnosis, unit: float = 1.0) -> Said:
    names = {p.name: p.alternatives for p in diagnosis.physics}
    after, noise = diagnosis.after.heldout_rmse / unit, diagnosis.noise / unit
    return Said(diagnosis.verdict, names, after, noise)


def same(one: Said, other: Said, within: float = 1e-3) -> bool:
    sizes = (one.after, one.noise) == pytest.approx((other.after, other.noise), rel=within)
    return (one.verdict, one.names) == (other.verdict, other.names) and sizes


def told(recording: Recording, unit: float = 1.0) -> Said:
    """The diagnosis of a measurement in a unit so much smaller, its tolerance declared in it."""
    tolerance = ToleranceConfig(offset=2.0 * unit)
    result = diagnose(replace(DiagnosisConfig(), tolerance=tolerance), recording)
    return said(result.diagnoses[0], unit)


def in_units(recording: Recording, angle: float, command: float, unit: str) -> Recording:
    """The same in other units, under names that say nothing of them."""
    sizes = {COMMAND: command, OTHER: command, ANGLE: angle, SIMULATED: angle}
    names = {n: n.removesuffix("_deg") for n in sizes}
    samples = recording.samples.assign(**{n: k * recording.samples[n] for n, k in sizes.items()})
    channels = tuple(
        Channel(names[c.name], c.role, unit, c.of and names[c.of]) for c in recording.channels
    )
    return Recording(samples.rename(columns=names), channels)


def shifted(recording: Recording, **by: float) -> Recording:
    """The same with so much added to some columns."""
    samples = recording.samples.assign(**{n: recording.samples[n] + k for n, k in by.items()})
    return replace(recording, samples=samples)


HIDDEN = {
    "play": {"backlash": {"width": 4.0}},
    "stop": {"end_stop/upper": {"angle": 25.0, "softness": 0.3}},
}


@pytest.mark.parametrize(
    ("hidden", "angle", "command"),
    [("stop", TO_COUNTS, 1.0), ("stop", TO_METRES, 1.0), ("play", 1.0, TO_METRES)],
)
@pytest.mark.long
def test_units_change_nothing(hidden, angle, command):
    recording = recorded(HIDDEN[hidden], seed=5)
    counted = told(in_units(recording, 1.0, 1.0, "counts"))
    assert same(counted, told(in_units(recording, angle, command, "counts"), angle))


@pytest.mark.parametrize(("unit", "size"), [("rad", np.pi / 180.0), ("mrad", 1e3 * np.pi / 180.0)])
def test_an_angle_is_one_in_every_unit(unit, size):
    recording = recorded({"gravity": {"deflection": 3.0, "zero": 1.2}}, seed=6)
    degrees = told(recording)
    assert "gravity" in {n for name, others in degrees.names.items() for n in (name, *others)}
    assert same(degrees, told(in_units(recording, size, size, unit), size), 0.01)


@pytest.mark.long
def test_clocks_and_signs_change_nothing():
    recording = recorded(HIDDEN["play"], seed=7)
    as_it_is = told(recording)
    assert same(as_it_is, told(shifted(recording, time_s=1.7e9)))
    flipped = in_units(recording, -1.0, -1.0, "deg")
    assert same(as_it_is, told(flipped))


@pytest.mark.long
def test_where_another_command_counts_from_changes_nothing():
    hidden = {f"coupling/{OTHER}": {"gain": 0.1}, "backlash": {"width": 4.0}}
    recording = recorded(hidden, seed=8, two_axes=True)
    as_it_is = told(recording)
    assert set(as_it_is.names) == {"backlash", "coupling"}
    assert same(as_it_is, told(shifted(recording, **{OTHER: 300.0})), 0.02)


def test_where_an_angle_counts_from_changes_nothing():
    recording = recorded(HIDDEN["stop"], seed=9, gain=1.03, offset=0.5)
    far = shifted(recording, **{ANGLE: 1000.0, SIMULATED: 1000.0})
    as_it_is, away = told(recording), told(far)
    assert set(away.names) == set(as_it_is.names) == {"end_stop"}


def posed(recording: Recording) -> Problem:
    angle, simulated = (n.removesuffix("_deg") for n in (ANGLE, SIMULATED))
    return pose_problem(DiagnosisConfig(), recording, angle, recording.values(simulated))


def test_a_fit_moves_parameters_of_any_size():
    recording = recorded({}, seed=12, noise=0.05)
    bent = recording.values(SIMULATED)
    bent = bent + 3.0 * (bent / 40.0) ** 3 - 4.0 * (bent / 40.0) ** 5
    recording = changed(recording, **{ANGLE: recording.values(ANGLE) + bent})
    found = []
    for size in (1.0, TO_METRES):
        problem = posed(in_units(recording, size, 1.0, "counts"))
        lens = term("lens_distortion", "second")
        ground = ground_of(problem, NoiseModel(0.05 * size), problem.train)
        start = lens.candidates(problem.motion, problem.around)[2]
        fit = improve(evaluate(ground, [Piece(lens, start)]))
        sizes = np.array([size**-2, size, size**-4])
        deviations = np.sqrt(np.diag(covariance_of(fit)))[-3:]
        found.append((fit.pieces[0].values / sizes, deviations / sizes))
    assert found[1][0] == pytest.approx(found[0][0], rel=1e-3)
    assert found[1][1] == pytest.approx(found[0][1], rel=1e-3)


def test_cycles_are_found_alike_in_every_unit():
    t = np.arange(2000) * 0.1
    wire, bend = 10.0 * np.sin(0.5 * t), 20.0 * np.sin(0.03 * t)
    channels = (
        Channel("wire_command", "command", "mm"),
        Channel("bend_command", "command", "deg"),
        Channel("out", "measurement", "mm"),
    )

    def cycles(size: float, more: np.ndarray) -> np.ndarray:
        columns = {"wire_command": size * wire, "bend_command": bend + more, "out": wire}
        return with_context(pd.DataFrame({"time_s": t, **columns}), channels)["cycle"].to_numpy()

    known = cycles(1.0, 0.0 * t)
    assert known.max() >= 10
    assert np.array_equal(known, cycles(1e-3, 0.0 * t))
    assert np.array_equal(known, cycles(1.0, np.random.default_rng(0).standard_normal(len(t))))


def test_commands_held_over_many_rows_change_nothing():
    recording = recorded(HIDDEN["play"], seed=11, cycles=9, noise=0.1)
    slow = lfilter([0.16], [1.0, -0.6], np.random.default_rng(3).standard_normal(9 * STEPS))
    recording = changed(recording, **{ANGLE: recording.values(ANGLE) + slow})
    rows, last = np.repeat(np.arange(len(recording.samples)), 10), slice(9, None, 10)
    held = recording.samples.iloc[rows].reset_index(drop=True)
    held["time_s"] = np.interp(np.arange(len(rows)), np.arange(len(rows))[last],
                               recording.values("time_s"))  # fmt: skip
    seen = np.full(len(rows), np.nan)
    seen[last] = recording.values(ANGLE)
    held[ANGLE] = seen
    assert same(told(recording), told(replace(recording, samples=held)), 0.02)
