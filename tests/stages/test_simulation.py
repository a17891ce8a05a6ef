from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pipeline.config import Config, HeldoutConfig, SimulatedAxis, SimulationConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.recording import Channel, Recording
from pipeline.runners.simulation import with_simulation
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


def test_a_simulation_that_is_not_used_is_said(capsys):
    own = Channel("sim_deg", "simulation", "deg", of="pitch_angle_deg")
    recorded = a_recording().with_channel(own, np.zeros(60))
    with_simulation(Config(simulation=KINEMATIC), recorded)
    assert capsys.readouterr().out == ""
    with_simulation(Config(simulation=SimulationConfig("affine")), recorded)
    assert "simulation=affine is not used" in capsys.readouterr().out


def test_a_recording_without_any_command_is_refused():
    whole = a_recording()
    mute = replace(whole, channels=whole.with_role("measurement"))
    with pytest.raises(UsageError, match="a channel of role 'command'; found none"):
        simulate(KINEMATIC, mute)


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


NO_MODEL = (
    "simulation of 'tip_angle_deg': expected a simulation channel .*; "
    "found no such channel, and mechanisms for pitch_angle_deg.* simulation=affine needs no model"
)


def test_a_measurement_that_nothing_simulates_is_refused():
    with pytest.raises(UsageError, match="a simulation channel of 'pitch_angle_deg'; found none"):
        simulate(SimulationConfig("recorded"), a_recording())
    with pytest.raises(UsageError, match=NO_MODEL):
        simulate(KINEMATIC, a_recording(2))


def test_identity_is_the_command_of_the_same_name_and_unit():
    answer = simulate(SimulationConfig("identity"), a_recording()).values("pitch_angle_sim_deg")
    assert answer.tolist() == a_recording().values("pitch_command_deg").tolist()
    channels = (Channel("motor_count", "command", "count"), a_recording().channels[1])
    samples = a_recording().samples.rename(columns={"pitch_command_deg": "motor_count"})
    with pytest.raises(UsageError, match=r"one command in deg .*found motor_count \[count\]"):
        simulate(SimulationConfig("identity"), Recording(samples, channels))


def test_affine_looks_at_no_held_out_row():
    recording = a_recording()
    samples = recording.samples.copy()
    samples.loc[40:, "pitch_angle_deg"] += 1000.0
    spoilt = replace(recording, samples=samples)
    heldout = HeldoutConfig("last_third")
    answer = simulate(SimulationConfig("affine"), spoilt, heldout).values("pitch_angle_sim_deg")
    assert np.allclose(answer, 0.7 * recording.values("pitch_command_deg"))


@pytest.mark.parametrize("kind", ["identity", "affine"])
def test_a_force_against_motion_that_nobody_models_is_left_out_whole(kind):
    recording = a_recording(2)
    channels = (*recording.channels[:2], Channel("tip_angle_deg", "measurement", "Nm"))
    answer = simulate(SimulationConfig(kind), Recording(recording.samples, channels))
    assert not np.any(answer.values("tip_angle_sim_deg"))
    assert np.ptp(answer.values("pitch_angle_sim_deg")) > 50.0


def test_a_function_that_fails_is_named_with_what_it_did(tmp_path, monkeypatch):
    (tmp_path / "bad_model.py").write_text(
        "import numpy as np\n"
        "def fails(table):\n    return table['yaw']\n"
        "def holes(table):\n    x = np.zeros(len(table)); x[7] = np.nan; return x\n"
        "def column(table):\n    return np.ones((len(table), 1))\n"
        "def leaves(table):\n    raise SystemExit(3)\n"
    )
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LoopgapError, match=r"found KeyError: 'yaw' \(bad_model.py, line 3\)"):
        simulate(SimulationConfig("python", "bad_model:fails"), a_recording())
    with pytest.raises(LoopgapError, match=r"found 1 that are none, the first in row 7"):
        simulate(SimulationConfig("python", "bad_model:holes"), a_recording())
    with pytest.raises(LoopgapError, match=r"found SystemExit: 3 \(bad_model.py, line 9\)"):
        simulate(SimulationConfig("python", "bad_model:leaves"), a_recording())
    column = simulate(SimulationConfig("python", "bad_model:column"), a_recording())
    assert column.values("pitch_angle_sim_deg").tolist() == [1.0] * 60


def test_a_functions_named_columns_may_stand_in_any_order(tmp_path, monkeypatch):
    (tmp_path / "named_model.py").write_text(
        "import pandas as pd\n"
        "def f(c):\n    both = {'tip_angle_deg': 2.0, 'pitch_angle_deg': 1.0}\n"
        "    return pd.DataFrame(both, c.index)\n"
    )
    monkeypatch.chdir(tmp_path)
    answer = simulate(SimulationConfig("python", "named_model:f"), a_recording(2))
    assert answer.values("pitch_angle_sim_deg")[0] == 1.0
    assert answer.values("tip_angle_sim_deg")[0] == 2.0


