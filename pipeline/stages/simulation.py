"""Simulation: what a model says for the commands of a recording that brings no simulation."""

import importlib
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from pipeline.config import HeldoutConfig, SimulatedAxis, SimulationConfig
from pipeline.discrepancy.problem.known_rows import held_out_rows
from pipeline.discrepancy.problem.line import FEWEST, line_in_a_command
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.physics.assembly import pieces_of
from pipeline.physics.force_motion import position_of
from pipeline.physics.force_units import RADIAN
from pipeline.physics.kinematics import CubicCurve
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.term import Surroundings, TermError
from pipeline.recording import CONTEXT_COLUMNS, Channel, Recording
from pipeline.stages.force_simulation import force_answer

OTHERS = "simulation=identity, affine, trace, mechanism or python"
LONG_S = 10.0
WIDE = 10.0  # bounds of terms: the user may mean another motion than the recorded one


def simulate(
    config: SimulationConfig,
    recording: Recording,
    heldout: HeldoutConfig | None = None,
    trace: pd.DataFrame | None = None,
    cutoff_hz: float | None = None,
) -> Recording:
    """The recording with a simulation channel for each measurement that has none.

    A recorded simulation always stays. heldout: rows that `affine` must not look at. trace: the
    table of kind `trace`, `time_s` and a column for each measurement. cutoff_hz: see
    `differentiate`. A force against motion of which no mechanism is named is simulated as 0, with
    `identity` and `affine`, too.
    UsageError where nothing simulates a measurement.
    """
    lacking = [
        c for c in recording.with_role("measurement") if recording.simulation_of(c.name) is None
    ]
    if not lacking:
        return recording
    if config.kind != "trace" and not recording.with_role("command"):
        raise UsageError(
            refusal("recording", "a channel of role 'command'", "none",
                    "Add what the robot was told: a simulation answers it.")
        )  # fmt: skip
    if config.kind == "python":
        answers = _call(config.function, recording, lacking)
    elif config.kind == "mechanism":
        answers = [_mechanism_answer(config, recording, c.name, cutoff_hz) for c in lacking]
    elif config.kind in ("identity", "affine"):
        answers = [_without_model(config.kind, recording, c, heldout) for c in lacking]
    elif config.kind == "trace" and trace is not None:
        answers = [_resampled(trace, recording, c.name) for c in lacking]
    else:
        raise UsageError(
            refusal("recording", f"a simulation channel of {lacking[0].name!r}", "none",
                    f"Add one, or choose {OTHERS}.")
        )  # fmt: skip
    for channel, values in zip(lacking, answers, strict=True):
        stem, _, unit = channel.name.rpartition("_")
        name = f"{stem}_sim_{unit}" if stem else f"{unit}_sim"
        recording = recording.with_channel(
            Channel(name, "simulation", channel.unit, of=channel.name), values
        )
    return recording


def _without_model(
    kind: str, recording: Recording, channel: Channel, heldout: HeldoutConfig | None
) -> np.ndarray:
    """What is said of a measurement where nobody has a model of it, (n,).

    Nothing, of a force against motion: a line in the position would be a spring, in the velocity a
    dashpot, and both are physics to be named.
    """
    if position_of(recording, channel.name) is not None:
        return np.zeros(len(recording.samples))
    if kind == "identity":
        return _identity(recording, channel)
    return _affine(recording, channel, heldout or HeldoutConfig())


def _identity(recording: Recording, channel: Channel) -> np.ndarray:
    """The command itself: the one of the same axis, or the only one of the same unit."""
    commands = recording.with_role("command")
    alike = [c for c in commands if c.unit == channel.unit]
    kin = [c for c in alike if c.name.split("_")[0] == channel.name.split("_")[0]]
    found = kin or alike
    if len(found) != 1:
        raise UsageError(
            refusal(f"simulation=identity of {channel.name!r}",
                    f"one command in {channel.unit} of the same first name",
                    ", ".join(f"{c.name} [{c.unit}]" for c in found or commands) or "none",
                    "Choose simulation=affine, or rename the command after its measurement.")
        )  # fmt: skip
    return recording.values(found[0].name)


def _affine(recording: Recording, channel: Channel, heldout: HeldoutConfig) -> np.ndarray:
    """Gain and offset of the command that follows the measurement best, on rows not held out."""
    motion = Motion(np.zeros(len(recording.samples)), recording.values("time_s"),
                    recording.values("cycle").astype(np.int64))  # fmt: skip
    measured = recording.values(channel.name)
    known = np.isfinite(measured)
    rows = known & ~held_out_rows(heldout, motion, known)
    commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
    best = line_in_a_command(commands, measured, rows)
    if best is None:
        raise LoopgapError(
            refusal(f"simulation=affine of {channel.name!r}",
                    f"a command that moves over at least {FEWEST} measured rows", "none",
                    "Record motion, or give a simulation channel.")
        )  # fmt: skip
    return best[0]


def _resampled(trace: pd.DataFrame, recording: Recording, name: str) -> np.ndarray:
    """A trace at the recording's times, straight between its samples; empty outside of them."""
    values = trace[name].to_numpy(float)
    known = np.isfinite(values)
    time_s = trace["time_s"].to_numpy(float)[known]
    wanted = recording.values("time_s")
    out = np.interp(wanted, time_s, values[known])
    out[(wanted < time_s[0]) | (wanted > time_s[-1])] = np.nan
    within = int(((time_s >= wanted[0]) & (time_s <= wanted[-1])).sum())
    if within < FEWEST:
        raise LoopgapError(
            refusal(f"simulation.path, column {name!r}",
                    f"at least {FEWEST} samples within {wanted[0]:g} to {wanted[-1]:g} s",
                    f"{within}, its times go from {time_s[0]:g} to {time_s[-1]:g}",
                    "Give the trace's time_s in seconds, beginning as the recording's does.")
        )  # fmt: skip
    return out


