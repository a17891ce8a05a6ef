"""Diagnosis: what the simulation of each measurement left out."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.diagnose import diagnose_measurement
from pipeline.discrepancy.model.result import DiagnosisResult
from pipeline.discrepancy.problem.driven import DiagnosisError
from pipeline.discrepancy.problem.force_problem import pose_force_problem
from pipeline.discrepancy.problem.known_rows import FEWEST_SAMPLES
from pipeline.discrepancy.problem.posing import pose_problem
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.scale import refuse_other_scales
from pipeline.discrepancy.problem.turns import unwrapped
from pipeline.errors import refusal
from pipeline.physics.force_motion import position_of
from pipeline.recording import Recording

LEAPS = "{name} leaps by a whole turn {count} times, as a sensor of one turn: its turns were added."


def diagnose(
    config: DiagnosisConfig,
    recording: Recording,
    say: Callable[[str], object] = lambda _: None,
) -> DiagnosisResult:
    """Name the physics that the simulation of each measurement left out.

    Every measurement needs its simulation channel in the recording (see `stages/simulation.py`).
    `say` is told which measurement is begun.
    Raises DiagnosisError where it has none, where there are too few samples, or where numbers are
    too large or too close to each other to reckon with.
    """
    recording.require(FEWEST_SAMPLES, "a diagnosis")
    measurements = recording.with_role("measurement")
    if not measurements:
        raise DiagnosisError(
            refusal(
                "recording", "a channel of role 'measurement'", "none", "Add what was measured."
            )
        )
    recording, leapt = unwrapped(recording)
    refuse_other_scales(recording)
    found = []
    for measurement in (m.name for m in measurements):
        say(measurement)
        problem = posed(config, recording, measurement)
        found.append(diagnose_measurement(recording, measurement, problem))
    leaps = tuple(LEAPS.format(name=name, count=count) for name, count in leapt.items())
    return DiagnosisResult(
        tuple(replace(d, notes=(*leaps, *d.notes)) for d, _, _ in found),
        tuple(e for _, e, _ in found),
        tuple(m for _, _, m in found),
    )


def posed(config: DiagnosisConfig, recording: Recording, measurement: str) -> Problem:
    """The problem of a measurement: a force against motion, or an angle behind a command."""
    simulation = simulated(recording, measurement)
    position = position_of(recording, measurement)
    if position is None:
        return pose_problem(config, recording, measurement, simulation)
    return pose_force_problem(config, recording, measurement, position, simulation)


def simulated(recording: Recording, measurement: str) -> np.ndarray:
    """The simulation of a measurement, (n,)."""
    channel = recording.simulation_of(measurement)
    if channel is None:
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "a simulation channel of it",
                "none",
                "Add the channel, or choose a simulation with `simulation=`.",
            )
        )
    return recording.values(channel.name)
