"""What the camera makes of the joint's angle: projection, lens, stale frames, a wandering mount."""

from dataclasses import dataclass

import numpy as np

NEAR_MM, FAR_MM = 3.0, 9.0
VIEW_HALF_WIDTH_MM = 12.0
DISTANCE_MM = 120.0


@dataclass(frozen=True)
class Camera:
    """A camera that looks at two markers of the link; the defaults see the angle as it is.

    `tilt_deg` turns the image plane away from the plane of motion about an axis in that plane,
    which stands at `tilt_axis_deg` from the home direction. `barrel` is the radial distortion at
    the edge of the view, whose centre is `centre_mm` away from the joint. A frame shows the pose
    `stale_s` before, or `stale_frames` frames before. The mount wanders: `wander_deg` in all, in
    the way of `wander_kind` ("linear", "settling", "stairs").
    """

    tilt_deg: float = 0.0
    tilt_axis_deg: float = 0.0
    perspective: float = 0.0
    barrel: float = 0.0
    centre_x_mm: float = 0.0
    centre_y_mm: float = 0.0
    stale_s: float = 0.0
    stale_frames: int = 0
    wander_deg: float = 0.0
    wander_kind: str = "linear"
    settle_s: float = 2000.0


def seen_deg(camera: Camera, joint_deg: np.ndarray, time_s: np.ndarray, cycle: np.ndarray,
             span_s: float) -> np.ndarray:  # fmt: skip
    """Angle in the image [deg], shape (n,); `span_s` is the time in which the mount wanders."""
    pose = np.asarray(joint_deg, dtype=float)
    if camera.stale_frames:
        index = np.maximum(np.arange(len(pose)) - camera.stale_frames, 0)
        pose = pose[index]
    if camera.stale_s:
        pose = np.interp(time_s - camera.stale_s, time_s, pose)
    if camera.tilt_deg or camera.barrel:
        pose = _in_image(camera, pose)
    return pose + _wander(camera, time_s, cycle, span_s)


def _in_image(camera: Camera, pose_deg: np.ndarray) -> np.ndarray:
    """Angle of the line through both markers, from their image positions; home reads its own."""
    seen = np.unwrap(_line_angle(camera, np.deg2rad(pose_deg)))
    home = _line_angle(camera, np.zeros(1))[0]
    return np.asarray(np.rad2deg(seen - home))


def _line_angle(camera: Camera, pose_rad: np.ndarray) -> np.ndarray:
    ends = []
    for radius in (NEAR_MM, FAR_MM):
        x, y = radius * np.cos(pose_rad), radius * np.sin(pose_rad)
        ends.append(_distorted(camera, *_projected(camera, x, y)))
    (x0, y0), (x1, y1) = ends
    return np.asarray(np.arctan2(y1 - y0, x1 - x0))


def _projected(camera: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pinhole projection after the plane of motion is turned by the tilt."""
    axis, tilt = np.deg2rad(camera.tilt_axis_deg), np.deg2rad(camera.tilt_deg)
    along = x * np.cos(axis) + y * np.sin(axis)
    across = -x * np.sin(axis) + y * np.cos(axis)
    depth = 1.0 + camera.perspective * across * np.sin(tilt) / DISTANCE_MM
    along, across = along / depth, across * np.cos(tilt) / depth
    return (
        along * np.cos(axis) - across * np.sin(axis),
        along * np.sin(axis) + across * np.cos(axis),
    )


def _distorted(camera: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    u, v = x - camera.centre_x_mm, y - camera.centre_y_mm
    scale = 1.0 + camera.barrel * (u * u + v * v) / VIEW_HALF_WIDTH_MM**2
    return u * scale, v * scale


def _wander(camera: Camera, time_s: np.ndarray, cycle: np.ndarray, span_s: float) -> np.ndarray:
    start = float(time_s[0])
    if camera.wander_kind == "settling":
        whole = 1.0 - np.exp(-span_s / camera.settle_s)
        share = (1.0 - np.exp(-(time_s - start) / camera.settle_s)) / whole
    elif camera.wander_kind == "stairs":
        share = cycle / 8.0
    else:
        share = (time_s - start) / span_s
    return np.asarray(camera.wander_deg * share)
