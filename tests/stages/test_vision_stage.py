from dataclasses import dataclass

import numpy as np
import pandas as pd
import pytest

from pipeline.config import CameraConfig, VisionConfig
from pipeline.errors import LoopgapError
from pipeline.recording import Channel, Recording
from pipeline.stages.vision import measure_angles
from pipeline.twin.microscope import encode, render
from pipeline.vision.frames import FrameFolder

CAMERA = CameraConfig(kind="twin")
POSES = np.concatenate([np.arange(0.0, 30.0, 1.0), np.arange(30.0, 0.0, -1.0)])


@dataclass(frozen=True)
class Film:
    """Frames in memory."""

    jpegs: tuple[bytes | None, ...]

    def read(self, row: int) -> bytes | None:
        return self.jpegs[row]

    def where(self, row: int) -> str:
        return f"film, row {row}"


def blank() -> bytes:
    return encode(np.full((756, 1008, 3), 180, np.uint8), 92)


@pytest.fixture(scope="module")
def film() -> Film:
    rng = np.random.default_rng(0)
    return Film(tuple(encode(render(pose, CAMERA, rng), 92) for pose in POSES))


def recording_of(rows: int) -> Recording:
    samples = pd.DataFrame(
        {
            "time_s": 3.0 * np.arange(rows),
            "cycle": 0,
            "step": np.arange(rows),
            "yaw_command_deg": np.arange(rows) * 1.0,
        }
    )
    return Recording(samples, (Channel("yaw_command_deg", "command", "deg"),))


def with_frame(film: Film, row: int, jpeg: bytes | None) -> Film:
    return Film((*film.jpegs[:row], jpeg, *film.jpegs[row + 1 :]))


@pytest.mark.parametrize("workers", [1, 2])
def test_angles_are_added_as_a_measurement(film, workers):
    done = []
    before = recording_of(len(POSES))
    vision = measure_angles(
        VisionConfig(workers=workers), before, "yaw", film, lambda *at: done.append(at)
    )
    assert vision.recording.channel("yaw_angle_deg").role == "measurement"
    assert "yaw_angle_deg" not in before.samples
    np.testing.assert_allclose(vision.recording.values("yaw_angle_deg"), POSES, atol=0.15)
    assert vision.markers["row"].tolist() == list(range(len(POSES)))
    assert not vision.markers["outlier"].any()
    assert (vision.markers["reason"] == "").all()
    assert vision.markers.drop(columns="reason").notna().all(axis=None)
    assert done == [(n, 60) for n in range(1, 61)]


def test_lost_and_empty_frames_stay_empty_with_the_reason(film):
    holed = with_frame(with_frame(film, 3, None), 7, blank())
    vision = measure_angles(VisionConfig(workers=1), recording_of(len(POSES)), "yaw", holed)
    angle_deg = vision.recording.values("yaw_angle_deg")
    assert np.flatnonzero(np.isnan(angle_deg)).tolist() == [3, 7]
    assert vision.markers["reason"][3] == "no frame"
    assert vision.markers["reason"][7].startswith("no green marker; base shaft not found")
    assert not vision.markers["outlier"].any()


def test_an_outlier_is_flagged_and_keeps_its_value(film):
    wild = encode(render(-35.0, CAMERA, np.random.default_rng(1)), 92)
    vision = measure_angles(
        VisionConfig(workers=1), recording_of(len(POSES)), "yaw", with_frame(film, 20, wild)
    )
    assert np.flatnonzero(vision.markers["outlier"]).tolist() == [20]
    assert vision.recording.values("yaw_angle_deg")[20] == pytest.approx(-35.0, abs=0.15)


@pytest.mark.parametrize("workers", [1, 2])
def test_an_unreadable_frame_is_named(tmp_path, film, workers):
    folder = FrameFolder(tmp_path, "yaw")
    (tmp_path / "frames").mkdir()
    for row, jpeg in enumerate(film.jpegs):
        folder.path(row).write_bytes(jpeg)
    assert (
        measure_angles(VisionConfig(workers=1), recording_of(4), "yaw", folder).markers.shape[0]
        == 4
    )
    folder.path(30).write_bytes(b"no image")
    with pytest.raises(LoopgapError, match=r"frames/yaw_000030.jpg: expected an image; found 8"):
        measure_angles(VisionConfig(workers=workers), recording_of(60), "yaw", folder)


def test_a_film_without_any_marker_is_refused():
    with pytest.raises(LoopgapError, match=r"markers in at least one frame; found none in 2 \(no"):
        measure_angles(VisionConfig(workers=1), recording_of(2), "yaw", Film((blank(), blank())))
