"""The bending angle in one frame: from the base line l1 to the line l2 through both markers."""

import math
from dataclasses import dataclass

import cv2
import numpy as np

from pipeline.config import VisionConfig
from pipeline.errors import LoopgapError, refusal
from pipeline.vision.base_line import Line, find_base_line
from pipeline.vision.markers import Blob, Pair, find_pair


@dataclass(frozen=True)
class MarkerLine:
    """The line l2: centres of both markers (x, y) [px from the centre of the upper left pixel] and
    the direction from green to red [deg, counter-clockwise]."""

    green_px: tuple[float, float]
    red_px: tuple[float, float]
    direction_deg: float


@dataclass(frozen=True)
class FrameMeasurement:
    """What one frame shows: both lines where they were found and, from both, the bending angle
    [deg, counter-clockwise from base to markers]; NaN and the reason where one is missing."""

    angle_deg: float
    markers: MarkerLine | None
    base: Line | None
    reason: str = ""


def decode(jpeg: bytes, where: str) -> np.ndarray:
    """The (h, w, 3) BGR image of an encoded frame; LoopgapError naming `where` if there is none."""
    data = np.frombuffer(jpeg, np.uint8)
    image = cv2.imdecode(data, cv2.IMREAD_COLOR) if data.size else None
    if image is None:
        raise LoopgapError(
            refusal(where, "an image", f"{len(jpeg)} bytes that are none",
                    "Take the file out (the frame then counts as lost), or record it anew.")
        )  # fmt: skip
    return image


def measure_frame(image: np.ndarray, config: VisionConfig) -> FrameMeasurement:
    """Markers, lines and bending angle in a (h, w, 3) BGR image."""
    pair = find_pair(image, config)
    base = find_base_line(image, config.base_region)
    markers = None if isinstance(pair, str) else marker_line(pair)
    line = None if isinstance(base, str) else base
    if markers is None or line is None:
        reason = "; ".join(missing for missing in (pair, base) if isinstance(missing, str))
        return FrameMeasurement(math.nan, markers, line, reason)
    turn_deg = markers.direction_deg - line.direction_deg
    return FrameMeasurement((turn_deg + 180.0) % 360.0 - 180.0, markers, line)


def marker_line(pair: Pair) -> MarkerLine:
    """The line through the centres of both markers.

    A centre is the median of the marker's pixels, interpolated within the pixel, along and across
    the line through both markers: a median along the image's own axes would turn a marker that
    is hidden in part into an error of the angle.
    """
    step = pair.red.centre_px - pair.green.centre_px
    along = step / np.linalg.norm(step)
    frame = np.stack([along, [-along[1], along[0]]])
    green, red = (_median_centre(blob, frame) for blob in (pair.green, pair.red))
    x, y = red - green
    direction_deg = math.degrees(math.atan2(-y, x))
    return MarkerLine(
        (float(green[0]), float(green[1])), (float(red[0]), float(red[1])), direction_deg
    )


def interpolated_median(values: np.ndarray, width: float) -> float:
    """Median of values (n,) each of which is spread evenly over `width`.

    With whole numbers and width 1 it is the interpolated median of grouped data.
    """
    middle = float(np.median(values))
    below = float(np.count_nonzero(values < middle - width))
    near = values[np.abs(values - middle) <= width]
    low, high = middle - width / 2, middle + width / 2
    while high - low > 1e-4 * width:
        guess = (low + high) / 2
        share = below + np.clip((guess - near) / width + 0.5, 0.0, 1.0).sum()
        low, high = (guess, high) if share < len(values) / 2 else (low, guess)
    return (low + high) / 2


def _median_centre(blob: Blob, frame: np.ndarray) -> np.ndarray:
    """Centre (x, y) of a blob by medians along the rows of `frame`, two unit vectors, (2, 2)."""
    width = float(np.abs(frame[0]).sum())
    medians = np.array([interpolated_median(blob.pixels @ axis, width) for axis in frame])
    return medians @ frame
