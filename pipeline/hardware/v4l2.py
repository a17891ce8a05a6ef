"""A camera of this machine, through OpenCV and Video4Linux."""

from pathlib import Path

import cv2
import numpy as np

from pipeline.config import CameraConfig
from pipeline.errors import UsageError, refusal
from pipeline.hardware.robot import HardwareError


class V4l2Camera:
    """`/dev/video<device>` at the configured size, compressed by the camera itself (MJPG)."""

    def __init__(self, name: str, config: CameraConfig) -> None:
        self.name = name
        self._where = f"{name} camera"
        self._config = config
        if name not in config.devices:
            raise UsageError(
                refusal("camera.devices", f"a device number for {name!r}", f"{config.devices}",
                        f"Say `+camera.devices.{name}=0` for /dev/video0.")
            )  # fmt: skip
        self._where += f" (/dev/video{config.devices[name]})"
        self._capture = cv2.VideoCapture(config.devices[name], cv2.CAP_V4L2)
        if not self._capture.isOpened():
            self._capture.release()
            raise HardwareError(
                refusal(self._where, "a camera", f"none ({_present()})",
                        f"Plug it in, set `camera.devices.{name}`, or join the group `video`.")
            )  # fmt: skip
        self._configure()

    def grab(self) -> bytes:
        """The image now: those that waited in the driver since before the call are thrown away."""
        for _ in range(self._config.stale_frames):
            self._capture.grab()
        taken, image = self._capture.read()
        if not taken:
            raise HardwareError(
                refusal(self._where, "an image", "none", "Check its cable and plug it in again.")
            )
        expected = (self._config.height_px, self._config.width_px, 3)
        if image.shape != expected:
            raise HardwareError(
                refusal(self._where, f"images of shape {expected}", f"{image.shape}",
                        "Set `camera.width_px` and `camera.height_px` to a size that it has.")
            )  # fmt: skip
        return encode_jpeg(image, self._config.jpeg_quality)

    def close(self) -> None:
        self._capture.release()

    def _configure(self) -> None:
        """Format first, then size: the other order makes some cameras fall back to raw video."""
        self._capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
        self._capture.set(cv2.CAP_PROP_FRAME_WIDTH, self._config.width_px)
        self._capture.set(cv2.CAP_PROP_FRAME_HEIGHT, self._config.height_px)
        code = int(self._capture.get(cv2.CAP_PROP_FOURCC))
        format_ = code.to_bytes(4, "little").decode("ascii", "replace")
        size = tuple(
            int(self._capture.get(side))
            for side in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
        )
        wanted = (self._config.width_px, self._config.height_px)
        if format_ != "MJPG" or size != wanted:
            self.close()
            raise HardwareError(
                refusal(self._where, f"MJPG of {wanted[0]} x {wanted[1]} px",
                        f"{format_} of {size[0]} x {size[1]} px", "Set `camera.width_px` and "
                        "`camera.height_px` to a size that `v4l2-ctl --list-formats-ext` shows.")
            )  # fmt: skip


def encode_jpeg(image: np.ndarray, quality: int) -> bytes:
    """A BGR image of shape (height, width, 3), uint8, as JPEG bytes."""
    encoded, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not encoded:
        raise HardwareError(
            refusal("image", "an image that JPEG can hold", f"shape {image.shape}", "Check it.")
        )
    return data.tobytes()


def _present() -> str:
    found = sorted(str(path) for path in Path("/dev").glob("video*"))
    return f"present: {', '.join(found)}" if found else "this machine has no /dev/video*"
