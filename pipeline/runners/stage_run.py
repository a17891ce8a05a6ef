"""One stage of a run: taken from where its result is already, or run; then kept and noted."""

import io
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from pipeline.errors import LoopgapError, refusal
from pipeline.runners.contracts import (
    ANGLES,
    FRAMES,
    NO_SAY,
    Contract,
    contract_of,
    in_laboratory,
    may_be_reused,
    simulated,
)
from pipeline.runners.run_folder import Kept, Run, fresh, made
from pipeline.tracking.cache import StageCache
from pipeline.tracking.code import code_of, libraries_of
from pipeline.tracking.files import CorruptError, appear
from pipeline.tracking.hashes import digest, files_matching, hashes_of
from pipeline.tracking.provenance import now
from pipeline.tracking.stage_record import (
    FROM_BEFORE,
    StageRecord,
    begin,
    has_begun,
    read_record,
    write_record,
)

FOLDER_IN_TEXT = "{folder}"
COPYING = ("importing", "diagnosis", "force_study")  # they leave recordings made of other files
RECORDING_FILES = ("recording.json", "samples.*")


@dataclass(frozen=True)
class Workplace:
    """Where results may come from: the cache, and the folder that the jobs of a sweep share.

    `before_work` is called before anything is written into the run's folder.
    """

    cache: StageCache | None
    shared: Path | None
    before_work: Callable[[], None]


def do_stage(run: Run, stage: str, place: Workplace) -> StageRecord:
    """Bring about the result of a stage in the run's folder, in the cheapest way that is right."""
    contract = contract_of(stage, run.config)
    inputs = inputs_of(run, stage, contract)
    key = key_of(run, stage, contract, inputs)
    record = _done_before(run, stage, contract, key)
    cache = place.cache if may_be_reused(stage, run.config) else None
    if record is None and cache is not None:
        record = _from_cache(run, contract, key, cache, place)
        if record is None:
            with cache.alone(key):
                record = _from_cache(run, contract, key, cache, place)
                if record is None:
                    place.before_work()
                    record = _made(run, stage, contract, key, inputs)
                    cache.put(record, run.folder)
    elif record is None:
        place.before_work()
        record = _made(run, stage, contract, key, inputs)
    run.kept.setdefault(stage, Kept(record.outputs, run.folder))
    return record


def key_of(run: Run, stage: str, contract: Contract, inputs: dict[str, str]) -> str:
    """Hash of everything that decides on a stage's result."""
    return digest(
        {
            "stage": stage,
            "settings": settings_of(asdict(run.config), contract.settings),
            "inputs": inputs,
            "code": code_of(contract.module),
            "libraries": libraries_of(contract.module),
        }
    )


def settings_of(everything: dict[str, Any], keys: tuple[str, ...]) -> dict[str, Any]:
    """The named sections and keys of a configuration, without what has no say in any result."""
    settings: dict[str, Any] = {}
    for key in keys:
        section, _, name = key.partition(".")
        value = everything[section][name] if name else everything[section]
        if isinstance(value, dict):
            value = {n: v for n, v in value.items() if f"{key}.{n}" not in NO_SAY}
        settings[key] = value
    return settings


def inputs_of(run: Run, stage: str, contract: Contract) -> dict[str, str]:
    """Name -> hash of each file that the stage may read: of earlier stages, and the user's own."""
    inputs: dict[str, str] = {}
    looks = stage in ("vision", "review")  # at frames, which no imported recording has
    own = run.given_recording() if run.config.recording is not None or not looks else None
    for pattern in contract.reads:
        source = pattern.partition("/")[0]
        if own is None or source not in ("acquisition", "vision"):
            inputs |= run.hashes(source, pattern)
    if own is not None and (stage == "prediction" or set(contract.reads) & {*ANGLES, *FRAMES}):
        inputs |= _outside(own, (*RECORDING_FILES, *(("frames/*",) if looks else ())))
    if in_laboratory(stage, run.config) and run.config.acquisition.commands is not None:
        inputs |= _whole(Path(run.config.acquisition.commands))
    simulation = run.config.simulation.path
    if stage in ("diagnosis", "baselines") and simulation is not None and Path(simulation).exists():
        inputs |= _whole(Path(simulation))
    if stage == "importing" and run.config.importing.path is not None:
        inputs |= _whole(Path(run.config.importing.path))
    if stage == "prediction":
        inputs |= _outside(Path(run.config.model or run.folder), ["model.json"])
    return dict(sorted(inputs.items()))


def _whole(path: Path) -> dict[str, str]:
    return _outside(path, ["*"]) if path.is_dir() else _outside(path.parent, [path.name])


