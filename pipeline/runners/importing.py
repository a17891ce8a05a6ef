"""Importing of a run: somebody's files to the recording that the other stages take."""

import json
from pathlib import Path

import numpy as np

from pipeline.atomically import write_atomically
from pipeline.errors import UsageError, refusal
from pipeline.foreign.mapping import check_mapping
from pipeline.foreign.read import read_table
from pipeline.foreign.table import ForeignTable
from pipeline.recording import load_recording, save_recording
from pipeline.runners.run_folder import IMPORTED, Run, made
from pipeline.stages.importing import Account, assemble
from pipeline.vision.frames import FrameFolder


def run_importing(run: Run) -> None:
    """Import `importing.path` by the mapping into OUT/recording; importing.json is its account."""
    config = run.config.importing
    check_mapping(config)
    if config.path is None:
        raise UsageError(
            refusal("importing.path", "the file or folder to import", "nothing",
                    "Give importing.path=FILE_OR_FOLDER.")
        )  # fmt: skip
    path = Path(config.path)
    folder = run.folder / IMPORTED
    tables = {name: read_table(path, name, table) for name, table in config.tables.items()}
    imported = assemble(config, tables)
    lost = {
        camera: _write_frames(folder, camera, tables[name], imported.frames[name])
        for name, camera in ((n, t.frames) for n, t in config.tables.items() if t.frames)
    }
    save_recording(imported.recording, folder)
    load_recording(folder)
    account = imported.account.as_json() | {"rows_without_frame": lost}
    write_atomically(folder / "importing.json", json.dumps(account, indent=1))
    _say(imported.account)
    for camera, count in lost.items():
        print(f"    frames of {camera}: {imported.account.rows - count}, {count} rows without")
    print(f"  recording: {folder}")


def _write_frames(folder: Path, camera: str, table: ForeignTable, wanted: np.ndarray) -> int:
    """Write the image of each row as `frames/<camera>_<row>.jpg`; how many rows have none."""
    if table.frames is None:
        raise UsageError(
            refusal(table.where, f"images for the frames of {camera!r}", "no images",
                    "Name a topic of images in `reading.topic`, or take `frames` out.")
        )  # fmt: skip
    rows_of: dict[int, list[int]] = {}
    for row, image in enumerate(wanted):
        rows_of.setdefault(int(image), []).append(row)
    made(folder / "frames")
    frames = FrameFolder(folder, camera)
    for image, data in enumerate(table.frames()):
        for row in rows_of.get(image, []):
            write_atomically(frames.path(row), data)
    return len(rows_of.get(-1, []))


def _say(account: Account) -> None:
    for table in account.tables.values():
        print(f"  {table.where}: {table.rows_read} rows")
        if table.rows_left_out or table.rows_moved:
            print(f"    time went back: {table.rows_left_out} rows left out, "
                  f"{table.rows_moved} moved")  # fmt: skip
        if table.resampled:
            print(
                f"    resampled ({table.resampled}) to the first table's times: largest gap "
                f"{table.largest_gap_s:.4g} s, {table.rows_outside} rows outside left empty"
            )
        if table.columns_left_out:
            print(f"    columns not taken: {_few(table.columns_left_out)}")
    print(
        f"  {account.rows} samples over {account.duration_s:.6g} s, {account.rows_cut} cut; step "
        f"{account.median_step_s:.4g} s (median), at most {account.largest_step_s:.4g} s"
    )
    for name, count in account.filled.items():
        print(f"    {name}: {count} empty samples filled")
    for name, count in account.empty.items():
        print(f"    {name}: {count} samples empty")


def _few(names: list[str]) -> str:
    more = f" and {len(names) - 12} more" if len(names) > 12 else ""
    return ", ".join(names[:12]) + more
