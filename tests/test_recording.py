import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from full_disk import full_at

from pipeline.atomically import write_atomically
from pipeline.recording import (
    Channel,
    Recording,
    RecordingError,
    branch_of,
    check_channels,
    cycles_from_reversals,
    file_stem,
    load_recording,
    reversals_of,
    save_recording,
)

COMMAND = Channel("pitch_command_deg", "command", "deg")
ANGLE = Channel("pitch_angle_deg", "measurement", "deg")
SIMULATION = Channel("pitch_angle_sim_deg", "simulation", "deg", of="pitch_angle_deg")


def triangle(cycles: int, steps: int = 40, amplitude: float = 30.0) -> np.ndarray:
    phase = np.arange(cycles * steps) / steps % 1.0
    return amplitude * (4 * np.abs((phase - 0.25) % 1.0 - 0.5) - 1.0)


def a_recording(cycles: int = 3, steps: int = 40) -> Recording:
    command = triangle(cycles, steps)
    samples = pd.DataFrame(
        {
            "time_s": np.arange(len(command)) * 3.0,
            "cycle": np.repeat(np.arange(cycles), steps),
            "step": np.tile(np.arange(steps), cycles),
            COMMAND.name: command,
            ANGLE.name: 0.7 * command,
            SIMULATION.name: 0.71 * command,
        }
    )
    return Recording(samples, (COMMAND, ANGLE, SIMULATION), "simulated")


def written(tmp_path: Path) -> Path:
    save_recording(a_recording(), tmp_path)
    return tmp_path


def edit_head(folder: Path, **changes: object) -> None:
    head = json.loads((folder / "recording.json").read_text())
    (folder / "recording.json").write_text(json.dumps(head | changes))


def edit_samples(folder: Path, column: str, row: int, value: object) -> None:
    samples = pd.read_csv(folder / "samples.csv", dtype=object)
    samples.loc[row, column] = value
    samples.to_csv(folder / "samples.csv", index=False)


def test_saved_is_loaded_again_to_the_last_digit(tmp_path):
    recording = a_recording()
    recording.samples.loc[5, ANGLE.name] = np.nan
    save_recording(recording, tmp_path)
    again = load_recording(tmp_path)
    pd.testing.assert_frame_equal(again.samples, recording.samples, check_exact=True)
    assert again.channels == recording.channels
    assert again.source == "simulated"
    assert sorted(f.name for f in tmp_path.iterdir()) == ["recording.json", "samples.csv"]


def test_parquet_is_read_like_csv(tmp_path):
    folder = written(tmp_path)
    csv = load_recording(folder)
    csv.samples.to_parquet(folder / "samples.parquet")
    (folder / "samples.csv").unlink()
    pd.testing.assert_frame_equal(load_recording(folder).samples, csv.samples)


def test_a_byte_order_mark_belongs_to_no_column(tmp_path):
    save_recording(a_recording(), tmp_path)
    for name in ("samples.csv", "recording.json"):
        file = tmp_path / name
        file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    pd.testing.assert_frame_equal(load_recording(tmp_path).samples, a_recording().samples)


def test_cycle_and_step_are_found_from_the_reversals(tmp_path):
    folder = written(tmp_path)
    whole = load_recording(folder)
    whole.samples.drop(columns=["cycle", "step"]).to_csv(folder / "samples.csv", index=False)
    found = load_recording(folder)
    assert found.samples["cycle"].tolist() == whole.samples["cycle"].tolist()
    assert found.samples["step"].tolist() == whole.samples["step"].tolist()


def test_branches_hold_their_direction_where_the_command_stands_still():
    command = np.array([0.0, 0.0, 1.0, 2.0, 2.0, 1.0, 1.0, 0.5, 1.0])
    assert branch_of(command).tolist() == [1, 1, 1, 1, 1, -1, -1, -1, 1]
    assert branch_of(np.zeros(4)).tolist() == [0, 0, 0, 0]


def test_reversals_ignore_encoder_noise():
    command = triangle(2) + np.random.default_rng(0).normal(0, 0.05, 80)
    assert np.allclose(reversals_of(command), [10, 30, 50, 70], atol=1)
    assert reversals_of(np.ones(5)).size == 0


def test_a_cycle_ends_where_the_command_comes_back_in_its_first_direction():
    assert np.bincount(cycles_from_reversals(triangle(4))).tolist() == [40, 40, 40, 40]
    assert cycles_from_reversals(np.linspace(0, 1, 20)).tolist() == [0] * 20


