"""What a diagnosis says, and the evidence behind it."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pipeline.discrepancy.location.locate import Located
from pipeline.discrepancy.model.model import CorrectedModel, Hypothesis
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.physics.motion import Motion
from pipeline.recording import Recording

SCHEMA = "loopgap.diagnosis/1"
VERDICTS = ("no_mismatch", "explained", "partly_explained", "unknown_physics", "ambiguous")


@dataclass(frozen=True)
class Estimate:
    """A parameter with its 95 % interval [unit]."""

    name: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class NamedPhysics:
    """One term that the simulation left out; surplus: of which it has too much instead."""

    name: str
    site: str
    probability: float
    parameters: tuple[Estimate, ...]
    heldout_rmse_without: float
    alternatives: tuple[str, ...]
    says: str
    surplus: bool = False


@dataclass(frozen=True)
class Errors:
    """Root mean square of the residual [unit] on fitted and on held-out samples."""

    train_rmse: float
    heldout_rmse: float


@dataclass(frozen=True)
class Location:
    """How much of the residual a coordinate explains."""

    coordinate: str
    share: float
    p_value: float
    where: str | None


@dataclass(frozen=True)
class Calibration:
    """measurement = gain * mechanism + offset [unit]; always fitted, named by nobody.

    delay_s: by how much a force was recorded later than its motion; None where no force is measured
    against a motion. smooth_error: root mean square [unit] of the smooth error that the declared
    `shape` or `accuracy` allows; None where none is allowed.
    """

    gain: float
    offset: float
    delay_s: float | None = None
    smooth_error: float | None = None


FOLLOWS = "The corrected simulation follows what the catalogue has no name for"


@dataclass(frozen=True)
class Unexplained:
    """The structured rest: its share of the mismatch's variance, and how likely by chance."""

    share: float
    p_value: float
    where: str | None


@dataclass(frozen=True)
class NextExperiment:
    """What to record next, and the file of its commands."""

    why: str
    commands: str | None


@dataclass(frozen=True)
class Diagnosis:
    """One measurement's entry of diagnosis.json; all lengths in the measurement's unit."""

    measurement: str
    unit: str
    verdict: str
    noise: float
    before: Errors
    after: Errors
    location: tuple[Location, ...]
    physics: tuple[NamedPhysics, ...]
    calibration: Calibration
    unexplained: Unexplained
    not_excited: tuple[str, ...]
    next_experiment: NextExperiment | None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Evidence:
    """All that a reader of one measurement's diagnosis may want to look at; arrays are (n,).

    recording: as it came. motion: the axis's drive, times, cycles and other commands.
    drive: name of the command that drives it. static: whether the simulation is a static curve of
    that command (then the drive is the command, else the simulation's trace).
    train, heldout: masks; `used` are the rows that are measured and no outliers. mistaken: a mask
    of rows that are so in themselves, whatever explains the others (`Problem.mistaken`).
    before, after: predictions of the simulation as it came and with the named terms.
    deviation: standard deviation of `after` against the measurement. noise: as learnt.
    hypotheses: the best first; its mechanism is what `after` was made with.
    located: where the residual of the rows that a fit may use lies, with the lines of its pictures.
    """

    recording: Recording
    measurement: str
    drive: str
    static: bool
    motion: Motion
    measured: np.ndarray
    train: np.ndarray
    heldout: np.ndarray
    used: np.ndarray
    mistaken: np.ndarray
    before: np.ndarray
    after: np.ndarray
    deviation: np.ndarray
    noise: NoiseModel
    hypotheses: tuple[Hypothesis, ...]
    located: tuple[Located, ...] = ()

    @property
    def residual_before(self) -> np.ndarray:
        """Measurement minus simulation, (n,); NaN where not measured."""
        return self.measured - self.before

    @property
    def residual_after(self) -> np.ndarray:
        """Measurement minus corrected simulation, (n,); NaN where not measured."""
        return self.measured - self.after

    def errors(self, predicted: np.ndarray) -> Errors:
        """Those of a prediction (n,), over measured rows but outliers; over all where all are."""
        square = (self.measured - predicted) ** 2
        train, heldout = self.train & self.used, self.heldout & self.used
        return Errors(
            root_mean(square[train if train.any() else self.train]),
            root_mean(square[heldout if heldout.any() else self.heldout]),
        )


def root_mean(square: np.ndarray) -> float:
    """Root mean square, given squares; NaN of none."""
    return float(np.sqrt(np.mean(square))) if len(square) else float("nan")


@dataclass(frozen=True)
class DiagnosisResult:
    """One diagnosis, its evidence and its model for each measurement, in the recording's order."""

    diagnoses: tuple[Diagnosis, ...]
    evidence: tuple[Evidence, ...]
    models: tuple[CorrectedModel, ...]


def as_json(diagnoses: tuple[Diagnosis, ...]) -> Mapping[str, Any]:
    """The content of diagnosis.json (notes and what is surplus belong to the report)."""
    entries = [{k: v for k, v in asdict(d).items() if k != "notes"} for d in diagnoses]
    for entry in entries:
        for physics in entry["physics"]:
            del physics["surplus"]
        entry["calibration"] = {k: v for k, v in entry["calibration"].items() if v is not None}
    return {"schema": SCHEMA, "measurements": entries}
