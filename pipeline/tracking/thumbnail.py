"""A frame small enough to keep a thousand of them in one review."""

import cv2
import numpy as np

WIDTH_PX = 640
QUALITY = 80


def small_jpeg(frame: bytes | None) -> tuple[bytes, int] | None:
    """A frame as a JPEG at most 640 px wide, and by what it was shrunk; None if unreadable."""
    data = np.frombuffer(frame or b"", np.uint8)
    image = cv2.imdecode(data, cv2.IMREAD_REDUCED_COLOR_2) if data.size else None
    if image is None:
        return None
    shrink = 2
    while image.shape[1] > WIDTH_PX:
        image = cv2.resize(image, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        shrink *= 2
    if shrink == 2 and 2 * image.shape[1] <= WIDTH_PX:
        return bytes(data), 1
    _, jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return jpeg.tobytes(), shrink
