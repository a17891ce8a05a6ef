"""From a configuration to a connected robot and open cameras."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager

from pipeline.clock import Clock
from pipeline.config import CameraConfig, RobotConfig
from pipeline.errors import UsageError, refusal
from pipeline.hardware.camera import Camera
from pipeline.hardware.epos2 import Epos2, qc_per_deg
from pipeline.hardware.epos2_emulator import Epos2Emulator
from pipeline.hardware.epos2_line import Epos2Line
from pipeline.hardware.folder_camera import FolderCamera
from pipeline.hardware.v4l2 import V4l2Camera

CAMERAS: dict[str, Callable[[str, CameraConfig], Camera]] = {
    "v4l2": V4l2Camera,
    "folder": FolderCamera,
}


@contextmanager
def connected_robot(
    config: RobotConfig, clock: Clock
) -> Iterator[tuple[Epos2, Epos2Emulator | None]]:
    """The robot of `config`, and its emulator where it is emulated; closed at the end."""
    with ExitStack() as stack:
        emulator = None
        port = config.port
        if config.kind == "emulated":
            emulator = stack.enter_context(
                Epos2Emulator(config.nodes, clock, config.baud, qc_per_deg(config) * 360)
            )
            port = emulator.port
        elif config.kind != "epos2":
            raise UsageError(
                refusal("robot.kind", "emulated or epos2", repr(config.kind), "Choose one.")
            )
        line = Epos2Line(port, config.baud)
        stack.callback(line.close)
        yield Epos2(line, config, clock), emulator


@contextmanager
def open_cameras(config: CameraConfig, names: Sequence[str]) -> Iterator[dict[str, Camera]]:
    """The cameras of this machine or of stored images, by name; closed at the end."""
    if config.kind not in CAMERAS:
        raise UsageError(
            refusal("camera.kind", "v4l2 or folder", repr(config.kind), "Choose one of these.")
        )
    with ExitStack() as stack:
        cameras: dict[str, Camera] = {}
        for name in names:
            cameras[name] = CAMERAS[config.kind](name, config)
            stack.callback(cameras[name].close)
        yield cameras