def test_ways_of_several_sizes_that_come_again_together_are_one_cycle():
    sizes = np.tile([30.0, 20.0, 10.0], 4)
    swinging = np.concatenate([size * triangle(1) / np.ptp(triangle(1)) for size in sizes])
    assert np.bincount(cycles_from_reversals(swinging)).tolist() == [120] * 4
    twice = swinging[: 2 * 120]
    assert np.bincount(cycles_from_reversals(twice)).tolist() == [40] * 6


@pytest.mark.parametrize(("rows", "cycles"), [(74.0, 9), (73.9, 9)])
def test_a_sum_of_sines_that_comes_again_is_a_cycle_however_often_it_passes_its_first_value(
    rows, cycles
):
    phase = 2.0 * np.pi * np.arange(int(cycles * rows)) / rows
    command = np.sin(phase + 0.3) + 0.8 * np.sin(3.0 * phase + 2.0) + 0.6 * np.sin(5.0 * phase)
    lengths = np.bincount(cycles_from_reversals(command))
    assert len(lengths) in (cycles, cycles + 1)
    np.testing.assert_allclose(lengths[1:-1], rows, atol=1.0)


def test_steps_that_come_a_sample_early_or_late_are_the_same_again():
    levels = np.array([0.0, 20.0, -10.0, 15.0, -20.0])
    at = (5.0 * (np.arange(1000) / 66.7 % 1.0)).astype(int)
    assert abs(len(np.unique(cycles_from_reversals(levels[at]))) - 15) <= 1


def test_cycles_of_a_recording_and_one_that_is_empty():
    recording = a_recording()
    assert recording.cycles([0, 2]).samples["cycle"].unique().tolist() == [0, 2]
    with pytest.raises(RecordingError, match=r"samples in cycles \[1, 7\].*none in \[7\]"):
        recording.cycles([1, 7])


def test_too_few_samples_for_the_work():
    with pytest.raises(RecordingError, match="at least 500 samples for training; found 120"):
        a_recording().require(500, "training")


def test_unknown_channel_names_those_that_exist():
    with pytest.raises(RecordingError, match="'yaw'.*pitch_command_deg, pitch_angle_deg"):
        a_recording().channel("yaw")


def test_no_recording_there(tmp_path):
    with pytest.raises(RecordingError, match="recording.json.*no such file"):
        load_recording(tmp_path / "nowhere")


def test_head_that_is_no_json(tmp_path):
    folder = written(tmp_path)
    (folder / "recording.json").write_text("{")
    with pytest.raises(RecordingError, match=r"recording.json: expected JSON; found .*line 1"):
        load_recording(folder)


def test_unknown_schema(tmp_path):
    folder = written(tmp_path)
    edit_head(folder, schema="loopgap.recording/9")
    with pytest.raises(RecordingError, match="'loopgap.recording/1'; found 'loopgap.recording/9'"):
        load_recording(folder)


@pytest.mark.parametrize("column", ["time_s", ANGLE.name])
def test_missing_column(tmp_path, column):
    folder = written(tmp_path)
    pd.read_csv(folder / "samples.csv").drop(columns=column).to_csv(
        folder / "samples.csv", index=False
    )
    with pytest.raises(RecordingError, match=f"samples.csv: expected a column '{column}'; found"):
        load_recording(folder)


def test_repeated_column(tmp_path):
    folder = written(tmp_path)
    text = (folder / "samples.csv").read_text()
    (folder / "samples.csv").write_text(text.replace(SIMULATION.name, ANGLE.name, 1))
    with pytest.raises(RecordingError, match=f"column '{ANGLE.name}' repeated"):
        load_recording(folder)


def test_repeated_channel(tmp_path):
    folder = written(tmp_path)
    edit_head(folder, channels=[COMMAND.as_json(), COMMAND.as_json()])
    with pytest.raises(RecordingError, match="each channel once; found 'pitch_command_deg'"):
        load_recording(folder)


def test_unit_that_does_not_fit_its_name(tmp_path):
    folder = written(tmp_path)
    edit_head(folder, channels=[COMMAND.as_json() | {"unit": "rad"}])
    with pytest.raises(RecordingError, match="unit of its name, 'deg'; found 'rad'"):
        load_recording(folder)