def _mechanism_answer(
    config: SimulationConfig, recording: Recording, name: str, cutoff_hz: float | None
) -> np.ndarray:
    position = position_of(recording, name)
    if position is not None:
        return force_answer(config, recording, name, position, cutoff_hz)
    if name not in config.axes:
        raise UsageError(
            refusal(f"simulation of {name!r}",
                    "a simulation channel in the recording, or a mechanism under simulation.axes",
                    f"no such channel, and mechanisms for {', '.join(config.axes) or 'nothing'}",
                    f"simulation=affine needs no model; or add either, or choose {OTHERS}.")
        )  # fmt: skip
    axis = config.axes[name]
    command = recording.channel(axis.command)
    others = {
        c.name: recording.values(c.name)
        for c in recording.with_role("command")
        if c.name != command.name
    }
    unit = recording.channel(name).unit
    motion = Motion(
        drive=recording.values(command.name),
        time_s=recording.values("time_s"),
        cycle=recording.values("cycle").astype(int),
        others=others,
        radian=RADIAN.get(unit, 1.0),
    )
    usual, around = (_surroundings(axis, recording, motion, unit, w) for w in (1.0, WIDE))
    try:
        pieces = pieces_of(axis.terms, around, usual)
    except TermError as error:
        raise UsageError(f"simulation of {name!r}, {error}") from error
    mechanism = Mechanism(CubicCurve(axis.gain, axis.cubic), pieces)
    return mechanism.respond(motion)[0]


def _surroundings(
    axis: SimulatedAxis, recording: Recording, motion: Motion, unit: str, wide: float = 1.0
) -> Surroundings:
    """The recorded motion, `wide` times as wide."""
    span = wide * max(float(np.ptp(motion.drive)), 1e-9)
    angle = abs(axis.gain) * span
    steps = np.diff(motion.time_s)
    return Surroundings(
        drive_span=span,
        drive_low=-0.5 * span,
        angle_span=angle,
        angle_low=-0.5 * angle,
        dwell_s=max(float(np.median(steps)) if len(steps) else 1.0, 1e-9),
        start_s=float(motion.time_s[0]),
        end_s=float(motion.time_s[-1]),
        travel=max(float(np.abs(np.diff(motion.drive)).sum()), 1e-9),
        drive_unit=recording.channel(axis.command).unit,
        angle_unit=unit,
        other_span={n: wide * float(np.ptp(v)) for n, v in motion.others.items()},
        other_unit={n: recording.channel(n).unit for n in motion.others},
    )


def _call(path: str | None, recording: Recording, lacking: Sequence[Channel]) -> list[np.ndarray]:
    names = [c.name for c in recording.with_role("command")]
    table = recording.samples[[*CONTEXT_COLUMNS, *names]].reset_index(drop=True)
    function, where = _function(path), f"simulation.function={path}"
    began_s = time.monotonic()
    try:
        answered = function(table.copy())
        if isinstance(answered, pd.DataFrame) and {*answered} == {c.name for c in lacking}:
            answered = answered[[c.name for c in lacking]]  # named, so in whatever order
        answer = np.asarray(answered, dtype=float)
    except (Exception, SystemExit) as error:
        raise LoopgapError(
            refusal(where, "an array of numbers", _said(error),
                    "Correct the function; it is called with the table of commands.")
        ) from error  # fmt: skip
    took_s = time.monotonic() - began_s
    if took_s > LONG_S:
        print(f"  {where} took {took_s:.0f} s")
    n, m = len(table), len(lacking)
    if answer.shape not in ([(n,), (n, 1)] if m == 1 else [(n, m)]):
        expected = (n,) if m == 1 else (n, m)
        raise LoopgapError(
            refusal(where, f"an array of shape {expected}", f"shape {answer.shape}",
                    "Return a row for each of the table, and a column for each measurement "
                    f"without a simulation ({', '.join(c.name for c in lacking)}).")
        )  # fmt: skip
    bad = int((~np.isfinite(answer)).sum())
    if bad:
        row = int(np.flatnonzero(~np.isfinite(answer.reshape(n, m)).all(axis=1))[0])
        raise LoopgapError(
            refusal(where, "finite numbers", f"{bad} that are none, the first in row {row}",
                    "Let it answer for every row.")
        )  # fmt: skip
    return list(answer.reshape(n, m).T)


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
    except (ImportError, AttributeError, SyntaxError) as error:
        raise UsageError(
            refusal(f"simulation.function={path}", "a function that can be imported", str(error),
                    f"Start loopgap in the folder of {module}.py, or install it.")
        ) from error  # fmt: skip
    except Exception as error:
        raise UsageError(
            refusal(f"simulation.function={path}", "a module that can be imported", _said(error),
                    f"Correct {module}.py.")
        ) from error  # fmt: skip
    return function


def _said(error: BaseException) -> str:
    """Somebody else's error, and the line of theirs that it comes from."""
    frames = traceback.extract_tb(error.__traceback__)[1:]
    theirs = [f for f in frames if "site-packages" not in f.filename and f.filename[:1] != "<"]
    at = f" ({Path(theirs[-1].filename).name}, line {theirs[-1].lineno})" if theirs else ""
    return f"{type(error).__name__}: {error}{at}"
