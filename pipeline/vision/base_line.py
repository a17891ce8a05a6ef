"""The line l1: the axis of the base shaft, from its two edges."""

from dataclasses import dataclass

import cv2
import numpy as np

STRIPS = 48
SMALLEST_REGION_PX = 16
SMOOTHING_OF_HEIGHT = 0.003
WIDTH_TOLERANCE = 0.1
WEAK_EDGE = 0.3
FAINT_EDGE_GREY = 12.0
STRIPS_NEEDED = 0.5
LARGEST_SPREAD = 0.05


@dataclass(frozen=True)
class Line:
    """A line in the image: a point (x, y) [px] on it and its direction, counter-clockwise [deg]."""

    point_px: tuple[float, float]
    direction_deg: float


def find_base_line(image: np.ndarray, region: list[float]) -> Line | str:
    """The axis of the shaft that crosses `region` from left to right, or why there is none.

    `image` is (h, w, 3) BGR; `region` is left, top, right, bottom as shares of the image. Each of
    48 vertical strips gives the shaft's two edges (the steepest rise and fall of brightness, to
    a fraction of a pixel); strips with faint edges or another shaft width than most are left out,
    and a line is fitted to the middles of the others.
    """
    height, width = image.shape[:2]
    left, right = round(region[0] * width), round(region[2] * width)
    top, bottom = round(region[1] * height), round(region[3] * height)
    if right - left < SMALLEST_REGION_PX or bottom - top < SMALLEST_REGION_PX:
        return f"base shaft not found: base_region is {right - left} x {bottom - top} px"
    grey = cv2.cvtColor(image[top:bottom, left:right], cv2.COLOR_BGR2GRAY)
    strips = cv2.resize(grey, (STRIPS, bottom - top), interpolation=cv2.INTER_AREA)
    sigma_px = SMOOTHING_OF_HEIGHT * height
    first, second, strength = _edges(strips, sigma_px)
    shaft_px = second - first
    usual_px = float(np.median(shaft_px))
    good = np.abs(shaft_px - usual_px) <= WIDTH_TOLERANCE * usual_px
    faint = FAINT_EDGE_GREY / (np.sqrt(2 * np.pi) * sigma_px)
    good &= strength >= max(faint, WEAK_EDGE * float(np.median(strength)))
    if good.sum() < STRIPS_NEEDED * STRIPS:
        return f"base shaft not found: its edges agree in {good.sum()} of {STRIPS} strips"
    strip_px = (right - left) / STRIPS
    x = left + (np.arange(STRIPS) + 0.5) * strip_px - 0.5
    y = top + (first + second) / 2
    slope, offset, spread = _robust_line(x[good], y[good])
    if spread > LARGEST_SPREAD * usual_px:
        return f"base shaft not found: its middle wanders by {spread:.1f} px"
    middle = (left + right) / 2
    direction_deg = float(-np.rad2deg(np.arctan(slope)))
    return Line((middle, slope * middle + offset), direction_deg)


def _edges(strips: np.ndarray, sigma_px: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Upper and lower edge [px from the top] and the weaker one's strength of each strip, (n,)."""
    size = 2 * int(np.ceil(3 * sigma_px)) + 1
    smooth = cv2.GaussianBlur(strips.astype(np.float32), (1, size), 0, sigmaY=sigma_px)
    steepness = np.diff(smooth, axis=0)
    inner = steepness[1:-1]
    rise, fall = inner.argmax(axis=0) + 1, inner.argmin(axis=0) + 1
    columns = np.arange(strips.shape[1])
    strength = np.minimum(steepness[rise, columns], -steepness[fall, columns])
    edges = np.stack([_peak(steepness, rise), _peak(-steepness, fall)]) + 0.5
    return edges.min(axis=0), edges.max(axis=0), strength


def _peak(curves: np.ndarray, top: np.ndarray) -> np.ndarray:
    """Where a parabola through the highest value of each column and its neighbours peaks, (n,)."""
    columns = np.arange(curves.shape[1])
    before, at, after = (curves[top + shift, columns] for shift in (-1, 0, 1))
    curvature = before - 2 * at + after
    return top + np.where(curvature < 0, (before - after) / (2 * np.minimum(curvature, -1e-9)), 0.0)


def _robust_line(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Slope, offset and spread of y over x: Theil and Sen's line, then least squares near it."""
    i, j = np.triu_indices(len(x), k=1)
    slope = float(np.median((y[j] - y[i]) / (x[j] - x[i])))
    rest = y - slope * x
    offset = float(np.median(rest))
    spread = 1.4826 * float(np.median(np.abs(rest - offset)))
    near = np.abs(rest - offset) <= 3 * max(spread, 0.1)
    slope, offset = np.polyfit(x[near], y[near], 1)
    return float(slope), float(offset), spread
