"""One table, written by each format's own library, comes in the same from all of them."""

import json
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import h5py
import numpy as np
import openpyxl
import pandas as pd
import pytest
import scipy.io

from pipeline.config_importing import ReadingConfig
from pipeline.errors import LoopgapError, UsageError
from pipeline.foreign.delimited import read_delimited
from tests.foreign.mapped import import_from, mapping

COUNT = 60
TABLE = pd.DataFrame(
    {
        "t": 1.7e9 + np.arange(COUNT) * 0.05,
        "cmd": 30.0 * np.sin(np.arange(COUNT) / 4.0),
        "ang": 0.4 * np.sin(np.arange(COUNT) / 4.0 - 0.3),
    }
)
TABLE.loc[7, "ang"] = np.nan


def xlsx(path: Path, table: pd.DataFrame = TABLE) -> None:
    book = openpyxl.Workbook()
    book.active.append(list(table.columns))
    for row in table.astype(object).where(table.notna(), None).itertuples(index=False):
        book.active.append(list(row))
    book.save(path)


def mat73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        for name in TABLE:
            item = file.create_dataset(f"log/{name}", data=TABLE[name].to_numpy()[None, :])
            item.attrs["MATLAB_class"] = np.bytes_("double")
        file["log/note"] = np.frombuffer("sunny".encode("utf-16-le"), np.uint16)[None, :]
        file["log/note"].attrs["MATLAB_class"] = np.bytes_("char")


def npz(path: Path) -> None:
    np.savez(path, t=TABLE["t"], both=TABLE[["cmd", "ang"]].to_numpy(), other=np.zeros((2, 3, 4)))


def npy_folder(path: Path) -> None:
    path.mkdir()
    np.save(path / "t.npy", TABLE["t"])
    np.save(path / "both.npy", TABLE[["cmd", "ang"]].to_numpy())


def records(table: pd.DataFrame = TABLE) -> list[dict[str, object]]:
    return [
        {"t": r.t, "q": {"cmd": r.cmd, "ang": [None if np.isnan(r.ang) else r.ang, 0]}}
        for r in table.itertuples()
    ]


def nested_parquet(path: Path) -> None:
    lists = [list(row) for row in TABLE[["cmd", "ang"]].to_numpy()]
    frame = pd.DataFrame({"t": TABLE["t"], "both": lists, "s": [{"x": x} for x in TABLE["cmd"]]})
    frame.to_parquet(path)


def european(path: Path) -> None:
    text = TABLE.to_csv(sep=";", decimal=",", index=False).replace("\n", "\r\n")
    path.write_bytes(("Messung 3, Größe 2\r\n\r\n" + text).encode("latin-1"))


def remarks_and_units(path: Path) -> None:
    lines = TABLE.to_csv(sep="\t", index=False).splitlines()
    text = "\n".join(["# a robot", lines[0], "s\tdeg\trad", *lines[1:30], "# pause", *lines[30:]])
    path.write_bytes("\ufeff".encode() + text.encode())


def no_header(path: Path) -> None:
    path.write_text(TABLE.to_csv(index=False, header=False, na_rep="nan"))


def spaces(path: Path) -> None:
    np.savetxt(path, TABLE.to_numpy(), header="t cmd ang", fmt="%24.17g")


