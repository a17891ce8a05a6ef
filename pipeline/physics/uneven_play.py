"""Play whose width goes with the pose: a gap that tapers or opens, teeth worn round one place."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.drive_play import DrivePlay
from pipeline.physics.force_units import FORCES, LENGTHS
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import varying_play
from pipeline.physics.term import Parameter, Surroundings, Term

TAPERED, WORN, OPENING = "tapered", "worn round", "opening"
FORMS = TAPERED, WORN
LEAST_LEFT, FARTHEST = 0.2, 0.35
LIKE_A_SHEATH = 3.0  # a stiff sheath's friction is the same signal, and likelier
TAPERS = (-0.6, -0.3, 0.3, 0.6)
UNWORN, PLACES, REACHES = (0.3, 0.6), (0.3, 0.5, 0.7), (0.1, 0.2)
OPENS, OVER, RARELY = (-0.9, 0.9), (0.03, 0.1), 10.0
NOTHING = 1e-3


class UnevenPlay(DrivePlay):
    """x_k = max(u_k - w(u_k)/2, min(u_k + w(u_k)/2, x_{k-1})), w(u) being one of three.

    Form "tapered": w = width (1 + taper (u - middle) / far), from the middle of the drive's range
    to its end at `far`: a pulley or a gear out of centre meshes deeper on one side of home, a wire
    slackens the further it is paid out. Friction that holds a share of a stiff wire's pull does the
    same, and is told as well. Form "worn round": w = width (unworn + (1 - unworn)
    exp(-((u - place) / reach)^2)), as teeth wear round where they are used most: never without play
    elsewhere, which would be a joint that snaps over there, nor over most of the range. Form
    "opening": w = width (1 + step tanh((u - place) / over)), as of teeth or a pin that is worn on
    one side, or a wire that only comes loose there: the catalogue has no name for where that is.
    It starts in the middle of its gap. Sources: the play operator with a width that changes,
    Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989), section 2; Archard, J. Appl.
    Phys. 24 (1953) 981 (wear in proportion to the way slid).
    """

    def __init__(self, form: str) -> None:
        self.form = form
        self.unlikely = {TAPERED: LIKE_A_SHEATH, OPENING: RARELY}.get(form, 0.0)
        self.also = ("friction",) if form == TAPERED else ()
        self.beyond = "how much wider the play is on one side" if form == OPENING else ""

    def richer(self) -> tuple[Term, ...]:
        return (UnevenPlay(OPENING),) if self.form == TAPERED else ()

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        span, unit = around.drive_span, around.drive_unit
        middle, far = around.drive_low + 0.5 * span, 0.5 * span
        width = self.width(around)
        if self.form == TAPERED:
            return (
                width,
                Parameter("taper", "", -1.0, 1.0, 0.0, 0.3),
                Parameter("middle", unit, middle, middle, middle, 0.0, weak=True),
                Parameter("far", unit, far, far, far, 0.0, weak=True),
            )
        low, high = around.drive_low, around.drive_low + span
        if self.form == OPENING:
            return (
                width,
                Parameter("step", "", -1.0, 1.0, 0.0, 0.5),
                Parameter("place", unit, low, high, middle, 0.2 * span),
                Parameter("over", unit, 0.01 * span, 0.3 * span, 0.05 * span, 0.05 * span),
            )
        return (
            width,
            Parameter("unworn", "", LEAST_LEFT, 1.0, 0.5, 0.0),
            Parameter("place", unit, low, high, middle, 0.2 * span),
            Parameter("reach", unit, 0.03 * span, FARTHEST * span, 0.2 * span, 0.1 * span),
        )

    def gap(self, drive: np.ndarray, values: np.ndarray) -> np.ndarray:
        """How wide the play is where the drive stands, (n,) [drive unit]."""
        if self.form == TAPERED:
            width, taper, middle, far = (float(v) for v in values)
            return np.maximum(width * (1.0 + taper * (drive - middle) / far), 0.0)
        if self.form == OPENING:
            width, step, place, over = (float(v) for v in values)
            return np.asarray(width * (1.0 + step * np.tanh((drive - place) / over)))
        width, unworn, place, reach = (float(v) for v in values)
        worn = np.exp(-(((drive - place) / reach) ** 2))
        return np.asarray(width * (unworn + (1.0 - unworn) * worn))

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        start = float(signal[0]) if state is None else float(state[0])
        out = varying_play(signal, 0.5 * self.gap(signal, values), start)
        return out, out[-1:].copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        span, low = around.drive_span, around.drive_low
        widths = span * np.array([0.01, 0.03, 0.1])
        if self.form == TAPERED:
            ends = low + 0.5 * span, 0.5 * span
            return np.array([[w, taper, *ends] for w in widths for taper in TAPERS])
        if self.form == OPENING:
            return np.array(
                [
                    [w, step, low + place * span, over * span]
                    for w in widths for step in OPENS for place in PLACES for over in OVER
                ]
            )  # fmt: skip
        return np.array(
            [
                [w, unworn, low + place * span, reach * span]
                for w in widths for unworn in UNWORN for place in PLACES for reach in REACHES
            ]
        )  # fmt: skip

    def excited(self, motion: Motion, around: Surroundings) -> bool:
        """No taper where a wire's pull or way goes in and comes out: that is its sheath's share."""
        units = around.drive_unit, around.angle_unit
        wire = any(kind.issuperset(units) for kind in (FORCES, LENGTHS))
        return around.drive_span > 0.0 and not (wire and self.form == TAPERED)

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        unit, span = around.drive_unit, around.drive_span
        drive = around.drive_low + span * np.linspace(0.0, 1.0, 101)
        gaps = self.gap(drive, values)
        gaps[gaps < NOTHING * gaps.max()] = 0.0
        most, least = int(np.argmax(gaps)), int(np.argmin(gaps))
        return (
            "The drive turns through play after each reversal before anything moves, "
            f"{worded(gaps[most])} {unit} of it at {worded(drive[most])} {unit}, "
            f"{worded(gaps[least])} {unit} at {worded(drive[least])} {unit}."
        )
