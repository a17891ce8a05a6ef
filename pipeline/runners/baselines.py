"""Baselines of a run: the table that stands beside a diagnosis."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from pipeline.errors import UsageError, refusal
from pipeline.recording import load_recording
from pipeline.runners.run_folder import Run
from pipeline.runners.simulation import with_simulation
from pipeline.stages.baselines import compare
from pipeline.tracking.tables import plain, write_table

DIAGNOSIS = "diagnosis"


def run_baselines(run: Run) -> None:
    """Fit the baselines to the recording; the diagnosis's own errors stand beside them."""
    folder = run.given_recording()
    if folder is None:
        raise UsageError(
            refusal("configuration", "recording=DIR, or the stage 'importing' before", "neither",
                    "Name the recording whose measurements the baselines are to answer.")
        )  # fmt: skip
    recording = with_simulation(run.config, load_recording(folder))
    with threadpool_limits(1):
        table = compare(run.config.diagnosis, recording)
    file = run.left("diagnosis.json", DIAGNOSIS)
    if file is not None:
        own = [
            diagnosed(file.parent, entry) for entry in json.loads(file.read_text())["measurements"]
        ]
        table = pd.concat([pd.DataFrame(own), table], ignore_index=True)
        order = {c.name: k for k, c in enumerate(recording.with_role("measurement"))}
        table = table.sort_values("measurement", key=lambda m: m.map(order), kind="stable")
    write_table(table, run.folder, "baselines")
    print(f"\nBeside models that know no mechanism:\n{plain(table)}")


def diagnosed(folder: Path, entry: dict[str, object]) -> dict[str, object]:
    """A diagnosis's own row: its errors on all measured rows, outliers among them."""
    rows = pd.read_csv(folder / DIAGNOSIS / f"{entry['measurement']}.csv")
    rows = rows[rows["measured"].notna() & rows["before"].notna()]
    square, heldout = (rows["measured"] - rows["after"]) ** 2, rows["heldout"] == 1
    names = [str(physics["name"]) for physics in entry["physics"]]  # type: ignore[attr-defined]
    return {
        "measurement": entry["measurement"],
        "model": f"diagnosis: {' + '.join(names) or 'calibration alone'}",
        "train RMSE": float(np.sqrt(square[~heldout].mean())),
        "held-out RMSE": float(np.sqrt(square[heldout].mean())),
        "unit": entry["unit"],
    }