def _outside(folder: Path, patterns: Iterable[str]) -> dict[str, str]:
    found = hashes_of(folder, files_matching(folder, patterns))
    return {f"{folder.resolve().name}/{name}": value for name, value in found.items()}


def _done_before(run: Run, stage: str, contract: Contract, key: str) -> StageRecord | None:
    """What an earlier try of this run left, if it is this very result and nothing has changed."""
    known = may_be_reused(stage, run.config) or in_laboratory(stage, run.config)
    record = read_record(run.folder, stage) if known else None
    if record is None or record.key != key:
        return None
    if _proven(run.folder, record):
        return replace(record, made=FROM_BEFORE)
    if in_laboratory(stage, run.config) and not simulated(run.config):
        raise LoopgapError(
            refusal(str(run.folder / stage), "what the robot left", "files changed since",
                    "Put them back, or write elsewhere with `hydra.run.dir=OUT`.")
        )  # fmt: skip
    print(f"  {stage}: files of {run.folder} have changed since: done anew", file=sys.stderr)
    return None


def _from_cache(
    run: Run, contract: Contract, key: str, cache: StageCache, place: Workplace
) -> StageRecord | None:
    """A kept result, brought into the run's folder, or lent where it is large; None if corrupt."""
    record = cache.get(key)
    if record is None:
        return None
    place.before_work()
    _clear(run.folder, record.stage, contract)
    if contract.large and place.shared is not None:
        lent = _lent(cache, record, place.shared)
        if lent is None:
            return None
        run.kept[record.stage] = Kept(record.outputs, lent)
        return record
    begin(run.folder, record.stage)
    if not cache.bring(record, run.folder):
        return None
    write_record(run.folder, record)
    return record


def _lent(cache: StageCache, record: StageRecord, shared: Path) -> Path | None:
    """Where the jobs of a sweep find a large result, brought there by the first that needs it."""
    folder = shared / f"{record.stage}-{record.key[:16]}"

    def fill(beside: Path) -> None:
        if not cache.bring(record, beside):
            raise CorruptError

    if folder.is_dir() and not _proven(folder, record):
        shutil.rmtree(folder, ignore_errors=True)
    if not folder.is_dir():
        try:
            appear(folder, fill, shared)
        except CorruptError:
            return None
    return folder


def _proven(folder: Path, record: StageRecord) -> bool:
    there = [name for name in record.outputs if (folder / name).is_file()]
    return hashes_of(folder, there) == record.outputs


def _made(
    run: Run, stage: str, contract: Contract, key: str, inputs: dict[str, str]
) -> StageRecord:
    """Run a stage into a clean place and note what it left."""
    _clear(run.folder, stage, contract)
    begin(run.folder, stage)
    began, began_s = now(), time.monotonic()
    with _overheard() as said:
        contract.function()(run)
    record = StageRecord(
        stage=stage,
        key=key,
        began=began,
        wall_time_s=round(time.monotonic() - began_s, 3),
        inputs=inputs,
        outputs=hashes_of(run.folder, files_matching(run.folder, contract.leaves)),
        said=said.getvalue().replace(str(run.folder), FOLDER_IN_TEXT),
    )
    write_record(run.folder, record)
    return record


def _clear(folder: Path, stage: str, contract: Contract) -> None:
    """Make room for a result: remove what a try of ours left, set anything else aside.

    What a real robot did is never removed, but for copies of what lies elsewhere.
    """
    there = [path for pattern in contract.leaves for path in folder.glob(pattern)]
    if not there:
        return
    only_there = stage not in COPYING and any(_of_a_real_robot(path) for path in there)
    if has_begun(folder, stage) and not only_there:
        for path in there:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        return
    aside = fresh(folder, "set_aside")
    for path in there:
        path.rename(made(aside / path.relative_to(folder).parent) / path.name)
    print(f"  {stage}: what was there is now in {aside}", file=sys.stderr)


def _of_a_real_robot(path: Path) -> bool:
    heads = path.rglob("recording.json") if path.is_dir() else []
    return any('"simulated"' not in head.read_text(encoding="utf-8") for head in heads)


@contextmanager
def _overheard() -> Iterator[io.StringIO]:
    """Keep a copy of what is printed meanwhile."""
    kept, outward = io.StringIO(), sys.stdout

    class Both(io.TextIOBase):
        def write(self, text: str) -> int:
            outward.write(text)
            return kept.write(text)

        def flush(self) -> None:
            outward.flush()

    with redirect_stdout(Both()):
        yield kept
