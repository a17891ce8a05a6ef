"""What of the EPOS2's object dictionary, states and error codes is used here.

Source: maxon EPOS2 Firmware Specification (device states: chapter 3; objects: chapter 8;
errors: chapter 7), CiA 402.
"""

from pipeline.hardware.epos2_frames import Entry

ERROR_REGISTER = Entry(0x1001, 0, 1)
ERROR_COUNT = Entry(0x1003, 0, 1)
SOFTWARE_VERSION = Entry(0x2003, 1, 2)
HOME_POSITION = Entry(0x2081, 0, 4, signed=True)
ENCODER_PULSES = Entry(0x2210, 1, 4)
CONTROLWORD = Entry(0x6040, 0, 2)
STATUSWORD = Entry(0x6041, 0, 2)
MODE = Entry(0x6060, 0, 1, signed=True)
MODE_DISPLAY = Entry(0x6061, 0, 1, signed=True)
POSITION_ACTUAL = Entry(0x6064, 0, 4, signed=True)
MAX_FOLLOWING_ERROR = Entry(0x6065, 0, 4)
TARGET_POSITION = Entry(0x607A, 0, 4, signed=True)
MIN_POSITION = Entry(0x607D, 1, 4, signed=True)
MAX_POSITION = Entry(0x607D, 2, 4, signed=True)
PROFILE_VELOCITY = Entry(0x6081, 0, 4)
PROFILE_ACCELERATION = Entry(0x6083, 0, 4)
PROFILE_DECELERATION = Entry(0x6084, 0, 4)
QUICK_STOP_DECELERATION = Entry(0x6085, 0, 4)
HOMING_METHOD = Entry(0x6098, 0, 1, signed=True)


def error_history(number: int) -> Entry:
    """The `number`-th last device error, from 1."""
    return Entry(0x1003, number, 4)


PROFILE_POSITION_MODE = 1
HOMING_MODE = 6
HOMING_ACTUAL_POSITION = 35

DISABLE_VOLTAGE = 0x0000
SHUTDOWN = 0x0006
SWITCH_ON = 0x0007
QUICK_STOP = 0x000B
ENABLE_OPERATION = 0x000F
START = 0x001F
START_ABSOLUTE_NOW = 0x003F
FAULT_RESET = 0x0080
START_BIT = 0x0010
RELATIVE_BIT = 0x0040
HALT_BIT = 0x0100

STATE_MASK = 0x417F
SWITCH_ON_DISABLED = 0x0140
READY_TO_SWITCH_ON = 0x0121
SWITCHED_ON = 0x0123
OPERATION_ENABLED = 0x0137
QUICK_STOP_ACTIVE = 0x0117
FAULT = 0x0108
FAULT_BIT = 0x0008
TARGET_REACHED_BIT = 0x0400
HOMING_ATTAINED_BIT = 0x1000
DEVIATION_BIT = 0x2000

STATE_WORDS = {
    SWITCH_ON_DISABLED: "switch-on disabled",
    READY_TO_SWITCH_ON: "ready to switch on",
    SWITCHED_ON: "switched on",
    OPERATION_ENABLED: "operation enabled",
    QUICK_STOP_ACTIVE: "quick stop active",
    FAULT: "fault",
}

FOLLOWING_ERROR = 0x8611
POSITION_LIMIT_ERROR = 0xFF09

DEVICE_ERRORS = {
    0x1000: ("generic error", "Switch the controller off and on."),
    0x2310: ("overcurrent", "Look for a short circuit or a jammed motor; lower the acceleration."),
    0x3210: ("overvoltage", "Check the supply; lower the deceleration."),
    0x3220: ("undervoltage", "Check that the supply is on and strong enough."),
    0x4210: ("overtemperature", "Let the controller cool; lower the continuous current."),
    0x5113: ("logic supply voltage too low", "Check the supply."),
    0x6320: ("software parameter error", "Set the controller up anew in EPOS Studio."),
    0x7320: ("position sensor error", "Check the encoder's cable and `robot.encoder_pulses`."),
    0x8611: (
        "following error: the motor could not keep up with its command",
        "Look for a jam or a taut wire; lower `robot.profile_velocity_rpm` or raise "
        "`robot.max_following_error_qc`.",
    ),
    0xFF01: ("Hall sensor error", "Check the Hall sensor's cable."),
    0xFF02: ("index processing error", "Check the encoder's cable."),
    0xFF03: ("encoder resolution error", "Check `robot.encoder_pulses`."),
    0xFF04: ("Hall sensor not found", "Check the Hall sensor's cable."),
    0xFF06: ("negative limit switch", "Move the mechanism off its limit switch."),
    0xFF07: ("positive limit switch", "Move the mechanism off its limit switch."),
    0xFF08: ("Hall angle detection error", "Check the motor's and sensor's cables."),
    0xFF09: (
        "software position limit",
        "Stay within `robot.limit_deg`, and home the robot where it is straight.",
    ),
    0xFF0A: ("position sensor breach", "Check the encoder's cable."),
}

NO_SUCH_OBJECT = 0x06020000
NO_SUCH_SUBINDEX = 0x06090011
READ_ONLY = 0x06010002
VALUE_RANGE = 0x06090030
WRONG_STATE = 0x08000022

ABORT_WORDS = {
    0x05040000: "time-out",
    0x05040001: "unknown command",
    0x06010000: "access not supported",
    0x06010001: "the object can only be written",
    READ_ONLY: "the object can only be read",
    NO_SUCH_OBJECT: "no such object",
    0x06040043: "incompatible parameter",
    0x06070010: "wrong parameter size",
    NO_SUCH_SUBINDEX: "no such subindex",
    VALUE_RANGE: "value out of range",
    0x06090031: "value too high",
    0x06090032: "value too low",
    0x08000000: "general error",
    0x08000020: "the object can't be accessed now",
    WRONG_STATE: "not possible in this device state",
    0x0F00FFB9: "wrong CAN node",
    0x0F00FFBC: "not in service mode",
    0x0F00FFBE: "wrong password",
    0x0F00FFBF: "illegal command",
    0x0F00FFC0: "wrong NMT state",
}


def device_error_words(code: int) -> tuple[str, str]:
    """(what a device error means, what to do) for the code that 0x1003 holds."""
    return DEVICE_ERRORS.get(
        code & 0xFFFF, ("an error this program doesn't know", "See the EPOS2 firmware manual.")
    )
