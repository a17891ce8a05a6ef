"""A real-time acquisition on the emulated robot that waits to be interrupted."""

import json
import sys
import time
from pathlib import Path

from pipeline.clock import RealClock
from pipeline.config import AcquisitionConfig, RobotConfig
from pipeline.hardware.epos2 import Epos2
from pipeline.hardware.epos2_emulator import Epos2Emulator
from pipeline.hardware.epos2_line import Epos2Line
from pipeline.recorder import Recorder
from pipeline.stages.acquisition import acquire, channels_of, protocol


class Camera:
    """Takes two images, then says so."""

    name = "yaw"
    taken = 0

    def grab(self) -> bytes:
        self.taken += 1
        if self.taken == 3:
            print("second sample", flush=True)
        return b"image"

    def close(self) -> None: ...


def main(folder: Path) -> None:
    config = AcquisitionConfig(steps_per_cycle=8, pause_s=0.01, amplitude_deg={"yaw": 80.0})
    robot_config = RobotConfig(kind="emulated")
    clock = RealClock()
    with (
        Epos2Emulator(robot_config.nodes, clock) as emulator,
        Recorder(folder, channels_of(config), "simulated") as recorder,
    ):
        robot = Epos2(Epos2Line(emulator.port, robot_config.baud), robot_config, clock)
        try:
            acquire(config, protocol(config, "yaw"), robot, {"yaw": Camera()}, clock, recorder)
        except KeyboardInterrupt:
            rest = emulator.shaft_deg()["yaw"]
            time.sleep(0.2)
            words = {
                "states": [node.state for node in emulator.nodes.values()],
                "moved_after_deg": emulator.shaft_deg()["yaw"] - rest,
            }
            print(json.dumps(words))
            sys.exit(130)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
