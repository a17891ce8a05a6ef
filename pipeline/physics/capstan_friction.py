"""Wire friction in a sheath: what comes out of it is less than what is pulled, by a share."""

import numpy as np

from pipeline.physics.force_units import FORCES
from pipeline.physics.motion import Motion
from pipeline.physics.pre_sliding import dragging, sliding
from pipeline.physics.term import Parameter, Surroundings, Term

LEAST_PULL = 1e-9


class CapstanFriction(Term):
    """out = pull exp(-wrap z), z from -1 to 1 over the pre-sliding `reach` of log(pull).

    Where reach = wrap and spread = 0, a play in the logarithm: after each reversal nothing comes
    out until the pull has changed by a factor of exp(2 wrap). A wire that is not pulled
    counts as pulled by LEAST_PULL. wrap = friction coefficient times the angle that it is bent by.
    Form "capstan bristle": z is of one bristle over a `reach` of pull (see `pre_sliding.py`).
    Sources: capstan equation (Euler 1769; Eytelwein 1808); Kaneko et al., IEEE Trans. Robot.
    Autom. 7 (1991) 351 (tendon in a sheath); bank of sliders: `pre_sliding.py`.
    """

    name = "friction"
    site = "transmission"
    says = (
        "The sheath holds the wire back by a share of its pull: the two ways differ by a factor "
        "of exp(2 x {wrap})."
    )

    def __init__(self, form: str = "capstan") -> None:
        self.form = form

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        if self.form == "capstan bristle":
            span = around.drive_span
            return (
                Parameter("wrap", "", 0.0, 3.0, 0.2, 0.1),
                Parameter("reach", around.drive_unit, 1e-3 * span, span, 0.05 * span, 0.1 * span),
                Parameter("release", "", 0.0, 1.0, 0.8, 0.0),
            )
        return (
            Parameter("wrap", "", 0.0, 3.0, 0.2, 0.1),
            Parameter("reach", "", 1e-3, 6.0, 0.2, 0.1),
            Parameter("spread", "", 0.0, 1.0, 0.3, 0.3),
        )

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        wrap, reach, spread = (float(v) for v in values)
        if self.form == "capstan bristle":
            share, bent = dragging(signal, reach, spread, state)
            return signal * np.exp(-wrap * share), bent
        share, slid = sliding(np.log(np.maximum(signal, LEAST_PULL)), reach, spread, state)
        return signal * np.exp(-wrap * share), slid

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        if self.form == "capstan bristle":
            span = around.drive_span
            return np.array(
                [[w, r * span, 0.8] for w in (0.05, 0.2, 0.6) for r in (0.01, 0.05, 0.2)]
            )
        wraps = (0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
        return np.array([[w, w * r, 0.1] for w in wraps for r in (0.3, 1.0)])

    def scaled(self, values: np.ndarray, factor: float) -> np.ndarray:
        """The play in the logarithm stays one: its reach grows with its wrap."""
        out = super().scaled(values, factor)
        if self.form == "capstan":
            out[1] *= factor
        return out

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """Where a force goes in and a force comes out, and the wire is pulled all the time."""
        forces = around.drive_unit in FORCES and around.angle_unit in FORCES
        return forces and around.drive_span > 0.0 and around.angle_low > -0.05 * around.angle_span
