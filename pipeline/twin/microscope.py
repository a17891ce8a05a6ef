"""A rendered microscope: the view along the axis about which one joint of the snake bends.

Lengths are in mm of the object plane, so that every image size shows the same scene: x to the
right, y down, from the upper left corner. A view stays in the plane of its own axis.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from pipeline.config import CameraConfig

FIELD_WIDTH_MM = 80.64  # 4032 px of 20 um
JOINT_MM = (32.0, 30.24)
BASE_TILT_DEG = 1.2  # of the base shaft in the image, counter-clockwise
SHAFT_DIAMETER_MM = 5.0
SHAFT_END_MM = -1.6  # along the axis, from the joint
HINGE_DIAMETER_MM = 3.0
ARM_DIAMETER_MM = 3.6
ARM_MM = (1.2, 21.0)
GREEN_MM = (2.2, 5.8)
RED_MM = (17.4, 21.0)
BLUR_MM = 0.08
NOISE_GREY = 2.0

BACKGROUND_BGR = (196.0, 203.0, 206.0)
STEEL_BGR = (150.0, 146.0, 142.0)
HINGE_BGR = (58.0, 56.0, 55.0)
BODY_BGR = (176.0, 180.0, 183.0)
GREEN_BGR = (62.0, 165.0, 44.0)
RED_BGR = (40.0, 36.0, 205.0)
LIGHT_FROM = (-0.30, -0.45, 0.84)  # x, y, towards the eye
AMBIENT = 0.42
GLOSS = 0.22
SHADOW = 0.30
SHADOW_OFFSET_MM = (0.9, 1.2)
SHADOW_BLUR_MM = 0.9
NOISE_SHIFTS = 64
NOISE_TILE = 1100


@dataclass(frozen=True)
class Backdrop:
    """What does not move: scene without the arm, sharp and as seen, light map and sensor noise.

    `sharp` and `seen` are (h, w, 3) uint8, `light` (h, w) float32 around 1, `noise`
    (h + NOISE_SHIFTS, w + NOISE_SHIFTS, 3) uint8 around 128.
    """

    sharp: np.ndarray
    seen: np.ndarray
    light: np.ndarray
    noise: np.ndarray
    px_per_mm: float


def render(pose_deg: float, config: CameraConfig, rng: np.random.Generator) -> np.ndarray:
    """The view of a joint bent by `pose_deg` (positive: counter-clockwise), (h, w, 3) uint8 BGR.

    `rng` draws the sensor noise of this frame.
    """
    backdrop = backdrop_of(config.width_px, config.height_px)
    frame = backdrop.seen.copy()
    _draw_arm(frame, backdrop, pose_deg)
    dy, dx = rng.integers(0, NOISE_SHIFTS, 2)
    noise = backdrop.noise[dy : dy + config.height_px, dx : dx + config.width_px]
    return cv2.addWeighted(frame, 1.0, noise, 1.0, -128.0)


def encode(frame: np.ndarray, jpeg_quality: int) -> bytes:
    """A BGR frame as JPEG."""
    return cv2.imencode(".jpg", frame, [cv2.IMWRITE_JPEG_QUALITY, jpeg_quality])[1].tobytes()


class TwinCamera:
    """A camera over the simulated snake: `pose_deg` says how far the joint in its view is bent."""

    def __init__(
        self, name: str, pose_deg: Callable[[], float], config: CameraConfig, seed: int
    ) -> None:
        self.name = name
        self._pose_deg = pose_deg
        self._config = config
        self._rng = np.random.default_rng(seed)

    def grab(self) -> bytes:
        """One JPEG of the snake as it stands now."""
        frame = render(self._pose_deg(), self._config, self._rng)
        return encode(frame, self._config.jpeg_quality)

    def close(self) -> None:
        """Nothing is held open."""


@lru_cache(maxsize=2)
def backdrop_of(width_px: int, height_px: int) -> Backdrop:
    """The still part of the scene for an image size."""
    px_per_mm = width_px / FIELD_WIDTH_MM
    light = _light(width_px, height_px)
    canvas = np.empty((height_px, width_px, 3), np.float32)
    canvas[:] = BACKGROUND_BGR
    box = (0, 0, width_px, height_px)
    along, across = _axes(box, px_per_mm, BASE_TILT_DEG)
    ramp_mm = 1.0 / px_per_mm
    shaft = _coverage(across, SHAFT_DIAMETER_MM / 2, ramp_mm) * _between(
        along, -2 * FIELD_WIDTH_MM, SHAFT_END_MM, ramp_mm
    )
    canvas *= (1.0 - SHADOW * _shadow(shaft, px_per_mm))[..., None]
    _blend(canvas, shaft, _shade(across / (SHAFT_DIAMETER_MM / 2), BASE_TILT_DEG, STEEL_BGR))
    hinge = _coverage(np.hypot(along, across), HINGE_DIAMETER_MM / 2, ramp_mm)
    _blend(canvas, hinge, np.array(HINGE_BGR, np.float32))
    sharp = _to_grey_levels(canvas * light[..., None])
    noise = _sensor_noise(width_px + NOISE_SHIFTS, height_px + NOISE_SHIFTS)
    return Backdrop(sharp, _blur(sharp, px_per_mm), light, noise, px_per_mm)


def arm_point_px(along_mm: float, pose_deg: float, width_px: int) -> np.ndarray:
    """Where a point of the arm's axis is in the image, (2,) px (x, y), pixel centres whole."""
    angle = np.deg2rad(pose_deg + BASE_TILT_DEG)
    point_mm = np.asarray(JOINT_MM) + along_mm * np.array([np.cos(angle), -np.sin(angle)])
    return point_mm * (width_px / FIELD_WIDTH_MM) - 0.5


