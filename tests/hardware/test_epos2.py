"""The robot driver over a real pseudo-terminal: start, move, faults, stop."""

import logging
import threading
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest
from lossy_emulator import FRAME_TIMEOUT_S, NODES, LossyEmulator, spoil_once

from pipeline.clock import RealClock, SimulatedClock
from pipeline.config import RobotConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2 import Epos2, qc_per_deg
from pipeline.hardware.epos2_line import Epos2Line

CONFIG = RobotConfig(kind="emulated", nodes=NODES)
ARRIVED_DEG = CONFIG.position_tolerance_qc / qc_per_deg(CONFIG)


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock()


@pytest.fixture
def emulator(clock: SimulatedClock) -> Iterator[LossyEmulator]:
    with LossyEmulator(clock) as emulator:
        yield emulator


@pytest.fixture
def robot(emulator: LossyEmulator, clock: SimulatedClock) -> Iterator[Epos2]:
    robot = Epos2(Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S), CONFIG, clock)
    yield robot
    robot.close()


def states(emulator: LossyEmulator) -> set[int]:
    return {node.state for node in emulator.nodes.values()}


def test_a_turn_of_the_papers_shaft_is_65536_counts() -> None:
    assert qc_per_deg(CONFIG) * 360 == 65536


def test_start_homes_and_enables_both(robot: Epos2, emulator: LossyEmulator) -> None:
    robot.start()
    assert states(emulator) == {objects.OPERATION_ENABLED}
    assert robot.read_deg() == {"yaw": 0.0, "pitch": 0.0}
    assert emulator.nodes[1].read(0x2210, 1) == (0, 256)


def test_both_axes_move_together_and_come_to_stand(
    robot: Epos2, emulator: LossyEmulator, clock: SimulatedClock
) -> None:
    robot.start()
    begun = clock.now_s()
    robot.move_to({"yaw": 60.0, "pitch": -45.0})
    took_s = clock.now_s() - begun
    for where in (robot.read_deg(), emulator.shaft_deg()):
        assert where["yaw"] == pytest.approx(60.0, abs=ARRIVED_DEG)
        assert where["pitch"] == pytest.approx(-45.0, abs=ARRIVED_DEG)
    cruise_s = 60.0 / 360 * 64 / (500 / 60)
    assert took_s == pytest.approx(cruise_s + 500 / 5000, abs=0.02)


def test_an_axis_that_is_not_named_stays(robot: Epos2) -> None:
    robot.start()
    robot.move_to({"yaw": 10.0, "pitch": 5.0})
    robot.move_to({"yaw": -10.0})
    assert robot.read_deg()["pitch"] == pytest.approx(5.0, abs=ARRIVED_DEG)


def test_homing_takes_the_place_where_the_robot_stands(
    robot: Epos2, emulator: LossyEmulator
) -> None:
    robot.start()
    robot.move_to({"yaw": 10.0})
    robot.stop()
    robot.start()
    assert robot.read_deg()["yaw"] == 0.0
    robot.move_to({"yaw": 5.0})
    assert emulator.shaft_deg()["yaw"] == pytest.approx(15.0, abs=2 * ARRIVED_DEG)


def test_commands_beyond_the_limit_are_refused_before_anything_moves(
    robot: Epos2, emulator: LossyEmulator
) -> None:
    robot.start()
    with pytest.raises(UsageError, match=r"yaw axis: .*\+-90 deg; found 91 deg.*limit_deg\.yaw"):
        robot.move_to({"pitch": 20.0, "yaw": 91.0})
    with pytest.raises(UsageError, match="found nan deg"):
        robot.move_to({"pitch": 20.0, "yaw": float("nan")})
    with pytest.raises(UsageError, match="an axis of yaw, pitch; found 'roll'"):
        robot.move_to({"pitch": 20.0, "roll": 1.0})
    assert emulator.shaft_deg() == {"yaw": 0.0, "pitch": 0.0}


def test_a_fault_of_before_is_cleared_and_told(
    robot: Epos2, emulator: LossyEmulator, caplog: pytest.LogCaptureFixture
) -> None:
    emulator.nodes[2].fail(0x7320)
    with caplog.at_level(logging.WARNING):
        robot.start()
    assert "pitch motor (EPOS2 node 2): clearing fault 0x7320 (position sensor" in caplog.text
    assert emulator.nodes[2].read(0x1003, 0)[1] & 0xFF == 0


def test_a_fault_that_stays_is_told_with_its_remedy(robot: Epos2, emulator: LossyEmulator) -> None:
    emulator.nodes[1].fail(0x2310)
    emulator.nodes[1].lasting_error = 0x2310
    with pytest.raises(LoopgapError, match=r"yaw motor .*fault 0x2310 \(overcurrent\).*short"):
        robot.start()


def test_a_jam_is_a_following_error_in_words(robot: Epos2, emulator: LossyEmulator) -> None:
    robot.start()
    emulator.nodes[2].jam()
    with pytest.raises(LoopgapError, match=r"pitch motor .*0x8611 \(following error.*jam"):
        robot.move_to({"pitch": 30.0})
    robot.stop()
    assert emulator.nodes[1].state == objects.SWITCH_ON_DISABLED
    assert emulator.nodes[2].state == objects.FAULT


