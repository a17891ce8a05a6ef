"""Vision: the bending angle in every frame of a recording."""

import math
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np
import pandas as pd

from pipeline.config import VisionConfig
from pipeline.errors import LoopgapError, refusal
from pipeline.recording import Channel, Recording
from pipeline.vision.angle import FrameMeasurement, decode, measure_frame
from pipeline.vision.frames import Frames
from pipeline.vision.gate import flag_outliers

LOST = FrameMeasurement(math.nan, None, None, "no frame")
NOWHERE = (math.nan, math.nan)


@dataclass(frozen=True)
class Vision:
    """`recording` with `<axis>_angle_deg` added, and `markers`: what was seen, a row a frame."""

    recording: Recording
    markers: pd.DataFrame


def measure_angles(
    config: VisionConfig,
    recording: Recording,
    axis: str,
    frames: Frames,
    progress: Callable[[int, int], None] | None = None,
) -> Vision:
    """Measure the bending angle of `axis` in the frames of its camera.

    A frame without a clear pair of markers or base line leaves its angle empty, and `markers` says
    why. Outliers are flagged there and keep their value. `progress` gets (done, all) frames.
    Raises LoopgapError for a frame that is no image, and where not one angle could be measured.
    """
    rows = range(len(recording.samples))
    seen = _measure_all(config, frames, rows, progress)
    angle_deg = np.array([frame.angle_deg for frame in seen])
    if np.isnan(angle_deg).all():
        reason = seen[0].reason if seen else "no rows"
        raise LoopgapError(
            refusal(frames.where(0), "markers in at least one frame",
                    f"none in {len(seen)} ({reason})",
                    "Check camera and vision configuration (colours, marker_separation_mm).")
        )  # fmt: skip
    told = f"{axis}_command_deg"
    command_deg = recording.values(told) if told in recording.samples else None
    outlier = flag_outliers(angle_deg, config.gate_deviations, command_deg)
    channel = Channel(f"{axis}_angle_deg", "measurement", "deg")
    return Vision(recording.with_channel(channel, angle_deg), _table(seen, outlier))


def _measure_all(
    config: VisionConfig,
    frames: Frames,
    rows: range,
    progress: Callable[[int, int], None] | None,
) -> list[FrameMeasurement]:
    look = partial(_look, config, frames)
    seen: list[FrameMeasurement] = []
    with _opencv_in_one_thread(), ThreadPoolExecutor(config.workers) as pool:
        try:
            for measurement in pool.map(look, rows):
                seen.append(measurement)
                if progress is not None:
                    progress(len(seen), len(rows))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return seen


def _look(config: VisionConfig, frames: Frames, row: int) -> FrameMeasurement:
    jpeg = frames.read(row)
    return LOST if jpeg is None else measure_frame(decode(jpeg, frames.where(row)), config)


@contextmanager
def _opencv_in_one_thread() -> Iterator[None]:
    """OpenCV's own threads and ours would get in each other's way; it lets go of Python's lock."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)


def _table(seen: list[FrameMeasurement], outlier: np.ndarray) -> pd.DataFrame:
    rows = []
    for frame in seen:
        green, red = (
            (frame.markers.green_px, frame.markers.red_px) if frame.markers else 2 * (NOWHERE,)
        )
        base = frame.base.point_px if frame.base else NOWHERE
        rows.append(
            {
                "angle_deg": frame.angle_deg,
                "green_x_px": green[0],
                "green_y_px": green[1],
                "red_x_px": red[0],
                "red_y_px": red[1],
                "marker_direction_deg": frame.markers.direction_deg if frame.markers else math.nan,
                "base_x_px": base[0],
                "base_y_px": base[1],
                "base_direction_deg": frame.base.direction_deg if frame.base else math.nan,
                "reason": frame.reason,
            }
        )
    table = pd.DataFrame(rows)
    table.insert(0, "row", np.arange(len(seen)))
    table.insert(2, "outlier", outlier)
    return table
