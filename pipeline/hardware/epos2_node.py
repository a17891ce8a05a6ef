"""An emulated EPOS2 node: object dictionary, CiA 402 states, and a motor that takes its time."""

import random
from collections.abc import Callable

from pipeline.clock import Clock
from pipeline.hardware import epos2_objects as objects
from pipeline.hardware.epos2_frames import Entry
from pipeline.hardware.profile import Profile, braking, resting, then, trapezoid

SERVO_LAG_S = 0.004
POSITION_MODE = -1
OBJECT_MODES = (objects.PROFILE_POSITION_MODE, objects.HOMING_MODE, POSITION_MODE, 3, -2, -3)

POSITION_SETTING = Entry(0x2062, 0, 4, signed=True)
VELOCITY_AVERAGED = Entry(0x2028, 0, 4, signed=True)
READ_ONLY = {
    objects.ERROR_REGISTER: 0,
    objects.SOFTWARE_VERSION: 0x2110,
    Entry(0x2027, 0, 2, signed=True): 0,
    VELOCITY_AVERAGED: 0,
    objects.STATUSWORD: 0,
    objects.MODE_DISPLAY: objects.PROFILE_POSITION_MODE,
    objects.POSITION_ACTUAL: 0,
}
WRITABLE = {
    objects.ERROR_COUNT: 0,
    Entry(0x2002, 0, 2): 5,
    Entry(0x2005, 0, 2): 500,
    POSITION_SETTING: 0,
    objects.HOME_POSITION: 0,
    objects.ENCODER_PULSES: 500,
    objects.CONTROLWORD: 0,
    objects.MODE: objects.PROFILE_POSITION_MODE,
    objects.MAX_FOLLOWING_ERROR: 2000,
    objects.TARGET_POSITION: 0,
    objects.MIN_POSITION: -(2**31),
    objects.MAX_POSITION: 2**31 - 1,
    Entry(0x607F, 0, 4): 25000,
    objects.PROFILE_VELOCITY: 1000,
    objects.PROFILE_ACCELERATION: 10000,
    objects.PROFILE_DECELERATION: 10000,
    objects.QUICK_STOP_DECELERATION: 10000,
    objects.HOMING_METHOD: 7,
}
ENTRIES = {(e.index, e.subindex): e for e in (*READ_ONLY, *WRITABLE)}
POSITIVE = (
    objects.PROFILE_VELOCITY,
    objects.PROFILE_ACCELERATION,
    objects.PROFILE_DECELERATION,
    objects.QUICK_STOP_DECELERATION,
)


def next_state(state: int, word: int, word_before: int) -> int:
    """The state after a controlword (CiA 402); an impossible command changes nothing."""
    if state == objects.FAULT:
        reset = word & ~word_before & objects.FAULT_RESET
        return objects.SWITCH_ON_DISABLED if reset else state
    if not word & 0x02:
        return objects.SWITCH_ON_DISABLED
    if not word & 0x04:
        stopping = state in (objects.OPERATION_ENABLED, objects.QUICK_STOP_ACTIVE)
        return objects.QUICK_STOP_ACTIVE if stopping else objects.SWITCH_ON_DISABLED
    if state == objects.QUICK_STOP_ACTIVE:
        return objects.OPERATION_ENABLED if word & 0x0F == 0x0F else state
    if not word & 0x01:
        return objects.READY_TO_SWITCH_ON
    if state == objects.SWITCH_ON_DISABLED:
        return state
    if state == objects.READY_TO_SWITCH_ON or not word & 0x08:
        return objects.SWITCHED_ON
    return objects.OPERATION_ENABLED


