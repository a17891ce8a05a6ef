"""Write the cases of a benchmark: recordings and commitments for all, truths kept apart."""

import json
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from pipeline.atomically import write_atomically
from pipeline.concealed.cases import realise, recordings_of
from pipeline.concealed.draw import Case
from pipeline.concealed.seal import seal
from pipeline.concealed.truth import truth_of
from pipeline.recording import save_recording


def generate(folder: Path, truth_folder: Path, cases: Sequence[Case]) -> None:
    """Write `CASE/`, `CASE.later/`, `declared.csv` and `commitments.json` to `folder`.

    `declared.csv` is what a user would know: the tolerance of the simulated curve. The envelopes
    go to `truth_folder`, one JSON file each.
    """
    truth_folder.mkdir(parents=True, exist_ok=True)
    commitments: dict[str, str] = {}
    declared = []
    for case in cases:
        realised = realise(case)
        first, later = recordings_of(case, realised)
        save_recording(first, folder / case.name)
        save_recording(later, folder / f"{case.name}.later")
        envelope, commitments[case.name] = seal(truth_of(case, realised))
        write_atomically(truth_folder / f"{case.name}.json", json.dumps(envelope))
        declared.append({"case": case.name, "tolerance_shape_deg": case.tolerance_shape_deg})
    table = pd.DataFrame(declared, columns=["case", "tolerance_shape_deg"])
    write_atomically(folder / "declared.csv", table.to_csv(index=False))
    write_atomically(folder / "commitments.json", json.dumps(commitments, indent=1))
