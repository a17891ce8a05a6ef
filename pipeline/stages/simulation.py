"""Simulation: what a model says for the commands of a recording that brings no simulation."""

import importlib
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.config import SimulationConfig
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.physics.assembly import pieces_of
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.term import Surroundings
from pipeline.recording import CONTEXT_COLUMNS, Channel, Recording


def simulate(config: SimulationConfig, recording: Recording) -> Recording:
    """The recording with a simulation channel for each measurement that has none.

    A recorded simulation always stays. UsageError where nothing simulates a measurement.
    """
    lacking = [
        c for c in recording.with_role("measurement") if recording.simulation_of(c.name) is None
    ]
    if not lacking:
        return recording
    if config.kind == "python":
        answers = _call(config.function, recording, lacking)
    elif config.kind == "mechanism":
        answers = [_mechanism_answer(config, recording, c.name) for c in lacking]
    else:
        raise UsageError(
            refusal("recording", f"a simulation channel of {lacking[0].name!r}", "none",
                    "Add one, or choose simulation=kinematic or simulation=python.")
        )  # fmt: skip
    for channel, values in zip(lacking, answers, strict=True):
        stem, _, unit = channel.name.rpartition("_")
        name = f"{stem}_sim_{unit}" if stem else f"{unit}_sim"
        recording = recording.with_channel(
            Channel(name, "simulation", channel.unit, of=channel.name), values
        )
    return recording


def _mechanism_answer(config: SimulationConfig, recording: Recording, name: str) -> np.ndarray:
    if name not in config.axes:
        raise UsageError(
            refusal("simulation.axes", f"a mechanism for {name!r}",
                    ", ".join(config.axes) or "none",
                    "Add one there, or a simulation channel to the recording.")
        )  # fmt: skip
    axis = config.axes[name]
    command = recording.channel(axis.command)
    others = {
        c.name: recording.values(c.name)
        for c in recording.with_role("command")
        if c.name != command.name
    }
    motion = Motion(
        drive=recording.values(command.name),
        time_s=recording.values("time_s"),
        cycle=recording.values("cycle").astype(int),
        others=others,
    )
    around = Surroundings(other_span={n: float(np.ptp(v)) for n, v in others.items()})
    mechanism = Mechanism(CubicCurve(axis.gain, axis.cubic), pieces_of(axis.terms, around))
    return mechanism.respond(motion)[0]


def _call(path: str | None, recording: Recording, lacking: Sequence[Channel]) -> list[np.ndarray]:
    names = [c.name for c in recording.with_role("command")]
    table = recording.samples[[*CONTEXT_COLUMNS, *names]].copy()
    answer = np.asarray(_function(path)(table), dtype=float)
    expected = (len(table),) if len(lacking) == 1 else (len(table), len(lacking))
    if answer.shape != expected:
        raise LoopgapError(
            refusal(f"simulation.function={path}", f"an array of shape {expected}",
                    f"shape {answer.shape}", "Return a row for each of the table, and a column for "
                    "each measurement without a simulation.")
        )  # fmt: skip
    return list(answer.reshape(len(table), len(lacking)).T)


def _function(path: str | None) -> Callable[[pd.DataFrame], object]:
    module, _, name = (path or "").partition(":")
    if not module or not name:
        raise UsageError(
            refusal("simulation.function", "module:function", repr(path),
                    "Say simulation.function=my_model:simulate.")
        )  # fmt: skip
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        function = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise UsageError(
            refusal(f"simulation.function={path}", "a function that can be imported", str(error),
                    f"Start loopgap in the folder of {module}.py, or install it.")
        ) from error  # fmt: skip
    return function
