"""A camera that replays images of a folder, or the frames of a video file, in order."""

import re
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from pipeline.config import CameraConfig
from pipeline.errors import UsageError, refusal
from pipeline.hardware.robot import HardwareError
from pipeline.hardware.v4l2 import encode_jpeg

JPEG_SUFFIXES = (".jpg", ".jpeg")
IMAGE_SUFFIXES = (*JPEG_SUFFIXES, ".png", ".bmp", ".tif", ".tiff")


class FolderCamera:
    """Every `grab` gives the next image of `camera.sources.<name>`; there is no image twice.

    Files are taken by name, numbers in it by their value (2 before 10). JPEG files are handed on
    as they are, after a decoder could read them; all else is encoded at `camera.jpeg_quality`.
    """

    def __init__(self, name: str, config: CameraConfig) -> None:
        self.name = name
        if name not in config.sources:
            raise UsageError(
                refusal("camera.sources", f"a folder or video file for {name!r}",
                        f"{config.sources}", f"Say `+camera.sources.{name}=PATH`.")
            )  # fmt: skip
        self._source = Path(config.sources[name])
        self._given = 0
        if self._source.is_dir():
            self._images = _images_of_folder(_image_files(self._source), config.jpeg_quality)
        else:
            self._images = _images_of_video(_open_video(self._source), config.jpeg_quality)

    def grab(self) -> bytes:
        image = next(self._images, None)
        if image is None:
            raise HardwareError(
                refusal(str(self._source), f"an image for sample {self._given + 1}",
                        f"{self._given} images in all", "Replay no more steps than it has images.")
            )  # fmt: skip
        self._given += 1
        return image

    def close(self) -> None:
        self._images = iter(())


def _image_files(folder: Path) -> list[Path]:
    files = [f for f in folder.iterdir() if f.suffix.lower() in IMAGE_SUFFIXES]
    if not files:
        raise HardwareError(
            refusal(str(folder), f"images ({', '.join(IMAGE_SUFFIXES)})", "none",
                    "Name the folder that holds the images themselves.")
        )  # fmt: skip
    return sorted(files, key=lambda file: _by_number(file.name))


def _by_number(name: str) -> list[tuple[int, str]]:
    return [(int(p), "") if p.isdigit() else (-1, p) for p in re.split(r"(\d+)", name)]


def _images_of_folder(files: list[Path], quality: int) -> Iterator[bytes]:
    for file in files:
        data = file.read_bytes()
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
        if image is None:
            raise HardwareError(
                refusal(str(file), "an image", f"{len(data)} bytes that no decoder reads",
                        "Replace the file, or take it out of the folder with its sample.")
            )  # fmt: skip
        yield data if file.suffix.lower() in JPEG_SUFFIXES else encode_jpeg(image, quality)


def _open_video(file: Path) -> cv2.VideoCapture:
    if not file.exists():
        raise HardwareError(
            refusal(str(file), "a folder of images or a video file", "no such file",
                    "Correct `camera.sources`.")
        )  # fmt: skip
    video = cv2.VideoCapture(str(file))
    if not video.isOpened():
        raise HardwareError(
            refusal(str(file), "a video", "a file that no decoder reads",
                    "Convert it, for example to FFV1 in Matroska (.mkv).")
        )  # fmt: skip
    return video


def _images_of_video(video: cv2.VideoCapture, quality: int) -> Iterator[bytes]:
    try:
        while True:
            taken, image = video.read()
            if not taken:
                return
            yield encode_jpeg(image, quality)
    finally:
        video.release()
