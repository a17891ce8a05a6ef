"""Time, resampling, filling and cutting on import, and mappings that can't be right."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from pipeline.errors import LoopgapError, UsageError
from tests.foreign.mapped import import_from, mapping

TWO_TABLES = """
tables:
  samples:
    file: samples.csv
    time: {column: t, unit: ms}
    channels:
      command_deg: {column: cmd, role: command, unit: deg}
      angle_deg: {column: ang, role: measurement, unit: deg}
  model:
    file: model.csv
    time: {rate_hz: 10, start_s: 0.1}
    resample: linear
    channels:
      angle_sim_deg: {column: y, role: simulation, of: angle_deg, unit: deg, sign: -1, offset: 1}
"""


def written(folder: Path, **columns: object) -> Path:
    count = 12
    table = {"t": 5000 + 50 * np.arange(count), "cmd": np.arange(count), "ang": np.arange(count)}
    pd.DataFrame(table | columns).to_csv(folder / "samples.csv", index=False)
    pd.DataFrame({"y": [0.0, -10.0, 10.0, 30.0]}).to_csv(folder / "model.csv", index=False)
    return folder


def one_table(**samples: object):
    config = mapping(TWO_TABLES, **samples)
    del config.tables["model"]
    return config


def test_time_starts_with_the_first_table_and_the_simulation_is_brought_to_it(tmp_path):
    imported = import_from(written(tmp_path), mapping(TWO_TABLES))
    recording = imported.recording
    assert recording.values("time_s").tolist() == [i / 20 for i in range(12)]
    simulated = recording.values("angle_sim_deg")
    expected = [1.0, 6.0, 11.0, 1.0, -9.0, -19.0, -29.0]
    assert np.isnan(simulated[[0, 1, 9, 10, 11]]).all()
    assert np.allclose(simulated[2:9], expected, atol=1e-12)
    account = imported.account.tables["model"]
    assert (account.rows_outside, account.resampled) == (5, "linear")
    assert account.largest_gap_s == pytest.approx(0.1)
    assert imported.account.empty == {"angle_sim_deg": 5}


@pytest.mark.parametrize(
    ("rule", "expected"),
    [("previous", [1, 1, 11, 11, -9, -9, -29]), ("nearest", [1, 11, 11, -9, -9, -29])],
)
def test_rules_that_take_a_sample_as_it_is(rule, expected, tmp_path):
    config = mapping(TWO_TABLES)
    config.tables["model"].resample = rule
    if rule == "nearest":
        config.tables["model"].time.start_s = 0.09  # ends at 0.39 s
    simulated = import_from(written(tmp_path), config).recording.values("angle_sim_deg")
    assert simulated[2 : 2 + len(expected)].tolist() == expected


def test_a_large_epoch_keeps_its_digits(tmp_path):
    stamps = 1_700_000_000_123_456_789 + 50_000_001 * np.arange(12)
    config = one_table(time={"unit": "ns"})
    times = import_from(written(tmp_path, t=stamps), config).recording.values("time_s")
    assert np.array_equal(np.rint(times * 1e9), 50_000_001 * np.arange(12))


def test_time_as_dates(tmp_path):
    dates = [f"2026-05-01T12:00:{i:02d}.25+02:00" for i in range(12)]
    config = one_table(time={"unit": "date"})
    recording = import_from(written(tmp_path, t=dates), config).recording
    assert recording.values("time_s").tolist() == list(range(12))
    dates[3] = "noon"
    with pytest.raises(LoopgapError, match=r"line 5, column 't': expected a date.*found 'noon'"):
        import_from(written(tmp_path, t=dates), config)


def test_time_that_goes_back_is_refused_and_dropped_or_sorted_only_when_asked(tmp_path):
    times = [0, 10, 20, 15, 20, 30, 40, 50, 60, 70, 80, 90]
    folder = written(tmp_path, t=times)
    with pytest.raises(
        LoopgapError,
        match=r"line 5, column 't': expected a time after 0.020000 s; found 0.015000 s "
        r"\(1 such rows\).*importing.tables.samples.on_time_going_back=drop",
    ):
        import_from(folder, one_table())
    dropped = import_from(folder, one_table(on_time_going_back="drop"))
    assert dropped.recording.values("command_deg").tolist() == [0, 1, 2, *range(5, 12)]
    assert dropped.account.tables["samples"].rows_left_out == 2
    sorted_ = import_from(folder, one_table(on_time_going_back="sort"))
    assert sorted_.recording.values("command_deg").tolist() == [0, 1, 3, 2, *range(5, 12)]
    assert sorted_.account.tables["samples"].rows_moved == 2
    assert sorted_.account.tables["samples"].rows_left_out == 1


def test_gaps_and_uneven_steps_stay_as_they_are(tmp_path):
    times = [0, 50, 100, 900, 950, 1000, 1050, 1101, 1150, 1200, 1250, 1300]
    imported = import_from(written(tmp_path, t=times), one_table())
    assert np.allclose(imported.recording.values("time_s") * 1000, times)
    assert imported.account.largest_step_s == pytest.approx(0.8)


def test_empty_measurements_stay_and_empty_commands_are_filled_only_when_asked(tmp_path):
    command = [np.nan, 1.0, np.nan, np.nan, 4.0, *range(5, 11), np.nan]
    angle = [0.0, np.nan, *range(2, 12)]
    folder = written(tmp_path, cmd=command, ang=angle)
    with pytest.raises(LoopgapError, match=r"command_deg, at 0 s \(row 0.*nothing in 4 rows. Fill"):
        import_from(folder, one_table())
    config = one_table(channels={"command_deg": {"fill": "previous"}})
    with pytest.raises(LoopgapError, match=r"at 0 s \(row 0 .*nothing in 1 rows"):
        import_from(folder, config)
    config.rows.start_s = 0.04
    held = import_from(folder, config)
    assert held.recording.values("command_deg").tolist() == [1, 1, 1, 4, *range(5, 11), 10]
    assert held.account.filled == {"command_deg": 3}
    assert held.account.empty == {"angle_deg": 1}
    config.tables["samples"].channels["command_deg"].fill = "linear"
    config.rows.end_s = 0.55
    joined = import_from(folder, config).recording.values("command_deg")
    assert np.allclose(joined, [1, 2, 3, 4, *range(5, 11)])


def test_rows_are_cut_and_thinned(tmp_path):
    config = one_table()
    config.rows.start_s, config.rows.end_s, config.rows.every = 0.1, 0.5, 3
    imported = import_from(written(tmp_path), config)
    assert imported.recording.values("command_deg").tolist() == [2, 5, 8]
    assert imported.recording.values("time_s").tolist() == [0.1, 0.25, 0.4]
    assert imported.account.rows_cut == 9
    config.rows.start_s = 7
    with pytest.raises(UsageError, match="expected rows between 0 and 0.55 s; found none from 7"):
        import_from(tmp_path, config)


def test_cycle_and_step_are_taken_where_the_file_has_them(tmp_path):
    config = one_table(channels={"cycle": {"column": "round", "role": "context"}})
    imported = import_from(written(tmp_path, round=[0] * 4 + [1] * 8), config)
    assert imported.recording.samples["cycle"].tolist() == [0] * 4 + [1] * 8
    assert imported.recording.samples["step"].tolist() == [*range(4), *range(8)]
    assert [c.name for c in imported.recording.channels] == ["command_deg", "angle_deg"]


ANGLE = {"role": "measurement", "unit": "deg"}
WRONG: list[tuple[dict[str, object], str]] = [
    ({"time": {"column": None}}, "where the time comes from; found neither.*rate_hz"),
    ({"time": {"rate_hz": 10}}, "either `column` or a `rate_hz` above 0"),
    ({"time": {"unit": "fortnight"}}, "expected a unit of time, s, ms.*found 'fortnight'"),
    ({"time": {"column": "tt"}}, r"expected a column 'tt'; found columns t, cmd, ang. Did you"),
    ({"resample": "linear"}, "expected nothing: the first table sets the times"),
    ({"on_time_going_back": "keep"}, "expected one of drop, sort; found 'keep'"),
    ({"channels": {"x": {"role": "guess"}}}, "role: expected one of command.*found 'guess'"),
    ({"channels": {"x": {"role": "command"}}}, "channels.x.unit: expected a unit; found none"),
    ({"channels": {"x": ANGLE | {"role": "context"}}}, "the role 'context' for `cycle` and"),
    ({"channels": {"time_s": ANGLE}}, "Time has its own key"),
    ({"channels": {"x": ANGLE | {"sign": 2}}}, "sign: expected 1 or -1; found 2"),
    ({"channels": {"x": ANGLE | {"fill": "linear"}}}, "'linear' for a measurement. Only commands"),
    ({"channels": {"x": ANGLE | {"from_unit": "mm"}}}, "channels.x: expected a unit that converts"),
    ({"channels": {"x_rad": ANGLE}}, "expected the unit of its name, 'rad'; found 'deg'"),
    ({"channels": {"x": ANGLE | {"role": "simulation", "of": "y"}}}, "`of` to name a measurement"),
]


@pytest.mark.parametrize(("settings", "words"), WRONG)
def test_a_mapping_that_cannot_be_right(settings, words, tmp_path):
    with pytest.raises(LoopgapError, match=words):
        import_from(written(tmp_path), one_table(**settings))


def test_tables_after_the_first_say_how_they_are_resampled_and_overlap(tmp_path):
    config = mapping(TWO_TABLES)
    config.tables["model"].resample = None
    with pytest.raises(UsageError, match="model.resample: expected one of linear, previous, near"):
        import_from(written(tmp_path), config)
    config.tables["model"].resample = "linear"
    config.tables["model"].time.start_s = 100.0
    with pytest.raises(UsageError, match="expected samples between 0 and 0.55 s.*found 100 to"):
        import_from(tmp_path, config)
    with pytest.raises(UsageError, match="a table with `channels`; found none"):
        import_from(tmp_path, mapping("tables: {}"))


def test_infinite_numbers_are_refused(tmp_path):
    angle = [0.0, np.inf, *range(2, 12)]
    with pytest.raises(LoopgapError, match=r"line 3, column 'ang'.*a finite number; found inf"):
        import_from(written(tmp_path, ang=angle), one_table())


def test_rows_long_after_a_tables_end_are_outside_without_a_warning(tmp_path, recwarn):
    config = mapping(TWO_TABLES)
    times_ms = 5000 + 100 * np.arange(12) ** 2
    imported = import_from(written(tmp_path, t=times_ms), config)
    assert imported.account.tables["model"].rows_outside == 10
    assert not recwarn.list
