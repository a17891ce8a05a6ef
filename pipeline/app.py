"""The command `loopgap`: typed configuration in, stages run in order, results out."""

import os
import signal
import sys
from importlib.metadata import version
from pathlib import Path
from types import FrameType

import hydra
from hydra.core.config_store import ConfigStore
from hydra.core.hydra_config import HydraConfig
from hydra.errors import HydraException
from hydra.types import RunMode
from omegaconf import DictConfig, OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import MarkedYAMLError

from pipeline import quick_compose
from pipeline.config import CONF, Config, register_schemas
from pipeline.config_check import check_config
from pipeline.config_errors import explain, refuse_added_keys
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.job import Job, run_job
from pipeline.runners.contracts import check_split
from pipeline.sweep import SWEEP_DIR, Sweep, going_on, options_first, sweep_asked
from pipeline.tracking.planned import override

INTERRUPTED = 130
UNUSABLE = 1
_in_hydra = hydra.main(version_base="1.3", config_path=str(CONF), config_name="config")


def main() -> None:
    """Run the command line; exit 0 when the work was done, 1 when it could not be, 2 on misuse."""
    sys.exit(run_command_line())


def run_command_line() -> int:
    """Run what `sys.argv` asks for and return the exit status."""
    os.environ.setdefault("HYDRA_FULL_ERROR", "1")
    signal.signal(signal.SIGTERM, _interrupt)
    if "--version" in sys.argv[1:]:
        print(f"loopgap {version('loopgap')}, on Hydra {version('hydra-core')}")
        return 0
    register_schemas(ConfigStore.instance())
    quick_compose.install()
    sys.argv[1:] = options_first(sys.argv[1:])
    try:
        sweep = sweep_asked(sys.argv[1:], CONF)
        if sweep is None:
            return _run_once()
        return _run_sweep(sweep)
    except (HydraException, OmegaConfBaseException) as error:
        return _complain(explain(error), UsageError.exit_status)
    except MarkedYAMLError as error:
        return _complain(_no_yaml(error), UsageError.exit_status)
    except LoopgapError as error:
        return _complain(_with_notes(str(error), error), error.exit_status)
    except OSError as error:
        return _complain(_with_notes(_unusable(error), error), UNUSABLE)
    except KeyboardInterrupt as error:
        said = "interrupted: what was done is in the run's folder"
        return _complain(_with_notes(said, error), INTERRUPTED)


def _run_once() -> int:
    failed: list[Exception] = []

    @_in_hydra
    def job(raw: DictConfig) -> None:
        try:
            _run_job(raw)
        except Exception as error:  # raised past Hydra, it would follow a line of Hydra's own
            failed.append(error)

    job()
    if failed:
        raise failed[0]
    return 0


def _run_sweep(sweep: Sweep) -> int:
    from pipeline.collecting import conclude  # it loads what only a sweep's end needs

    if not any(a.startswith(SWEEP_DIR) for a in sys.argv):
        sys.argv.append(override(SWEEP_DIR.rstrip("="), sweep.folder))
    print(f"{sweep.jobs} jobs; should it be stopped, this goes on:\n"
          f"  {going_on(sys.argv[1:], sweep.folder)}", flush=True)  # fmt: skip
    with sweep.running():
        try:
            _in_hydra(_run_job)()
        except (HydraException, OmegaConfBaseException, LoopgapError, OSError):
            raise
        except Exception as error:  # of the launcher: a job's errors end with the job
            _complain(f"the launcher lost a job: {_first_line(error)}", UNUSABLE)
            conclude(sweep.folder)
            return UNUSABLE
        return conclude(sweep.folder)


def _run_job(raw: DictConfig) -> None:
    settings = HydraConfig.get()
    folder = Path(settings.runtime.output_dir)
    in_sweep = settings.mode == RunMode.MULTIRUN
    job = Job(
        folder,
        list(settings.overrides.task),
        settings.job.num if in_sweep else 0,
        folder.parent if in_sweep else None,
    )

    def configure() -> tuple[Config, str]:
        refuse_added_keys(raw)
        config = OmegaConf.to_object(raw)
        assert isinstance(config, Config)
        check_config(config)
        check_split(config)
        return config, OmegaConf.to_yaml(raw, resolve=True)

    try:
        run_job(job, configure)
    except (Exception, KeyboardInterrupt) as error:
        if not in_sweep and not isinstance(error, UsageError):
            error.add_note("When its cause is gone, this goes on:\n"
                           f"  {going_on(sys.argv[1:], folder)}")  # fmt: skip
        raise


def _first_line(error: Exception) -> str:
    return f"{type(error).__name__}: {str(error).strip().partition(chr(10))[0]}"


def _unusable(error: OSError) -> str:
    return refusal(
        str(error.filename or "a folder of this run"),
        "a place that can be written",
        f"{error.strerror or error}",
        "Free or unlock it, or write elsewhere with `hydra.run.dir=OUT`.",
    )


def _no_yaml(error: MarkedYAMLError) -> str:
    mark = error.problem_mark
    where = "configuration" if mark is None else f"{mark.name}, line {mark.line + 1}"
    return refusal(where, "YAML", error.problem or str(error), "Mend the file there.")


def _with_notes(message: str, error: BaseException) -> str:
    return "\n".join([message, *getattr(error, "__notes__", [])])


def _complain(message: str, status: int) -> int:
    print(f"loopgap: {message}", file=sys.stderr)
    return status


def _interrupt(_signal: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


if __name__ == "__main__":
    main()