def test_target_reached_is_not_believed_without_the_encoder(
    robot: Epos2, emulator: LossyEmulator
) -> None:
    robot.start()
    emulator.nodes[1].jam()
    with pytest.raises(LoopgapError, match="to stand at 910 qc within 2 s; found .* at 0 qc"):
        robot.move_to({"yaw": 5.0})


def test_a_held_axis_that_faults_is_noticed_by_the_next_move(
    robot: Epos2, emulator: LossyEmulator
) -> None:
    robot.start()
    emulator.nodes[2].fail(0x3220)
    with pytest.raises(LoopgapError, match=r"pitch motor .*0x3220 \(undervoltage\)"):
        robot.move_to({"yaw": 1.0})


def test_a_motor_that_something_else_disabled_is_noticed(
    robot: Epos2, emulator: LossyEmulator
) -> None:
    robot.start()
    emulator.nodes[1].write(0x6040, 0, objects.DISABLE_VOLTAGE)
    with pytest.raises(LoopgapError, match="expected operation enabled; found switch-on disabled"):
        robot.move_to({"yaw": 1.0})


def test_a_lost_answer_in_a_move_costs_time_only(robot: Epos2, emulator: LossyEmulator) -> None:
    robot.start()
    for angle in (1.0, 2.0, 3.0):
        emulator.disturb = spoil_once(lambda data: b"")
        robot.move_to({"yaw": angle})
        assert emulator.shaft_deg()["yaw"] == pytest.approx(angle, abs=ARRIVED_DEG)


def test_stop_brakes_before_it_disables(emulator: LossyEmulator, clock: SimulatedClock) -> None:
    line = Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S)
    robot = Epos2(line, CONFIG, clock)
    robot.start()
    line.write(1, objects.TARGET_POSITION, 16000)
    line.write(1, objects.CONTROLWORD, objects.START_ABSOLUTE_NOW)
    clock.sleep_s(0.5)
    robot.stop()
    assert states(emulator) == {objects.SWITCH_ON_DISABLED}
    rest = emulator.shaft_deg()
    clock.sleep_s(1.0)
    assert emulator.shaft_deg() == rest
    assert 0.0 < rest["yaw"] < 80.0
    robot.close()


def test_one_dead_node_does_not_keep_the_other_from_stopping(
    robot: Epos2, emulator: LossyEmulator
) -> None:
    robot.start()
    alive = emulator.nodes.pop(1), emulator.nodes[2]
    with pytest.raises(LoopgapError, match=r"every motor stopped and disabled.*supply off"):
        robot.stop()
    assert alive[1].state == objects.SWITCH_ON_DISABLED


def test_stop_goes_on_when_it_is_interrupted(
    emulator: LossyEmulator, clock: SimulatedClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = Epos2(Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S), CONFIG, clock)
    robot.start()
    sleep, impatient = clock.sleep_s, [KeyboardInterrupt()]

    def sleep_once_interrupted(duration_s: float) -> None:
        sleep(duration_s)
        if impatient:
            raise impatient.pop()

    monkeypatch.setattr(clock, "sleep_s", sleep_once_interrupted)
    with pytest.raises(KeyboardInterrupt):
        robot.stop()
    assert states(emulator) == {objects.SWITCH_ON_DISABLED}
    robot.close()


def test_wrong_node_is_told(emulator: LossyEmulator, clock: SimulatedClock) -> None:
    config = replace(CONFIG, nodes={"yaw": 5}, limit_deg={"yaw": 90.0})
    robot = Epos2(Epos2Line(emulator.port, 115200, FRAME_TIMEOUT_S), config, clock)
    with pytest.raises(LoopgapError, match="node 5, .*wrong CAN node.*`robot.nodes`"):
        robot.start()
    robot.close()


def test_an_axis_without_limit_is_told(emulator: LossyEmulator, clock: SimulatedClock) -> None:
    line = Epos2Line(emulator.port, 115200)
    with pytest.raises(UsageError, match=r"robot\.limit_deg: expected a limit for axis 'roll'"):
        Epos2(line, replace(CONFIG, nodes={"roll": 1}), clock)
    line.close()


def test_a_step_through_the_line_takes_milliseconds(robot: Epos2, clock: SimulatedClock) -> None:
    robot.start()
    begun = time.monotonic()
    for step in range(1, 51):
        robot.move_to({"yaw": 1.2 * step, "pitch": 0.0})
        robot.read_deg()
    assert (time.monotonic() - begun) / 50 < 0.05
    assert clock.now_s() == pytest.approx(50 * 0.1, rel=0.1)


def test_real_time_moves_take_real_time() -> None:
    clock = RealClock()
    with LossyEmulator(clock) as emulator:
        robot = Epos2(Epos2Line(emulator.port, 115200), CONFIG, clock)
        robot.start()
        seen: list[float] = []
        watch = threading.Timer(0.15, lambda: seen.append(emulator.shaft_deg()["yaw"]))
        watch.start()
        robot.move_to({"yaw": 10.0})
        watch.join()
        assert 0.0 < seen[0] < 10.0
        assert emulator.shaft_deg()["yaw"] == pytest.approx(10.0, abs=ARRIVED_DEG)
        robot.stop()
        robot.close()
