"""Tension loss: play that grows from cycle to cycle."""

from typing import ClassVar

import numpy as np
from numba import njit

from pipeline.number_words import worded
from pipeline.physics.backlash import AHEAD, BEFORE_RIPPLE, Backlash
from pipeline.physics.friction import Friction
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import varying_play
from pipeline.physics.pre_sliding import bristled
from pipeline.physics.term import Parameter, Shown, Surroundings, Term
from pipeline.physics.transmission_ripple import TransmissionRipple

SOONER, MUCH = 0.5, 0.5
REACHES, LONGEST = (0.01, 0.04, 0.12), 0.25
BESIDE = (-1.0, -0.5, 0.0, 0.5, 1.0)


@njit(cache=True)
def worn_play(drive, width, growth, onset, settled, at, last, travel):  # type: ignore[no-untyped-def]
    """The play operator, (n,), with a width that grows with the travel, and the travel in the end.

    onset: travel before which nothing grows; settled: over which growth fades, inf for never. at,
    last, travel: where the play, the drive and its travel were before.
    """
    out = np.empty(drive.size)
    for i in range(drive.size):
        travel += abs(drive[i] - last)
        last = drive[i]
        worn = max(travel - onset, 0.0)
        if settled < np.inf:
            worn = -settled * np.expm1(-worn / settled)
        half = 0.5 * (width + growth * worn)
        at = max(at, last - half) if last - half > at else min(at, last + half)
        out[i] = at
    return out, travel


@njit(cache=True)
def dragged(drive, width, reach, at, force):  # type: ignore[no-untyped-def]
    """The drive less half a width (n,) times a bristle's share, (n,), and that share in the end.

    at, force: where the drive and the share were before.
    """
    out = np.empty(drive.size)
    for i in range(drive.size):
        stiffness = 1.0 / max(reach, width[i], 1e-12)
        force = bristled(force, drive[i] - at, stiffness, 1.0, 1.0, 1.0)[0]
        at = drive[i]
        out[i] = at - 0.5 * width[i] * force
    return out, force


