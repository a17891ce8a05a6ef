"""Play: lost motion with sharp corners after each reversal."""

import numpy as np

from pipeline.number_words import worded
from pipeline.physics.coasting_play import CoastingPlay
from pipeline.physics.drive_play import DrivePlay
from pipeline.physics.motion import Motion
from pipeline.physics.play_operator import play
from pipeline.physics.term import Parameter, Surroundings, Term
from pipeline.physics.transmission_ripple import TransmissionRipple
from pipeline.physics.uneven_play import FORMS, UnevenPlay
from pipeline.physics.yielding_play import YieldingPlay

AHEAD, PIN = "ahead of ripple", "pin"
BEFORE_RIPPLE, BEHIND_JOINT = TransmissionRipple.place - 5.0, 85.0


class Backlash(DrivePlay):
    """x_k = max(u_k - w/2, min(u_k + w/2, x_{k-1})), with the gap w in the drive's unit.

    It starts in the middle of its gap. Form "ahead of ripple" is play in a gear whose output shaft
    ripples, the other one behind what ripples. In form "pin" what the joint carries follows that
    through a gap of its angle, as wide wherever the joint is and whatever holds it. Source: the
    play operator, Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989), section 2.
    """

    means = "play: lost motion with sharp corners after each reversal"
    says = "The drive turns through {width} of play after each reversal before anything moves."
    says_of_pin = "What the joint carries turns through {width} of play after each reversal."

    def __init__(self, form: str = "") -> None:
        self.form = form
        self.before_curve = form != PIN
        self.place = {AHEAD: BEFORE_RIPPLE, PIN: BEHIND_JOINT}.get(form, Backlash.place)
        self.only_beside = TransmissionRipple.name if form == AHEAD else ""
        # Where the nominal curve is straight, chance would decide.
        self.unlikely = 1.0 if form == PIN else 0.0

    @property
    def in_usual_order(self) -> str:
        return self.form if self.form == PIN else ""

    @property
    def kin(self) -> str:
        return self.in_usual_order

    def elsewhere(self) -> tuple[Term, ...]:
        return () if self.form else (Backlash(AHEAD),)

    def richer(self) -> tuple[Term, ...]:
        if self.form:
            return ()
        return CoastingPlay(), YieldingPlay(), Backlash(PIN), *map(UnevenPlay, FORMS)

    def parameters(self, around: Surroundings) -> tuple[Parameter, ...]:
        unit, span = self.reach(around)
        return (Parameter("width", unit, 0.0, 0.9 * span, 0.05 * span, 0.05 * span),)

    def reach(self, around: Surroundings) -> tuple[str, float]:
        """Unit and range of what moves through the gap."""
        if self.form == PIN:
            return around.angle_unit, around.angle_span
        return around.drive_unit, around.drive_span

    def respond(
        self, signal: np.ndarray, motion: Motion, values: np.ndarray, state: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        start = float(signal[0]) if state is None else float(state[0])
        out = play(signal, 0.5 * float(values[0]), start)
        return out, out[-1:].copy()

    def candidates(self, motion: Motion, around: Surroundings) -> np.ndarray:
        return self.reach(around)[1] * np.array([[0.003], [0.01], [0.03], [0.07], [0.15], [0.3]])

    def sentence(self, values: np.ndarray, around: Surroundings) -> str:
        if self.form != PIN:
            return super().sentence(values, around)
        return self.says_of_pin.format(width=f"{worded(values[0])} {around.angle_unit}")
