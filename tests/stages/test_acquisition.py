"""The paper's protocol, dwell times, and what is left when something goes wrong in the middle."""

import json
import logging
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pipeline.clock import SimulatedClock
from pipeline.config import AcquisitionConfig, RobotConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2 import Epos2
from pipeline.hardware.epos2_emulator import Epos2Emulator
from pipeline.hardware.epos2_line import Epos2Line
from pipeline.recorder import Recorder
from pipeline.recording import branch_of, cycles_from_reversals, load_recording
from pipeline.stages.acquisition import acquire, channels_of, protocol

SMALL = AcquisitionConfig(cycles=2, steps_per_cycle=8, amplitude_deg={"yaw": 20.0, "pitch": 12.0})
ROBOT = RobotConfig(kind="emulated")
SCRIPT = Path(__file__).with_name("interrupted_acquisition.py")


class NumberedCamera:
    """Images that say how many were taken before; may have an accident."""

    def __init__(self, name: str, accident: BaseException | None = None, after: int = 5) -> None:
        self.name = name
        self.taken = 0
        self._accident, self._after = accident, after

    def grab(self) -> bytes:
        if self._accident and self.taken == self._after:
            raise self._accident
        self.taken += 1
        return b"image %d" % self.taken

    def close(self) -> None: ...


class Memory:
    """A sink that remembers."""

    def __init__(self) -> None:
        self.rows: list[Mapping[str, float]] = []

    def write(self, row: Mapping[str, float], frames: Mapping[str, bytes]) -> None:
        self.rows.append(row)


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock()


@pytest.fixture
def emulator(clock: SimulatedClock) -> Iterator[Epos2Emulator]:
    with Epos2Emulator(ROBOT.nodes, clock, frame_timeout_s=0.1) as emulator:
        yield emulator


@pytest.fixture
def robot(emulator: Epos2Emulator, clock: SimulatedClock) -> Iterator[Epos2]:
    robot = Epos2(Epos2Line(emulator.port, 115200, timeout_s=0.1), ROBOT, clock)
    yield robot
    robot.close()


def states(emulator: Epos2Emulator) -> set[int]:
    return {node.state for node in emulator.nodes.values()}


