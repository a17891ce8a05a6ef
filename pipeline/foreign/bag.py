"""ROS 1 and ROS 2 bags (sqlite3 and mcap): the numbers and images of one topic."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore
from tqdm import tqdm

from pipeline.config_importing import ReadingConfig
from pipeline.errors import UsageError, refusal
from pipeline.foreign.images import IMAGES, encoded
from pipeline.foreign.rows import LONGEST, Columns
from pipeline.foreign.table import ForeignFileError, ForeignTable, parsing, suggestion

LOG_TIME = "log_time"
JOINT_STATE = "sensor_msgs/msg/JointState"
JOINT_FIELDS = ("position", "velocity", "effort")


def read_bag(path: Path, reading: ReadingConfig) -> ForeignTable:
    """A row for each message of `reading.topic`.

    Columns are `log_time` and `header.stamp` [ns], and the message's numbers by dotted path
    (`pose.position.x`, `data.0`); of joint states `<joint>.position`, `.velocity`, `.effort`.
    """
    with _opened(path) as bag:
        connections = _connections(path, bag, reading.topic)
        kind = connections[0].msgtype
        columns = Columns()
        for number, (moment_ns, message) in enumerate(_messages(bag, connections)):
            at = f"{path}, topic {reading.topic}, message {number} (from 0)"
            row = dict(_joints(at, message) if kind == JOINT_STATE else _numbers("", message))
            columns.add({LOG_TIME: moment_ns} | row)
    where = f"{path}, topic {reading.topic} ({kind})"
    table = columns.arrays()
    if not table:
        raise ForeignFileError(
            refusal(where, "messages", "none", "Name another topic, or record again.")
        )
    frames = _frames(path, str(reading.topic), where) if kind in IMAGES else None
    return ForeignTable(where, table, lambda row: f"message {row} (from 0)", frames=frames)


@contextmanager
def _opened(path: Path) -> Iterator[AnyReader]:
    expected = "a whole bag: ROS 1 (.bag), or ROS 2 (.mcap, .db3 or the folder with metadata.yaml)"
    remedy = "Point `file` at the bag; mend it with `rosbag reindex` or `ros2 bag reindex`."
    with (
        parsing(str(path), expected, remedy),
        AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag,
    ):
        yield bag


def _connections(path: Path, bag: AnyReader, topic: str | None) -> list[Connection]:
    found = [c for c in bag.connections if c.topic == topic]
    kinds = {c.msgtype for c in found}
    if len(kinds) != 1:
        there = sorted({f"{c.topic} ({c.msgtype})" for c in bag.connections})
        names = [c.topic for c in bag.connections]
        expected = "a topic of one message type" if kinds else "a topic of the bag"
        raise UsageError(
            refusal(f"{path}, reading.topic", expected,
                    f"{topic!r}; there are {', '.join(there) or 'none'}",
                    suggestion(topic or "", names) + "Name one of these.")
        )  # fmt: skip
    return found


def _messages(bag: AnyReader, connections: list[Connection]) -> Iterator[tuple[int, object]]:
    """Moments [ns] and messages in the bag's order, with a bar where it takes its time."""
    total = sum(c.msgcount for c in connections)
    stream = bag.messages(connections=connections)
    for connection, moment_ns, raw in tqdm(
        stream, total=total, desc=f"  {connections[0].topic}", leave=False, delay=1.0, disable=None
    ):
        yield moment_ns, bag.deserialize(raw, connection.msgtype)


def _joints(where: str, message: object) -> Iterator[tuple[str, object]]:
    """Each joint's numbers by its name: their order may change from message to message."""
    names = list(getattr(message, "name", []))
    yield from _numbers("header", getattr(message, "header", None))
    for field in JOINT_FIELDS:
        values = getattr(message, field)
        if len(values) not in (0, len(names)):
            raise ForeignFileError(
                refusal(where, f"a {field} for each of {', '.join(names)}, or none",
                        f"{len(values)}", "Record whole messages, or name another topic.")
            )  # fmt: skip
        for joint, value in zip(names, values, strict=False):
            yield f"{joint}.{field}", float(value)


def _numbers(name: str, value: object) -> Iterator[tuple[str, object]]:
    """The numbers within a message, with their dotted paths; a stamp is one number [ns]."""
    if is_dataclass(value):
        parts = {f.name: getattr(value, f.name) for f in fields(value)}
        if {"sec", "nanosec"} <= set(parts):
            yield name, int(parts["sec"]) * 10**9 + int(parts["nanosec"])
            return
        for key, part in parts.items():
            yield from _numbers(f"{name}.{key}" if name else key, part)
    elif isinstance(value, (np.ndarray, list)) and len(value) <= LONGEST:
        for number, part in enumerate(value):
            yield from _numbers(f"{name}.{number}", part)
    elif isinstance(value, (bool, int, float, np.number)):
        yield name, value


def _frames(path: Path, topic: str, where: str) -> Callable[[], Iterator[bytes]]:
    def images() -> Iterator[bytes]:
        with _opened(path) as bag:
            stream = _messages(bag, _connections(path, bag, topic))
            for number, (_, message) in enumerate(stream):
                yield encoded(f"{where}, message {number} (from 0)", message)

    return images