@pytest.mark.parametrize(
    ("name", "unit", "fits"),
    [
        ("theta_m", "deg", True),
        ("joint_a", "rad", True),
        ("x_n", "mm", True),
        ("position_m", "m", True),
        ("x_m", "mm", False),
        ("position_m", "deg", False),
        ("force_n", "mm", False),
        ("motor_current_a", "ma", False),
    ],
)
def test_one_letter_that_ends_a_name_is_a_unit_where_it_may_be(name, unit, fits):
    channels = [Channel(name, "command", unit)]
    if fits:
        check_channels("recording.json", channels)
        return
    with pytest.raises(RecordingError, match=f"unit of its name, '{name[-1]}'; found '{unit}'"):
        check_channels("recording.json", channels)


def test_simulation_in_another_unit(tmp_path):
    folder = written(tmp_path)
    edit_head(folder, channels=[ANGLE.as_json(), SIMULATION.as_json() | {"unit": "mm"}])
    with pytest.raises(RecordingError, match="unit of 'pitch_angle_deg', 'deg'; found 'mm'"):
        load_recording(folder)


def test_simulation_of_no_measurement(tmp_path):
    folder = written(tmp_path)
    edit_head(folder, channels=[ANGLE.as_json(), SIMULATION.as_json() | {"of": "roll"}])
    with pytest.raises(RecordingError, match=r"`of` to name a measurement \(pitch_angle_deg\)"):
        load_recording(folder)


def test_unknown_role(tmp_path):
    folder = written(tmp_path)
    edit_head(folder, channels=[COMMAND.as_json() | {"role": "guess"}])
    with pytest.raises(RecordingError, match="a role of command, measurement.*found 'guess'"):
        load_recording(folder)


def test_time_that_goes_back(tmp_path):
    folder = written(tmp_path)
    edit_samples(folder, "time_s", 7, "1.5")
    with pytest.raises(RecordingError, match=r"row 9, column 'time_s': expected a time not before"):
        load_recording(folder)


def test_text_in_a_number_column(tmp_path):
    folder = written(tmp_path)
    edit_samples(folder, ANGLE.name, 3, "n/k")
    with pytest.raises(
        RecordingError, match=r"row 5, column 'pitch_angle_deg': expected a number; found 'n/k'"
    ):
        load_recording(folder)


def test_an_empty_command_is_refused_but_an_empty_measurement_is_not(tmp_path):
    folder = written(tmp_path)
    edit_samples(folder, ANGLE.name, 3, None)
    assert int(load_recording(folder).samples[ANGLE.name].isna().sum()) == 1
    edit_samples(folder, COMMAND.name, 3, None)
    with pytest.raises(RecordingError, match=r"row 5, column 'pitch_command_deg'.*found nothing"):
        load_recording(folder)


@pytest.mark.parametrize(
    ("end", "words"),
    [(",", "row 6: expected 6 cells, as in row 1; found 7"), (None, "row 6: .* found 5. Mend")],
)
def test_a_row_of_another_width_is_refused(tmp_path, end, words):
    folder = written(tmp_path)
    lines = (folder / "samples.csv").read_text().splitlines()
    lines[5] = lines[5] + end if end else lines[5].rpartition(",")[0]
    (folder / "samples.csv").write_text("\n".join(lines))
    with pytest.raises(RecordingError, match=words):
        load_recording(folder)


def test_rows_that_are_all_longer_than_the_head_do_not_shift(tmp_path):
    folder = written(tmp_path)
    head, *rows = (folder / "samples.csv").read_text().splitlines()
    (folder / "samples.csv").write_text("\n".join([head, *(f"{row},1" for row in rows)]))
    with pytest.raises(RecordingError, match=r"row 2: expected 6 cells, as in row 1; found 7"):
        load_recording(folder)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "first row with the columns' names; found an empty file"),
        ("time_s;pitch_command_deg\n0;1\n", r"columns parted by commas.*stages=\[importing"),
    ],
)
def test_a_file_that_is_no_table(tmp_path, text, words):
    folder = written(tmp_path)
    (folder / "samples.csv").write_text(text)
    with pytest.raises(RecordingError, match=words):
        load_recording(folder)


def test_a_table_in_another_encoding(tmp_path):
    folder = written(tmp_path)
    text = (folder / "samples.csv").read_text()
    (folder / "samples.csv").write_bytes(text.encode("utf-16"))
    with pytest.raises(RecordingError, match="text in UTF-8; found byte 0xff at 0. Save it as UTF"):
        load_recording(folder)


