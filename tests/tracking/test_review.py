import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest
from full_disk import full_at
from play_loop import curve, play, triangle
from rerun.chunk import RrdReader

from pipeline.recording import Channel, Recording
from pipeline.tracking.figures import loop_picture
from pipeline.tracking.review import AxisReview, write_review
from pipeline.tracking.thumbnail import WIDTH_PX

STEPS = 40
WIDTH, HEIGHT = 1008, 756
GREEN_PX, RED_PX, BASE_PX = (520.0, 380.0), (700.0, 340.0), (230.0, 378.0)
LOST_MARKER, LOST_FRAME, OUTLIER = 3, 5, 7
VIEWS = {
    "yaw: camera", "yaw: bending angle [deg]", "yaw: measured − predicted [deg]", "yaw: loop",
    "yaw: motor shaft [deg]", "yaw: angle over command [deg]", "Errors", "Summary", "Notes",
}  # fmt: skip


def jpeg() -> bytes:
    image = np.full((HEIGHT, WIDTH, 3), 170, np.uint8)
    cv2.circle(image, (round(GREEN_PX[0]), round(GREEN_PX[1])), 24, (60, 190, 60), -1)
    cv2.circle(image, (round(RED_PX[0]), round(RED_PX[1])), 24, (40, 40, 210), -1)
    return cv2.imencode(".jpg", image)[1].tobytes()


def predictions() -> pd.DataFrame:
    command = triangle(1, 60.0, STEPS)
    angle = curve(play(command, 1.5))
    return pd.DataFrame(
        {
            "time_s": 100.0 + 3.0 * np.arange(STEPS),
            "cycle": 0,
            "direction": np.where(np.gradient(command) >= 0, 1, -1),
            "command_deg": command,
            "measured_deg": angle + 0.1,
            "nominal_deg": curve(command),
            "nominal_std_deg": 1.2,
            "compensated_deg": angle,
            "compensated_std_deg": 0.2,
        }
    )


def markers() -> pd.DataFrame:
    table = pd.DataFrame(
        {
            "green_x_px": GREEN_PX[0], "green_y_px": GREEN_PX[1],
            "red_x_px": RED_PX[0], "red_y_px": RED_PX[1],
            "base_x_px": BASE_PX[0], "base_y_px": BASE_PX[1], "base_direction_deg": 0.0,
            "outlier": False, "reason": "",
        },
        index=range(STEPS),
    )  # fmt: skip
    table.loc[LOST_MARKER, ["green_x_px", "green_y_px"]] = np.nan
    table.loc[LOST_MARKER, "reason"] = "no green marker"
    table.loc[OUTLIER, "outlier"] = True
    return table


def axis_review(axis: str, frame: bytes) -> AxisReview:
    table = predictions()
    samples = table[["time_s", "cycle"]].assign(
        step=np.arange(STEPS),
        **{
            f"{axis}_command_deg": table["command_deg"],
            f"{axis}_encoder_deg": table["command_deg"],
            f"{axis}_angle_deg": table["measured_deg"].mask(table.index == LOST_MARKER),
        },
    )
    channels = (
        Channel(f"{axis}_command_deg", "command", "deg"),
        Channel(f"{axis}_encoder_deg", "encoder", "deg"),
        Channel(f"{axis}_angle_deg", "measurement", "deg"),
    )
    frames = dict.fromkeys(range(STEPS), frame) | {LOST_FRAME: b"no image"}
    picture = loop_picture(axis, table)
    return AxisReview(Recording(samples, channels), markers(), frames.get, table, picture)