def test_papers_protocol_is_a_triangle_of_equal_steps() -> None:
    commands = protocol(AcquisitionConfig(), "pitch")
    pitch = commands["pitch_command_deg"].to_numpy()
    assert len(commands) == 1800
    assert (commands["yaw_command_deg"] == 0.0).all()
    assert np.diff(pitch, prepend=0.0) == pytest.approx(
        1.2 * np.tile(np.repeat([1.0, -1.0, 1.0], [50, 100, 50]), 9)
    )
    assert (pitch.max(), pitch.min(), pitch[-1]) == (60.0, -60.0, 0.0)
    assert (branch_of(pitch)[:200] == np.repeat([1, -1, 1], [50, 100, 50])).all()
    assert (cycles_from_reversals(pitch) == commands["cycle"]).all()
    assert commands["step"].tolist() == list(range(200)) * 9


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"steps_per_cycle": 10}, r"steps_per_cycle: expected a multiple of 4.*found 10"),
        ({"steps_per_cycle": 0}, r"steps_per_cycle: expected a multiple of 4.*found 0"),
        ({"cycles": 0}, r"acquisition\.cycles: expected at least 1; found 0"),
        ({"amplitude_deg": {"pitch": 60.0}}, "axis 'yaw' in `axes` and `amplitude_deg`"),
        ({"axes": ["pitch"]}, r"axis 'yaw' in `axes` and `amplitude_deg`; found axes \['pitch'\]"),
    ],
)
def test_impossible_protocols(change: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        protocol(AcquisitionConfig(**change), "yaw")  # type: ignore[arg-type]


def test_samples_follow_moves_and_pauses(
    robot: Epos2, emulator: Epos2Emulator, clock: SimulatedClock, tmp_path: Path
) -> None:
    commands = protocol(SMALL, "yaw")
    camera = NumberedCamera("yaw")
    steps: list[None] = []
    with Recorder(tmp_path / "yaw", channels_of(SMALL), "simulated") as recorder:
        recording = acquire(
            SMALL, commands, robot, {"yaw": camera}, clock, recorder, "simulated",
            lambda: steps.append(None),
        )  # fmt: skip
    stored = load_recording(tmp_path / "yaw")
    pd.testing.assert_frame_equal(stored.samples, recording.samples)
    assert (stored.source, stored.channels) == ("simulated", recording.channels)
    assert recording.values("yaw_command_deg") == pytest.approx(commands["yaw_command_deg"])
    assert recording.values("yaw_encoder_deg") == pytest.approx(
        recording.values("yaw_command_deg"), abs=0.003
    )
    assert (np.diff(recording.values("time_s")) > SMALL.pause_s).all()
    assert (np.diff(recording.values("time_s")) < SMALL.pause_s + 1.0).all()
    assert len(steps) == camera.taken == 16
    assert (tmp_path / "yaw/frames/yaw_000015.jpg").read_bytes() == b"image 16"
    assert states(emulator) == {objects.SWITCH_ON_DISABLED}


def test_dwell_follows_the_times_of_a_table(robot: Epos2, clock: SimulatedClock) -> None:
    times = [100.0, 101.5, 105.0, 105.5, 145.5]
    yaw = [5.0, 6.0, 7.0, 6.0, 5.0]
    commands = pd.DataFrame(
        {"time_s": times, "cycle": 0, "step": range(5)}
        | {"yaw_command_deg": yaw, "pitch_command_deg": 0.0}
    )
    recording = acquire(SMALL, commands, robot, {}, clock, Memory())
    assert np.diff(recording.values("time_s")) == pytest.approx(np.diff(times), abs=1e-9)


def test_samples_that_come_too_late_are_counted(
    robot: Epos2, clock: SimulatedClock, caplog: pytest.LogCaptureFixture
) -> None:
    commands = pd.DataFrame(
        {"time_s": [0.0, 0.1, 5.0], "cycle": 0, "step": range(3)}
        | {"yaw_command_deg": [0.0, 60.0, 60.0], "pitch_command_deg": 0.0}
    )
    with caplog.at_level(logging.WARNING):
        recording = acquire(SMALL, commands, robot, {}, clock, Memory())
    assert "1 samples were taken later than commanded, the latest by 1.2" in caplog.text
    assert recording.values("time_s")[1] - recording.values("time_s")[0] > 1.0


def test_robot_is_left_at_home(
    robot: Epos2, emulator: Epos2Emulator, clock: SimulatedClock
) -> None:
    acquire(SMALL, protocol(SMALL, "yaw").head(3), robot, {}, clock, Memory())
    assert emulator.shaft_deg() == pytest.approx({"yaw": 0.0, "pitch": 0.0}, abs=0.06)


def test_commands_beyond_the_robots_limits_are_refused_before_it_starts(
    robot: Epos2, emulator: Epos2Emulator, clock: SimulatedClock
) -> None:
    commands = protocol(SMALL, "yaw") * 5
    with pytest.raises(UsageError, match=r"yaw_command_deg: .*\+-90 deg; found 100 deg"):
        acquire(SMALL, commands, robot, {}, clock, Memory())
    assert emulator.nodes[1].read(0x2210, 1)[1] == 500, "nothing was configured yet"


@pytest.mark.parametrize("accident", [LoopgapError("the camera broke"), KeyboardInterrupt()])
def test_accident_in_the_middle_stops_the_robot_and_goes_on(
    robot: Epos2,
    emulator: Epos2Emulator,
    clock: SimulatedClock,
    tmp_path: Path,
    accident: BaseException,
) -> None:
    camera = NumberedCamera("yaw", accident)
    recorder = Recorder(tmp_path / "yaw", channels_of(SMALL), "simulated")
    with recorder, pytest.raises(type(accident)) as caught:
        acquire(SMALL, protocol(SMALL, "yaw"), robot, {"yaw": camera}, clock, recorder)
    assert caught.value is accident
    assert states(emulator) == {objects.SWITCH_ON_DISABLED}
    assert len(load_recording(tmp_path / "yaw").samples) == 5


def test_a_jam_in_the_middle_keeps_the_samples_before(
    robot: Epos2, emulator: Epos2Emulator, clock: SimulatedClock
) -> None:
    sink = Memory()

    def jam_after_three() -> None:
        if len(sink.rows) == 3:
            emulator.nodes[1].jam()

    with pytest.raises(LoopgapError, match="yaw motor .*0x8611"):
        acquire(SMALL, protocol(SMALL, "yaw") * 4, robot, {}, clock, sink, progress=jam_after_three)
    assert len(sink.rows) == 3
    assert states(emulator) == {objects.FAULT, objects.SWITCH_ON_DISABLED}


def test_a_robot_that_can_not_be_stopped_is_said_beside_the_first_error(
    robot: Epos2, emulator: Epos2Emulator, clock: SimulatedClock
) -> None:
    with pytest.raises(LoopgapError, match="expected an open serial line") as caught:
        acquire(SMALL, protocol(SMALL, "yaw"), robot, {}, clock, Memory(), progress=emulator.close)
    assert any("Switch the motors' supply off" in note for note in caught.value.__notes__)


def test_ctrl_c_in_another_process(tmp_path: Path) -> None:
    """A real SIGINT, in real time, while the motor moves."""
    process = subprocess.Popen(
        [sys.executable, str(SCRIPT), str(tmp_path / "yaw")],
        stdout=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "second sample\n"
    time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    last_words = json.loads(process.communicate(timeout=20)[0])
    assert process.returncode == 130
    assert last_words["states"] == [objects.SWITCH_ON_DISABLED] * 2
    assert last_words["moved_after_deg"] == 0.0
    recording = load_recording(tmp_path / "yaw")
    assert len(recording.samples) >= 2
    assert len(list((tmp_path / "yaw" / "frames").glob("yaw_*.jpg"))) >= len(recording.samples)