def test_a_time_that_stands_still(tmp_path):
    folder = written(tmp_path)
    samples = pd.read_csv(folder / "samples.csv").assign(time_s=2.0)
    samples.to_csv(folder / "samples.csv", index=False)
    with pytest.raises(RecordingError, match="a time that goes on; found 2 s in all 120 rows"):
        load_recording(folder)


def test_a_file_in_place_of_the_folder(tmp_path):
    folder = written(tmp_path)
    with pytest.raises(RecordingError, match="found a file. Name the folder, or import"):
        load_recording(folder / "samples.csv")


def test_cycle_that_is_no_whole_number(tmp_path):
    folder = written(tmp_path)
    edit_samples(folder, "cycle", 2, "0.5")
    with pytest.raises(RecordingError, match=r"row 4, column 'cycle': expected a whole number"):
        load_recording(folder)


def test_two_sample_files_are_one_too_many(tmp_path):
    folder = written(tmp_path)
    (folder / "samples.parquet").write_bytes(b"")
    with pytest.raises(RecordingError, match="one of samples.csv and samples.parquet"):
        load_recording(folder)


def test_recordings_of_the_collection_load(concealed_recordings):
    for folder in concealed_recordings:
        recording = load_recording(folder)
        command = recording.values("pitch_command_deg")
        if np.ptp(recording.values("yaw_command_deg")) == 0:
            found = cycles_from_reversals(command)
            assert np.array_equal(found, recording.values("cycle"))


@pytest.mark.parametrize(
    ("entry", "found"),
    [
        (
            {"name": "x", "role": "simulation", "unit": "deg", "of": ["y"]},
            r"text for `of`.*\['y'\]",
        ),
        ({"name": "time_s", "role": "command", "unit": "s"}, "beside the context columns time_s"),
    ],
)
def test_entries_that_name_no_measurement_or_a_context_column(tmp_path, entry, found):
    folder = written(tmp_path)
    edit_head(folder, channels=[COMMAND.as_json(), ANGLE.as_json(), entry])
    with pytest.raises(RecordingError, match=f"recording.json, channel .*{found}"):
        load_recording(folder)


def test_head_nested_beyond_all_reading(tmp_path):
    folder = written(tmp_path)
    (folder / "recording.json").write_text("[" * 100_000)
    with pytest.raises(RecordingError, match="expected JSON; found maximum recursion"):
        load_recording(folder)


@pytest.mark.parametrize("number", ["99999999999999999999", "1e300"])
def test_more_cycles_than_can_be_counted(tmp_path, number):
    folder = written(tmp_path)
    edit_samples(folder, "cycle", 4, number)
    with pytest.raises(RecordingError, match="row 6, column 'cycle': expected a whole number"):
        load_recording(folder)


@pytest.mark.parametrize(
    ("column", "values", "found"),
    [
        ("time_s", pd.to_datetime(np.arange(120), unit="s"), "dates or times of day"),
        ("time_s", pd.to_timedelta(np.arange(120), unit="s"), "dates or times of day"),
        (ANGLE.name, [[1.0, 2.0]] * 120, "lists"),
    ],
)
def test_parquet_columns_that_hold_no_numbers(tmp_path, column, values, found):
    folder = written(tmp_path)
    (folder / "samples.csv").unlink()
    samples = a_recording().samples.assign(**{column: values})
    samples.to_parquet(folder / "samples.parquet")
    with pytest.raises(RecordingError, match=f"{column}': expected numbers; found {found}"):
        load_recording(folder)


def test_only_a_simulation_simulates():
    command = Channel("pitch_command_deg", "command", "deg", of=ANGLE.name)
    recording = Recording(a_recording().samples, (command, ANGLE, SIMULATION))
    assert recording.simulation_of(ANGLE.name) == SIMULATION


def test_every_channel_has_a_file_of_its_own():
    names = ["pitch_angle_deg", "Größe", "/joint/angle[0]", "/joint/angle/0/", "../x", "a" * 300]
    stems = [file_stem(name) for name in names]
    assert stems[:2] == names[:2]
    assert len(set(stems)) == len(names)
    assert all("/" not in s and not s.startswith(".") and len(s) < 100 for s in stems)


def test_a_full_disk_is_told_with_the_file_and_gets_its_room_back(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    write_atomically(path, "old")
    with full_at(1000), pytest.raises(OSError, match="table.csv") as refused:
        write_atomically(path, "x" * 5000)
    assert refused.value.filename == str(path)
    assert [f.name for f in tmp_path.iterdir()] == ["table.csv"]
    assert path.read_text() == "old"
