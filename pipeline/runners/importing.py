"""Importing of a run: somebody's files to the recording that the other stages take."""

import json
from pathlib import Path

from pipeline.errors import UsageError, refusal
from pipeline.foreign.read import read_table
from pipeline.recording import load_recording, save_recording, write_atomically
from pipeline.runners.run_folder import IMPORTED, Run
from pipeline.stages.importing import Account, assemble, check_mapping


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
    tables = {name: read_table(path, name, table) for name, table in config.tables.items()}
    imported = assemble(config, tables)
    folder = run.folder / IMPORTED
    save_recording(imported.recording, folder)
    load_recording(folder)
    write_atomically(folder / "importing.json", json.dumps(imported.account.as_json(), indent=1))
    _say(imported.account)
    print(f"  recording: {folder}")


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