WRITERS: list[tuple[str, Callable[[Path], object], dict[str, str], dict[str, object]]] = [
    ("a.csv", lambda path: TABLE.to_csv(path, index=False), {}, {}),
    ("utf16.txt", lambda path: TABLE.to_csv(path, sep="|", index=False, encoding="utf-16"), {}, {}),
    ("european.csv", european, {},
     {"decimal": ",", "skip_rows": 1, "encoding": "latin-1"}),
    ("remarks.tsv", remarks_and_units, {}, {"comment": "#", "skip_after_header": 1}),
    ("no_header.csv", no_header, {"t": "0", "cmd": "1", "ang": "2"}, {}),
    ("spaces.dat", spaces, {"t": "0", "cmd": "1", "ang": "2"}, {"comment": "#"}),
    ("a.xlsx", xlsx, {}, {}),
    ("v5.mat", lambda path: scipy.io.savemat(path, {"log": dict(TABLE.items()), "note": "sunny"}),
     {"t": "log.t", "cmd": "log.cmd", "ang": "log.ang"}, {}),
    ("v73.mat", mat73, {}, {"root": "log"}),
    ("both.npy", lambda path: np.save(path, TABLE.to_numpy()),
     {"t": "0", "cmd": "1", "ang": "2"}, {}),
    ("both.npz", npz, {"cmd": "both.0", "ang": "both.1"}, {}),
    ("folder", npy_folder, {"cmd": "both.0", "ang": "both.1"}, {}),
    ("a.parquet", TABLE.to_parquet, {}, {}),
    ("nested.parquet", nested_parquet, {"cmd": "s.x", "ang": "both.1"}, {}),
    ("records.json", lambda path: path.write_text(json.dumps({"run": {"log": records()}})),
     {"cmd": "q.cmd", "ang": "q.ang.0"}, {"root": "run.log"}),
    ("columns.json", lambda path: path.write_text(json.dumps(TABLE.to_dict("list"))), {}, {}),
    ("lines.jsonl",
     lambda path: path.write_text("\n\n".join(json.dumps(record) for record in records())),
     {"cmd": "q.cmd", "ang": "q.ang.0"}, {}),
]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "write", "columns", "reading"), WRITERS, ids=[w[0] for w in WRITERS]
)
def test_every_format_gives_the_same_recording(name, write, columns, reading, tmp_path):
    path = tmp_path / name
    write(path)
    config = mapping(reading=reading)
    table = config.tables["samples"]
    table.time.column = columns.get("t", "t")
    for channel, short in (("command_deg", "cmd"), ("angle_deg", "ang")):
        table.channels[channel].column = columns.get(short, short)
    imported = import_from(path, config)
    recording = imported.recording
    assert np.allclose(recording.values("time_s"), np.arange(COUNT) * 0.05, atol=1e-6)
    assert np.allclose(recording.values("command_deg"), TABLE["cmd"], rtol=1e-14, atol=1e-14)
    expected = np.degrees(TABLE["ang"])
    assert np.allclose(
        recording.values("angle_deg"), expected, rtol=1e-12, atol=1e-12, equal_nan=True
    )
    assert imported.account.empty == {"angle_deg": 1}


def broken_npy(path: Path) -> None:
    np.save(path, TABLE.to_numpy())
    path.write_bytes(path.read_bytes()[:-100])