class TensionLoss(Term):
    """Play of a width that grows with the travel s of the drive: wear, or slackening.

    Forms: "linear" w = width + growth s; "late" w = width + growth max(s - onset, 0); "settling"
    w = width + growth settled (1 - exp(-s / settled)); "cycle" w = width + growth n, n being the
    number of the cycle. Forms "round" and "cycle round" grow as "linear" and "cycle", and their
    corners are round: a bank of plays whose widths lie up to a share `rounding` beside the whole.
    Forms "dragged" and "cycle dragged" grow so, too, of a wire that rubs: x = u - w / 2 z(u), with
    Dahl's bristle z over a `reach` no shorter than w, else the joint would move against the drive,
    nor so long that the wire hardly slips and what grows is its stretch.
    Each stands also "ahead of ripple", as `Backlash` does.
    Source: the play operator with a width that changes; banks of it (Prandtl, Ishlinskii); Dahl,
    AIAA J. 14 (1976) 1675; wear in proportion to the way slid (Archard, J. Appl. Phys. 24 (1953)
    981).
    """

    name = "tension_loss"
    site = "transmission"
    place = 40.0
    remembers = "way"
    evolves = True
    before_curve = True
    group = "play"
    far_apart = True
    unlikely = 3.0  # else chance would decide against play of one width
    grows: ClassVar = {
        f"{form}{ahead}": tuple(f"{richer}{ahead}" for richer in further)
        for form, further in (
            ("linear", ("late", "settling", "round", "dragged")),
            ("cycle", ("late", "settling", "cycle round", "cycle dragged")),
        )
        for ahead in ("", f" {AHEAD}")
    }
    means = "a wire that slackens: the loop's width grows from cycle to cycle"
    says = "The wire slackens: its play was {width} at the start and grows by {growth} of travel."

    def __init__(self, form: str = "linear") -> None:
        self.form = form
        ahead = form.endswith(AHEAD)
        self.place = BEFORE_RIPPLE if ahead else TensionLoss.place
        self.only_beside = TransmissionRipple.name if ahead else ""

    @property
    def in_usual_order(self) -> str:
        return self.form.removesuffix(AHEAD).rstrip()

    @property
    def kin(self) -> str:
        return "linear" if self.in_usual_order == "cycle" else self.in_usual_order

    def elsewhere(self) -> tuple[Term, ...]:
        return () if self.only_beside else (TensionLoss(f"{self.form} {AHEAD}"),)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        travel = around.travel
        most = span / travel
        growth = Parameter("growth", f"{unit}/{unit}", 0.0, 4.0 * most, 0.05 * most, 0.05 * most)
        if "cycle" in self.in_usual_order:
            each, a_cycle = span / max(around.cycles, 1), f"{unit}/cycle"
            growth = Parameter("growth_a_cycle", a_cycle, 0.0, 4 * each, 0.05 * each, 0.05 * each)
        own = (growth, Parameter("width", unit, 0.0, 0.8 * span, 0.02 * span, 0.05 * span))
        if self.in_usual_order == "late":
            return (*own, Parameter("onset", unit, 0.0, 0.9 * travel, 0.2 * travel, 0.0))
        if "dragged" in self.in_usual_order:
            return (*own, Parameter("reach", unit, 0.0, span, 0.05 * span, 0.05 * span))
        if "round" in self.in_usual_order:
            return (*own, Parameter("rounding", "", 0.0, 1.0, 0.5, 0.2))
        if self.in_usual_order == "settling":
            low, high = 0.05 * travel, 5.0 * travel
            return (*own, Parameter("settled", unit, low, high, 0.7 * travel, 0.0))
        return own

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if "dragged" in self.in_usual_order:
            return self.respond_dragged(signal, motion, values, state)
        growth, width, *more = values
        onset = more[0] if self.in_usual_order == "late" else 0.0
        settled = more[0] if self.in_usual_order == "settling" else np.inf
        parts = [1.0 + more[0] * k for k in BESIDE] if "round" in self.in_usual_order else [1.0]
        by_cycle = "cycle" in self.in_usual_order
        if state is None:
            begun = [*[signal[0]] * len(parts), signal[0], 0.0]
            state = np.array([*begun, motion.cycle[0]] if by_cycle else begun)
        last, travelled, *first = state[len(parts) :]
        plays, travel = [], travelled
        for part, at in zip(parts, state, strict=False):
            if by_cycle:
                half = 0.5 * part * (width + growth * (motion.cycle - first[0]))
                play = varying_play(signal, half, at)
            else:
                play, travel = worn_play(
                    signal, part * width, part * growth, onset, settled, at, last, travelled
                )
            plays.append(play)
        kept = np.array([*(play[-1] for play in plays), signal[-1], travel, *first])
        return (plays[0] if len(plays) == 1 else np.mean(plays, axis=0)), kept

    def respond_dragged(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `respond`, of a wire that rubs; state: drive, bristle, travel, the first cycle."""
        growth, width, reach = values
        begun = (signal[0], 0.0, 0.0, motion.cycle[0]) if state is None else state
        at, force, travelled, first = (float(v) for v in begun)
        travel = travelled + np.cumsum(np.abs(np.diff(signal, prepend=at)))
        grown = motion.cycle - first if "cycle" in self.in_usual_order else travel
        out, force = dragged(np.ascontiguousarray(signal), width + growth * grown, reach, at, force)
        return out, np.array([signal[-1], force, travel[-1], first])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        parts = around.cycles if "cycle" in self.in_usual_order else around.travel
        growths = around.drive_span / max(parts, 1e-9) * np.array([0.01, 0.05, 0.2])
        rows = [[g, w * around.drive_span] for g in growths for w in (0.0, 0.02, 0.06)]
        if self.in_usual_order in ("linear", "cycle"):
            return np.array(rows)
        if "round" in self.in_usual_order:
            return np.array([[*r, 0.5] for r in rows])
        if "dragged" in self.in_usual_order:
            return np.array([[*r, reach * around.drive_span] for r in rows for reach in REACHES])
        return np.array([[*r, s * around.travel] for r in rows for s in (0.15, 0.4)])

    def retold(self, starts: np.ndarray) -> np.ndarray:
        """Play that settles looks steady once it has: as wide by then, it may all have grown."""
        if self.in_usual_order != "settling":
            return starts
        sooner = starts * [1.0, 1.0, SOONER]
        grown = np.vstack([starts, sooner])
        grown[:, 0] += grown[:, 1] / grown[:, 2]
        grown[:, 1] = 0.0
        return np.vstack([starts, grown])

    def plainer(self, values: np.ndarray, shown: Shown) -> str:
        """Backlash where the growth is not worth a parameter, the course that it takes known.

        Friction where the wire rubs. Of a growth that is none nothing can be learnt of its course
        (Davies, Biometrika 64 (1977) 247), and with both free a growth that is surely there looks
        as if it might not be.
        """
        steady = Friction.name if "dragged" in self.in_usual_order else Backlash.name
        return self.name if shown.worth(0, range(2, len(values))) else steady

    def may_be_itself(self, values: np.ndarray, around: Surroundings, shown: Shown) -> bool:
        """Whether as much as MUCH of the width that it had in the end may have grown."""
        way = self.grown_a_growth(values, around)
        in_the_end = values[1] + values[0] * way
        return shown.most(0, range(2, len(values))) * way > MUCH * in_the_end

    def grown_a_growth(self, values: np.ndarray, around: Surroundings) -> float:
        """How much wider it got for each unit of its growth: the way or cycles that count."""
        if "cycle" in self.in_usual_order:
            return float(max(around.cycles - 1, 0))
        if self.in_usual_order == "late":
            return max(around.travel - values[2], 0.0)
        if self.in_usual_order == "settling":
            return float(-values[2] * np.expm1(-around.travel / values[2]))
        return around.travel

    def slight(self, values: np.ndarray, around: Surroundings) -> bool:
        dragged = "dragged" in self.in_usual_order
        return dragged and bool(values[2] > LONGEST * around.drive_span)

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        return around.cycles >= 2 and around.travel > 0.0

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if "cycle" not in self.in_usual_order:
            return super().sentence(values, around)
        unit = around.drive_unit
        return (
            f"The wire slackens: its play was {worded(values[1])} {unit} at the start and grows by "
            f"{worded(values[0])} {unit} with each cycle."
        )