def _draw_arm(frame: np.ndarray, backdrop: Backdrop, pose_deg: float) -> None:
    box = _arm_box(frame, backdrop.px_per_mm, pose_deg)
    x0, y0, x1, y1 = box
    angle_deg = pose_deg + BASE_TILT_DEG
    along, across = _axes(box, backdrop.px_per_mm, angle_deg)
    ramp_mm = 1.0 / backdrop.px_per_mm
    arm = _coverage(across, ARM_DIAMETER_MM / 2, ramp_mm) * _between(along, *ARM_MM, ramp_mm)
    view = backdrop.sharp[y0:y1, x0:x1].astype(np.float32)
    view *= (1.0 - SHADOW * _shadow(arm, backdrop.px_per_mm))[..., None]
    paint = np.empty_like(view)
    paint[:] = BODY_BGR
    _blend(paint, _between(along, *GREEN_MM, ramp_mm), np.array(GREEN_BGR, np.float32))
    red_mm = (RED_MM[0], RED_MM[1] + ramp_mm)  # the paint goes round the tip's edge
    _blend(paint, _between(along, *red_mm, ramp_mm), np.array(RED_BGR, np.float32))
    lit = _shade(across / (ARM_DIAMETER_MM / 2), angle_deg, paint)
    lit *= backdrop.light[y0:y1, x0:x1, None]
    _blend(view, arm, lit)
    frame[y0:y1, x0:x1] = _blur(_to_grey_levels(view), backdrop.px_per_mm)


def _arm_box(frame: np.ndarray, px_per_mm: float, pose_deg: float) -> tuple[int, int, int, int]:
    height, width = frame.shape[:2]
    ends = np.array([arm_point_px(end, pose_deg, width) for end in (0.0, ARM_MM[1])])
    margin = (ARM_DIAMETER_MM / 2 + max(SHADOW_OFFSET_MM) + 2.5 * SHADOW_BLUR_MM) * px_per_mm
    low = np.floor(ends.min(axis=0) - margin).astype(int)
    high = np.ceil(ends.max(axis=0) + margin).astype(int)
    return (
        max(0, int(low[0])),
        max(0, int(low[1])),
        min(width, int(high[0])),
        min(height, int(high[1])),
    )


