"""The robot, cameras and clock that a configuration names, opened together and closed together."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

from pipeline.clock import Clock, RealClock, SimulatedClock
from pipeline.config import CameraConfig, Config
from pipeline.errors import UsageError, refusal
from pipeline.hardware.camera import Camera
from pipeline.hardware.epos2 import Epos2, qc_per_deg
from pipeline.hardware.epos2_emulator import Epos2Emulator
from pipeline.hardware.epos2_line import Epos2Line
from pipeline.hardware.folder_camera import FolderCamera
from pipeline.hardware.robot import Robot
from pipeline.hardware.v4l2 import V4l2Camera
from pipeline.twin.microscope import TwinCamera
from pipeline.twin.snake import Snake

TWIN = "twin"
CAMERAS: dict[str, Callable[[str, CameraConfig], Camera]] = {
    "v4l2": V4l2Camera,
    "folder": FolderCamera,
}


@dataclass(frozen=True)
class Laboratory:
    """What one session works with; `truth` tells the twin's true pose [deg], where there is one."""

    robot: Robot
    cameras: Mapping[str, Camera]
    clock: Clock
    truth: Callable[[], Mapping[str, float]] | None


@contextmanager
def open_laboratory(config: Config, axes: Sequence[str], seed: int) -> Iterator[Laboratory]:
    """Open the robot and the cameras that see `axes`; `seed` is of the twin's noise.

    UsageError for a mixture of real and simulated parts that can't work together.
    """
    _check(config)
    clock = SimulatedClock() if config.acquisition.clock == "simulated" else RealClock()
    with ExitStack() as stack:
        port, emulator = config.robot.port, None
        if config.robot.kind == "emulated":
            qc_per_turn = qc_per_deg(config.robot) * 360.0
            emulator = stack.enter_context(
                Epos2Emulator(config.robot.nodes, clock, config.robot.baud, qc_per_turn)
            )
            port = emulator.port
        line = Epos2Line(port, config.robot.baud)
        stack.callback(line.close)
        robot = Epos2(line, config.robot, clock)
        truth = None
        if config.camera.kind == TWIN and emulator is not None:
            snake = Snake(config.twin, seed)
            truth = snake.pose_deg
            cameras = _microscopes(config, axes, seed, snake, emulator, clock)
        else:
            camera_of = CAMERAS[config.camera.kind]
            cameras = {axis: camera_of(axis, config.camera) for axis in axes}
        for camera in cameras.values():
            stack.callback(camera.close)
        yield Laboratory(robot, cameras, clock, truth)


def _check(config: Config) -> None:
    if config.camera.kind not in (TWIN, *CAMERAS):
        raise UsageError(
            refusal("configuration, camera.kind", f"one of {', '.join((TWIN, *CAMERAS))}",
                    repr(config.camera.kind), "Choose one.")
        )  # fmt: skip
    real_robot = config.robot.kind != "emulated"
    if real_robot and config.camera.kind == TWIN:
        raise UsageError(
            refusal("configuration, camera", "a camera that sees the real robot", "camera=twin",
                    "Choose camera=v4l2, or robot=emulated.")
        )  # fmt: skip
    if real_robot and config.acquisition.clock != "real":
        raise UsageError(
            refusal("configuration, acquisition.clock", "real time for a real robot",
                    config.acquisition.clock, "Say acquisition.clock=real.")
        )  # fmt: skip


def _microscopes(
    config: Config,
    axes: Sequence[str],
    seed: int,
    snake: Snake,
    emulator: Epos2Emulator,
    clock: Clock,
) -> dict[str, Camera]:
    """A rendered microscope for each axis; the snake follows the shafts when it is looked at."""

    def pose_of(axis: str) -> Callable[[], float]:
        def look() -> float:
            snake.move(clock.now_s(), emulator.shaft_deg())
            return snake.seen_deg()[axis]

        return look

    return {
        axis: TwinCamera(axis, pose_of(axis), config.camera, seed + number)
        for number, axis in enumerate(axes, start=1)
    }
