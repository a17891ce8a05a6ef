"""Stored images and videos as cameras: order, decoder, end, and what is no image."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from pipeline.config import CameraConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.hardware.folder_camera import FolderCamera


def grey(value: int) -> np.ndarray:
    return np.full((48, 64, 3), value, np.uint8)


def camera_of(source: Path) -> FolderCamera:
    return FolderCamera("yaw", CameraConfig(kind="folder", sources={"yaw": str(source)}))


def level(jpeg: bytes) -> int:
    image = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert image is not None
    return int(np.median(image))


def test_files_come_by_their_numbers_and_jpegs_untouched(tmp_path: Path) -> None:
    for number in (10, 9, 100, 1):
        cv2.imwrite(str(tmp_path / f"yaw_{number}.jpg"), grey(number))
    camera = camera_of(tmp_path)
    grabbed = [camera.grab() for _ in range(4)]
    assert grabbed == [(tmp_path / f"yaw_{n}.jpg").read_bytes() for n in (1, 9, 10, 100)]


def test_other_formats_become_jpeg(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "0.png"), grey(77))
    jpeg = camera_of(tmp_path).grab()
    assert jpeg.startswith(b"\xff\xd8")
    assert level(jpeg) == 77


def test_video_frames_come_in_order(tmp_path: Path) -> None:
    file = tmp_path / "yaw.avi"
    writer = cv2.VideoWriter(str(file), cv2.VideoWriter.fourcc(*"MJPG"), 10, (64, 48))
    assert writer.isOpened()
    for value in (20, 90, 200):
        writer.write(grey(value))
    writer.release()
    camera = camera_of(file)
    assert [level(camera.grab()) for _ in range(3)] == pytest.approx([20, 90, 200], abs=2)
    with pytest.raises(LoopgapError, match="an image for sample 4; found 3 images in all"):
        camera.grab()
    camera.close()


def test_no_image_comes_twice(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "0.jpg"), grey(0))
    camera = camera_of(tmp_path)
    camera.grab()
    with pytest.raises(LoopgapError, match="an image for sample 2; found 1 images in all"):
        camera.grab()


@pytest.mark.parametrize("content", [b"", b"\xff\xd8\xff\xe0 no picture"])
def test_unreadable_image_is_named(tmp_path: Path, content: bytes) -> None:
    cv2.imwrite(str(tmp_path / "0.jpg"), grey(0))
    (tmp_path / "1.jpg").write_bytes(content)
    camera = camera_of(tmp_path)
    camera.grab()
    with pytest.raises(LoopgapError, match=rf"1\.jpg: .*{len(content)} bytes that no decoder"):
        camera.grab()


def test_folder_without_images(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("no image")
    with pytest.raises(LoopgapError, match=r"expected images \(\.jpg.*found none"):
        camera_of(tmp_path)


def test_absent_source(tmp_path: Path) -> None:
    with pytest.raises(LoopgapError, match=r"nowhere: .*no such file.*`camera\.sources`"):
        camera_of(tmp_path / "nowhere")


def test_file_that_is_no_video(tmp_path: Path) -> None:
    (tmp_path / "film.mkv").write_text("no film")
    with pytest.raises(LoopgapError, match=r"film\.mkv: expected a video; found .*no decoder"):
        camera_of(tmp_path / "film.mkv")


def test_camera_without_source() -> None:
    with pytest.raises(UsageError, match=r"`\+camera\.sources\.yaw=PATH`"):
        FolderCamera("yaw", CameraConfig(kind="folder"))
