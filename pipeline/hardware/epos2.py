"""The robot driver: motor shafts turned by EPOS2 controllers on one serial port."""

from collections.abc import Callable, Mapping

from pipeline.clock import Clock
from pipeline.config import RobotConfig
from pipeline.errors import UsageError, refusal
from pipeline.hardware.epos2_line import Epos2Line
from pipeline.hardware.epos2_motor import Motor
from pipeline.hardware.robot import HardwareError

STOP_STEPS: tuple[Callable[[Motor], None], ...] = (
    Motor.quick_stop,
    Motor.wait_standstill,
    Motor.disable,
)


class Epos2:
    """A Robot whose axes are EPOS2 nodes (`robot.nodes`); angles are degrees of output shaft."""

    def __init__(self, line: Epos2Line, config: RobotConfig, clock: Clock) -> None:
        self._line = line
        self._clock = clock
        self._qc_per_deg = qc_per_deg(config)
        self._limits_deg = {axis: _limit_deg(config, axis) for axis in config.nodes}
        self._motors = {
            axis: Motor(axis, node, line, config, clock) for axis, node in config.nodes.items()
        }

    @property
    def limits_deg(self) -> Mapping[str, float]:
        return self._limits_deg

    def start(self) -> None:
        for axis, motor in self._motors.items():
            motor.prepare(self._counts(self._limits_deg[axis]))
        for motor in self._motors.values():
            motor.enable()
            motor.home()

    def move_to(self, angles_deg: Mapping[str, float]) -> None:
        targets_qc = {axis: self._target_qc(axis, angle) for axis, angle in angles_deg.items()}
        durations_s = [
            self._motors[axis].begin_move(target)
            for axis, target in targets_qc.items()
            if not self._motors[axis].stands_at(target)
        ]
        self._clock.sleep_s(max(durations_s, default=0.0))
        for motor in self._motors.values():
            motor.wait_arrived()

    def read_deg(self) -> dict[str, float]:
        return {a: motor.position_qc() / self._qc_per_deg for a, motor in self._motors.items()}

    def stop(self) -> None:
        """Quick stop, wait for standstill, disable.

        Each step is done for each motor whatever happened before, even at another Ctrl-C; then
        the first Ctrl-C is raised again, or a HardwareError says what could not be stopped.
        """
        failures: list[BaseException] = []
        for step in STOP_STEPS:
            for motor in self._motors.values():
                try:
                    step(motor)
                except BaseException as error:
                    failures.append(error)
        for failure in failures:
            if not isinstance(failure, Exception):
                raise failure
        if failures:
            raise HardwareError(
                refusal("robot", "every motor stopped and disabled", f"{failures[0]}",
                        "Switch the motors' supply off.")
            ) from failures[0]  # fmt: skip

    def close(self) -> None:
        """Give the serial port back."""
        self._line.close()

    def _counts(self, angle_deg: float) -> int:
        return round(angle_deg * self._qc_per_deg)

    def _target_qc(self, axis: str, angle_deg: float) -> int:
        if axis not in self._motors:
            raise UsageError(
                refusal("robot", f"an axis of {', '.join(self._motors)}", repr(axis),
                        "Add it to `robot.nodes`.")
            )  # fmt: skip
        limit_deg = self._limits_deg[axis]
        if not abs(angle_deg) <= limit_deg:
            raise UsageError(
                refusal(f"{axis} axis", f"a command within +-{limit_deg:g} deg",
                        f"{angle_deg:g} deg", f"Command less, or raise `robot.limit_deg.{axis}`.")
            )  # fmt: skip
        return self._counts(angle_deg)


def qc_per_deg(config: RobotConfig) -> float:
    """Encoder counts for a degree of output shaft: four for each pulse, through the gear."""
    return 4 * config.encoder_pulses * config.gear_ratio / 360.0


def _limit_deg(config: RobotConfig, axis: str) -> float:
    if axis not in config.limit_deg:
        raise UsageError(
            refusal("robot.limit_deg", f"a limit for axis {axis!r}", f"{dict(config.limit_deg)}",
                    f"Say `+robot.limit_deg.{axis}=90`, or what the mechanism bears.")
        )  # fmt: skip
    return config.limit_deg[axis]
