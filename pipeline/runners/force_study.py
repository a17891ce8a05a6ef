"""The study of a force against motion: import two recordings, diagnose one, answer the other."""

from pathlib import Path

from threadpoolctl import threadpool_limits

from pipeline.errors import UsageError, refusal
from pipeline.foreign.mapping import check_mapping
from pipeline.foreign.read import read_table
from pipeline.recording import Recording, save_recording
from pipeline.runners.diagnosis import answer, summary, write_answer, write_pages
from pipeline.runners.run_folder import Run
from pipeline.runners.simulation import with_simulation
from pipeline.stages.force_study import errors_table, parameters_table
from pipeline.stages.importing import assemble
from pipeline.tracking.tables import plain, write_table

WITHIN = "force_study.fitted and force_study.other"


def run_force_study(run: Run) -> None:
    """Diagnose `force_study.fitted`, predict `force_study.other`, compare with simpler laws."""
    config, study = run.config, run.config.force_study
    fitted, other = (_imported(run, name) for name in (study.fitted, study.other))
    answered = answer(config.diagnosis, [fitted])
    write_answer(answered, run.folder)
    write_pages(answered, run.folder)
    model = next((m for m in answered.models if m.force), None)
    if model is None:
        raise UsageError(
            refusal(WITHIN, "a force measured against a position",
                    ", ".join(f"{c.name} [{c.unit}]" for c in fitted.channels),
                    "Map a command in a unit of length or angle and a measurement of force.")
        )  # fmt: skip
    place = answered.models.index(model)
    diagnosis, evidence = answered.diagnoses[place], answered.evidence[place]
    cutoff_hz = config.diagnosis.cutoff_hz
    with threadpool_limits(1):
        errors = errors_table(model, evidence, fitted, other, cutoff_hz)
    parameters = parameters_table(
        model, diagnosis, evidence, fitted, study.mass, study.published, cutoff_hz
    )
    for name, table in (("errors", errors), ("parameters", parameters)):
        write_table(table, run.folder / "force_study", name)
    print(f"\n{summary(diagnosis)}")
    print(f"\nRelative error of the force:\n{plain(errors)}")
    print(f"\nParameters:\n{plain(parameters)}")
    print(f"  report, opens in any browser: {run.folder / 'report.html'}")


def _imported(run: Run, name: str | None) -> Recording:
    config = run.config.importing
    check_mapping(config)
    if config.path is None or name is None:
        raise UsageError(
            refusal(f"importing.path, {WITHIN}", "a folder and two files in it",
                    f"{config.path}, {name}", "Give importing.path=FOLDER.")
        )  # fmt: skip
    path = Path(config.path) / name
    tables = {key: read_table(path, key, table) for key, table in config.tables.items()}
    recording = with_simulation(run.config, assemble(config, tables).recording)
    save_recording(recording, run.folder / "recordings" / Path(name).stem)
    return recording
