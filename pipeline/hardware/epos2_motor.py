"""One motor behind an EPOS2 node: its states, homing, moves and faults, in counts (qc)."""

import logging
from collections.abc import Callable

from pipeline.clock import Clock
from pipeline.config import RobotConfig
from pipeline.errors import refusal
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2_line import Epos2Line
from pipeline.hardware.profile import trapezoid
from pipeline.hardware.robot import HardwareError

POLL_S = 0.005
STATE_TIMEOUT_S = 1.0
ARRIVAL_TIMEOUT_S = 2.0
STANDSTILL_QC = 2
QUICK_STOP_RPM_S = 10000

log = logging.getLogger(__name__)


class Motor:
    """Drives one node; every wait has an end, every fault is told in words."""

    def __init__(
        self, axis: str, node: int, line: Epos2Line, config: RobotConfig, clock: Clock
    ) -> None:
        self._name = f"{axis} motor (EPOS2 node {node})"
        self._node = node
        self._line = line
        self._config = config
        self._clock = clock
        self._target_qc = 0

    def prepare(self, limit_qc: int) -> None:
        """Clear a fault, disable, and write what this robot needs of settings."""
        self._line.read(self._node, objects.SOFTWARE_VERSION)
        self._control(objects.DISABLE_VOLTAGE)
        self._clear_fault()
        self._wait_for(objects.SWITCH_ON_DISABLED)
        pulses = self._config.encoder_pulses
        if self._line.read(self._node, objects.ENCODER_PULSES) != pulses:
            self._line.write(self._node, objects.ENCODER_PULSES, pulses)
        for entry, value in (
            (objects.MIN_POSITION, -limit_qc),
            (objects.MAX_POSITION, limit_qc),
            (objects.MAX_FOLLOWING_ERROR, self._config.max_following_error_qc),
            (objects.PROFILE_VELOCITY, self._config.profile_velocity_rpm),
            (objects.PROFILE_ACCELERATION, self._config.profile_acceleration_rpm_s),
            (objects.PROFILE_DECELERATION, self._config.profile_acceleration_rpm_s),
            (objects.QUICK_STOP_DECELERATION, QUICK_STOP_RPM_S),
            (objects.MODE, objects.HOMING_MODE),
            (objects.HOMING_METHOD, objects.HOMING_ACTUAL_POSITION),
            (objects.HOME_POSITION, 0),
        ):
            self._line.write(self._node, entry, value)

    def enable(self) -> None:
        """Switch the power stage on; the motor holds where it stands."""
        for word, state in (
            (objects.SHUTDOWN, objects.READY_TO_SWITCH_ON),
            (objects.SWITCH_ON, objects.SWITCHED_ON),
            (objects.ENABLE_OPERATION, objects.OPERATION_ENABLED),
        ):
            self._control(word)
            self._wait_for(state)

    def home(self) -> None:
        """Call the present position zero (method 35), then change to profile position mode."""
        self._control(objects.START)
        self._wait_until(
            lambda: bool(self._enabled_status() & objects.HOMING_ATTAINED_BIT), "to be homed"
        )
        self._control(objects.ENABLE_OPERATION)
        self._line.write(self._node, objects.MODE, objects.PROFILE_POSITION_MODE)
        self._wait_until(
            lambda: (
                self._line.read(self._node, objects.MODE_DISPLAY) == objects.PROFILE_POSITION_MODE
            ),
            "profile position mode",
        )
        self._target_qc = 0

    def begin_move(self, target_qc: int) -> float:
        """Start an absolute move; return how long it should take [s]."""
        per_s = 4 * self._config.encoder_pulses / 60
        acceleration = self._config.profile_acceleration_rpm_s * per_s
        velocity = self._config.profile_velocity_rpm * per_s
        way = trapezoid(self._target_qc, target_qc, velocity, acceleration, acceleration)
        self._line.write(self._node, objects.TARGET_POSITION, target_qc)
        self._control(objects.ENABLE_OPERATION)
        self._control(objects.START_ABSOLUTE_NOW)
        self._target_qc = target_qc
        return way.duration_s

    def wait_arrived(self) -> None:
        """Return when the profile has ended and the encoder itself agrees with the target."""
        self._wait_until(self._has_arrived, f"to stand at {self._target_qc} qc", ARRIVAL_TIMEOUT_S)

    def stands_at(self, target_qc: int) -> bool:
        """Whether the last move was already to this target."""
        return self._target_qc == target_qc

    def position_qc(self) -> int:
        """The encoder's count now."""
        return self._line.read(self._node, objects.POSITION_ACTUAL)

    def quick_stop(self) -> None:
        """Brake at once; the motor stays powered."""
        self._control(objects.QUICK_STOP)

    def wait_standstill(self) -> None:
        """Return when two readings agree, or when the time for braking is over."""
        deadline_s = self._clock.now_s() + STATE_TIMEOUT_S
        before = self.position_qc()
        while self._clock.now_s() < deadline_s:
            self._clock.sleep_s(2 * POLL_S)
            now = self.position_qc()
            if abs(now - before) <= STANDSTILL_QC:
                return
            before = now
        log.warning("%s still moved %g s after a quick stop", self._name, STATE_TIMEOUT_S)

    def disable(self) -> None:
        """Take the power off; return when the controller says so."""
        self._control(objects.DISABLE_VOLTAGE)
        off = (objects.SWITCH_ON_DISABLED, objects.FAULT)
        self._wait_until(lambda: self._status() & objects.STATE_MASK in off, "to be disabled")

    def _has_arrived(self) -> bool:
        if not self._enabled_status() & objects.TARGET_REACHED_BIT:
            return False
        return abs(self.position_qc() - self._target_qc) <= self._config.position_tolerance_qc

    def _status(self) -> int:
        return self._line.read(self._node, objects.STATUSWORD)

    def _enabled_status(self) -> int:
        """The statusword; HardwareError where the motor is no longer enabled."""
        status = self._status()
        if status & objects.FAULT_BIT:
            raise self._fault("no fault")
        if status & objects.STATE_MASK != objects.OPERATION_ENABLED:
            raise HardwareError(
                refusal(self._name, "operation enabled", _state_words(status),
                        "Something else disabled it: check the enable input and start again.")
            )  # fmt: skip
        return status

    def _control(self, word: int) -> None:
        self._line.write(self._node, objects.CONTROLWORD, word)

    def _clear_fault(self) -> None:
        if not self._status() & objects.FAULT_BIT:
            return
        log.warning("%s: clearing %s", self._name, self._errors()[0])
        self._control(objects.FAULT_RESET)
        deadline_s = self._clock.now_s() + STATE_TIMEOUT_S
        while self._status() & objects.FAULT_BIT:
            if self._clock.now_s() >= deadline_s:
                raise self._fault("a fault that can be reset")
            self._clock.sleep_s(POLL_S)
        self._line.write(self._node, objects.ERROR_COUNT, 0)

    def _errors(self) -> tuple[str, str]:
        """(the controller's errors in words, what to do about the latest)."""
        register = self._line.read(self._node, objects.ERROR_REGISTER)
        count = self._line.read(self._node, objects.ERROR_COUNT)
        codes = [
            self._line.read(self._node, objects.error_history(n + 1)) & 0xFFFF for n in range(count)
        ]
        words = [f"0x{code:04X} ({objects.device_error_words(code)[0]})" for code in codes]
        remedy = objects.device_error_words(codes[0])[1] if codes else "Switch it off and on."
        return f"fault {', then '.join(words) or 'of unknown cause'} [0x{register:02X}]", remedy

    def _fault(self, expected: str) -> HardwareError:
        found, remedy = self._errors()
        return HardwareError(refusal(self._name, expected, found, remedy))

    def _wait_for(self, state: int) -> None:
        def reached() -> bool:
            status = self._status()
            if status & objects.FAULT_BIT:
                raise self._fault(objects.STATE_WORDS[state])
            return status & objects.STATE_MASK == state

        self._wait_until(reached, f"state {objects.STATE_WORDS[state]!r}")

    def _wait_until(
        self, done: Callable[[], bool], expected: str, timeout_s: float = STATE_TIMEOUT_S
    ) -> None:
        deadline_s = self._clock.now_s() + timeout_s
        while not done():
            if self._clock.now_s() >= deadline_s:
                found = f"{_state_words(self._status())} at {self.position_qc()} qc"
                raise HardwareError(
                    refusal(self._name, f"{expected} within {timeout_s:g} s", found,
                            "Look for a jam or a tight wire, and check the supply.")
                )  # fmt: skip
            self._clock.sleep_s(POLL_S)


def _state_words(status: int) -> str:
    known = objects.STATE_WORDS.get(status & objects.STATE_MASK, "an unknown state")
    return f"{known} (statusword 0x{status:04X})"