def test_a_module_that_fails_when_it_is_imported(tmp_path, monkeypatch):
    (tmp_path / "worse_model.py").write_text("size = 3\nsize / 0\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError, match=r"division by zero \(worse_model.py, line 2\)"):
        simulate(SimulationConfig("python", "worse_model:f"), a_recording())


def test_a_trace_of_another_rate_is_resampled(tmp_path, capsys):
    time_s = np.arange(5.0, 90.0, 0.25)
    file = tmp_path / "trace.csv"
    pd.DataFrame({"time_s": time_s, "pitch_angle_deg": 2.0 * time_s}).to_csv(file, index=False)
    config = Config(simulation=SimulationConfig("trace", path=str(file)))
    answer = with_simulation(config, a_recording()).values("pitch_angle_sim_deg")
    assert np.isnan(answer[:5]).all()
    assert np.allclose(answer[5:], 2.0 * np.arange(5.0, 60.0))
    assert "one each 0.25 s" in (said := capsys.readouterr().out)
    assert "5 rows of the recording are outside" in said
    with pytest.raises(LoopgapError, match=r"no tip_angle_deg; there are time_s, pitch_angle_deg"):
        with_simulation(config, a_recording(2))


def test_a_trace_says_what_it_bridges_and_holds_numbers(tmp_path, capsys):
    file = tmp_path / "trace.csv"
    config = Config(simulation=SimulationConfig("trace", path=str(file)))
    table = pd.DataFrame({"time_s": np.arange(60.0), "pitch_angle_deg": 1.0})
    table.drop(index=range(20, 39)).to_csv(file, index=False)
    with_simulation(config, a_recording())
    assert "pitch_angle_deg: its longest gap, 20 s, is bridged straight" in capsys.readouterr().out
    table.astype(object).replace({"time_s": {7.0: "seven"}}).to_csv(file, index=False)
    with pytest.raises(LoopgapError, match=r"column 'time_s', row 7 .*a number; found 'seven'"):
        with_simulation(config, a_recording())
    table.replace({"time_s": {7.0: 5.5}}).to_csv(file, index=False)
    with pytest.raises(LoopgapError, match=r"row 7 .*: expected rising numbers; found 5.5 after 6"):
        with_simulation(config, a_recording())
    table.assign(time_s=1000.0 * table["time_s"]).to_csv(file, index=False)
    with pytest.raises(LoopgapError, match=r"10 samples within 0 to 59 s; found 1, its times go"):
        with_simulation(config, a_recording())


def test_a_mechanism_is_read_from_a_list_of_terms(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text(
        "pitch_angle_deg:\n  command: pitch_command_deg\n  terms:\n    - backlash: {width: 4}\n"
    )
    config = Config(simulation=SimulationConfig("mechanism", path=str(file)))
    answer = with_simulation(config, a_recording()).values("pitch_angle_sim_deg")
    assert answer[19] == pytest.approx(48.0)
    file.write_text("pitch_angle_deg: {comand: pitch_command_deg}\n")
    with pytest.raises(UsageError, match=r"comand"):
        with_simulation(config, a_recording())


def listed(folder, terms: str, more: str = "") -> Config:
    file = folder / "mine.yaml"
    head = f"pitch_angle_deg: {{command: pitch_command_deg, terms: {terms}}}\n"
    file.write_text(head + more)
    return Config(simulation=SimulationConfig("mechanism", path=str(file)))


def test_a_term_without_numbers_has_the_size_of_the_recorded_motion(tmp_path):
    answer = with_simulation(listed(tmp_path, "[backlash]"), a_recording())
    width = 0.05 * 100.0  # of a command that goes from 50 to -50 deg
    assert answer.values("pitch_angle_sim_deg")[19] == pytest.approx(50.0 - width / 2)


@pytest.mark.parametrize(
    ("terms", "more", "words"),
    [
        ("[backslash: {}]", "", "'pitch_angle_deg', terms: expected one of .*found 'backslash'"),
        ("[drift/often]", "", "expected one of drift/linear, .*; found 'drift/often'"),
        ("[backlash: {width: -1}]", "", "'pitch_angle_deg', term 'backlash', parameter 'width'"),
        ("[backlash, backlash]", "", "found a term twice among backlash, backlash"),
        ("[]", "pitch_angle_deg: {}", "line 2: found duplicate key pitch_angle_deg"),
    ],
)
def test_a_mechanism_that_can_not_be_says_where(terms, more, words, tmp_path):
    with pytest.raises(UsageError, match=words):
        with_simulation(listed(tmp_path, terms, more), a_recording())
