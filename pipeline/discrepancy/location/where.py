"""A located part of a residual in words and as lines for a picture."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pipeline.discrepancy.location.coordinates import Ground
from pipeline.discrepancy.location.curve_words import (
    binned,
    curve_words,
    least_squares_share,
    least_squares_shares,
)
from pipeline.discrepancy.problem.spikes import Spikes
from pipeline.number_words import worded

CLEAR = 0.75
FADES = 0.005
ONE_LEVEL = 0.3
BINS = 120
PICTURE_BINS = 48


@dataclass(frozen=True)
class Profile:
    """Mean residual over a coordinate: curves by name, each an array (k, 2) of coordinate, mean."""

    x_label: str
    y_label: str
    curves: Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Scene:
    """What words need: coordinates and residual of the rows (m,), units of angle and drive."""

    ground: Ground
    values: np.ndarray
    unit: str
    drive_unit: str


def describe(
    coordinate: str,
    fitted: np.ndarray,
    said: Mapping[str, np.ndarray],
    left: np.ndarray,
    scene: Scene,
) -> tuple[str, Profile]:
    """Words and lines of one coordinate's part.

    fitted: what it says of each row, (m,). said: the same for every sure coordinate by name.
    left: (m,) what none says.
    """
    own = fitted + left
    name, _, channel = coordinate.partition(":")
    ground, unit = scene.ground, scene.drive_unit
    if name == "command":
        label = f"command [{unit}]"
        words = _straight_words(fitted, ground) or curve_words(
            ground.drive, own, ground.position, f"{unit} of command"
        )
        return words, _picture(ground.drive, own, label, scene)
    if name in ("direction", "travel"):
        other = said.get("travel" if name == "direction" else "direction", 0.0)
        loop = own + other
        words = _loop_words(loop, "travel" in said, scene)
        if name == "direction":
            picture = _picture(ground.drive, loop, f"command [{unit}]", scene, by_direction=True)
        else:
            label = f"travel since the last reversal [{unit}]"
            picture = _picture(ground.travel, loop, label, scene, by_direction=True)
        return words, picture
    if name == "dwell":
        words = _level_words(ground.dwell_s, fitted, scene, "a dwell of", "s")
        return words, _picture(ground.dwell_s, own, "dwell [s]", scene, by_direction=True)
    if name == "rate":
        words = _level_words(ground.rate, fitted, scene, "", f"{unit}/s")
        return words, _picture(ground.rate, own, f"rate [{unit}/s]", scene, by_direction=True)
    if name == "other_command":
        words = _other_words(channel, fitted, scene)
        return words, _picture(ground.others[channel], own, channel, scene)
    if name == "image_position":
        words = curve_words(ground.position, own, ground.position, f"{scene.unit} as simulated")
        return words, _picture(ground.position, own, f"simulated [{scene.unit}]", scene)
    if name == "time":
        return _time_words(own, scene), _picture(ground.time_s, own, "time [s]", scene)
    return _cycle_words(fitted, own, scene), _picture(
        ground.cycle.astype(float), own, "cycle", scene, by_direction=True
    )


def describe_spikes(spikes: Spikes, scene: Scene) -> tuple[str, Profile]:
    """Words and lines for samples that stand apart from their neighbours."""
    height = np.abs(spikes.height[spikes.lone])
    words = f"in {len(height)} single frames, up to {worded(height.max())} {scene.unit} off"
    number = np.arange(len(spikes.height), dtype=float)
    curve = np.column_stack([number, spikes.height])[spikes.lone]
    return words, Profile("sample", f"off its neighbours [{scene.unit}]", {"frames": curve})


def _picture(
    x: np.ndarray, y: np.ndarray, label: str, scene: Scene, by_direction: bool = False
) -> Profile:
    parts = {"all": np.isfinite(x)}
    if by_direction:
        way = scene.ground.direction
        parts = {"ascending": np.isfinite(x) & (way > 0), "descending": np.isfinite(x) & (way < 0)}
    curves = {}
    for name, rows in parts.items():
        if np.any(rows):
            centre, mean, _ = binned(x[rows], y[rows], PICTURE_BINS)
            curves[name] = np.column_stack([centre, mean])
    return Profile(label, f"residual [{scene.unit}]", curves)


def _straight_words(fitted: np.ndarray, ground: Ground) -> str:
    """Words for what is a line in the command beside one in the simulation; "" where it is none.

    A simulation that is late or early is off by what it still has to go, or has gone too far.
    """
    one = np.ones(len(fitted))
    beside = np.column_stack([one, np.nan_to_num(ground.position)])
    line = ground.drive[:, None]
    if least_squares_share(line, fitted, beside, one) < CLEAR:
        return ""
    if not np.ptp(ground.position) > 0.0:
        return "in step with the command"
    slope = np.linalg.lstsq(np.column_stack([line, beside]), fitted, rcond=None)[0][0]
    late = slope * np.polyfit(ground.drive, beside[:, 1], 1)[0] > 0.0
    how = "later" if late else "earlier"
    return f"in step with the command, which the simulation follows {how} than the measurement"


def _loop_words(loop: np.ndarray, fades: bool, scene: Scene) -> str:
    ground = scene.ground
    opposite = ground.direction * loop
    width, share = fading_width(ground.travel, opposite, ground.step)
    begin, side, stepped = _step_along(ground.drive, opposite)
    if fades and stepped > max(ONE_LEVEL, 2.0 * share):
        return (
            f"beyond {worded(begin)} {scene.drive_unit} of command on the {side} side, "
            "differently on the way up and down"
        )
    if fades and share > FADES:
        return _fading_words("each reversal", width, scene)
    level = float(np.mean(opposite))
    if level**2 > ONE_LEVEL * float(np.mean((loop - np.mean(loop)) ** 2)):
        side = "behind the motion" if level < 0 else "ahead in the direction of motion"
        return f"{side}, by {worded(abs(level))} {scene.unit}"
    for way, end in ((-1, "upper"), (1, "lower")):
        rows = ground.direction == way
        width, share = fading_width(ground.travel[rows], opposite[rows], ground.step)
        if fades and share > 4 * FADES:
            return _fading_words(f"reversals at the {end} end", width, scene)
    return "differently on the way up and on the way down"


def _step_along(drive: np.ndarray, opposite: np.ndarray) -> tuple[float, str, float]:
    """Where along the drive a residual's part opposite in direction jumps; the share of that."""
    centre, mean, count = binned(drive, opposite, PICTURE_BINS)
    if len(centre) < 8:
        return 0.0, "", 0.0
    weight, constant = np.sqrt(count), np.ones((len(centre), 1))
    steps = (centre >= centre[3:-2, None])[:, :, None].astype(float)
    shares = least_squares_shares(steps, mean, constant, weight)
    best = int(np.argmax(shares))
    begin = float(0.5 * (centre[2 + best] + centre[3 + best]))
    above = float(np.abs(mean[centre >= begin]).mean()) > float(np.abs(mean[centre < begin]).mean())
    spread = float(count @ (mean - count @ mean / count.sum()) ** 2)
    power = float(np.sum(opposite**2)) or 1.0
    return begin, "positive" if above else "negative", float(shares[best]) * spread / power


