"""The command `loopgap`: typed configuration in, stages run in order, results out."""

import datetime
import json
import os
import signal
import sys
import traceback
from pathlib import Path
from types import FrameType

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from hydra.errors import HydraException
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException

from pipeline.config import Config, check_config, register_schemas
from pipeline.config_errors import explain
from pipeline.errors import LoopgapError, UsageError
from pipeline.recording import write_atomically
from pipeline.run import run_stages
from pipeline.tracking.collection import collect
from pipeline.tracking.reuse import SHARED_STAGES, note_recording, same_recording

PACKAGE = Path(__file__).resolve().parent
CONF = PACKAGE / "conf" if (PACKAGE / "conf").is_dir() else PACKAGE.parent / "conf"
SWEEP_DIR = "hydra.sweep.dir="
INTERRUPTED = 130
UNUSABLE = 1


def main() -> None:
    """Run the command line; exit 0 when the work was done, 1 when it could not be, 2 on misuse."""
    sys.exit(run_command_line())


def run_command_line() -> int:
    """Run what `sys.argv` asks for and return the exit status."""
    os.environ.setdefault("HYDRA_FULL_ERROR", "1")
    signal.signal(signal.SIGTERM, _interrupt)
    register_schemas(ConfigStore.instance())
    sweep = _sweep_folder()
    try:
        _hydra_job()
    except (HydraException, OmegaConfBaseException) as error:
        return _complain(explain(error), UsageError.exit_status)
    except LoopgapError as error:
        return _complain(str(error), error.exit_status)
    except OSError as error:
        return _complain(f"{error.filename or 'output'}: can't be used: {error}", UNUSABLE)
    except KeyboardInterrupt:
        return _complain("interrupted: what was recorded is in the run folder", INTERRUPTED)
    return _report_sweep(sweep) if sweep else 0


@hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")
def _hydra_job(raw: DictConfig) -> None:
    settings = HydraConfig.get()
    folder = Path(settings.runtime.output_dir)
    in_sweep = settings.mode == RunMode.MULTIRUN
    overrides = dict(o.lstrip("+~").split("=", 1) for o in settings.overrides.task if "=" in o)
    head = {"overrides": overrides, "number": settings.job.num if in_sweep else 0}
    _note(folder, head | {"status": "running"})
    try:
        config = OmegaConf.to_object(raw)
        assert isinstance(config, Config)
        check_config(config)
        write_atomically(folder / "config.yaml", OmegaConf.to_yaml(raw, resolve=True))
        shared = same_recording(config, folder.parent) if in_sweep else None
        if shared is not None:
            print(f"job {head['number']}: the recording of job {shared.name} is the same; used")
            config.earlier = str(shared)
            config.stages = [stage for stage in config.stages if stage not in SHARED_STAGES]
        run_stages(config, folder)
        note_recording(config, folder)
    except BaseException as error:
        _note(folder, head | {"status": "failed", "error": f"{type(error).__name__}: {error}"})
        if not in_sweep or not isinstance(error, Exception):
            raise
        _complain(f"job {head['number']}: {error}", 1)
        if not isinstance(error, LoopgapError):
            traceback.print_exception(error)
        return
    _note(folder, head | {"status": "done"})


def _note(folder: Path, job: dict[str, object]) -> None:
    write_atomically(folder / "job.json", json.dumps(job, indent=1))


def _sweep_folder() -> Path | None:
    """Where a multirun writes, chosen here so that its table can be made after the last job."""
    if not {"-m", "--multirun"} & set(sys.argv):
        return None
    given = [a.removeprefix(SWEEP_DIR) for a in sys.argv if a.startswith(SWEEP_DIR)]
    if given:
        return Path(given[-1].strip("'\""))
    folder = Path(f"outputs/sweep_{datetime.datetime.now():%Y-%m-%d_%H-%M-%S-%f}")
    sys.argv.append(SWEEP_DIR + str(folder))
    return folder


def _report_sweep(folder: Path) -> int:
    collection = collect(folder)
    print(f"\ntable of all jobs: {folder / 'results.md'}")
    for job in collection.incomplete.itertuples():
        print(f"job {job.job} {job.status}: {job.error}", file=sys.stderr)
    return 1 if len(collection.incomplete) else 0


def _complain(message: str, status: int) -> int:
    print(f"loopgap: {message}", file=sys.stderr)
    return status


def _interrupt(_signal: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    main()
