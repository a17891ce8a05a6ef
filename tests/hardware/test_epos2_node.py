"""The emulated controller's states, motion, limits and faults."""

import pytest

from pipeline.clock import SimulatedClock
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2_frames import Entry
from pipeline.hardware.epos2_node import EmulatedNode, next_state

POSITION_MODE_SETTING = Entry(0x2062, 0, 4, signed=True)
S = objects


class Bench:
    """A node, its clock, and words for reading and writing it."""

    def __init__(self) -> None:
        self.clock = SimulatedClock()
        self.node = EmulatedNode(self.clock, junk=lambda: 0)

    def get(self, entry: Entry) -> int:
        error, dword = self.node.read(entry.index, entry.subindex)
        assert error == 0
        return entry.decode(dword)

    def put(self, entry: Entry, value: int) -> int:
        return self.node.write(entry.index, entry.subindex, entry.encode(value))

    def control(self, *words: int) -> None:
        for word in words:
            assert self.put(S.CONTROLWORD, word) == 0

    def enable(self) -> None:
        assert self.put(S.ENCODER_PULSES, 256) == 0
        self.control(S.SHUTDOWN, S.SWITCH_ON, S.ENABLE_OPERATION)
        assert self.get(S.STATUSWORD) & S.STATE_MASK == S.OPERATION_ENABLED

    def start(self, target_qc: int, word: int = S.START_ABSOLUTE_NOW) -> None:
        assert self.put(S.TARGET_POSITION, target_qc) == 0
        self.control(S.ENABLE_OPERATION, word)


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.mark.parametrize(
    ("state", "word", "after"),
    [
        (S.SWITCH_ON_DISABLED, S.SHUTDOWN, S.READY_TO_SWITCH_ON),
        (S.SWITCH_ON_DISABLED, S.SWITCH_ON, S.SWITCH_ON_DISABLED),
        (S.SWITCH_ON_DISABLED, S.ENABLE_OPERATION, S.SWITCH_ON_DISABLED),
        (S.READY_TO_SWITCH_ON, S.SWITCH_ON, S.SWITCHED_ON),
        (S.READY_TO_SWITCH_ON, S.QUICK_STOP, S.SWITCH_ON_DISABLED),
        (S.SWITCHED_ON, S.ENABLE_OPERATION, S.OPERATION_ENABLED),
        (S.SWITCHED_ON, S.SHUTDOWN, S.READY_TO_SWITCH_ON),
        (S.OPERATION_ENABLED, S.SWITCH_ON, S.SWITCHED_ON),
        (S.OPERATION_ENABLED, S.QUICK_STOP, S.QUICK_STOP_ACTIVE),
        (S.OPERATION_ENABLED, 0x0002, S.QUICK_STOP_ACTIVE),
        (S.OPERATION_ENABLED, S.DISABLE_VOLTAGE, S.SWITCH_ON_DISABLED),
        (S.QUICK_STOP_ACTIVE, S.ENABLE_OPERATION, S.OPERATION_ENABLED),
        (S.QUICK_STOP_ACTIVE, S.DISABLE_VOLTAGE, S.SWITCH_ON_DISABLED),
        (S.FAULT, S.ENABLE_OPERATION, S.FAULT),
        (S.FAULT, S.FAULT_RESET, S.SWITCH_ON_DISABLED),
    ],
)
def test_states_follow_cia_402(state: int, word: int, after: int) -> None:
    assert next_state(state, word, 0) == after


def test_fault_reset_needs_a_rising_edge() -> None:
    assert next_state(S.FAULT, S.FAULT_RESET, S.FAULT_RESET) == S.FAULT


def test_statuswords_of_the_way_to_enabled(bench: Bench) -> None:
    seen = [bench.get(S.STATUSWORD)]
    for word in (S.SHUTDOWN, S.SWITCH_ON, S.ENABLE_OPERATION, S.QUICK_STOP):
        bench.control(word)
        seen.append(bench.get(S.STATUSWORD))
    assert seen == [0x0140, 0x0121, 0x0123, 0x0137, 0x0117]


def test_move_takes_its_time_and_target_reached_comes_at_its_end(bench: Bench) -> None:
    bench.enable()
    bench.start(10000)
    assert not bench.get(S.STATUSWORD) & S.TARGET_REACHED_BIT
    bench.clock.sleep_s(0.3)
    assert 0 < bench.get(S.POSITION_ACTUAL) < 10000
    bench.clock.sleep_s(1.0)
    assert bench.get(S.STATUSWORD) & S.TARGET_REACHED_BIT
    assert bench.get(S.POSITION_ACTUAL) == 10000


def test_target_reached_says_nothing_about_a_motor_that_is_held(bench: Bench) -> None:
    bench.enable()
    bench.node.jam()
    bench.start(1500)
    bench.clock.sleep_s(1.0)
    assert bench.get(S.STATUSWORD) & S.TARGET_REACHED_BIT
    assert bench.get(S.POSITION_ACTUAL) == 0


