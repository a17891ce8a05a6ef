"""The corrected simulation: a fitted mechanism with its noise and how sure it is."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from pipeline.discrepancy.model.start import End, end_from_json, variance_of_start
from pipeline.discrepancy.model.zero import WalkedZero
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.errors import LoopgapError, refusal
from pipeline.physics.catalogue import term
from pipeline.physics.kinematics import Beside, Curve, IdentityCurve, SampledCurve, SmoothError
from pipeline.physics.mechanism import PLACES, Mechanism, OwnCourse
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.term import Surroundings, Term

SCHEMA = "loopgap.model/4"
DIFFERENCE = 0.2


class ModelError(LoopgapError):
    """A stored model is not as the format says."""


@dataclass(frozen=True)
class Hypothesis:
    """An explanation that competes: its names, its probability, and a mechanism that can answer.

    zero: where its own walk ended. forms: the same names in other forms, which fit nearly as well.
    """

    names: tuple[str, ...]
    probability: float
    mechanism: Mechanism
    zero: WalkedZero | None = None
    forms: tuple[Mechanism, ...] = ()

    def respond(self, motion: Motion) -> np.ndarray:
        """What it expects to be measured, (n,)."""
        answer = self.mechanism.respond(motion)[0]
        return answer if self.zero is None else answer + self.zero.level * self.zero.later(motion)


@dataclass(frozen=True)
class CorrectedModel:
    """What predicts a measurement from commands.

    drive: channel whose samples drive the mechanism: a command, or, where not `static`, the
    simulation of the measurement. covariance: of gain, offset, bends and all term parameters in
    their order. noise: of one measured sample. force: whether a force against the motion of `drive`
    is measured; simulated: whether a simulation says part of it; delay_s: how much later than its
    motion it is recorded. rivals: the other explanations. later: what answers once the recording's
    `lasted_s` are over, held-out rows having been fitted too; zero: where it stood then. counted:
    the step of the encoder that counted the drive, 0.0 of another. rough: the noise of a drive that
    was measured, 0.0 of another. cornered: whether its commands go on beyond their samples, see
    `corners.py`. end: where the recording ended, and as what it left the mechanism.
    zeros: see `Motion`.
    """

    measurement: str
    unit: str
    drive: str
    static: bool
    radian: float
    mechanism: Mechanism
    noise: NoiseModel
    covariance: np.ndarray
    force: bool = False
    simulated: bool = True
    delay_s: float = 0.0
    rivals: tuple[Hypothesis, ...] = ()
    zero: WalkedZero | None = None
    later: Mechanism | None = None
    lasted_s: float = np.inf
    counted: float = 0.0
    rough: float = 0.0
    cornered: bool = False
    end: End | None = None
    zeros: Mapping[str, float] = field(default_factory=dict)

    def predict(self, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
        """Expected measurement and its standard deviation, each (n,), from the motion alone.

        The deviation holds the noise, the walk since the first sample, what the parameters leave
        open and how far the rivals, by their probabilities, expect something else. A motion that
        begins soon after the model's recording, where that ended, goes on from there; one that
        begins at another command than that recording did may have come there on any way. After that
        recording's end, all its rows have been learnt from, and a zero that walks goes on from
        where it stood then.
        """
        goes_on = self.end is not None and self.end.goes_on(motion)
        fresh = self.mechanism.respond(motion)[0]
        slopes = np.column_stack(self._slopes(motion, fresh))
        open_variance = np.maximum(np.einsum("ij,jk,ik->i", slopes, self.covariance, slopes), 0.0)
        noise = self.noise.deviation**2 + self.noise.jitter**2
        walked = self.noise.walk**2 * np.arange(len(fresh))
        zero = np.zeros(len(fresh))
        if self.zero is not None:
            later: np.ndarray = self.zero.later(motion) | goes_on
            since = self.zero.deviation**2 + self.noise.walk**2 * np.cumsum(later)
            zero, walked = self.zero.level * later, np.where(later, since, walked)
        variance = noise + walked + open_variance
        for rival in self.rivals:
            told = fresh if goes_on else fresh + zero
            variance += rival.probability * (rival.respond(motion) - told) ** 2
        if self.end is not None and not (goes_on or self.end.begins_alike(motion)):
            variance += variance_of_start(self.mechanism, motion, fresh, self.end)
        return self._expected(motion, fresh) + zero, np.sqrt(variance)

    def _expected(self, motion: Motion, fresh: np.ndarray) -> np.ndarray:
        """What is expected without the zero; `fresh` (n,) of a motion on which nothing is known."""
        own = self.later or self.mechanism
        if self.end is not None and self.end.goes_on(motion):
            return self.end.answer(own, motion)
        after = motion.time_s - motion.time_s[0] > self.lasted_s
        return np.where(after, own.respond(motion)[0], fresh) if after.any() else fresh

    def _slopes(self, motion: Motion, expected: np.ndarray) -> list[np.ndarray]:
        """Change of the prediction for a unit of each parameter, by differences."""
        deviations = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        out = []
        for k, deviation in enumerate(deviations):
            step = DIFFERENCE * deviation
            if step == 0.0 or not np.isfinite(step):
                out.append(np.zeros(len(expected)))
                continue
            out.append((self._moved(k, step).respond(motion)[0] - expected) / step)
        return out

    def _moved(self, place: int, step: float) -> Mechanism:
        m = self.mechanism
        bends = () if m.error is None else m.error.weights
        flat = np.array([m.gain, m.offset, *bends, *(v for p in m.pieces for v in p.values)])
        flat[place] += step
        return _mechanism(m, flat)


def require(commands: list[str], needed: list[str]) -> None:
    """Raise ModelError where a command that a model needs is not there."""
    missing = [name for name in needed if name not in commands]
    if missing:
        raise ModelError(
            refusal("recording", f"the command {missing[0]!r} that the model was fitted with",
                    f"commands {', '.join(commands) or 'none'}", "Name the channel so.")
        )  # fmt: skip


def _mechanism(like: Mechanism, flat: np.ndarray) -> Mechanism:
    k, error = 2, like.error
    if error is not None:
        k += len(error.weights)
        error = replace(error, weights=tuple(float(weight) for weight in flat[2:k]))
    pieces = []
    for piece in like.pieces:
        pieces.append(Piece(piece.term, flat[k : k + len(piece.values)]))
        k += len(piece.values)
    gain, offset = (float(value) for value in flat[:2])
    return replace(like, pieces=tuple(pieces), gain=gain, offset=offset, error=error)


def as_json(model: CorrectedModel) -> dict[str, Any]:
    """The model as plain JSON."""
    m = model.mechanism
    curve = (
        {"first": m.curve.first, "spacing": m.curve.spacing, "angle": m.curve.angle.tolist()}
        if isinstance(m.curve, SampledCurve)
        else None
    )
    return {
        "schema": SCHEMA,
        "measurement": model.measurement,
        "unit": model.unit,
        "drive": model.drive,
        "static": model.static,
        "radian": model.radian,
        "zeros": dict(model.zeros),
        "force": model.force,
        "simulated": model.simulated,
        "delay_s": model.delay_s,
        "curve": curve,
        "course": None if m.course is None else _course_told(m.course),
        **_fitted(m, model.zero),
        "later": None if model.later is None else _fitted(model.later, None),
        "lasted_s": model.lasted_s if np.isfinite(model.lasted_s) else None,
        "counted": model.counted,
        "rough": model.rough,
        "cornered": model.cornered,
        "end": None if model.end is None else model.end.as_json(),
        "noise": asdict(model.noise),
        "covariance": model.covariance.tolist(),
        "rivals": [
            {"probability": r.probability, **_fitted(r.mechanism, r.zero)} for r in model.rivals
        ],
    }


def _fitted(m: Mechanism, zero: WalkedZero | None) -> dict[str, Any]:
    """All of a mechanism but its curve, and where its zero ended, as plain JSON."""
    return {
        "zero": None if zero is None else asdict(zero),
        "gain": m.gain,
        "offset": m.offset,
        "error": None if m.error is None else asdict(m.error),
        "terms": [_told(p) for p in m.pieces],
    }


def _course_told(course: OwnCourse) -> dict[str, Any]:
    """What a simulation has itself, by its place."""
    return {place: [_told(piece) for piece in getattr(course, place)] for place in PLACES}


def _told(piece: Piece) -> dict[str, Any]:
    """A term and its values by name."""
    parameters = dict(zip(_parameters(piece.term), piece.values.tolist(), strict=True))
    return {"name": piece.term.name, "form": piece.term.form, "parameters": parameters}


def from_json(entry: Mapping[str, Any], others: list[str]) -> CorrectedModel:
    """The model that `as_json` wrote; `others` are the other commands that a coupling may need.

    Raises ModelError where the schema is another or something is missing.
    """
    if entry.get("schema") != SCHEMA:
        raise ModelError(
            refusal("model", f"schema {SCHEMA!r}", repr(entry.get("schema")),
                    "Diagnose anew, or point `model=` at the folder of a diagnosis.")
        )  # fmt: skip
    try:
        curve: Curve = IdentityCurve()
        if entry["curve"] is not None:
            c = entry["curve"]
            curve = SampledCurve(c["first"], c["spacing"], np.array(c["angle"], dtype=float))
        course = None
        if entry.get("course") is not None:
            own = entry["course"]
            course = OwnCourse(
                *(tuple(_piece(told, others) for told in own.get(place, ())) for place in PLACES)
            )
        like = Mechanism(curve, course=course)
        mechanism = _refitted(entry, like, others)
        rivals = tuple(
            Hypothesis(tuple(t["name"] for t in r["terms"]), r["probability"],
                       _refitted(r, like, others), _zero(r))
            for r in entry.get("rivals", [])
        )  # fmt: skip
        return CorrectedModel(
            entry["measurement"], entry["unit"], entry["drive"], entry["static"], entry["radian"],
            mechanism, NoiseModel(**entry["noise"]), np.array(entry["covariance"], dtype=float),
            entry.get("force", False), entry.get("simulated", True), entry.get("delay_s", 0.0),
            rivals, _zero(entry),
            None if entry.get("later") is None else _refitted(entry["later"], like, others),
            np.inf if entry.get("lasted_s") is None else entry["lasted_s"],
            entry.get("counted", 0.0), entry.get("rough", 0.0), entry.get("cornered", False),
            None if entry.get("end") is None else end_from_json(entry["end"]),
            entry.get("zeros", {}),
        )  # fmt: skip
    except (KeyError, TypeError, ValueError) as problem:
        raise ModelError(
            refusal(
                "model", "the entries that a diagnosis writes", f"{problem!r}", "Diagnose anew."
            )
        ) from problem


def _refitted(entry: Mapping[str, Any], like: Mechanism, others: list[str]) -> Mechanism:
    """The mechanism that `_fitted` wrote, with the curve and course of another."""
    error = None
    if entry["error"] is not None:
        e = entry["error"]
        beside = tuple(Beside(**other) for other in e.get("beside", ()))
        error = SmoothError(e["middle"], e["half_range"], tuple(e["weights"]), beside)
        require(others, [other.command for other in beside])
    pieces = tuple(_piece(t, others) for t in entry["terms"])
    return replace(like, pieces=pieces, gain=entry["gain"], offset=entry["offset"], error=error)


def _piece(entry: Mapping[str, Any], others: list[str]) -> Piece:
    """A term with its values; ModelError where its parameters have other names now."""
    own, stored = term(entry["name"], entry["form"], others), entry["parameters"]
    if list(stored) != _parameters(own):
        raise ModelError(
            refusal(f"model, term {entry['name']!r}", f"parameters {', '.join(_parameters(own))}",
                    ", ".join(stored), "Diagnose anew.")
        )  # fmt: skip
    return Piece(own, np.array(list(stored.values()), dtype=float))


def _parameters(term: Term) -> list[str]:
    """Names of a term's parameters in the order of its values."""
    return [p.name for p in term.parameters(Surroundings())]


def _zero(entry: Mapping[str, Any]) -> WalkedZero | None:
    zero = entry.get("zero")
    return None if zero is None else WalkedZero(**zero)
