"""The review of a run: one rerun recording of frames, markers, signals and loops.

Rerun's interface changes with each release: this is the one file that knows it. Both axes stand on
one time axis that begins with each axis's own first sample, so that one cursor moves them together.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import rerun as rr
import rerun.blueprint as rrb

from pipeline.atomically import write_atomically
from pipeline.recording import Recording
from pipeline.tracking.thumbnail import small_jpeg

APPLICATION = "loopgap"
TIMELINE = "time"
FRAMES_AT_MOST = 1000
FRAMES_A_CHUNK = 50
ROOM_FOR_LEGEND = 1.35
PAPER = [255, 255, 255, 255]
COLOURS = {
    "command": "#FFFFFF",
    "encoder": "#E69F00",
    "measured": "#A8A8A8",
    "nominal": "#F0743A",
    "compensated": "#56B4E9",
    "cw": "#56B4E9",
    "ccw": "#2BC48E",
    "now": "#F0E442",
    "green_marker": "#00E676",
    "red_marker": "#FF5252",
    "base_line": "#F0E442",
    "marker_line": "#40C4FF",
}
SERIES = {
    "command": ("command", "command", 3.0),
    "encoder": ("encoder", "encoder", 1.0),
    "measured": ("measured", "measured", 1.2),
    "nominal": ("nominal model", "nominal", 1.5),
    "compensated": ("compensated model", "compensated", 1.5),
    "nominal_error": ("nominal model", "nominal", 1.5),
    "compensated_error": ("compensated model", "compensated", 1.5),
    "simulated": ("simulation as it came", "nominal", 1.5),
    "corrected": ("corrected simulation", "compensated", 1.5),
    "simulated_error": ("simulation as it came", "nominal", 1.5),
    "corrected_error": ("corrected simulation", "compensated", 1.5),
}
SHAFT = ("command", "encoder")
ANGLES = ("measured", "nominal", "compensated")
ERRORS = ("nominal_error", "compensated_error")
SIMULATED = ("measured", "simulated", "corrected")
LEFT_OUT = ("simulated_error", "corrected_error")
AS_POINTS = ("measured", *ERRORS, *LEFT_OUT)

Signals = dict[str, tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class AxisReview:
    """What is shown of one axis.

    recording: with `<axis>_command_deg`, `_angle_deg`, perhaps `_encoder_deg`; markers: a row for
    each sample as `stages.vision` leaves it, none at all where no frame was looked at; read_frame:
    encoded, None where lost; predictions: `stages.evaluation.predict_cycles`; loop_png: a picture.
    """

    recording: Recording
    markers: pd.DataFrame
    read_frame: Callable[[int], bytes | None]
    predictions: pd.DataFrame
    loop_png: bytes


@dataclass(frozen=True)
class DiagnosisReview:
    """What is shown of one measurement's diagnosis.

    time_s: (n,). values: the series of `SIMULATED` and `LEFT_OUT` by name, each (n,) [unit], NaN
    where there is none. pictures: PNGs by name (a word).
    """

    time_s: np.ndarray
    values: Mapping[str, np.ndarray]
    unit: str
    pictures: Mapping[str, bytes]


def write_review(
    path: Path, axes: Mapping[str, AxisReview], pictures: Mapping[str, bytes], summary: str
) -> None:
    """Write the recording whole, or leave the old one.

    `pictures` are PNGs by name (a word), `summary` is Markdown. Frames wider than 640 px are halved
    until they are not, and evenly thinned to at most 1000 an axis; the signals keep every sample.
    """
    signals = {axis: _signals(axis, review) for axis, review in axes.items()}
    with _written(path, blueprint(signals, list(pictures))) as stream:
        for axis, review in axes.items():
            _log_axis(stream, axis, review, signals[axis])
        _log_pictures(stream, "figures", pictures)
        _log_summary(stream, summary)


def write_diagnosis_review(
    path: Path, measurements: Mapping[str, DiagnosisReview], summary: str
) -> None:
    """Write the recording of a diagnosis whole, or leave the old one; `summary` is Markdown."""
    signals = {
        name: _finite({k: (review.time_s, v) for k, v in review.values.items()})
        for name, review in measurements.items()
    }
    views: list[rrb.Container | rrb.View] = []
    for name, review in measurements.items():
        plots = rrb.Vertical(
            _series_view(name, SIMULATED, f"measured and simulated [{review.unit}]", signals[name]),
            _series_view(name, LEFT_OUT, f"measured − simulated [{review.unit}]", signals[name]),
        )
        pictures = [
            _picture_view(f"{name}/figures/{p}", p.replace("_", " ")) for p in review.pictures
        ]
        views.append(rrb.Horizontal(plots, rrb.Tabs(*pictures), name=name))
    views.append(rrb.TextDocumentView(origin="summary", name="Summary"))
    with _written(path, _opened(rrb.Tabs(*views, active_tab=0))) as stream:
        for name, review in measurements.items():
            _log_signals(stream, name, signals[name])
            _log_pictures(stream, f"{name}/figures", review.pictures)
        _log_summary(stream, summary)


@contextmanager
def _written(path: Path, layout: rrb.Blueprint) -> Iterator[rr.RecordingStream]:
    """A stream that is written to `path` once all is in it."""
    rr.set_strict_mode(True)
    stream = rr.RecordingStream(APPLICATION)
    memory = stream.memory_recording()  # rerun's own file sink waits for ever on a full disk
    stream.send_blueprint(layout)
    yield stream
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, memory.drain_as_bytes())


def blueprint(signals: Mapping[str, Signals], pictures: Sequence[str]) -> rrb.Blueprint:
    """What opens: a row for each axis (camera, signals, loop), and tabs of what belongs beside.

    The signals' plots open at their full length and height, with room for the legend.
    """
    overview = rrb.Vertical(*(_axis_row(axis, signals[axis]) for axis in signals), name="Overview")
    shafts = [_series_view(axis, SHAFT, "motor shaft [deg]", signals[axis]) for axis in signals]
    loops = rrb.Vertical(
        *(rrb.Horizontal(_loop_view(axis), _picture_view(f"{axis}/loop_picture", f"{axis}: loop"))
          for axis in signals),
        name="On the loop",
    )  # fmt: skip
    figures = [_picture_view(f"figures/{name}", name.capitalize()) for name in pictures]
    summary = rrb.TextDocumentView(origin="summary", name="Summary")
    notes = rrb.TextLogView(origin="/", contents="/**/notes", name="Notes")
    shaft = rrb.Vertical(*shafts, name="Motor shafts")
    return _opened(rrb.Tabs(overview, shaft, loops, *figures, summary, notes, active_tab=0))


def _opened(views: rrb.Tabs) -> rrb.Blueprint:
    return rrb.Blueprint(
        views,
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="paused"),
        auto_views=False,
        auto_layout=False,
    )


def _axis_row(axis: str, signals: Signals) -> rrb.Horizontal:
    return rrb.Horizontal(
        rrb.Spatial2DView(origin=f"{axis}/camera", name=f"{axis}: camera"),
        rrb.Vertical(
            _series_view(axis, ANGLES, "bending angle [deg]", signals),
            _series_view(axis, ERRORS, "measured − predicted [deg]", signals),
        ),
        _picture_view(f"{axis}/loop_picture", f"{axis}: loop"),
        column_shares=[1.1, 1.6, 0.9],
    )


def _series_view(
    axis: str, series: Sequence[str], title: str, signals: Signals
) -> rrb.TimeSeriesView:
    series = [name for name in series if name in signals]
    time_s = np.concatenate([signals[name][0] for name in series])
    values = np.concatenate([signals[name][1] for name in series])
    longest_s = float(time_s.max()) if len(time_s) else 0.0
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    room = 0.05 * (high - low) or 1.0
    whole = rrb.TimeRange(
        start=rrb.TimeRangeBoundary.absolute(seconds=0.0),
        end=rrb.TimeRangeBoundary.absolute(seconds=ROOM_FOR_LEGEND * longest_s),
    )
    return rrb.TimeSeriesView(
        origin=f"{axis}/signals",
        contents=[f"$origin/{name}" for name in series],
        name=f"{axis}: {title}",
        axis_x=rrb.TimeAxis(view_range=whole),
        axis_y=rrb.ScalarAxis(range=(low - room, high + room)),
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop),
    )


def _picture_view(origin: str, title: str) -> rrb.Spatial2DView:
    return rrb.Spatial2DView(origin=origin, name=title, background=PAPER)


def _loop_view(axis: str) -> rrb.Spatial2DView:
    return rrb.Spatial2DView(origin=f"{axis}/loop", name=f"{axis}: angle over command [deg]")


def _signals(axis: str, review: AxisReview) -> Signals:
    """Time since the axis's first sample [s] and values [deg] of each series, both (n,)."""
    recording, predictions = review.recording, review.predictions
    begin_s = recording.values("time_s")[:1].sum()
    time_s = recording.values("time_s") - begin_s
    predicted_s = predictions["time_s"].to_numpy(float) - begin_s
    columns = {name: predictions[f"{name}_deg"].to_numpy(float) for name in ANGLES}
    series = {
        "command": (time_s, recording.values(f"{axis}_command_deg")),
        "measured": (time_s, recording.values(f"{axis}_angle_deg")),
        "nominal": (predicted_s, columns["nominal"]),
        "compensated": (predicted_s, columns["compensated"]),
        "nominal_error": (predicted_s, columns["measured"] - columns["nominal"]),
        "compensated_error": (predicted_s, columns["measured"] - columns["compensated"]),
    }
    if f"{axis}_encoder_deg" in recording.samples:
        series["encoder"] = (time_s, recording.values(f"{axis}_encoder_deg"))
    return _finite(series)


