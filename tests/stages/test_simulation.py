import numpy as np
import pandas as pd
import pytest

from pipeline.config import SimulatedAxis, SimulationConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.recording import Channel, Recording
from pipeline.stages.simulation import simulate

KINEMATIC = SimulationConfig(
    "mechanism", axes={"pitch_angle_deg": SimulatedAxis("pitch_command_deg", 0.8, 1e-5)}
)


def a_recording(measurements: int = 1) -> Recording:
    command = np.concatenate([np.linspace(0, 50, 20), np.linspace(50, -50, 40)])
    channels = [Channel("pitch_command_deg", "command", "deg")]
    samples = {"time_s": np.arange(60.0), "cycle": 0, "step": np.arange(60),
               "pitch_command_deg": command}  # fmt: skip
    for name in ("pitch_angle_deg", "tip_angle_deg")[:measurements]:
        channels.append(Channel(name, "measurement", "deg"))
        samples[name] = 0.7 * command
    return Recording(pd.DataFrame(samples), tuple(channels))


def test_kinematics_simulate_a_measurement_that_has_no_simulation():
    simulated = simulate(KINEMATIC, a_recording())
    command = simulated.values("pitch_command_deg")
    channel = simulated.simulation_of("pitch_angle_deg")
    assert channel.unit == "deg"
    assert np.allclose(simulated.values(channel.name), 0.8 * command - 1e-5 * command**3)


def test_terms_of_the_configuration_act():
    with_play = SimulationConfig(
        "mechanism",
        axes={"pitch_angle_deg": SimulatedAxis("pitch_command_deg", 1.0, 0.0,
                                               {"backlash": {"width": 4.0}})},
    )  # fmt: skip
    answer = simulate(with_play, a_recording()).values("pitch_angle_sim_deg")
    assert answer[19] == pytest.approx(48.0)  # ascending: half the width behind
    assert answer[-1] == pytest.approx(-48.0)


def test_a_recorded_simulation_stays():
    recorded = a_recording().with_channel(
        Channel("sim_deg", "simulation", "deg", of="pitch_angle_deg"), np.zeros(60)
    )
    assert simulate(KINEMATIC, recorded) is recorded


def test_function_of_ones_own(tmp_path, monkeypatch):
    (tmp_path / "my_own_model.py").write_text(
        "def simulate(table):\n    return 2 * table['pitch_command_deg'].to_numpy()\n"
        "def short(table):\n    return [1.0]\n"
    )
    monkeypatch.chdir(tmp_path)
    config = SimulationConfig("python", "my_own_model:simulate")
    answer = simulate(config, a_recording())
    assert np.allclose(answer.values("pitch_angle_sim_deg")[19], 100.0)
    with pytest.raises(LoopgapError, match=r"shape \(60,\); found shape \(1,\)"):
        simulate(SimulationConfig("python", "my_own_model:short"), a_recording())
    with pytest.raises(UsageError, match="Start loopgap in the folder of no_such_model.py"):
        simulate(SimulationConfig("python", "no_such_model:simulate"), a_recording())
    with pytest.raises(UsageError, match="expected module:function; found 'simulate'"):
        simulate(SimulationConfig("python", "simulate"), a_recording())


def test_a_measurement_that_nothing_simulates_is_refused():
    with pytest.raises(UsageError, match="a simulation channel of 'pitch_angle_deg'; found none"):
        simulate(SimulationConfig("recorded"), a_recording())
    with pytest.raises(UsageError, match="a mechanism for 'tip_angle_deg'; found pitch_angle_deg"):
        simulate(KINEMATIC, a_recording(2))
