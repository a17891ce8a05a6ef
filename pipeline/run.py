"""One run: its stages in their order."""

from collections.abc import Iterator
from pathlib import Path

from pipeline.config import Config
from pipeline.errors import UsageError, refusal
from pipeline.runners.run_folder import Run
from pipeline.runners.stage_run import FOLDER_IN_TEXT, Workplace, do_stage
from pipeline.tracking.stage_record import FROM_BEFORE, RAN, StageRecord


def run_stages(config: Config, folder: Path, place: Workplace) -> Iterator[StageRecord]:
    """Bring about what the named stages leave, one by one, and say what each did."""
    earlier = None if config.earlier is None else Path(config.earlier)
    if earlier is not None and not earlier.is_dir():
        raise UsageError(
            refusal(f"earlier={earlier}", "the folder of an earlier run", "no such folder",
                    "Name one that a run has written, for instance outputs/<date and time>.")
        )  # fmt: skip
    run = Run(config, folder, earlier)
    for number, stage in enumerate(config.stages, start=1):
        head = f"[{number}/{len(config.stages)}] {stage}"
        print(head, flush=True)
        record = do_stage(run, stage, place)
        if record.made != RAN:
            print(record.said.replace(FOLDER_IN_TEXT, str(folder)), end="")
        print(f"{head}: {_how(record)}", flush=True)
        yield record
    print(f"everything is in {folder}", flush=True)


def _how(record: StageRecord) -> str:
    if record.made == RAN:
        return f"{record.wall_time_s:.1f} s"
    where = "here before" if record.made == FROM_BEFORE else "in the cache"
    return f"{where}, made {record.began} in {record.wall_time_s:.1f} s"