def _fading_words(turns: str, width: float, scene: Scene) -> str:
    if width <= 1.5 * scene.ground.step:
        return f"at once after {turns}"
    return f"after {turns}, over {worded(width)} {scene.drive_unit} of command"


def fading_width(travel: np.ndarray, opposite: np.ndarray, step: float) -> tuple[float, float]:
    """Travel after a reversal over which a residual changes linearly, and the share that this has.

    A straight trend over all the travel is no change after a reversal, and left out. travel: (m,)
    since the reversal, NaN before the first. opposite: (m,) direction times residual.
    """
    known = np.isfinite(travel)
    if np.sum(known) < 8 or not np.ptp(travel[known]) > 0:
        return 0.0, 0.0
    centre, mean, count = binned(travel[known], opposite[known], BINS)
    weight = np.sqrt(count)
    span = float(centre[-1])
    widths = np.geomspace(max(step, 0.002 * span), 0.7 * span, 60)
    trend = np.column_stack([np.ones(len(centre)), centre])
    fading = np.maximum(0.0, 1.0 - centre / widths[:, None])[:, :, None]
    shares = least_squares_shares(fading, mean, trend, weight)
    best = int(np.argmax(shares))
    straight = least_squares_share(trend, mean, np.zeros((len(centre), 1)), weight)
    return float(widths[best]), float(shares[best]) * (1.0 - straight)


