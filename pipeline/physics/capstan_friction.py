"""Wire friction in a sheath: what comes out of it is less than what is pulled, by a share."""

from typing import ClassVar

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.force_units import FORCES, LENGTHS
from pipeline.physics.motion import Motion
from pipeline.physics.pre_sliding import ELEMENTS, FASTEST, dragging, sliding
from pipeline.physics.term import Parameter, Surroundings, Term

LEAST_PULL = 1e-9
FAREST_HOME = 20.0
BENT = "capstan bent"


class CapstanFriction(Term):
    """out = pull exp(-wrap z), z from -1 to 1 over the pre-sliding `reach` of log(pull).

    Where reach = wrap and spread = 0, a play in the logarithm: after each reversal nothing comes
    out until the pull has changed by a factor of exp(2 wrap). It begins as it was tightened; form
    "capstan begun" begins anywhere between that (1) and as it was let go (-1). A wire that is not
    pulled counts as pulled by LEAST_PULL. wrap = friction coefficient times the angle that it is
    bent by.
    Form "capstan bent": the sheath is bent anew while it runs, its wrap going to `later` over the
    time `lasts` from `bent` on. The travel of log(pull) counts by how much it is bent, so that
    where reach = wrap it stays a play in the logarithm.
    Form "capstan bristle": z is of one bristle over a `reach` of pull (see `pre_sliding.py`). Form
    "pretensioned", where a way goes in and a spring pulls at the far end: pull = way + pretension,
    so that the loop is the wider the further the wire is pulled.
    Sources: capstan equation (Euler 1769; Eytelwein 1808); Kaneko et al., IEEE Trans. Robot.
    Autom. 7 (1991) 351 (tendon in a sheath); bank of sliders: `pre_sliding.py`.
    """

    name = "friction"
    site = "transmission"
    place = 60.0
    remembers = "way"
    grows: ClassVar = {"capstan": ("capstan begun", "capstan bristle", BENT)}
    says = (
        "The sheath holds the wire back by a share of its pull: the two ways differ by a factor "
        "of exp(2 x {wrap})."
    )

    says_of_pretensioned = (
        "The sheath holds the wire back by a share of its pull: the two ways differ by "
        "{percent:.2g} % of the way from where the wire would be slack, {pretension} from zero."
    )

    says_of_bent = (
        "The sheath holds the wire back by a share of its pull: the two ways differ by a factor "
        "of exp(2 x {wrap:.3g}) at first, and of exp(2 x {later:.3g}) once it was bent anew, over "
        "{lasts} s from {bent} s on."
    )

    def __init__(self, form: str = "capstan") -> None:
        self.form = form
        self.far_apart = form == BENT
        self.before_curve = form != "pretensioned"

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        if self.form == "capstan bristle":
            span = around.drive_span
            return (
                Parameter("wrap", "", 0.0, 3.0, 0.2, 0.1),
                Parameter("reach", around.drive_unit, 1e-3 * span, span, 0.05 * span, 0.1 * span),
                Parameter("release", "", 0.0, FASTEST, 0.8, 0.0),
            )
        own = (
            Parameter("wrap", "", 0.0, 3.0, 0.2, 0.1),
            Parameter("reach", "", 1e-3, 6.0, 0.2, 0.1),
            Parameter("spread", "", 0.0, 1.0, 0.3, 0.3),
        )
        if self.form == "capstan begun":
            return (*own, Parameter("begun", "", -1.0, 1.0, 0.0, 1.0))
        if self.form == BENT:
            lasts = max(around.end_s - around.start_s, 1e-9)
            return (
                *own,
                Parameter("later", "", 0.0, 3.0, 0.2, 0.1),
                Parameter("bent", "s", around.start_s, around.start_s + lasts, around.start_s, 0.0),
                Parameter("lasts", "s", 1e-3 * lasts, lasts, lasts, 0.0),
            )
        if self.form != "pretensioned":
            return own
        span, home = around.angle_span, -around.angle_low
        return (*own, Parameter("pretension", around.angle_unit, home + 1e-3 * span,
                                home + FAREST_HOME * span, home + 0.5 * span, span))  # fmt: skip

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        if self.form == BENT:
            return self.respond_bent(signal, motion, values, state)
        wrap, reach, spread = (float(v) for v in values[:3])
        if self.form == "capstan bristle":
            begin = np.append(signal[0], 1.0) if state is None else state
            share, bent = dragging(signal, reach, spread, begin)
            return signal * np.exp(-wrap * share), bent
        home = float(values[3]) if self.form == "pretensioned" else 0.0
        pull = signal + home
        if state is None and self.form != "pretensioned":
            begun = float(values[3]) if self.form == "capstan begun" else 1.0
            state = np.append(np.log(max(pull[0], LEAST_PULL)), np.full(ELEMENTS, begun))
        share, slid = sliding(np.log(np.maximum(pull, LEAST_PULL)), reach, spread, state)
        return pull * np.exp(-wrap * share) - home, slid

    def respond_bent(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """As `respond`, of a sheath that is bent anew; state: log(pull), then that of `sliding`."""
        wrap, reach, spread, later, bent, lasts = (float(v) for v in values)
        pull = np.log(np.maximum(signal, LEAST_PULL))
        if state is None:
            state = np.concatenate([pull[:1], [0.0], np.ones(ELEMENTS)])
        wraps = wrap + (later - wrap) * np.clip((motion.time_s - bent) / lasts, 0.0, 1.0)
        moved = np.diff(pull, prepend=state[0]) * wrap / np.maximum(wraps, LEAST_PULL)
        share, slid = sliding(state[1] + np.cumsum(moved), reach, spread, state[1:])
        return signal * np.exp(-wraps * share), np.concatenate([pull[-1:], slid])

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        if self.form == BENT:
            lasts = max(around.end_s - around.start_s, 1e-9)
            whens = [(0.0, 1.0), *((0.1 + 0.2 * k, how) for k in range(5) for how in (0.05, 0.3))]
            wraps = (0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
            return np.array(
                [
                    [wrap, wrap, 0.1, later, around.start_s + when * lasts, how * lasts]
                    for wrap in wraps for later in wraps for when, how in whens
                ]
            )  # fmt: skip
        if self.form == "capstan bristle":
            span = around.drive_span
            return np.array(
                [[w, r * span, 0.8] for w in (0.05, 0.2, 0.6) for r in (0.01, 0.05, 0.2)]
            )
        if self.form == "pretensioned":
            sizes = [(size, 0.5 + far) for size in (0.01, 0.04, 0.15) for far in (0.05, 0.5, 2.0)]
            span, home = around.angle_span, -around.angle_low - 0.5 * around.angle_span
            return np.array(
                [
                    [0.5 * size / far, 0.5 * size / far, 0.1, home + far * span]
                    for size, far in sizes
                ]
            )
        wraps = (0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
        begun = ((-1.0,), (0.0,), (1.0,)) if self.form == "capstan begun" else ((),)
        return np.array([[w, w * r, 0.1, *b] for w in wraps for r in (0.3, 1.0) for b in begun])

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """The play in the logarithm stays one: its reach grows with its wrap."""
        out = super().scaled(values, factor)
        if self.form != "capstan bristle":
            out[1] *= factor
        if self.form == BENT:
            out[3] *= factor
        return out

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a force goes in and a force comes out, and the wire is pulled all the time.

        A pretensioned one where a length goes in and a length comes out.
        """
        units = LENGTHS if self.form == "pretensioned" else FORCES
        alike = around.drive_unit in units and around.angle_unit in units
        taut = self.form == "pretensioned" or around.angle_low > -0.05 * around.angle_span
        return alike and around.drive_span > 0.0 and taut

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form == BENT:
            named = dict(zip((p.name for p in self.parameters(around)), values, strict=True))
            late = {name: worded(named[name]) for name in ("lasts", "bent")}
            return self.says_of_bent.format(**(named | late))
        if self.form != "pretensioned":
            return super().sentence(values, around)
        return self.says_of_pretensioned.format(
            percent=100.0 * float(np.expm1(2.0 * values[0])),
            pretension=f"{worded(abs(values[3]))} {around.angle_unit}",
        )