def halved(write: Callable[[Path], object]) -> Callable[[Path], object]:
    def half(path: Path) -> None:
        write(path)
        data = path.read_bytes()
        path.write_bytes(data[: len(data) // 2 - 3])

    return half


def text_in_a_column(path: Path) -> None:
    lines = TABLE.to_csv(index=False).splitlines()
    lines[4] = lines[4].replace(f"{TABLE['cmd'][3]}", "stuck")
    path.write_text("\n".join(["# run 3", *lines]))


def objects(path: Path) -> None:
    np.save(path, np.array([{"t": 1.0}], dtype=object), allow_pickle=True)


def uncalculated(path: Path) -> None:
    book = openpyxl.Workbook()
    for row in (["t", "cmd", "ang"], [0.0, 1.0, "=B2/57.3"]):
        book.active.append(row)
    book.save(path)


def two_sheets(path: Path) -> None:
    book = openpyxl.Workbook()
    book.active.title = "notes"
    book.create_sheet("log")
    book.save(path)


def workbook(*rows: list[object]) -> Callable[[Path], object]:
    def write(path: Path) -> None:
        book = openpyxl.Workbook()
        for row in rows:
            book.active.append(row)
        book.save(path)

    return write


BAD: list[tuple[str, Callable[[Path], object], str]] = [
    ("empty.csv", lambda path: path.write_text(""), "expected samples; found an empty file"),
    ("blank.csv", lambda path: path.write_text("\n\n \n"), "nothing in the file but blank"),
    ("head.csv", lambda path: path.write_text("t,cmd,ang\n"), "found a header alone"),
    ("cut.csv", halved(lambda path: TABLE.to_csv(path, index=False)),
     r"line \d+: expected 3 cells; found 1. The file ends within a row"),
    ("text.csv", text_in_a_column,
     r"line 6, column 'cmd': expected a number; found 'stuck'"),
    ("latin.csv", lambda path: path.write_bytes("t,cmd,ang\n0,1,2\n# Größe\n".encode("latin-1")),
     "expected text in UTF-8.*reading.encoding: latin-1"),
    ("comma.csv", lambda path: path.write_text("t;cmd;ang\n0;0,5;1\n1;0,7;1\n"),
     "found '0,5'. If that is a decimal comma"),
    ("twice.csv", lambda path: path.write_text("t,cmd,cmd,ang\n0,1,1,2\n"),
     "expected one column 'cmd'; found several of that name. Give its index"),
    ("other.csv", lambda path: path.write_text("t,Cmd,ang\n0,1,2\n"),
     r"expected a column 'cmd'; found columns t, Cmd, ang. Did you mean 'Cmd'\?"),
    ("long.csv", lambda path: path.write_text(f't,cmd,ang\n0,1,"{"x" * 200_000}"\n'),
     "expected a table of text; found field larger"),
    ("cut.npy", broken_npy, "expected a whole NumPy file"),
    ("objects.npy", objects, r"expected an array of numbers; found Python objects \(a pickle\)"),
    ("no.npy", lambda path: path.write_text("t,cmd"), "expected a whole NumPy file"),
    ("cut.npz", halved(npz), "expected a whole NumPy file"),
    ("cut.mat", halved(lambda path: scipy.io.savemat(path, dict(TABLE.items()))),
     "expected a whole MATLAB file"),
    ("cut73.mat", halved(mat73), "expected a whole MATLAB file"),
    ("cut.xlsx", halved(xlsx), "expected a whole xlsx workbook"),
    ("formula.xlsx", uncalculated, r"row 2: expected calculated values; found the formula =B2"),
    ("dates.xlsx", workbook(["t", "cmd", "ang"], [datetime(2026, 5, 1, 12), 1.0, 2.0]),
     "row 2, column 't': expected a number; found the date or time 2026-05-01 12:00:00. Take"),
    ("title.xlsx", workbook(["Run 3"], ["t", "cmd", "ang"], [0.0, 1.0, 2.0]),
     r"found columns Run 3, 1, 2. .*Names were taken from row 1 \(`reading.skip_rows`\)"),
    ("parted.csv", lambda path: path.write_text("t, cmd; ang\n0, 1; 2\n1, 2; 3\n"),
     r"Cells were parted at ';' \(`reading.separator`\)"),
    ("structs.mat", lambda path: scipy.io.savemat(path, {"log": [{"t": 0.0}, {"t": 1.0}]}),
     "found columns none; log is "),
    ("sheets.xlsx", two_sheets, "name of a sheet.*Choose one of notes, log"),
    ("cut.parquet", halved(TABLE.to_parquet), "expected a whole Parquet file"),
    ("cut.json", lambda path: path.write_text(json.dumps(records())[:400]), "expected JSON"),
    ("deep.json", lambda path: path.write_text("[" * 100_000), "expected JSON"),
    ("number.json", lambda path: path.write_text("3"), "list of records or a mapping of columns"),
    ("cut.jsonl", lambda path: path.write_text('{"t": 1}\n{"t": '), "line 2: expected JSON"),
    ("nested.json", lambda path: path.write_text('{"run": {"cmd": [0, 1]}}'),
     "expected a column 'cmd'; found columns run.cmd. Did you mean 'run.cmd'"),
    ("a.docx", lambda path: path.write_text("x"), r"expected one of .csv, .tsv.*found .docx"),
    ("cut.bag", lambda path: path.write_bytes(b"#ROSBAG V2.0\n1234"), "expected a whole bag"),
    ("not.mcap", lambda path: path.write_text("x" * 200), "expected a whole bag"),
    ("not.db3", lambda path: path.write_text("x" * 2000), "expected a whole bag"),
    ("empty_folder", lambda path: path.mkdir(), "found no npy files"),
]  # fmt: skip


def test_a_word_among_decimal_commas_is_what_the_message_shows(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("t;cmd;ang\n0;0,5;1\n1;0,7;2\n2;stuck;3\n")
    table = read_delimited(path, ReadingConfig(decimal=","))
    with pytest.raises(
        LoopgapError, match="line 4, column 'cmd': expected a number; found 'stuck'"
    ):
        table.numbers("cmd")
    assert table.numbers("ang").tolist() == [1, 2, 3]


@pytest.mark.parametrize(("name", "write", "words"), BAD, ids=[b[0] for b in BAD])
def test_a_file_that_cannot_be_used_says_why_and_what_to_do(name, write, words, tmp_path):
    path = tmp_path / name
    write(path)
    with pytest.raises(LoopgapError, match=words):
        import_from(path, mapping(reading={"comment": "#"} if name == "text.csv" else {}))


@pytest.mark.parametrize(("name", "write"), [w[:2] for w in WRITERS], ids=[w[0] for w in WRITERS])
def test_a_damaged_file_is_read_or_refused_but_never_a_crash(name, write, tmp_path):
    path = tmp_path / name
    write(path)
    file = path if path.is_file() else path / "both.npy"
    whole = file.read_bytes()
    random = np.random.default_rng(len(whole))
    for damaged in range(4):
        data = np.frombuffer(whole, np.uint8).copy()
        data[random.integers(0, len(data), 20)] = random.integers(0, 256, 20)
        file.write_bytes(data[: random.integers(1, len(data))] if damaged == 0 else data)
        try:
            ends = np.all(np.diff(import_from(path, mapping()).recording.values("time_s")) >= 0.0)
        except LoopgapError as refused:
            ends = "found" in str(refused)
        assert ends


def test_a_variable_that_is_no_column_says_what_it_is(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", {"t": np.arange(4.0), "cmd": np.zeros((2, 3, 4))})
    with pytest.raises(UsageError, match=r"'cmd'.*found an array of shape \(2, 3, 4\)"):
        import_from(tmp_path / "a.mat", mapping())


def test_a_separator_is_one_character(tmp_path):
    TABLE.to_csv(tmp_path / "a.csv", index=False)
    with pytest.raises(UsageError, match="reading.separator: expected one character; found ';;'"):
        import_from(tmp_path / "a.csv", mapping(reading={"separator": ";;"}))


def test_text_cells_of_a_workbook_may_have_a_decimal_comma(tmp_path):
    workbook(["t", "cmd", "ang"], ["0,0", "1,5", 2.0], ["0,5", 1.0, 2.0])(tmp_path / "a.xlsx")
    recording = import_from(tmp_path / "a.xlsx", mapping(reading={"decimal": ","})).recording
    assert recording.values("time_s").tolist() == [0.0, 0.5]
    assert recording.values("command_deg").tolist() == [1.5, 1.0]


def test_which_file_a_pattern_means(tmp_path):
    for name in ("run_1.csv", "run_2.csv"):
        TABLE.to_csv(tmp_path / name, index=False)
    assert import_from(tmp_path, mapping(file="*_2.csv")).account.rows == COUNT
    beside = import_from(tmp_path / "run_1.csv", mapping(file="*_2.csv"))
    assert beside.account.tables["samples"].where.endswith("run_2.csv")
    with pytest.raises(UsageError, match=r"one file 'run_\*.csv'.*found run_1.csv, run_2.csv"):
        import_from(tmp_path, mapping(file="run_*.csv"))
    with pytest.raises(UsageError, match=r"found none; there are imported, run_1.csv"):
        import_from(tmp_path / "run_1.csv", mapping(file="walk.csv"))
    with pytest.raises(UsageError, match="expected a file or folder to import; found nothing"):
        import_from(tmp_path / "nowhere", mapping())
