"""The order in which a camera is set up, what is read back, and which image is the newest."""

from typing import Any

import cv2
import numpy as np
import pytest

from pipeline.config import CameraConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.hardware.v4l2 import V4l2Camera

CONFIG = CameraConfig(
    kind="v4l2", width_px=64, height_px=48, devices={"yaw": 0}, stale_frames=4, jpeg_quality=95
)
MJPG = cv2.VideoWriter.fourcc(*"MJPG")
YUYV = cv2.VideoWriter.fourcc(*"YUYV")


class FakeCapture:
    """A camera whose n-th image has the brightness 10 n, and which forgets what it is told to."""

    def __init__(self, forgets: dict[int, float] | None = None, size: tuple[int, int] = (48, 64)):
        self.settings: dict[int, float] = {}
        self.forgets = forgets or {}
        self.size = size
        self.images = 0
        self.plugged = True
        self.released = False

    def isOpened(self) -> bool:  # noqa: N802
        return True

    def set(self, key: int, value: float) -> bool:
        self.settings[key] = self.forgets.get(key, value)
        return True

    def get(self, key: int) -> float:
        return self.settings[key]

    def grab(self) -> bool:
        self.images += 1
        return self.plugged

    def read(self) -> tuple[bool, np.ndarray | None]:
        self.images += 1
        image = np.full((*self.size, 3), 10 * self.images, np.uint8)
        return (True, image) if self.plugged else (False, None)

    def release(self) -> None:
        self.released = True


def opened(capture: FakeCapture, monkeypatch: pytest.MonkeyPatch) -> V4l2Camera:
    def open_capture(device: int, interface: int) -> Any:
        assert (device, interface) == (0, cv2.CAP_V4L2)
        return capture

    monkeypatch.setattr(cv2, "VideoCapture", open_capture)
    return V4l2Camera("yaw", CONFIG)


def test_format_is_set_before_size(monkeypatch: pytest.MonkeyPatch) -> None:
    capture = FakeCapture()
    opened(capture, monkeypatch)
    assert list(capture.settings) == [
        cv2.CAP_PROP_FOURCC,
        cv2.CAP_PROP_FRAME_WIDTH,
        cv2.CAP_PROP_FRAME_HEIGHT,
    ]
    assert capture.settings[cv2.CAP_PROP_FOURCC] == MJPG


def test_stale_images_are_thrown_away(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = opened(FakeCapture(), monkeypatch)
    image = cv2.imdecode(np.frombuffer(camera.grab(), np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    assert image.shape == (48, 64, 3)
    assert np.median(image) == 50


@pytest.mark.parametrize(
    ("forgets", "words"),
    [
        ({cv2.CAP_PROP_FOURCC: YUYV}, "expected MJPG of 64 x 48 px; found YUYV of 64 x 48 px"),
        ({cv2.CAP_PROP_FRAME_WIDTH: 640}, "found MJPG of 640 x 48 px.*`camera.width_px`"),
    ],
)
def test_what_the_camera_did_not_take_is_told(
    monkeypatch: pytest.MonkeyPatch, forgets: dict[int, float], words: str
) -> None:
    capture = FakeCapture(forgets)
    with pytest.raises(LoopgapError, match=words):
        opened(capture, monkeypatch)
    assert capture.released


def test_images_of_another_size_than_promised(monkeypatch: pytest.MonkeyPatch) -> None:
    camera = opened(FakeCapture(size=(24, 32)), monkeypatch)
    with pytest.raises(LoopgapError, match=r"shape \(48, 64, 3\); found \(24, 32, 3\)"):
        camera.grab()


def test_camera_that_went_away(monkeypatch: pytest.MonkeyPatch) -> None:
    capture = FakeCapture()
    camera = opened(capture, monkeypatch)
    capture.plugged = False
    with pytest.raises(LoopgapError, match=r"/dev/video0\): expected an image; found none"):
        camera.grab()


def test_no_camera() -> None:
    config = CameraConfig(kind="v4l2", devices={"yaw": 63})
    with pytest.raises(LoopgapError, match=r"yaw camera \(/dev/video63\): .*found none.*Plug it"):
        V4l2Camera("yaw", config)


def test_no_device_number() -> None:
    with pytest.raises(UsageError, match=r"Say `\+camera\.devices\.pitch=0`"):
        V4l2Camera("pitch", CONFIG)