class EmulatedNode:
    """One controller with its motor. `junk` fills the word that an answer leaves without meaning.

    The motor follows its profile a few milliseconds late, and is looked up when somebody asks:
    nothing runs between two requests.
    """

    def __init__(self, clock: Clock, junk: Callable[[], int]) -> None:
        self._clock = clock
        self._junk = junk
        self._values: dict[Entry, int] = READ_ONLY | WRITABLE
        self._errors: list[int] = []
        self._state = objects.SWITCH_ON_DISABLED
        self._profile = resting(0.0)
        self._start_s = clock.now_s()
        self._origin_qc = 0
        self._has_moved = False
        self._homed = False
        self._jammed_qc: float | None = None
        self.lasting_error: int | None = None

    @property
    def state(self) -> int:
        """The state bits of the statusword."""
        return self._state

    def motor_qc(self) -> float:
        """Where the motor truly is, counted from where it was switched on."""
        if self._jammed_qc is not None:
            return self._jammed_qc
        return self._profile.at(self._clock.now_s() - self._start_s - SERVO_LAG_S)[0]

    def jam(self) -> None:
        """Hold the motor fast where it is now."""
        self._jammed_qc = self.motor_qc()

    def fail(self, code: int) -> None:
        """Go into fault with a device error."""
        self._errors.insert(0, code)
        self._brake(objects.QUICK_STOP_DECELERATION)
        self._state = objects.FAULT

    def read(self, index: int, subindex: int) -> tuple[int, int]:
        """(error, DWORD) of an object."""
        self._watch_following_error()
        if index == 0x1003 and 1 <= subindex <= len(self._errors):
            return 0, self._errors[subindex - 1]
        entry = ENTRIES.get((index, subindex))
        if entry is None:
            return _absence(index), 0
        dword = entry.encode(self._value(entry))
        return 0, dword | self._junk() << 16 if entry.size_bytes <= 2 else dword

    def write(self, index: int, subindex: int, dword: int) -> int:
        """Set an object; return the error, 0 where there is none."""
        self._watch_following_error()
        entry = ENTRIES.get((index, subindex))
        if entry is None:
            return _absence(index)
        if entry in READ_ONLY:
            return objects.READ_ONLY
        value = entry.decode(dword)
        error = self._objection(entry, value)
        if error:
            return error
        before, self._values[entry] = self._values[entry], value
        if entry == objects.CONTROLWORD:
            self._obey(value, before)
        elif entry == objects.ERROR_COUNT:
            self._errors.clear()
        elif entry == POSITION_SETTING:
            self._step_to(value)
        return 0

    def _objection(self, entry: Entry, value: int) -> int:
        low, high = self._values[objects.MIN_POSITION], self._values[objects.MAX_POSITION]
        if entry == objects.TARGET_POSITION and not low <= value <= high:
            return objects.VALUE_RANGE
        if entry in POSITIVE and value == 0:
            return objects.VALUE_RANGE
        if entry == objects.MODE and value not in OBJECT_MODES:
            return objects.VALUE_RANGE
        if entry == objects.ERROR_COUNT and value != 0:
            return objects.VALUE_RANGE
        if entry == objects.ENCODER_PULSES and self._state != objects.SWITCH_ON_DISABLED:
            return objects.WRONG_STATE
        return 0

    def _value(self, entry: Entry) -> int:
        if entry == objects.STATUSWORD:
            return self._statusword()
        if entry == objects.POSITION_ACTUAL:
            return round(self.motor_qc()) - self._origin_qc
        if entry == objects.ERROR_COUNT:
            return len(self._errors)
        if entry == objects.ERROR_REGISTER:
            return _register_of(self._errors[0]) if self._errors else 0
        if entry == objects.MODE_DISPLAY:
            return self._values[objects.MODE]
        if entry == VELOCITY_AVERAGED:
            return round(self._demand()[1] / self._qc_s(1))
        return self._values[entry]

    def _statusword(self) -> int:
        word = self._state
        if self._state == objects.OPERATION_ENABLED:
            if self._has_moved and self._trajectory_ended():
                word |= objects.TARGET_REACHED_BIT
            homing = self._values[objects.MODE] == objects.HOMING_MODE
            started = self._values[objects.CONTROLWORD] & objects.START_BIT
            if self._homed if homing else started:
                word |= objects.HOMING_ATTAINED_BIT
        if objects.FOLLOWING_ERROR in self._errors[:1]:
            word |= objects.DEVIATION_BIT
        return word

    def _obey(self, word: int, before: int) -> None:
        state = next_state(self._state, word, before)
        if self._state == objects.FAULT and state != objects.FAULT and self.lasting_error:
            self.fail(self.lasting_error)
            return
        if state != self._state:
            self._brake(objects.QUICK_STOP_DECELERATION)
        self._state = state
        if state != objects.OPERATION_ENABLED:
            return
        if word & objects.HALT_BIT:
            self._brake(objects.PROFILE_DECELERATION)
        elif word & ~before & objects.START_BIT:
            self._begin(word)

    def _begin(self, word: int) -> None:
        mode = self._values[objects.MODE]
        if mode == objects.HOMING_MODE:
            if self._values[objects.HOMING_METHOD] == objects.HOMING_ACTUAL_POSITION:
                home_qc = self._values[objects.HOME_POSITION]
                self._origin_qc = round(self.motor_qc()) - home_qc
                self._homed = self._has_moved = True
        elif mode == objects.PROFILE_POSITION_MODE:
            self._start_profile(word)

    def _start_profile(self, word: int) -> None:
        if word & 0x20:
            self._brake(objects.PROFILE_DECELERATION)
        target_qc = self._origin_qc + self._values[objects.TARGET_POSITION]
        if word & objects.RELATIVE_BIT:
            target_qc += round(self._profile.rest_qc) - self._origin_qc
        low, high = self._values[objects.MIN_POSITION], self._values[objects.MAX_POSITION]
        if not low <= target_qc - self._origin_qc <= high:
            self.fail(objects.POSITION_LIMIT_ERROR)
            return
        way = trapezoid(
            self._profile.rest_qc,
            target_qc,
            self._qc_s(self._values[objects.PROFILE_VELOCITY]),
            self._qc_s(self._values[objects.PROFILE_ACCELERATION]),
            self._qc_s(self._values[objects.PROFILE_DECELERATION]),
        )
        if self._trajectory_ended():
            self._follow(way)
        else:
            self._profile = then(self._profile, way)
        self._has_moved = True

    def _step_to(self, value_qc: int) -> None:
        """Position mode: jump, as far as the following error allows."""
        enabled = self._state == objects.OPERATION_ENABLED
        if not enabled or self._values[objects.MODE] != POSITION_MODE:
            return
        there_qc = self._origin_qc + value_qc
        if abs(there_qc - self.motor_qc()) > self._values[objects.MAX_FOLLOWING_ERROR]:
            self.fail(objects.FOLLOWING_ERROR)
        else:
            self._follow(resting(there_qc))

    def _brake(self, deceleration: Entry) -> None:
        position_qc, velocity_qc_s = self._demand()
        if self._jammed_qc is not None:
            position_qc, velocity_qc_s = self._jammed_qc, 0.0
        rate_qc_s2 = self._qc_s(self._values[deceleration])
        self._follow(braking(position_qc, velocity_qc_s, rate_qc_s2))

    def _follow(self, profile: Profile) -> None:
        self._profile, self._start_s = profile, self._clock.now_s()

    def _demand(self) -> tuple[float, float]:
        return self._profile.at(self._clock.now_s() - self._start_s)

    def _trajectory_ended(self) -> bool:
        return self._clock.now_s() - self._start_s >= self._profile.duration_s

    def _watch_following_error(self) -> None:
        behind_qc = abs(self._demand()[0] - self.motor_qc())
        allowed_qc = self._values[objects.MAX_FOLLOWING_ERROR]
        if self._state == objects.OPERATION_ENABLED and behind_qc > allowed_qc:
            self.fail(objects.FOLLOWING_ERROR)

    def _qc_s(self, rpm: float) -> float:
        return rpm * 4 * self._values[objects.ENCODER_PULSES] / 60.0


def _absence(index: int) -> int:
    known = any(index == there for there, _ in ENTRIES)
    return objects.NO_SUCH_SUBINDEX if known else objects.NO_SUCH_OBJECT


def _register_of(code: int) -> int:
    return 0x02 if code == 0x2310 else 0x20


def seeded_junk(seed: int) -> Callable[[], int]:
    """Words without meaning, the same for the same seed."""
    source = random.Random(seed)
    return lambda: source.randrange(1, 0x10000)
