"""Files of commands: what is taken, and each refusal with its words."""

from pathlib import Path

import pytest

from pipeline.commands import read_commands
from pipeline.errors import UsageError

AXES = ("yaw", "pitch")


def written(folder: Path, text: str) -> Path:
    file = folder / "commands.csv"
    file.write_text(text)
    return file


def test_absent_axis_stands_at_zero_and_cycles_come_from_reversals(tmp_path: Path) -> None:
    values = [0, 10, 20, 10, 0, -10, -20, -10, 0, 10, 20, 10, 0]
    rows = "".join(f"{2 * i},{value}\n" for i, value in enumerate(values))
    commands = read_commands(written(tmp_path, "time_s, pitch_command_deg\n" + rows), AXES)
    assert commands["pitch_command_deg"].tolist() == values
    assert commands["yaw_command_deg"].tolist() == [0.0] * 13
    assert commands["cycle"].tolist() == [0] * 8 + [1] * 5
    assert commands["step"].tolist() == [*range(8), *range(5)]


def test_cycles_of_the_file_are_kept(tmp_path: Path) -> None:
    text = "time_s,cycle,step,yaw_command_deg\n0,3,7,1\n1,3,8,2\n"
    commands = read_commands(written(tmp_path, text), AXES)
    assert commands[["cycle", "step"]].to_numpy().tolist() == [[3, 7], [3, 8]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "a CSV file of commands; found No columns"),
        ("time_s,yaw_command_deg\n", "at least one row; found none"),
        ("t,yaw_command_deg\n0,1\n", "a column 'time_s'; found columns t, yaw_command_deg"),
        ("time_s,cycle\n0,1\n", "a column of yaw_command_deg, pitch_command_deg; found columns"),
        ("time_s,yaw_command_deg,roll_command_deg\n0,1,2\n", "found column 'roll_command_deg'"),
        ("time_s,yaw_command_deg\n0,1\n1,far\n", "row 3, column 'yaw_command_deg'.*found 'far'"),
        ("time_s,yaw_command_deg\n0,1\n1,\n", "row 3, column 'yaw_command_deg'.*found nothing"),
        ("time_s,yaw_command_deg\n0,1\n1,inf\n", "row 3, .*expected a number; found 'inf'"),
        ("time_s,yaw_command_deg\n0,1\n0,2\n", "row 3, column 'time_s': expected a time after 0"),
        ("time_s,yaw_command_deg\n5,1\n3,2\n", "a time after 5 s; found 3 s"),
        ("time_s,cycle,yaw_command_deg\n0,0.5,1\n", "column 'cycle': expected a whole number"),
    ],
)
def test_refusals(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        read_commands(written(tmp_path, text), AXES)


def test_absent_file(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"acquisition\.commands=.*nothing\.csv: .*No such file"):
        read_commands(tmp_path / "nothing.csv", AXES)
