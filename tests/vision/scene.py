"""Views of the twin, and what may go wrong in front of its lens, for the tests of vision."""

import cv2
import numpy as np

from pipeline.config import CameraConfig
from pipeline.twin.microscope import (
    ARM_DIAMETER_MM,
    BASE_TILT_DEG,
    FIELD_WIDTH_MM,
    arm_point_px,
    render,
)

CAMERA = CameraConfig(kind="twin")
GREEN_MM, RED_MM = 4.0, 19.2
BACKGROUND = (190, 197, 200)


def view(pose_deg: float, camera: CameraConfig = CAMERA, seed: int = 0) -> np.ndarray:
    return render(pose_deg, camera, np.random.default_rng(seed))


def paint_block(
    frame: np.ndarray, centre_px: np.ndarray, size_mm: tuple[float, float], angle_deg: float, bgr
) -> np.ndarray:
    """The frame with a rectangle laid over it, sides along and across `angle_deg`."""
    px_per_mm = frame.shape[1] / FIELD_WIDTH_MM
    angle = np.deg2rad(angle_deg)
    along = np.array([np.cos(angle), -np.sin(angle)]) * size_mm[0] * px_per_mm / 2
    across = np.array([np.sin(angle), np.cos(angle)]) * size_mm[1] * px_per_mm / 2
    corners = centre_px + np.array(
        [along + across, along - across, -along - across, across - along]
    )
    painted = frame.copy()
    cv2.fillPoly(painted, [np.round(corners * 16).astype(np.int32)], bgr, cv2.LINE_AA, 4)
    return painted


def hide(frame: np.ndarray, pose_deg: float, from_mm: float, to_mm: float) -> np.ndarray:
    """The frame with the arm covered between two distances from the joint."""
    centre = arm_point_px((from_mm + to_mm) / 2, pose_deg, frame.shape[1])
    size_mm = (to_mm - from_mm, 1.6 * ARM_DIAMETER_MM)
    return paint_block(frame, centre, size_mm, pose_deg + BASE_TILT_DEG, BACKGROUND)


def hide_corner(frame: np.ndarray, pose_deg: float) -> np.ndarray:
    """The frame with a quarter of the red marker covered, at its tip and lower side."""
    angle = np.deg2rad(pose_deg + BASE_TILT_DEG)
    px_per_mm = frame.shape[1] / FIELD_WIDTH_MM
    lower = np.array([np.sin(angle), np.cos(angle)]) * ARM_DIAMETER_MM / 4 * px_per_mm
    centre = arm_point_px(RED_MM + 0.9, pose_deg, frame.shape[1]) + lower
    return paint_block(frame, centre, (1.9, 1.9), pose_deg + BASE_TILT_DEG, BACKGROUND)


def decoy(frame: np.ndarray, centre_mm: tuple[float, float], bgr) -> np.ndarray:
    """The frame with a block larger than a marker, in a marker's colour."""
    centre = np.array(centre_mm) * frame.shape[1] / FIELD_WIDTH_MM
    return paint_block(frame, centre, (5.0, 5.0), 20.0, bgr)


def through_jpeg(frame: np.ndarray, quality: int) -> np.ndarray:
    data = cv2.imencode(".jpg", frame, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return cv2.imdecode(data, cv2.IMREAD_COLOR)


def glare(frame: np.ndarray, centre_px: np.ndarray, radius_px: float) -> np.ndarray:
    """The frame with a bright soft spot."""
    y, x = np.mgrid[: frame.shape[0], : frame.shape[1]]
    distance = np.hypot(x - centre_px[0], y - centre_px[1])
    light = 120.0 * np.exp(-0.5 * (distance / radius_px) ** 2)
    return np.clip(frame + light[..., None], 0, 255).astype(np.uint8)
