"""Diagnosis: what the simulation of each measurement left out."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.diagnose import diagnose_measurement
from pipeline.discrepancy.problem import FEWEST_SAMPLES, DiagnosisError, pose_problem
from pipeline.discrepancy.result import DiagnosisResult
from pipeline.errors import refusal
from pipeline.recording import Recording

Simulation = Callable[[pd.DataFrame, str], np.ndarray]


def diagnose(
    config: DiagnosisConfig, recording: Recording, simulation: Simulation | None = None
) -> DiagnosisResult:
    """Name the physics that the simulation of each measurement left out.

    A measurement's own simulation channel is its simulation; without one, `simulation` is called
    with the command table and the measurement's name and answers with an array (n,). Raises
    DiagnosisError where a measurement has neither, or too few samples.
    """
    recording.require(FEWEST_SAMPLES, "a diagnosis")
    measurements = recording.with_role("measurement")
    if not measurements:
        raise DiagnosisError(
            refusal("recording", "a channel of role 'measurement'", "none", "Add what was measured.")
        )
    found = [
        diagnose_measurement(
            recording,
            m.name,
            pose_problem(config, recording, m.name, simulated(recording, m.name, simulation)),
        )
        for m in measurements
    ]
    return DiagnosisResult(
        tuple(d for d, _, _ in found),
        tuple(e for _, e, _ in found),
        tuple(m for _, _, m in found),
    )


def simulated(
    recording: Recording, measurement: str, simulation: Simulation | None
) -> np.ndarray:
    """The simulation of a measurement, (n,), from the recording or from a function."""
    channel = recording.simulation_of(measurement)
    if channel is not None:
        return recording.values(channel.name)
    if simulation is None:
        raise DiagnosisError(
            refusal(
                f"measurement {measurement!r}",
                "a simulation channel of it, or `simulation=`",
                "neither",
                "Add the channel, or choose a simulation.",
            )
        )
    commands = [c.name for c in recording.with_role("command")]
    table = recording.samples[["time_s", "cycle", "step", *commands]].copy()
    answer = np.asarray(simulation(table, measurement), dtype=float)
    if answer.shape != (len(table),):
        raise DiagnosisError(
            refusal(
                f"simulation of {measurement!r}",
                f"an array of shape ({len(table)},)",
                f"shape {answer.shape}",
                "Answer with one value for each row of the command table.",
            )
        )
    return answer
