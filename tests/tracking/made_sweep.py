"""A sweep's folder as jobs leave it, with errors of known size."""

import json
from pathlib import Path

import pandas as pd

COLUMNS = ["axis", "method", "cycle", "metric", "value", "unit", "n"]


def add_job(
    sweep: Path,
    name: str,
    overrides: dict[str, object],
    status: str = "done",
    rmse: float = 0.5,
    commit: str = "abc",
) -> Path:
    """A job whose nominal error is three times `rmse`; a failed one found no port."""
    folder = sweep / name
    folder.mkdir(parents=True)
    error = None if status == "done" else "LoopgapError: no such port"
    told = {key: str(value) for key, value in overrides.items()}
    (folder / "job.json").write_text(
        json.dumps({"overrides": told, "status": status, "error": error})
    )
    (folder / "config.yaml").write_text(f"seed: 0\ncache: {{folder: {sweep}}}\ntold: {told}\n")
    outputs = {"vision/yaw/samples.csv": f"hash of seed {overrides.get('seed', 0)}",
               "evaluation/metrics.csv": "hash"}  # fmt: skip
    (folder / "provenance.json").write_text(json.dumps({
        "code": {"commit": commit, "uncommitted": None, "source": "s"},
        "stages": [{"stage": "vision", "inputs": {}, "outputs": outputs}],
    }))  # fmt: skip
    if status == "done":
        (folder / "evaluation").mkdir()
        rows = [
            ("pitch", "nominal", None, "model_rmse", 3 * rmse, "deg", 600),
            ("pitch", "compensated", None, "model_rmse", rmse, "deg", 600),
            ("pitch", "compensated", 6, "model_rmse", 2 * rmse, "deg", 200),
            ("pitch", "compensated", None, "targets_converged", 100, "targets", 100),
        ]
        metrics = pd.DataFrame(rows, columns=COLUMNS).astype({"cycle": "Int64"})
        metrics.to_csv(folder / "evaluation" / "metrics.csv", index=False)
    return folder


def plan(sweep: Path, *task: str, **params: str) -> None:
    """What Hydra leaves of a multirun with these overrides, and this sweep of its experiment."""
    lines = [
        "hydra:",
        "  sweeper:",
        f"    params: {json.dumps({k.replace('__', '.'): v for k, v in params.items()})}",
        "  overrides:",
        f"    task: {json.dumps(list(task))}",
        "  runtime:",
        "    choices: {experiment: null, twin: paper}",
    ]
    sweep.mkdir(parents=True, exist_ok=True)
    (sweep / "multirun.yaml").write_text("\n".join(lines))
