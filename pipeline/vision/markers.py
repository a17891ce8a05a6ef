"""The green and the red marker: masks by colour, the pair by its known separation."""

from dataclasses import dataclass
from itertools import product

import cv2
import numpy as np

from pipeline.config import VisionConfig

SEARCH_WIDTH_PX = 504
SMALLEST_MM2 = 1.5
MOST_CANDIDATES = 8
MARGIN_MM = 0.8
OPENING_MM = 0.4
SMALLEST_AREA_RATIO = 0.5
SMALLEST_FILL_RATIO = 0.85
CLEAR_LEAD = 0.25


@dataclass(frozen=True)
class Blob:
    """Pixels of one colour that hang together: (n, 2) x, y [px], and their mean (2,)."""

    pixels: np.ndarray
    centre_px: np.ndarray


@dataclass(frozen=True)
class Pair:
    """The two markers that belong together."""

    green: Blob
    red: Blob


def find_pair(image: np.ndarray, config: VisionConfig) -> Pair | str:
    """The pair of markers in a (h, w, 3) BGR image, or why there is no clear one.

    Of all green and red blobs the pair is taken whose centres are as far apart as the markers
    are known to be (within `separation_tolerance`) and whose areas are alike, not the largest
    blobs: something of the same colour in view is no marker. The image is searched thinned out,
    then only the surroundings of each candidate are looked at in full resolution.
    """
    px_per_mm = image.shape[1] / config.field_width_mm
    thinning = max(1, image.shape[1] // SEARCH_WIDTH_PX)
    thin = cv2.resize(
        image, None, fx=1 / thinning, fy=1 / thinning, interpolation=cv2.INTER_NEAREST
    )
    thin_hsv = cv2.cvtColor(thin, cv2.COLOR_BGR2HSV)
    greens, reds = (
        _blobs(image, _boxes(colour_mask(thin_hsv, colour, config), thinning), colour, config)
        for colour in ("green", "red")
    )
    for colour, found in (("green", greens), ("red", reds)):
        if not found:
            return f"no {colour} marker"
    known_px = config.marker_separation_mm * px_per_mm
    tolerance = config.separation_tolerance
    nearest, fitting = np.inf, []
    for green, red in product(greens, reds):
        apart = float(np.linalg.norm(red.centre_px - green.centre_px)) / known_px
        nearest = apart if abs(apart - 1) < abs(nearest - 1) else nearest
        if abs(apart - 1) <= tolerance:
            unlike = abs(np.log(len(green.pixels) / len(red.pixels)))
            fitting.append((abs(apart - 1) / tolerance + unlike, green, red))
    if not fitting:
        found_mm = nearest * config.marker_separation_mm
        return (
            f"no two markers {config.marker_separation_mm:g} mm apart (nearest: {found_mm:.1f} mm)"
        )
    fitting.sort(key=lambda entry: entry[0])
    _, green, red = fitting[0]
    if len(fitting) > 1 and fitting[1][0] - fitting[0][0] < CLEAR_LEAD:
        return "two pairs of markers fit equally well"
    return _hidden_part(green, red) or Pair(green, red)


def _hidden_part(green: Blob, red: Blob) -> str:
    """What shows that one of two markers of the same size and form is hidden in part, or nothing.

    A strip may be missing on the side towards the other marker or away from it: this shifts the
    centre along the line through both. A missing corner would turn the line.
    """
    areas = sorted((len(green.pixels), len(red.pixels)))
    if areas[0] < SMALLEST_AREA_RATIO * areas[1]:
        return f"a marker is mostly hidden ({100 * areas[0] / areas[1]:.0f} % of the other)"
    fills = sorted((_fill(green), _fill(red)))
    if fills[0] < SMALLEST_FILL_RATIO * fills[1]:
        return f"a corner of a marker is hidden (it fills {100 * fills[0]:.0f} % of its outline)"
    return ""


def _fill(blob: Blob) -> float:
    """Share of the smallest rectangle around a blob that it fills."""
    _, (width, height), _ = cv2.minAreaRect(blob.pixels.astype(np.float32))
    return len(blob.pixels) / ((width + 1.0) * (height + 1.0))


def colour_mask(hsv: np.ndarray, colour: str, config: VisionConfig) -> np.ndarray:
    """Where an HSV image has the marker's colour, (h, w) uint8 of 0 and 255."""
    if colour == "green":
        return _in_range(hsv, config.green_hue, config.green_saturation, config.green_value)
    saturation, value = config.red_saturation, config.red_value
    low = _in_range(hsv, config.red_hue_low, saturation, value)
    return low | _in_range(hsv, config.red_hue_high, saturation, value)


def _in_range(hsv: np.ndarray, hue: list[int], saturation: int, value: int) -> np.ndarray:
    low = np.array([hue[0], saturation, value], np.uint8)
    high = np.array([hue[1], 255, 255], np.uint8)
    return cv2.inRange(hsv, low, high)


def _boxes(thin_mask: np.ndarray, thinning: int) -> list[np.ndarray]:
    """Boxes (x, y, width, height) [px of the full image] of the largest blobs of a thinned mask."""
    x, y, width, height = cv2.boundingRect(thin_mask)
    if width == 0:
        return []
    _, _, stats, _ = cv2.connectedComponentsWithStats(thin_mask[y : y + height, x : x + width])
    largest = sorted(stats[1:], key=lambda s: -int(s[cv2.CC_STAT_AREA]))[:MOST_CANDIDATES]
    return [thinning * (s[:4] + np.array([x, y, 0, 0])) for s in largest]


def _blobs(
    image: np.ndarray, boxes: list[np.ndarray], colour: str, config: VisionConfig
) -> list[Blob]:
    """What there is in full resolution in and close around each box; each blob once."""
    px_per_mm = image.shape[1] / config.field_width_mm
    margin = round(MARGIN_MM * px_per_mm)
    blobs: dict[tuple[float, ...], Blob] = {}
    for x, y, width, height in boxes:
        x0, y0 = max(0, x - margin), max(0, y - margin)
        view = image[y0 : y + height + margin, x0 : x + width + margin]
        mask = colour_mask(cv2.cvtColor(view, cv2.COLOR_BGR2HSV), colour, config)
        pixels = _largest(_opened(mask, px_per_mm))
        if len(pixels) >= SMALLEST_MM2 * px_per_mm**2:
            pixels = pixels + np.array([x0, y0], np.float64)
            centre_px = pixels.mean(axis=0)
            blobs[tuple(centre_px)] = Blob(pixels, centre_px)
    return list(blobs.values())


def _opened(mask: np.ndarray, px_per_mm: float) -> np.ndarray:
    size = 2 * round(OPENING_MM * px_per_mm / 2) + 1
    return cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((size, size), np.uint8))


def _largest(mask: np.ndarray) -> np.ndarray:
    """Pixels (x, y) of the largest component of a mask, (n, 2)."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(mask)
    if count < 2:
        return np.zeros((0, 2), np.int32)
    label = 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax())
    y, x = np.nonzero(labels == label)
    return np.stack([x, y], axis=1)
