"""Acquisition: move, pause, take an image and read the encoders, one sample at a time."""

import logging
from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np
import pandas as pd

from pipeline.clock import Clock
from pipeline.commands import SUFFIX
from pipeline.config import AcquisitionConfig
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.hardware.camera import Camera
from pipeline.hardware.robot import Robot
from pipeline.recording import Channel, Recording

LATE_S = 0.01

log = logging.getLogger(__name__)


class Sink(Protocol):
    """Where samples go; `write` returns when the sample and its frames are safe."""

    def write(self, row: Mapping[str, float], frames: Mapping[str, bytes]) -> None: ...


def channels_of(config: AcquisitionConfig) -> tuple[Channel, ...]:
    """What is recorded: a command and an encoder channel for each axis [deg of shaft]."""
    kinds = ("command", "encoder")
    return tuple(Channel(f"{a}_{kind}_deg", kind, "deg") for kind in kinds for a in config.axes)


def protocol(config: AcquisitionConfig, axis: str) -> pd.DataFrame:
    """The paper's commands for one axis, the others at 0: `cycle`, `step`, a column for each axis.

    A cycle goes 0, +A, 0, -A, 0 in `steps_per_cycle` equal steps; a row is where a step ends.
    """
    _check_protocol(config, axis)
    steps = config.steps_per_cycle
    turn = np.arange(1, steps + 1) / steps
    triangle = np.interp(turn, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    commands = {f"{a}{SUFFIX}": np.zeros(config.cycles * steps) for a in config.axes}
    commands[f"{axis}{SUFFIX}"] = np.tile(config.amplitude_deg[axis] * triangle, config.cycles)
    cycle = np.repeat(np.arange(config.cycles), steps)
    step = np.tile(np.arange(steps), config.cycles)
    return pd.DataFrame({"cycle": cycle, "step": step, **commands})


def acquire(
    config: AcquisitionConfig,
    commands: pd.DataFrame,
    robot: Robot,
    cameras: Mapping[str, Camera],
    clock: Clock,
    sink: Sink,
    source: str = "real",
    progress: Callable[[], object] = lambda: None,
) -> Recording:
    """Send every command, record a sample after each, and leave the robot at home, disabled.

    `commands` has `cycle`, `step` and `<axis>_command_deg`; each sample is taken `pause_s` after
    its move. With `time_s` too, the first sample is, and the others keep that table's times.
    `time_s` of the recording is the clock's when the images were taken; `progress` is called
    after each sample. Whatever happens in the middle, Ctrl-C too, the robot is stopped and
    disabled, the sink has all samples so far, and the exception goes on.
    """
    _check_limits(commands, robot)
    rows: list[dict[str, float]] = []
    try:
        robot.start()
        first_s: float | None = None
        late_s: list[float] = []
        for _, command in commands.iterrows():
            robot.move_to({a: float(command[f"{a}{SUFFIX}"]) for a in config.axes})
            if first_s is None or "time_s" not in command:
                clock.sleep_s(config.pause_s)
            else:
                due_s = first_s + command["time_s"] - commands["time_s"].iloc[0]
                late_s.append(clock.now_s() - due_s)
                clock.sleep_s(-late_s[-1])
            frames = {name: camera.grab() for name, camera in cameras.items()}
            now_s = clock.now_s()
            first_s = now_s if first_s is None else first_s
            rows.append(_sample(config, command, now_s, robot.read_deg()))
            sink.write(rows[-1], frames)
            progress()
        _tell_late(np.asarray(late_s))
        robot.move_to(dict.fromkeys(config.axes, 0.0))
    except BaseException as error:
        _stop_after(error, robot)
        raise
    robot.stop()
    return Recording(pd.DataFrame(rows), channels_of(config), source)


def _sample(
    config: AcquisitionConfig,
    command: pd.Series,
    now_s: float,
    encoders_deg: Mapping[str, float],
) -> dict[str, float]:
    row: dict[str, float] = {
        "time_s": now_s,
        "cycle": int(command["cycle"]),
        "step": int(command["step"]),
    }
    row |= {f"{a}{SUFFIX}": float(command[f"{a}{SUFFIX}"]) for a in config.axes}
    return row | {f"{a}_encoder_deg": encoders_deg[a] for a in config.axes}


def _stop_after(error: BaseException, robot: Robot) -> None:
    try:
        robot.stop()
    except LoopgapError as failure:
        log.error("%s", failure)
        error.add_note(str(failure))


def _tell_late(late_s: np.ndarray) -> None:
    late_s = late_s[late_s > LATE_S]
    if late_s.size:
        log.warning(
            "%d samples were taken later than commanded, the latest by %.2f s: "
            "the robot needs more time between them",
            late_s.size,
            late_s.max(),
        )


def _check_limits(commands: pd.DataFrame, robot: Robot) -> None:
    for axis, limit_deg in robot.limits_deg.items():
        farthest_deg = float(commands[f"{axis}{SUFFIX}"].abs().max())
        if farthest_deg > limit_deg:
            raise UsageError(
                refusal(f"{axis}{SUFFIX}", f"commands within +-{limit_deg:g} deg",
                        f"{farthest_deg:g} deg", f"Command less, or raise `robot.limit_deg.{axis}`"
                        " if the mechanism allows it.")
            )  # fmt: skip


def _check_protocol(config: AcquisitionConfig, axis: str) -> None:
    if axis not in config.axes or axis not in config.amplitude_deg:
        raise UsageError(
            refusal("acquisition", f"axis {axis!r} in `axes` and `amplitude_deg`",
                    f"axes {list(config.axes)}, amplitudes of {list(config.amplitude_deg)}",
                    "Add what is missing.")
        )  # fmt: skip
    if config.steps_per_cycle < 4 or config.steps_per_cycle % 4:
        raise UsageError(
            refusal("acquisition.steps_per_cycle", "a multiple of 4, so that a step ends at each "
                    "reversal", f"{config.steps_per_cycle}", "200 is the paper's.")
        )  # fmt: skip
    if config.cycles < 1:
        raise UsageError(
            refusal("acquisition.cycles", "at least 1", f"{config.cycles}", "9 is the paper's.")
        )
