"""Images of ROS messages as JPEG."""

from typing import Any

import cv2
import numpy as np

from pipeline.errors import refusal
from pipeline.foreign.table import ForeignFileError

COMPRESSED = "sensor_msgs/msg/CompressedImage"
IMAGES = ("sensor_msgs/msg/Image", COMPRESSED)
JPEG_QUALITY = 98
JPEG_START = b"\xff\xd8\xff"
TO_BGR: dict[str, int | None] = {
    "mono8": None, "8UC1": None, "bgr8": None, "8UC3": None,
    "rgb8": cv2.COLOR_RGB2BGR, "rgba8": cv2.COLOR_RGBA2BGR, "bgra8": cv2.COLOR_BGRA2BGR,
}  # fmt: skip


def encoded(where: str, message: Any) -> bytes:
    """The image of a message as JPEG: as it is where it is one, else encoded at quality 98."""
    if hasattr(message, "format"):
        data = message.data.tobytes()
        if data.startswith(JPEG_START):
            return bytes(data)
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
        if image is None:
            raise _refuse(where, f"{len(data)} bytes of format {message.format!r}")
    else:
        image = _raw(where, message)
    return cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()


def _raw(where: str, message: Any) -> np.ndarray:
    if message.encoding not in TO_BGR:
        raise _refuse(where, f"encoding {message.encoding!r}")
    rows = message.data.reshape(message.height, message.step)
    channels = {"mono8": 1, "8UC1": 1, "rgba8": 4, "bgra8": 4}.get(message.encoding, 3)
    pixels = rows[:, : message.width * channels].reshape(message.height, message.width, channels)
    conversion = TO_BGR[message.encoding]
    return pixels if conversion is None else cv2.cvtColor(pixels, conversion)


def _refuse(where: str, found: str) -> ForeignFileError:
    return ForeignFileError(
        refusal(where, f"a JPEG or PNG, or an image of encoding {', '.join(TO_BGR)}", found,
                "Convert the topic to one of these, for instance with image_transport.")
    )  # fmt: skip
