"""What is on disk while a recording grows, and folders that can't be written."""

import errno
import math
import os
from pathlib import Path

import pytest

from pipeline.errors import LoopgapError
from pipeline.recorder import Recorder
from pipeline.recording import Channel, load_recording

CHANNELS = (
    Channel("yaw_command_deg", "command", "deg"),
    Channel("yaw_encoder_deg", "encoder", "deg"),
)


def sample(step: int) -> dict[str, float]:
    angle = 0.1 * step
    return {
        "time_s": step / 3,
        "cycle": 0,
        "step": step,
        "yaw_command_deg": angle,
        "yaw_encoder_deg": angle + 1e-9,
    }


def test_every_row_is_loadable_before_the_next(tmp_path: Path) -> None:
    with Recorder(tmp_path / "run" / "yaw", CHANNELS, "simulated") as recorder:
        assert len(load_recording(tmp_path / "run" / "yaw").samples) == 0
        for step in range(5):
            recorder.write(sample(step), {"yaw": b"image %d" % step})
            recording = load_recording(tmp_path / "run" / "yaw")
            assert recording.samples.iloc[-1].to_dict() == sample(step)
            frame = tmp_path / "run" / "yaw" / "frames" / f"yaw_{step:06d}.jpg"
            assert frame.read_bytes() == b"image %d" % step
    assert recording.source == "simulated"
    assert recording.channels == CHANNELS


def test_frame_is_there_before_its_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = Recorder(tmp_path / "yaw", CHANNELS, "real")
    recorder.write(sample(0), {"yaw": b"image"})
    sync, synced = os.fsync, []

    def watch(descriptor: int) -> None:
        synced.append(Path(os.readlink(f"/proc/self/fd/{descriptor}")).name)
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", watch)
    recorder.write(sample(1), {"yaw": b"image"})
    assert synced == [".yaw_000001.jpg.part", "samples.csv"]
    recorder.close()


def test_an_empty_measurement_stays_empty(tmp_path: Path) -> None:
    with Recorder(tmp_path / "yaw", CHANNELS, "real") as recorder:
        recorder.write(sample(0) | {"yaw_encoder_deg": math.nan}, {})
    assert load_recording(tmp_path / "yaw").samples["yaw_encoder_deg"].isna().all()


def test_a_full_disk_leaves_whole_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorder = Recorder(tmp_path / "yaw", CHANNELS, "real")
    recorder.write(sample(0), {})
    write = os.write
    monkeypatch.setattr(os, "write", lambda file, data: write(file, data[:7]))
    with pytest.raises(LoopgapError, match="yaw: expected a folder that can be written.*no space"):
        recorder.write(sample(1), {})
    monkeypatch.undo()
    recorder.write(sample(1), {})
    recorder.close()
    assert list(load_recording(tmp_path / "yaw").samples["step"]) == [0, 1]


def test_a_sample_with_a_wrong_column_is_refused(tmp_path: Path) -> None:
    row = sample(0)
    del row["yaw_encoder_deg"]
    with (
        Recorder(tmp_path / "yaw", CHANNELS, "real") as recorder,
        pytest.raises(LoopgapError, match="a sample of time_s, cycle, .*yaw_encoder_deg; found"),
    ):
        recorder.write(row, {})


def test_a_recording_is_never_overwritten(tmp_path: Path) -> None:
    Recorder(tmp_path, CHANNELS, "real").close()
    with pytest.raises(LoopgapError, match=r"without a recording; found recording\.json in it"):
        Recorder(tmp_path, CHANNELS, "real")


def test_output_below_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("in the way")
    with pytest.raises(LoopgapError, match=r"can be written; found .*Not a directory.*hydra\.run"):
        Recorder(tmp_path / "out" / "yaw", CHANNELS, "real")


def test_read_only_output_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The administrator may write anywhere: there the system's refusal is played."""
    folder = tmp_path / "locked"
    folder.mkdir()
    folder.chmod(0o500)
    if os.access(folder, os.W_OK):

        def refuse(path: Path, *_: object, **__: object) -> None:
            raise OSError(errno.EROFS, os.strerror(errno.EROFS), str(path))

        monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(LoopgapError, match="expected a folder that can be written; found .*locked"):
        Recorder(folder / "yaw", CHANNELS, "real")
    monkeypatch.undo()
    folder.chmod(0o700)
