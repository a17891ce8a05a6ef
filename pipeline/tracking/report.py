"""report.html: a diagnosis for people, in one file that needs no network."""

from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from pipeline.atomically import write_atomically
from pipeline.discrepancy.model.result import Diagnosis, Evidence
from pipeline.physics.catalogue import FORCES, MEANINGS
from pipeline.recording import file_stem
from pipeline.tracking import report_words as words
from pipeline.tracking.diagnosis_figures import diagnosis_figures, overview_figure, spoken, svg_of
from pipeline.tracking.figures import save_figure
from pipeline.tracking.review import DiagnosisReview, write_diagnosis_review

NOT_SHOWN = "This recording could not have shown these, whether or not they are there:"
NO_FORCE = "These show only where a force or torque is measured against the position:"
TEMPLATE = "report.html.jinja"
PAGE_COLOURS = {
    "#6E6E6E": "var(--measured)",
    "#D55E00": "var(--before)",
    "#0072B2": "var(--after)",
    "#009E73": "var(--other-way)",
    "#E69F00": "var(--further)",
    "#C8C8C8": "var(--faint)",
    "#E4E4E4": "var(--grid)",
}
CAPTIONS = {
    "loop": "One cycle that nothing was fitted to: what was measured, the simulation as it came, "
    "and the simulation with what it left out.",
    "residual": "What is off along the command, in all cycles kept apart. Grey: two deviations of "
    "the noise.",
    "time": "What is off over the whole recording. Shaded: cycles kept apart from every fit.",
    "next": "The proposed motion.",
}


def write_report(
    folder: Path,
    diagnoses: Sequence[Diagnosis],
    evidence: Sequence[Evidence],
    commands: Sequence[pd.DataFrame | None],
) -> None:
    """Write `report.html`, its pictures (PNG, PDF) in `figures/`, and `diagnosis.rrd` for rerun.

    diagnoses, evidence, commands: one for each measurement; commands are the proposed ones.
    """
    measurements, reviews = [], {}
    for diagnosis, proof, proposed in zip(diagnoses, evidence, commands, strict=True):
        figures, stem = diagnosis_figures(proof, proposed), file_stem(diagnosis.measurement)
        saved = {
            name: save_figure(figure, folder / "figures", f"{stem}_{name}")
            for name, figure in figures.items()
        }
        pictures = {name: paths[0].read_bytes() for name, paths in saved.items()}
        reviews[diagnosis.measurement] = review_of(proof, pictures)
        drawn = {
            name: Markup(svg_of(figure, f"{stem}-{name}", PAGE_COLOURS))
            for name, figure in figures.items()
        }
        measurements.append(_measurement(diagnosis, proof, drawn))
    save_figure(overview_figure(evidence), folder / "figures", "overview")
    write_atomically(folder / "report.html", page(measurements))
    write_diagnosis_review(folder / "diagnosis.rrd", reviews, summary(diagnoses))


def review_of(evidence: Evidence, pictures: Mapping[str, bytes]) -> DiagnosisReview:
    """What the rerun recording shows of a measurement's diagnosis."""
    time_s = evidence.motion.time_s - evidence.motion.time_s[0]
    values = {
        "measured": evidence.measured,
        "simulated": evidence.before,
        "corrected": evidence.after,
        "simulated_error": evidence.residual_before,
        "corrected_error": evidence.residual_after,
    }
    unit = evidence.recording.channel(evidence.measurement).unit
    return DiagnosisReview(time_s, values, unit, pictures)


def summary(diagnoses: Sequence[Diagnosis]) -> str:
    """Every verdict in Markdown."""
    return "\n\n".join(
        f"# {spoken(d.measurement)}: {words.TITLES[d.verdict].lower()}\n\n"
        f"{words.verdict_sentence(d)} {words.error_sentence(d)}"
        for d in diagnoses
    )


def page(measurements: Sequence[Mapping[str, Any]]) -> str:
    """The page's text from what is said of each measurement."""
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {
        "said": words.said, "number": words.number, "percent": words.percent,
        "chance": words.chance, "coordinate": words.coordinate, "sentence": words.sentence,
        "spoken": spoken, "placed": words.placed,
    }  # fmt: skip
    text = resources.files("pipeline.tracking").joinpath("templates", TEMPLATE).read_text("utf-8")
    return environment.from_string(text).render(
        measurements=measurements, what_it_is=MEANINGS, captions=CAPTIONS
    )


def _measurement(
    diagnosis: Diagnosis, evidence: Evidence, pictures: Mapping[str, Markup]
) -> dict[str, Any]:
    located = [entry for entry in evidence.located if entry.where is not None]
    largest = max(diagnosis.before.heldout_rmse, diagnosis.after.heldout_rmse, diagnosis.noise)
    return {
        "diagnosis": diagnosis,
        "title": words.TITLES[diagnosis.verdict],
        "tone": words.TONES[diagnosis.verdict],
        "verdict": words.verdict_sentence(diagnosis),
        "errors": words.error_sentence(diagnosis),
        "bars": [
            ("as it came", "before", diagnosis.before.heldout_rmse, largest),
            ("corrected", "after", diagnosis.after.heldout_rmse, largest),
            ("noise", "measured", diagnosis.noise, largest),
        ],
        "pictures": pictures,
        "located": located,
        "silent": [e.coordinate for e in evidence.located if e.where is None],
        "not_shown": _not_shown(diagnosis.not_excited),
        "hypotheses": evidence.hypotheses,
        "samples": int(np.sum(evidence.used)),
        "heldout": int(np.sum(evidence.heldout & evidence.used)),
    }


def _not_shown(names: Sequence[str]) -> list[tuple[str, list[str]]]:
    """Names that a recording could not have shown, under a sentence on why."""
    forces = FORCES if set(names) >= FORCES else set()
    parts = ((NOT_SHOWN, [n for n in names if n not in forces]), (NO_FORCE, sorted(forces)))
    return [(told, those) for told, those in parts if those]