@pytest.fixture(scope="module")
def review(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "review" / "run.rrd"
    axes = {axis: axis_review(axis, jpeg()) for axis in ("yaw", "pitch")}
    write_review(path, axes, {"errors": axes["yaw"].loop_png}, "# What came out\n")
    return path


def column(path: Path, entity: str, name: str) -> pd.Series:
    """All values of a component of an entity, in the order of time."""
    tables = []
    for chunk in RrdReader(path).store().stream():
        if chunk.entity_path == entity and name in chunk.to_record_batch().schema.names:
            tables.append(chunk.to_record_batch().to_pandas())
    table = pd.concat(tables)
    return (table.sort_values("time") if "time" in table else table)[name]


def test_every_entity_is_there(review: Path) -> None:
    found = set(RrdReader(review).store().schema().entity_paths())
    for axis in ("yaw", "pitch"):
        for name in ("camera/frame", "camera/green_marker", "camera/red_marker",
                     "camera/base_line", "camera/marker_line", "signals/command",
                     "signals/encoder", "signals/measured", "signals/nominal",
                     "signals/compensated", "signals/nominal_error", "signals/compensated_error",
                     "loop/measured", "loop/nominal", "loop/cw", "loop/ccw", "loop/now",
                     "loop_picture", "notes"):  # fmt: skip
            assert f"/{axis}/{name}" in found
    assert {"/figures/errors", "/summary"} <= found
    assert [p.name for p in review.parent.iterdir()] == ["run.rrd"]


def test_frames_are_small_and_markers_lie_on_them(review: Path) -> None:
    blobs = column(review, "/yaw/camera/frame", "EncodedImage:blob")
    assert len(blobs) == STEPS - 1  # one was no image
    image = cv2.imdecode(np.asarray(blobs.iloc[0][0], np.uint8), cv2.IMREAD_COLOR)
    assert image.shape[1] == WIDTH // 2 <= WIDTH_PX
    points = column(review, "/yaw/camera/green_marker", "Points2D:positions")
    points = points[points.notna()]
    x, y = points.iloc[0][0]
    assert (x, y) == pytest.approx(((GREEN_PX[0] + 0.5) / 2, (GREEN_PX[1] + 0.5) / 2))
    blue, green, red = image[int(y), int(x)].astype(int)
    assert green > 1.5 * max(blue, red)
    assert [len(p) for p in points].count(0) == 1
    assert len(points.iloc[LOST_MARKER]) == 0


def test_lines_run_through_base_and_markers(review: Path) -> None:
    strips = column(review, "/yaw/camera/base_line", "LineStrips2D:strips").dropna()
    (x0, y0), (x1, y1) = (np.asarray(p, float) for p in strips.iloc[0][0])
    assert y0 == y1 == pytest.approx((BASE_PX[1] + 0.5) / 2)
    assert (x0 + x1) / 2 == pytest.approx((BASE_PX[0] + 0.5) / 2)
    strips = column(review, "/yaw/camera/marker_line", "LineStrips2D:strips").dropna()
    begin, end = (np.asarray(p, float) for p in strips.iloc[0][0])
    slope = (RED_PX[1] - GREEN_PX[1]) / (RED_PX[0] - GREEN_PX[0])
    assert (end - begin)[1] / (end - begin)[0] == pytest.approx(slope)


def test_signals_keep_every_sample_and_start_at_zero(review: Path) -> None:
    scalars = column(review, "/pitch/signals/nominal", "Scalars:scalars").dropna()
    assert np.allclose([s[0] for s in scalars], predictions()["nominal_deg"])
    measured = column(review, "/pitch/signals/measured", "Scalars:scalars").dropna()
    assert len(measured) == STEPS - 1
    times = column(review, "/pitch/signals/nominal", "time").dropna()
    assert times.iloc[0] == pd.Timedelta(0)
    assert times.iloc[-1] == pd.Timedelta(seconds=3.0 * (STEPS - 1))


def test_loop_points_upwards(review: Path) -> None:
    strip = column(review, "/pitch/loop/nominal", "LineStrips2D:strips").iloc[0][0]
    points = np.stack([np.asarray(p, float) for p in strip])
    assert np.allclose(points[:, 1], -curve(points[:, 0]), atol=1e-4)


def test_notes_say_which_frame_was_set_aside_and_why(review: Path) -> None:
    texts = column(review, "/yaw/notes", "TextLog:text").tolist()
    assert [t[0] for t in texts] == [
        f"yaw, sample {LOST_MARKER}: no green marker", f"yaw, sample {OUTLIER}: outlier",
    ]  # fmt: skip


def test_blueprint_names_its_views(review: Path) -> None:
    reader = RrdReader(review)
    (entry,) = reader.blueprints()
    names = set()
    for chunk in reader.store(store=entry).stream():
        batch = chunk.to_record_batch()
        for field in batch.schema.names:
            if field.endswith("display_name"):
                names |= {value[0] for value in batch.column(field).to_pylist() if value}
    assert names >= VIEWS | {view.replace("yaw", "pitch") for view in VIEWS} | {"Overview"}


def test_a_recording_without_frames_markers_and_encoder_can_be_reviewed(tmp_path: Path) -> None:
    whole = axis_review("yaw", jpeg())
    samples = whole.recording.samples.drop(columns="yaw_encoder_deg")
    recording = Recording(
        samples, tuple(c for c in whole.recording.channels if "enc" not in c.name)
    )
    bare = AxisReview(
        recording, pd.DataFrame(), lambda _row: None, whole.predictions, whole.loop_png
    )
    write_review(tmp_path / "run.rrd", {"yaw": bare}, {}, "")
    found = RrdReader(tmp_path / "run.rrd").store().schema().entity_paths()
    assert "/yaw/signals/measured" in found
    assert "/yaw/camera/frame" not in found
    assert "/yaw/signals/encoder" not in found


def test_a_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    (tmp_path / "run.rrd").write_bytes(b"old")
    whole = axis_review("yaw", jpeg())
    broken = replace(whole, markers=whole.markers.drop(columns="base_direction_deg"))
    with pytest.raises(KeyError, match="base_direction_deg"):
        write_review(tmp_path / "run.rrd", {"yaw": broken}, {}, "")
    assert [p.name for p in tmp_path.iterdir()] == ["run.rrd"]
    assert (tmp_path / "run.rrd").read_bytes() == b"old"


@pytest.mark.parametrize("size", [0, 4096, 20_000])
def test_a_full_disk_leaves_the_old_file_and_is_told_with_its_name(
    size: int, tmp_path: Path
) -> None:
    path = tmp_path / "run.rrd"
    path.write_bytes(b"old")
    with full_at(size), pytest.raises(OSError, match="run.rrd"):
        write_review(path, {"yaw": axis_review("yaw", jpeg())}, {}, "")
    assert [f.name for f in tmp_path.iterdir()] == ["run.rrd"]
    assert path.read_bytes() == b"old"


def test_the_viewer_shows_frames_and_signals(review: Path, tmp_path: Path) -> None:
    viewer = shutil.which("rerun") or shutil.which("rerun", path=str(Path(sys.executable).parent))
    assert viewer is not None
    environment = os.environ | {"HOME": str(tmp_path), "XDG_RUNTIME_DIR": str(tmp_path)}
    subprocess.run(
        [viewer, "analytics", "disable"], env=environment, capture_output=True, check=True
    )
    picture = tmp_path / "screen.png"
    command = [viewer, "-", "--bind", "127.0.0.1", "--port", "auto", "--headless",
               "--window-size", "1400x900", "--screenshot-to", str(picture)]  # fmt: skip
    with review.open("rb") as recording:
        shown = subprocess.run(command, env=environment, stdin=recording, capture_output=True,
                               timeout=60, check=False)  # fmt: skip
    said = (shown.stdout + shown.stderr).decode(errors="replace")
    if re.search("failed to get render context|no suitable.*adapter", said, re.IGNORECASE):
        pytest.skip("no graphics driver for the viewer; Debian's is mesa-vulkan-drivers")
    assert shown.returncode == 0, said
    image = cv2.imread(str(picture))
    scale = image.shape[1] / 1400
    camera = image[round(120 * scale) : round(420 * scale), : round(400 * scale)].reshape(-1, 3)
    plots = image[:, round(480 * scale) : round(900 * scale)].reshape(-1, 3)
    for pixels, bgr in ((camera, (60, 190, 60)), (camera, (40, 40, 210)), (camera, (170, 170, 170)),
                        (plots, (58, 116, 240)), (plots, (233, 180, 86))):  # fmt: skip
        assert (np.abs(pixels.astype(int) - bgr).max(axis=1) < 16).sum() > 30, bgr
