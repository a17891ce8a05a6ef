"""Prediction: what the corrected simulation says for any commands."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from pipeline.discrepancy.model.model import CorrectedModel, ModelError
from pipeline.discrepancy.problem.cornered import moved_on
from pipeline.discrepancy.problem.counts import between_known_counts
from pipeline.discrepancy.problem.rough import behind_known_noise
from pipeline.errors import refusal
from pipeline.physics.force_motion import force_motion
from pipeline.physics.motion import Motion
from pipeline.recording import Recording


def predict(
    models: Sequence[CorrectedModel], recording: Recording, cutoff_hz: float | None = None
) -> pd.DataFrame:
    """`time_s`, and of each measurement `<name>_predicted` and `<name>_std`, row by row.

    The motion begins with the recording's first row, or goes on where the model's recording ended
    (see `CorrectedModel.predict`); measurements are not looked at. A model that corrects a
    simulation's trace needs that channel in the recording. cutoff_hz: see `differentiate`, where a
    force is predicted. Raises ModelError where a channel that a model needs is missing.
    """
    out = pd.DataFrame({"time_s": recording.values("time_s")})
    for model in models:
        expected, deviation = model.predict(motion_for(model, recording, cutoff_hz))
        out[f"{model.measurement}_predicted"] = expected
        out[f"{model.measurement}_std"] = deviation
    return out


def motion_for(
    model: CorrectedModel, recording: Recording, cutoff_hz: float | None = None
) -> Motion:
    """What drives a model in this recording."""
    commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
    own = commands.pop(model.drive, None) if model.static else None
    if not model.static:
        own = _simulated(model, recording)
    if own is None:
        raise ModelError(
            refusal("recording", f"the command {model.drive!r} that the model was fitted with",
                    f"commands {', '.join(commands) or 'none'}", "Name the channel so.")
        )  # fmt: skip
    if model.force:
        simulated = _simulated(model, recording) if model.simulated else np.zeros(len(own))
        motion = force_motion(recording, model.drive, simulated, cutoff_hz)[0]
        return motion.delayed(model.delay_s)
    drive = between_known_counts(np.ascontiguousarray(own, dtype=float), model.counted)
    time_s = recording.values("time_s")
    motion = Motion(
        drive=behind_known_noise(drive, time_s, model.rough),
        time_s=time_s,
        cycle=recording.values("cycle").astype(np.int64),
        others=commands,
        radian=model.radian,
        zeros=model.zeros,
    )
    return moved_on(motion) if model.cornered else motion


def _simulated(model: CorrectedModel, recording: Recording) -> np.ndarray:
    channel = recording.simulation_of(model.measurement)
    if channel is None:
        raise ModelError(
            refusal("recording", f"a simulation channel of {model.measurement!r}", "none",
                    "The model corrects a simulation: add that channel, or the same `simulation=`.")
        )  # fmt: skip
    return recording.values(channel.name)
