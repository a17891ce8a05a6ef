"""ROS bags of both kinds, written by rosbags: joints, numbers, images, and what is refused."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

from pipeline import app
from pipeline.config import Config
from pipeline.errors import LoopgapError, UsageError
from pipeline.foreign.bag import _joints
from pipeline.foreign.images import encoded
from pipeline.recording import load_recording
from pipeline.runners.importing import run_importing
from pipeline.runners.run_folder import Run
from pipeline.vision.frames import FrameFolder
from tests.foreign.mapped import import_from, mapping

START_NS = 1_700_000_000_000_000_000
JOINTS = """
tables:
  joints:
    file: {file}
    reading: {{topic: /joint_states}}
    time: {{column: header.stamp, unit: ns}}
    channels:
      elbow_deg: {{column: elbow.position, role: measurement, from_unit: rad, unit: deg}}
  commands:
    file: {file}
    reading: {{topic: /command}}
    time: {{column: log_time, unit: ns}}
    resample: previous
    channels:
      command_deg: {{column: data, role: command, unit: deg, fill: previous}}
  camera:
    file: {file}
    reading: {{topic: {camera}}}
    time: {{column: header.stamp, unit: ns}}
    resample: nearest
    frames: elbow
"""
KINDS = ("ros1.bag", "sqlite3", "mcap")


def picture(number: int) -> np.ndarray:
    image = np.zeros((24, 32, 3), np.uint8)
    image[:, : 4 + number] = (10, 200, 30)  # green, as rgb
    return image


def write_bag(path: Path, kind: str, steps: int = 20) -> None:
    """Joints at 20 Hz whose order changes, commands at 10 Hz from 20 ms before, images at 5 Hz."""
    ros1 = kind == "ros1.bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    types = store.types
    header, stamp = types["std_msgs/msg/Header"], types["builtin_interfaces/msg/Time"]

    def head(moment_ns: int) -> object:
        time = stamp(sec=moment_ns // 10**9, nanosec=moment_ns % 10**9)
        extra = {"seq": 0} if ros1 else {}
        return header(stamp=time, frame_id="base", **extra)

    def joints(step: int) -> object:
        order = ["elbow", "wrist"] if step % 2 else ["wrist", "elbow"]
        values = {"elbow": 0.1 * step, "wrist": -1.0}
        return types["sensor_msgs/msg/JointState"](
            header=head(START_NS + step * 50_000_000), name=order,
            position=np.array([values[j] for j in order]), velocity=np.zeros(0),
            effort=np.zeros(0),
        )  # fmt: skip

    def images(step: int) -> tuple[object, object]:
        rgb = picture(step)
        stamped = head(START_NS + step * 50_000_000)
        jpeg = cv2.imencode(".jpg", rgb[..., ::-1])[1].ravel()
        raw = types["sensor_msgs/msg/Image"](
            header=stamped, height=24, width=32, encoding="rgb8", is_bigendian=0, step=96,
            data=rgb.ravel(),
        )  # fmt: skip
        return raw, types["sensor_msgs/msg/CompressedImage"](stamped, "jpeg", jpeg)

    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    with Writer1(path) if ros1 else Writer2(path, version=9, storage_plugin=plugin) as bag:
        topics = {
            "/joint_states": "sensor_msgs/msg/JointState", "/command": "std_msgs/msg/Float64",
            "/image": "sensor_msgs/msg/Image", "/jpeg": "sensor_msgs/msg/CompressedImage",
            "/note": "std_msgs/msg/String",
        }  # fmt: skip
        at = {name: bag.add_connection(name, topics[name], typestore=store) for name in topics}

        def write(topic: str, moment_ns: int, message: object) -> None:
            encode = store.serialize_ros1 if ros1 else store.serialize_cdr
            bag.write(at[topic], moment_ns, encode(message, topics[topic]))

        for step in range(steps):
            now_ns = START_NS + step * 50_000_000
            if step % 2 == 0:
                value = types["std_msgs/msg/Float64"](data=float(step))
                write("/command", now_ns - 20_000_000, value)
            write("/joint_states", now_ns + 1_000_000, joints(step))
            if step % 4 == 0:
                raw, jpeg = images(step)
                write("/image", now_ns, raw)
                write("/jpeg", now_ns, jpeg)
        write("/note", now_ns, types["std_msgs/msg/String"](data="done"))


@pytest.mark.parametrize("kind", KINDS)
def test_joints_by_name_commands_held_and_images_at_their_rows(kind, tmp_path):
    write_bag(tmp_path / kind, kind)
    camera = "/jpeg" if kind == "mcap" else "/image"
    imported = import_from(tmp_path, mapping(JOINTS.format(file=kind, camera=camera)))
    recording = imported.recording
    assert np.allclose(recording.values("time_s"), np.arange(20) * 0.05, atol=1e-9)
    assert np.allclose(recording.values("elbow_deg"), np.degrees(0.1 * np.arange(20)))
    held = [2.0 * (step // 2) for step in range(18)]
    assert recording.values("command_deg").tolist() == [*held, 16.0, 16.0]
    assert imported.account.filled == {"command_deg": 2}  # behind the last command
    assert f"previous resampling of {kind}, topic /command (std_msgs/msg/F" in recording.source


@pytest.mark.parametrize("kind", KINDS)
def test_frames_lie_where_vision_looks_for_them(kind, tmp_path, monkeypatch):
    write_bag(tmp_path / kind, kind)
    raw = "/jpeg" if kind == "mcap" else "/image"
    conf = tmp_path / "conf" / "importing"
    conf.mkdir(parents=True)
    (conf / "mine.yaml").write_text(JOINTS.format(file=kind, camera=raw))
    out = tmp_path / "out"
    arguments = ["loopgap", "--config-dir", str(conf.parent), "stages=[importing]",
                 "importing=mine", f"importing.path={tmp_path}", f"hydra.run.dir={out}",
                 "importing.rows.start_s=0.1"]  # fmt: skip
    monkeypatch.setattr(sys, "argv", arguments)
    assert app.run_command_line() == 0
    folder = out / "recording"
    account = json.loads((folder / "importing.json").read_text())
    assert account["rows"] == 18
    assert account["rows_without_frame"] == {"elbow": 3}  # those after the last image
    frames = FrameFolder(folder, "elbow")
    for row, step in enumerate([0, 4, 4, 4]):  # images at 0, 0.2 s, ...; rows from 0.1 s
        data = frames.read(row)
        assert data is not None
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
        assert np.abs(image.astype(int) - picture(step)[..., ::-1]).mean() < 4
    assert frames.read(17) is None


def bag(path: Path) -> Path:
    write_bag(path / "ros1.bag", "ros1.bag", steps=8)
    return path


def test_a_missing_topic_lists_those_there_are_with_their_types(tmp_path):
    config = mapping(JOINTS.format(file="ros1.bag", camera="/image"))
    config.tables["joints"].reading.topic = "/joint_state"
    with pytest.raises(
        UsageError,
        match=r"a topic of the bag; found '/joint_state'; there are /command "
        r"\(std_msgs/msg/Float64\), /image \(sensor.*"
        r"Did you mean '/joint_states'",
    ):
        import_from(bag(tmp_path), config)


def test_a_topic_of_another_type_says_which_and_what_it_holds(tmp_path):
    config = mapping(JOINTS.format(file="ros1.bag", camera="/image"))
    config.tables["joints"].reading.topic = "/note"
    with pytest.raises(
        UsageError, match=r"topic /note \(std_msgs/msg/String\): expected a column 'elbow.position'"
        "; found columns log_time",
    ):  # fmt: skip
        import_from(bag(tmp_path), config)


def test_a_joint_that_is_not_there(tmp_path):
    config = mapping(JOINTS.format(file="ros1.bag", camera="/image"))
    config.tables["joints"].channels["elbow_deg"].column = "elbow.velocity"
    with pytest.raises(UsageError, match="expected a column 'elbow.velocity'.*elbow.position"):
        import_from(bag(tmp_path), config)


def test_joints_without_their_numbers_are_refused():
    message = SimpleNamespace(name=["elbow", "wrist"], position=[0.1], velocity=[], effort=[])
    with pytest.raises(LoopgapError, match="position for each of elbow, wrist, or none; found 1"):
        dict(_joints("bag, message 0", message))


def test_images_come_from_image_topics_and_are_not_interpolated(tmp_path):
    config = mapping(JOINTS.format(file="ros1.bag", camera="/command"))
    config.path = str(bag(tmp_path))
    config.tables["camera"].time.column = "log_time"
    run = Run(Config(importing=config), tmp_path / "out")
    with pytest.raises(UsageError, match=r"/command.*expected images for the frames of 'elbow'"):
        run_importing(run)
    config.tables["camera"].resample = "linear"
    with pytest.raises(UsageError, match="expected previous or nearest for images; found linear"):
        run_importing(run)


def test_an_image_of_an_encoding_that_is_unknown(tmp_path):
    types = get_typestore(Stores.ROS2_HUMBLE).types
    stamp = types["builtin_interfaces/msg/Time"](sec=0, nanosec=0)
    message = types["sensor_msgs/msg/Image"](
        header=types["std_msgs/msg/Header"](stamp=stamp, frame_id=""), height=1, width=2,
        encoding="yuv422", is_bigendian=0, step=4, data=np.zeros(4, np.uint8),
    )  # fmt: skip
    with pytest.raises(LoopgapError, match="found encoding 'yuv422'. Convert the topic"):
        encoded("bag, message 0", message)


@pytest.mark.parametrize("kind", KINDS)
def test_a_bag_that_was_cut_off(kind, tmp_path):
    write_bag(tmp_path / kind, kind)
    file = next(f for f in [tmp_path / kind, *tmp_path.rglob("*.db3"), *tmp_path.rglob("*.mcap")]
                if f.is_file())  # fmt: skip
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    with pytest.raises(LoopgapError, match="expected a whole bag"):
        import_from(tmp_path, mapping(JOINTS.format(file=kind, camera="/image")))


def test_the_mapping_to_start_from_takes_the_joint_from_the_command_line(tmp_path, monkeypatch):
    arguments = ["loopgap", "stages=[importing]", "importing=joint_bag",
                 f"importing.path={bag(tmp_path) / 'ros1.bag'}", f"hydra.run.dir={tmp_path}/out",
                 "importing.tables.joints.channels.joint_deg.column=elbow.position"]  # fmt: skip
    monkeypatch.setattr(sys, "argv", arguments)
    assert app.run_command_line() == 0
    recording = load_recording(tmp_path / "out" / "recording")
    assert np.allclose(recording.values("joint_deg"), np.degrees(0.1 * np.arange(8)))
    assert recording.values("joint_command_deg")[2] == pytest.approx(np.degrees(2.0))