def _level_words(level: np.ndarray, fitted: np.ndarray, scene: Scene, noun: str, unit: str) -> str:
    direction = scene.ground.direction
    middle = 0.5 * (np.quantile(level, 0.02) + np.quantile(level, 0.98))
    high, low = level > middle, level <= middle
    noun = f"{noun} " if noun else ""
    ends = (
        f"{noun}{worded(np.median(level[high]))} {unit}",
        f"{worded(np.median(level[low]))} {unit}",
    )
    opposite = float(np.mean((direction * fitted)[high]) - np.mean((direction * fitted)[low]))
    alike = float(np.mean(fitted[high]) - np.mean(fitted[low]))
    if abs(opposite) >= abs(alike):
        behind = float(np.mean(direction * scene.values)) < 0
        more = "more" if (opposite < 0) == behind else "less"
        return (
            f"{more} {'behind' if behind else 'ahead of'} the motion at {ends[0]} than at {ends[1]}"
        )
    return f"shifts by {worded(alike, '+')} at {ends[0]} against {ends[1]}"


def _other_words(channel: str, fitted: np.ndarray, scene: Scene) -> str:
    name = short_name(channel)
    command = scene.ground.others[channel]
    moving = np.abs(np.diff(command, prepend=command[:1])) > 0
    moving |= np.roll(moving, -1)
    inside = float(np.sum(fitted[moving] ** 2)) / max(float(np.sum(fitted**2)), 1e-300)
    if np.mean(moving) < 0.9 and inside > 0.6:
        return f"while {name} moves"
    return f"in step with {name}"


def short_name(channel: str) -> str:
    """`yaw` for `yaw_command_deg`."""
    return channel.partition("_command")[0] or channel


def _time_words(own: np.ndarray, scene: Scene) -> str:
    time_s = scene.ground.time_s
    centre, mean, count = binned(time_s, own, BINS)
    weight, constant = np.sqrt(count), np.ones((len(centre), 1))
    steps = least_squares_shares(
        (centre >= centre[2:-1, None])[:, :, None].astype(float), mean, constant, weight
    )
    line = least_squares_share(centre[:, None], mean, constant, weight)
    if len(steps) and max(steps) > max(CLEAR, line):
        begin = float(centre[2 + int(np.argmax(steps))])
        after = time_s >= begin
        jump = float(np.mean(own[after]) - np.mean(own[~after]))
        return f"from {worded(begin)} s on, by {worded(jump, '+')} {scene.unit}"
    drift = float(np.polyfit(centre, mean, 1)[0] * np.ptp(time_s))
    if line > CLEAR:
        return f"steadily over the recording, by {worded(drift, '+')} {scene.unit} in all"
    return f"slowly over the recording, within {worded(np.ptp(mean))} {scene.unit}"


def _cycle_words(fitted: np.ndarray, own: np.ndarray, scene: Scene) -> str:
    ground = scene.ground
    cycles = np.unique(ground.cycle)
    inside = [ground.cycle == cycle for cycle in cycles]
    means = np.array([own[rows].mean() for rows in inside])
    widths = np.array([(ground.direction * own)[rows].mean() for rows in inside])
    count = np.array([rows.sum() for rows in inside])
    weight = np.sqrt(count)
    if count @ widths**2 > count @ means**2:
        slope = np.polyfit(cycles, widths, 1)[0]
        share = least_squares_share(cycles[:, None].astype(float), widths,
                                    np.ones((len(cycles), 1)), weight)  # fmt: skip
        if share > 0.5:
            return f"the loop {'widens' if slope < 0 else 'narrows'} from cycle to cycle"
        return "the loop's width differs between cycles"
    constant = np.ones((len(cycles), 1))
    steps = least_squares_shares(
        (cycles >= cycles[1:, None])[:, :, None].astype(float), means, constant, weight
    )
    line = least_squares_share(cycles[:, None].astype(float), means, constant, weight)
    if max(steps) > max(CLEAR, line):
        return f"from cycle {int(cycles[1 + int(np.argmax(steps))])} on"
    return "steadily from cycle to cycle" if line > CLEAR else "differently from cycle to cycle"
