"""The paper's model of a hysteresis loop: one mixture for each direction of travel.

The nominal mixture knows whole cycles, cw the ascending and ccw the descending branches. The two
branches are those of the full loops that they were trained on: after a reversal half way the robot
is on an inner loop that neither of them knows.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.config import TrainingConfig
from pipeline.errors import LoopgapError, refusal
from pipeline.models.mixture import MixtureRegression
from pipeline.recording import Recording, branch_of

SCHEMA = "loopgap.loop_model/1"
MODELS = ("nominal", "cw", "ccw")
DIRECTIONS = {"nominal": 0, "cw": 1, "ccw": -1}


@dataclass(frozen=True)
class BranchSamples:
    """Samples of one model: command and angle [deg] and their cycle, each of shape (n,)."""

    command_deg: np.ndarray
    angle_deg: np.ndarray
    cycle: np.ndarray

    def only(self, cycles: Sequence[int]) -> "BranchSamples":
        """The samples of some cycles."""
        kept = np.isin(self.cycle, cycles)
        return BranchSamples(self.command_deg[kept], self.angle_deg[kept], self.cycle[kept])


@dataclass(frozen=True)
class LoopModel:
    """Nominal, ascending (cw) and descending (ccw) mixtures of one axis, and its channels."""

    command: str
    measurement: str
    nominal: MixtureRegression
    cw: MixtureRegression
    ccw: MixtureRegression

    @classmethod
    def fit(
        cls,
        recording: Recording,
        axis: str,
        cycles: Sequence[int],
        k: Mapping[str, int],
        config: TrainingConfig,
        seed: int,
    ) -> "LoopModel":
        """Fit the three mixtures with `k[model]` Gaussians to an axis's cycles."""
        samples = branch_samples(recording, axis, cycles)
        mixtures = {}
        for model in MODELS:
            s = samples[model]
            try:
                mixtures[model] = MixtureRegression.fit(
                    s.command_deg, s.angle_deg, k[model], config, seed
                )
            except LoopgapError as error:
                raise type(error)(f"{axis}, {model} model: {error}") from error
        return cls(command_of(axis), measurement_of(axis), **mixtures)

    def predict(
        self, command_deg: np.ndarray, direction: np.ndarray | int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Mean angle and standard deviation [deg], both (n,), for commands of shape (n,).

        direction: shape (n,) or one for all: +1 asks cw, -1 ccw, 0 nominal.
        """
        command_deg = np.atleast_1d(np.asarray(command_deg, dtype=float))
        direction = np.broadcast_to(direction, command_deg.shape)
        mean, deviation = np.empty_like(command_deg), np.empty_like(command_deg)
        for model, sign in DIRECTIONS.items():
            rows = np.sign(direction) == sign
            if rows.any():
                mixture: MixtureRegression = getattr(self, model)
                mean[rows], deviation[rows] = mixture.predict(command_deg[rows])
        return mean, deviation

    def as_json(self) -> dict[str, Any]:
        """Plain JSON that `from_json` takes back."""
        head = {"schema": SCHEMA, "command": self.command, "measurement": self.measurement}
        return head | {model: getattr(self, model).as_json() for model in MODELS}

    @classmethod
    def from_json(cls, entry: dict[str, Any]) -> "LoopModel":
        """The model that `as_json` described; LoopgapError if it is another thing."""
        found = entry.get("schema") if isinstance(entry, dict) else type(entry).__name__
        if found != SCHEMA:
            raise LoopgapError(
                refusal("loop model", f"schema {SCHEMA!r}", repr(found), "Train the model anew.")
            )
        missing = [key for key in ("command", "measurement", *MODELS) if key not in entry]
        if missing:
            raise LoopgapError(
                refusal("loop model", f"a key {missing[0]!r}", f"{', '.join(entry)}",
                        "Train the model anew.")
            )  # fmt: skip
        mixtures = {model: MixtureRegression.from_json(entry[model]) for model in MODELS}
        return cls(entry["command"], entry["measurement"], **mixtures)


def command_of(axis: str) -> str:
    """Channel of an axis's commanded shaft angle."""
    return f"{axis}_command_deg"


def measurement_of(axis: str) -> str:
    """Channel of an axis's measured bending angle."""
    return f"{axis}_angle_deg"


def branch_samples(
    recording: Recording, axis: str, cycles: Sequence[int]
) -> dict[str, BranchSamples]:
    """The samples of the wanted cycles for each of the three models.

    The direction of travel is read from the whole recording, so that the first sample of a cycle
    knows the one before it.
    """
    command, angle = (recording.channel(c).name for c in (command_of(axis), measurement_of(axis)))
    direction = branch_of(recording.values(command))
    recording.cycles(cycles)  # refuses cycles that were not recorded
    everything = BranchSamples(
        recording.values(command),
        recording.values(angle),
        recording.samples["cycle"].to_numpy(int),
    )
    wanted = np.isin(everything.cycle, list(cycles))
    rows = {"nominal": wanted, "cw": wanted & (direction > 0), "ccw": wanted & (direction < 0)}
    return {
        model: BranchSamples(
            everything.command_deg[kept], everything.angle_deg[kept], everything.cycle[kept]
        )
        for model, kept in rows.items()
    }
