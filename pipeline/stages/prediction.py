"""Prediction: what the corrected simulation says for any commands."""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from pipeline.discrepancy.model import CorrectedModel, ModelError
from pipeline.errors import refusal
from pipeline.physics.motion import Motion
from pipeline.recording import Recording


def predict(
    models: Sequence[CorrectedModel],
    recording: Recording,
    simulated: Callable[[Recording, str], np.ndarray] | None = None,
) -> pd.DataFrame:
    """`time_s`, and of each measurement `<name>_predicted` and `<name>_std`, row by row.

    The recording's motion is taken from its first row on, by its commands alone. A model that is
    driven by a simulation's trace asks `simulated` for it (or takes the recording's own channel).
    Raises ModelError where a channel that a model needs is missing.
    """
    out = pd.DataFrame({"time_s": recording.values("time_s")})
    for model in models:
        expected, deviation = model.predict(motion_for(model, recording, simulated))
        out[f"{model.measurement}_predicted"] = expected
        out[f"{model.measurement}_std"] = deviation
    return out


def motion_for(
    model: CorrectedModel,
    recording: Recording,
    simulated: Callable[[Recording, str], np.ndarray] | None,
) -> Motion:
    """What drives a model in this recording."""
    commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
    if model.static:
        if model.drive not in commands:
            raise ModelError(
                refusal("recording", f"the command {model.drive!r} that the model was fitted with",
                        f"commands {', '.join(commands) or 'none'}", "Name the channel so.")
            )  # fmt: skip
        drive = commands.pop(model.drive)
    else:
        drive = _trace(model, recording, simulated)
        commands.pop(model.drive, None)
    return Motion(
        drive=np.ascontiguousarray(drive, dtype=float),
        time_s=recording.values("time_s"),
        cycle=recording.values("cycle").astype(np.int64),
        others=commands,
        radian=model.radian,
    )


def _trace(
    model: CorrectedModel,
    recording: Recording,
    simulated: Callable[[Recording, str], np.ndarray] | None,
) -> np.ndarray:
    channel = recording.simulation_of(model.measurement)
    if channel is not None:
        return recording.values(channel.name)
    if simulated is None:
        raise ModelError(
            refusal("recording", f"a simulation channel of {model.measurement!r}", "none",
                    "The model corrects a simulation's trace: add that channel.")
        )  # fmt: skip
    return simulated(recording, model.measurement)