def _finite(series: Signals) -> Signals:
    return {
        name: (when_s[np.isfinite(values)], values[np.isfinite(values)])
        for name, (when_s, values) in series.items()
    }


def _log_axis(stream: rr.RecordingStream, axis: str, review: AxisReview, signals: Signals) -> None:
    time_s = review.recording.values("time_s")
    time_s = time_s - time_s[:1].sum()
    _log_frames(stream, axis, review, time_s)
    _log_signals(stream, axis, signals)
    _log_loop(stream, axis, review, time_s)
    if len(review.markers):
        _log_notes(stream, axis, review.markers, time_s)
    _log_pictures(stream, axis, {"loop_picture": review.loop_png})


def _log_pictures(stream: rr.RecordingStream, entity: str, pictures: Mapping[str, bytes]) -> None:
    for name, png in pictures.items():
        image = rr.EncodedImage(contents=png, media_type="image/png")
        stream.log(f"{entity}/{name}", image, static=True)


def _log_summary(stream: rr.RecordingStream, summary: str) -> None:
    document = rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN)
    stream.log("summary", document, static=True)


def _log_frames(
    stream: rr.RecordingStream, axis: str, review: AxisReview, time_s: np.ndarray
) -> None:
    every = max(1, -(-len(time_s) // FRAMES_AT_MOST))
    rows = list(range(0, len(time_s), every))
    shrink = 1
    with ThreadPoolExecutor(2) as pool:
        for begin in range(0, len(rows), FRAMES_A_CHUNK):
            chunk = rows[begin : begin + FRAMES_A_CHUNK]
            small = pool.map(small_jpeg, map(review.read_frame, chunk))
            seen = [(row, *frame) for row, frame in zip(chunk, small, strict=True) if frame]
            if not seen:
                continue
            shrink = seen[0][2]
            stream.send_columns(
                f"{axis}/camera/frame",
                [_times(time_s[[row for row, *_ in seen]])],
                rr.EncodedImage.columns(
                    blob=[jpeg for _, jpeg, _ in seen], media_type=["image/jpeg"] * len(seen)
                ),
            )
    if len(review.markers):
        _log_markers(stream, axis, review.markers.iloc[rows], time_s[rows], shrink)


def _log_markers(
    stream: rr.RecordingStream, axis: str, markers: pd.DataFrame, time_s: np.ndarray, shrink: int
) -> None:
    """Centres and lines over the frames; rerun counts pixels from the corner, not the centre."""
    green, red, base = (
        (markers[[f"{name}_x_px", f"{name}_y_px"]].to_numpy(float) + 0.5) / shrink
        for name in ("green", "red", "base")
    )
    for name, centre in (("green", green), ("red", red)):
        entity = f"{axis}/camera/{name}_marker"
        look = rr.Points2D.from_fields(colors=[_rgb(f"{name}_marker")], radii=[_points(5.0)])
        stream.log(entity, look, static=True)
        there = np.isfinite(centre).all(axis=1)
        columns = rr.Points2D.columns(positions=centre[there]).partition(there.astype(int))
        stream.send_columns(entity, [_times(time_s)], columns)
    turn = np.radians(markers["base_direction_deg"].to_numpy(float))
    along = np.stack([np.cos(turn), -np.sin(turn)], axis=1) * 220.0 / shrink
    lines = {
        "base_line": np.stack([base - along, base + along], axis=1),
        "marker_line": np.stack([green - 0.5 * (red - green), red + 0.5 * (red - green)], axis=1),
    }
    for name, strips in lines.items():
        entity = f"{axis}/camera/{name}"
        line = rr.LineStrips2D.from_fields(colors=[_rgb(name)], radii=[_points(1.2)])
        stream.log(entity, line, static=True)
        there = np.isfinite(strips).all(axis=(1, 2))
        columns = rr.LineStrips2D.columns(strips=list(strips[there].astype(np.float32))).partition(
            there.astype(int)
        )
        stream.send_columns(entity, [_times(time_s)], columns)


def _log_signals(stream: rr.RecordingStream, axis: str, signals: Signals) -> None:
    for name, (time_s, values) in signals.items():
        entity = f"{axis}/signals/{name}"
        label, colour, width = SERIES[name]
        look = (
            rr.SeriesPoints(
                colors=[_rgb(colour)], names=[label], markers=["circle"], marker_sizes=[width]
            )
            if name in AS_POINTS
            else rr.SeriesLines(colors=[_rgb(colour)], names=[label], widths=[width])
        )
        stream.log(entity, look, static=True)
        stream.send_columns(entity, [_times(time_s)], rr.Scalars.columns(scalars=values))


def _log_loop(
    stream: rr.RecordingStream, axis: str, review: AxisReview, time_s: np.ndarray
) -> None:
    """The loop as lines: command to the right, angle upwards (rerun's y points down)."""
    command = review.recording.values(f"{axis}_command_deg")
    angle = review.recording.values(f"{axis}_angle_deg")
    there = np.isfinite(angle)
    points = np.stack([command, -angle], axis=1)
    lines = {"measured": points[there]}
    for name, method, direction in (
        ("nominal", "nominal", None), ("cw", "compensated", 1), ("ccw", "compensated", -1)
    ):  # fmt: skip
        table = review.predictions
        branch = table if direction is None else table[table["direction"] == direction]
        curve = branch.drop_duplicates("command_deg").sort_values("command_deg")
        curve_points = np.stack([curve["command_deg"], -curve[f"{method}_deg"]], axis=1)
        lines[name] = curve_points
    for order, (name, line) in enumerate(lines.items()):
        width = _points(0.4 if name == "measured" else 1.0)
        strip = rr.LineStrips2D([line], colors=[_rgb(name)], radii=[width], draw_order=order)
        stream.log(f"{axis}/loop/{name}", strip, static=True)
    look = rr.Points2D.from_fields(colors=[_rgb("now")], radii=[_points(5.0)])
    stream.log(f"{axis}/loop/now", look, static=True)
    columns = rr.Points2D.columns(positions=points[there]).partition(there.astype(int))
    stream.send_columns(f"{axis}/loop/now", [_times(time_s)], columns)


def _log_notes(
    stream: rr.RecordingStream, axis: str, markers: pd.DataFrame, time_s: np.ndarray
) -> None:
    """One line for each frame that was set aside, with the reason."""
    reason = markers["reason"].astype(object).fillna("").to_numpy(str)
    noted = np.flatnonzero(markers["outlier"].to_numpy(bool) | (reason != ""))
    if not len(noted):
        return
    texts = [f"{axis}, sample {i}: {reason[i] or 'outlier'}" for i in noted]
    columns = rr.TextLog.columns(text=texts, level=["WARN"] * len(noted))
    stream.send_columns(f"{axis}/notes", [_times(time_s[noted])], columns)


def _times(time_s: np.ndarray) -> rr.TimeColumn:
    return rr.TimeColumn(TIMELINE, duration=time_s)


def _points(width: float) -> float:
    """A radius in points of the screen: rerun keeps these as negative numbers."""
    return -width


def _rgb(name: str) -> list[int]:
    return list(bytes.fromhex(COLOURS[name].removeprefix("#")))