def test_held_motor_faults_with_a_following_error(bench: Bench) -> None:
    bench.enable()
    bench.node.jam()
    bench.start(2500)
    bench.clock.sleep_s(1.0)
    assert bench.get(S.STATUSWORD) == S.FAULT | S.DEVIATION_BIT
    assert bench.get(S.error_history(1)) == S.FOLLOWING_ERROR
    assert bench.get(S.ERROR_REGISTER) == 0x20
    bench.control(S.FAULT_RESET)
    assert bench.put(S.ERROR_COUNT, 0) == 0
    assert (bench.get(S.STATUSWORD), bench.get(S.ERROR_COUNT)) == (S.SWITCH_ON_DISABLED, 0)


def test_a_jump_in_position_mode_faults(bench: Bench) -> None:
    bench.enable()
    assert bench.put(S.MODE, -1) == 0
    assert bench.put(POSITION_MODE_SETTING, 1900) == 0
    assert bench.get(S.POSITION_ACTUAL) == 1900
    assert bench.put(POSITION_MODE_SETTING, 4000) == 0
    assert bench.get(S.STATUSWORD) & S.FAULT_BIT


def test_a_new_target_needs_a_rising_edge(bench: Bench) -> None:
    bench.enable()
    bench.start(100)
    bench.clock.sleep_s(1.0)
    assert bench.put(S.TARGET_POSITION, 200) == 0
    bench.control(S.START_ABSOLUTE_NOW)
    bench.clock.sleep_s(1.0)
    assert bench.get(S.POSITION_ACTUAL) == 100


def test_start_without_at_once_waits_for_the_move_before(bench: Bench) -> None:
    bench.enable()
    bench.start(9000)
    bench.clock.sleep_s(0.1)
    bench.start(0, S.START)
    reached = []
    for _ in range(400):
        bench.clock.sleep_s(0.01)
        reached.append(bench.get(S.POSITION_ACTUAL))
    assert (max(reached), reached[-1]) == (9000, 0)


def test_start_at_once_turns_round(bench: Bench) -> None:
    bench.enable()
    bench.start(9000)
    bench.clock.sleep_s(0.1)
    bench.start(0)
    bench.clock.sleep_s(3.0)
    assert bench.get(S.POSITION_ACTUAL) == 0


def test_relative_move_beyond_the_limit_faults(bench: Bench) -> None:
    bench.enable()
    assert bench.put(S.MAX_POSITION, 1000) == 0
    bench.start(700)
    bench.clock.sleep_s(1.0)
    bench.start(700, 0x5F)
    assert bench.get(S.error_history(1)) == S.POSITION_LIMIT_ERROR


def test_quick_stop_brakes_and_disabling_holds_no_more(bench: Bench) -> None:
    bench.enable()
    bench.start(100000)
    bench.clock.sleep_s(0.5)
    bench.control(S.QUICK_STOP)
    before = bench.node.motor_qc()
    bench.clock.sleep_s(0.5)
    rest = bench.node.motor_qc()
    bench.clock.sleep_s(0.5)
    assert before < rest == bench.node.motor_qc() < 100000
    bench.control(S.DISABLE_VOLTAGE)
    assert bench.get(S.STATUSWORD) == S.SWITCH_ON_DISABLED


def test_halt_stops_and_keeps_the_motor_enabled(bench: Bench) -> None:
    bench.enable()
    bench.start(100000)
    bench.clock.sleep_s(0.5)
    bench.control(0x010F)
    bench.clock.sleep_s(0.5)
    assert bench.get(S.STATUSWORD) == S.OPERATION_ENABLED | S.TARGET_REACHED_BIT
    assert bench.get(S.POSITION_ACTUAL) < 100000


def test_homing_method_35_makes_the_present_position_zero(bench: Bench) -> None:
    bench.enable()
    bench.start(1234)
    bench.clock.sleep_s(1.0)
    assert bench.put(S.MODE, S.HOMING_MODE) == 0
    assert bench.put(S.HOMING_METHOD, 35) == 0
    bench.control(S.ENABLE_OPERATION, S.START)
    assert bench.get(S.STATUSWORD) & S.HOMING_ATTAINED_BIT
    assert bench.get(S.POSITION_ACTUAL) == 0
    assert bench.node.motor_qc() == 1234


def test_encoder_resolution_is_written_only_while_disabled(bench: Bench) -> None:
    bench.enable()
    assert bench.put(S.ENCODER_PULSES, 512) == S.WRONG_STATE
    bench.control(S.DISABLE_VOLTAGE)
    assert bench.put(S.ENCODER_PULSES, 512) == 0


@pytest.mark.parametrize(
    ("entry", "value"),
    [(S.PROFILE_VELOCITY, 0), (S.MODE, 9), (S.ERROR_COUNT, 1)],
)
def test_values_out_of_range_are_refused(bench: Bench, entry: Entry, value: int) -> None:
    assert bench.put(entry, value) == S.VALUE_RANGE