def _axes(
    box: tuple[int, int, int, int], px_per_mm: float, angle_deg: float
) -> tuple[np.ndarray, np.ndarray]:
    """Distance [mm] along and across (to the left of) a direction from the joint, each (h, w)."""
    x0, y0, x1, y1 = box
    x = ((np.arange(x0, x1) + 0.5) / px_per_mm - JOINT_MM[0]).astype(np.float32)
    y = ((np.arange(y0, y1) + 0.5) / px_per_mm - JOINT_MM[1]).astype(np.float32)[:, None]
    cos, sin = np.float32(np.cos(np.deg2rad(angle_deg))), np.float32(np.sin(np.deg2rad(angle_deg)))
    return x * cos - y * sin, -x * sin - y * cos


def _coverage(distance_mm: np.ndarray, half_mm: float, ramp_mm: float) -> np.ndarray:
    """Share of each pixel within `half_mm` of the axis."""
    return np.clip((half_mm - np.abs(distance_mm)) / ramp_mm + 0.5, 0.0, 1.0)


def _between(along_mm: np.ndarray, low_mm: float, high_mm: float, ramp_mm: float) -> np.ndarray:
    return _coverage(along_mm - (low_mm + high_mm) / 2, (high_mm - low_mm) / 2, ramp_mm)


def _shade(
    across: np.ndarray, angle_deg: float, paint_bgr: np.ndarray | tuple[float, ...]
) -> np.ndarray:
    """A cylinder's paint under the lamp, (h, w, 3); `across` is -1..1 over the diameter."""
    angle = np.deg2rad(angle_deg)
    sideways = np.clip(across, -1.0, 1.0)
    upwards = np.sqrt(1.0 - sideways * sideways)
    light_across = -LIGHT_FROM[0] * np.sin(angle) - LIGHT_FROM[1] * np.cos(angle)
    lit = np.maximum(sideways * np.float32(light_across) + upwards * np.float32(LIGHT_FROM[2]), 0)
    gloss = lit * lit
    gloss *= gloss
    gloss *= gloss
    diffuse = (AMBIENT + (1.0 - AMBIENT) * lit)[..., None] * np.asarray(paint_bgr, np.float32)
    diffuse += (np.float32(255.0 * GLOSS) * gloss)[..., None]
    return diffuse


def _blend(canvas: np.ndarray, share: np.ndarray, paint: np.ndarray) -> None:
    canvas += share[..., None] * (paint - canvas)


def _shadow(body: np.ndarray, px_per_mm: float) -> np.ndarray:
    dx, dy = (round(offset * px_per_mm) for offset in SHADOW_OFFSET_MM)
    height, width = body.shape
    thrown = np.pad(body, ((dy, 0), (dx, 0)), mode="edge")[:height, :width]
    size = 2 * round(1.2 * SHADOW_BLUR_MM * px_per_mm) + 1
    return cv2.blur(cv2.blur(thrown, (size, size)), (size, size))


def _light(width_px: int, height_px: int) -> np.ndarray:
    """Lamp from the upper left and a vignette, (h, w) float32 around 1."""
    x = np.linspace(-1, 1, width_px, dtype=np.float32)
    y = np.linspace(-1, 1, height_px, dtype=np.float32)[:, None]
    return (1.04 - 0.07 * x - 0.05 * y - 0.09 * (x * x + y * y)).astype(np.float32)


def _sensor_noise(width_px: int, height_px: int) -> np.ndarray:
    tile = np.random.default_rng(0).standard_normal((NOISE_TILE, NOISE_TILE, 3), dtype=np.float32)
    tiles = (-(-height_px // NOISE_TILE), -(-width_px // NOISE_TILE), 1)
    return np.tile(_to_grey_levels(128.0 + NOISE_GREY * tile), tiles)[:height_px, :width_px]


def _blur(image: np.ndarray, px_per_mm: float) -> np.ndarray:
    return cv2.GaussianBlur(image, (0, 0), BLUR_MM * px_per_mm)


def _to_grey_levels(values: np.ndarray) -> np.ndarray:
    return np.clip(values + 0.5, 0.0, 255.0).astype(np.uint8)
