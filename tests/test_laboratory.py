"""What a configuration opens: a camera that is one class and one line, and none that is neither."""

import pytest

from pipeline import laboratory
from pipeline.config import CameraConfig, Config, RobotConfig
from pipeline.errors import UsageError


class StillCamera:
    """Somebody's camera."""

    def __init__(self, name: str, config: CameraConfig) -> None:
        self.name, self.seen, self.closed = name, config.jpeg_quality, False

    def grab(self) -> bytes:
        return b""

    def close(self) -> None:
        self.closed = True


def configured(camera: str) -> Config:
    return Config(robot=RobotConfig(kind="emulated"), camera=CameraConfig(camera, jpeg_quality=77))


def test_a_new_camera_is_one_class_and_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(laboratory.CAMERAS, "still", StillCamera)
    with laboratory.open_laboratory(configured("still"), ["yaw"], 0) as opened:
        camera = opened.cameras["yaw"]
        assert isinstance(camera, StillCamera)
        assert (camera.name, camera.seen, camera.closed) == ("yaw", 77, False)
        assert opened.truth is None
    assert camera.closed


def test_a_camera_that_is_none_is_refused_before_anything_is_opened() -> None:
    refused = "camera.kind: expected one of twin, v4l2, folder; found 'stil'"
    with (
        pytest.raises(UsageError, match=refused),
        laboratory.open_laboratory(configured("stil"), ["yaw"], 0),
    ):
        pass
