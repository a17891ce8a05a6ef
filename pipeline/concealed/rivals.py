"""Which names the data of a case can't tell apart: those that a diagnosis may state with reason.

Some can never be told by the contract of the diagnosis (`ALWAYS`, `PLAIN`: what bends one static
curve; a lag or a creep at one dwell). Others are found by fitting the plant with the rival's parts
to the effect: where even the best fit leaves less than `TOLD_APART`, twice the log-likelihood that
separates them, the rival is a true one. Effects larger than `TOLD_OVER_NOISE` are always told
apart then (twenty to forty draws of each pair), and a name that contains another as its limit
(growing play and play) is no rival of it: the simpler one is right. A rival's settings stay within
what the plant draws for it: with wider ones more would tie (slack that straightens over a degree
matches any hardening stretch), but no such thing is ever hidden.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from pipeline.concealed.draw import Case, Hidden
from pipeline.concealed.effects import Effect, Settings, place
from pipeline.concealed.motions import HELD_OUT, RECORDED_CYCLES, Motion
from pipeline.concealed.names import BENDS
from pipeline.concealed.plant import WIRE_STIFFNESS, respond
from pipeline.concealed.sizing import calibration_columns

IMPLIED = {"tension_loss": frozenset({"backlash"})}
ALWAYS = (BENDS,)
PLAIN = (
    frozenset({"friction", "creep"}),
    frozenset({"creep", "response_lag"}),
    frozenset({"backlash", "frame_lag"}),
    frozenset({"frame_lag", "response_lag"}),
)
CANDIDATES = {
    "backlash": ("friction", "creep", "frame_lag", "response_lag"),
    "friction": ("backlash", "creep", "frame_lag", "response_lag"),
    "creep": ("backlash", "friction", "frame_lag", "response_lag"),
    "response_lag": ("backlash", "friction", "creep", "frame_lag"),
    "frame_lag": ("backlash", "friction", "creep", "response_lag"),
    "tension_loss": ("backlash", "friction"),
    "contact": ("end_stop", "camera_tilt", "gravity", "lens_distortion"),
    "end_stop": ("contact",),
    "slack": ("compliance",),
    "compliance": ("slack",),
    "camera_tilt": ("contact",),
    "gravity": ("contact",),
    "lens_distortion": ("contact",),
    "lost_steps": ("drift",),
    "drift": ("lost_steps",),
}
TOLD_APART = 16.0
TOLD_OVER_NOISE = {"plain": 5.0, "rich": 1.5}
WHOLE_TORQUE = 2 * WIRE_STIFFNESS
TRIALS = 24
REFINED = 2
EVALUATIONS = 12


@dataclass(frozen=True)
class Form:
    """One way in which a rival may look: fixed settings, and free ones with their bounds.

    A free setting with a positive lower bound is searched for in its logarithm.
    """

    fixed: Settings
    free: dict[str, tuple[float, float]]

    def settings(self, unit: np.ndarray) -> Settings:
        """Settings at a point of the unit cube, shape (number of free settings,)."""
        found: Settings = dict(self.fixed)
        for u, (name, (low, high)) in zip(unit, self.free.items(), strict=True):
            found[name] = float(low * (high / low) ** u if low > 0 else low + u * (high - low))
        return found


def _forms(motion: Motion, top_deg: float) -> dict[str, list[Form]]:
    span = float(motion.time_s[-1])
    stiff: Settings = {"stop_stiffness": 40.0 * WHOLE_TORQUE}
    return {
        "backlash": [Form({}, {"clearance_deg": (0.02, 20.0)})],
        "friction": [
            Form(
                {},
                {
                    "sheath_torque": (0.005 * WHOLE_TORQUE, 12.0 * WHOLE_TORQUE),
                    "presliding_low_deg": (0.3, 1.5),
                    "presliding_high_deg": (1.8, 22.0),
                    "sheath_asymmetry": (-0.4, 0.4),
                },
            )
        ],
        "creep": [Form({}, {"dashpot_share": (0.001, 0.5), "dashpot_s": (8.0, 120.0)})],
        "response_lag": [
            Form({}, {"viscosity_s": (0.05, 12.0)}),
            Form({}, {"swing_s": (0.05, 8.0), "swing_damping": (0.2, 0.9)}),
        ],
        "frame_lag": [Form({}, {"stale_s": (0.05, 12.0)})],
        "contact": [
            Form(
                {"pad_side": side},
                {
                    "pad_stiffness": (0.2, 2.5 * WHOLE_TORQUE),
                    "pad_deg": (0.2 * top_deg, 0.7 * top_deg),
                },
            )
            for side in (-1.0, 1.0)
        ],
        "end_stop": [
            *(Form(stiff, {f"stop_{s}_deg": (0.4 * top_deg, top_deg)}) for s in ("high", "low")),
            Form(stiff, {f"stop_{s}_deg": (0.4 * top_deg, top_deg) for s in ("high", "low")}),
        ],
        "slack": [Form({}, {"pretension_deg": (-10.0, 0.0), "straightening_deg": (0.05, 0.3)})],
        "compliance": [
            Form(
                {"pretension_deg": 0.0},
                {"wire_softness": (0.2, 5.0), "toe_share": (0.1, 0.4), "toe_deg": (4.0, 14.0)},
            )
        ],
        "gravity": [Form({}, {"weight": (2.0, 900.0), "mounting_rad": (0.9, 2.2)})],
        "lens_distortion": [
            Form({}, {"barrel": (-0.6, 0.6), "centre_x_mm": (2.0, 6.0), "centre_y_mm": (-3.0, 3.0)})
        ],
        "camera_tilt": [
            Form({"perspective": 1.0}, {"tilt_deg": (2.0, 55.0), "tilt_axis_deg": (0.0, 180.0)})
        ],
        "lost_steps": [Form({}, {"slip_deg": (-20.0, 20.0), "slip_sample": (230.0, 1580.0)})],
        "drift": [
            Form({"wander_kind": "linear"}, {"wander_deg": (-20.0, 20.0)}),
            Form(
                {"wander_kind": "settling"},
                {"wander_deg": (-20.0, 20.0), "settle_s": (0.3 * span, 0.8 * span)},
            ),
        ],
    }


def rivals_of(case: Case, hidden: Hidden) -> list[str]:
    """Catalogue names that can't be told from this effect in this case, the names sorted."""
    name = hidden.effect.name
    never = ALWAYS + (PLAIN if case.excitation == "plain" else ())
    found = {other for group in never if name in group for other in group}
    if hidden.alone_over_noise < TOLD_OVER_NOISE[case.excitation]:
        maybe = set(CANDIDATES.get(name, ())) - found
        found |= {rival for rival in maybe if separation(case, hidden, rival) < TOLD_APART}
    return sorted(found - {name})


def separation(case: Case, hidden: Hidden, rival: str) -> float:
    """Twice the log-likelihood by which the training cycles prefer the effect to its best rival.

    Both act alone in the plant, but for what the simulation has itself; gain, offset, a declared
    curve and jittering zeros are refitted, and the noise is whitened with its true correlation.
    """
    motion, weight = _training(case, hidden)
    plant = case.bare()
    simulated = case.simulated_deg(motion)
    effect = respond(place(plant, hidden.effect, hidden.size), motion)
    whitened = _whitener(case, motion, weight, simulated)
    target = whitened(effect)
    top = float(np.abs(simulated).max())
    rng = np.random.default_rng([case.seed, 3])
    best = np.inf
    for form in _forms(motion, top)[rival]:

        def rest(unit: np.ndarray, form: Form = form) -> np.ndarray:
            other = place(plant, Effect(rival, form.settings(unit), (), 1.0), 1.0)
            return whitened(respond(other, motion)) - target

        best = min(best, _least(rest, len(form.free), rng))
    return best


def _least(rest: Callable[[np.ndarray], np.ndarray], count: int, rng: np.random.Generator) -> float:
    """Smallest sum of squares over the unit cube: random trials, the best ones refined."""
    points = rng.uniform(0.02, 0.98, (TRIALS, count))
    sums = np.array([np.sum(rest(p) ** 2) for p in points])
    least = float(sums.min())
    for index in np.argsort(sums)[:REFINED]:
        if least < TOLD_APART:
            break
        fit = least_squares(
            rest, points[index], bounds=(0.0, 1.0), diff_step=1e-3, max_nfev=EVALUATIONS
        )
        least = min(least, 2.0 * float(fit.cost))
    return least


def _training(case: Case, hidden: Hidden) -> tuple[Motion, np.ndarray]:
    """Motion on which the separation is judged, and how often each sample counts, (n,).

    Equal cycles of an effect that doesn't change with time are run once and counted as often as
    they are trained on.
    """
    repeats = case.excitation == "plain" and hidden.effect.name not in (
        "tension_loss", "lost_steps", "drift",
    )  # fmt: skip
    motion = case.motion.head(2 if repeats else RECORDED_CYCLES)
    trained = RECORDED_CYCLES - len(HELD_OUT)
    if repeats:
        return motion, np.where(motion.cycle == 0, 1.0, trained - 1.0)
    return motion, np.where(np.isin(motion.cycle, HELD_OUT), 0.0, 1.0)


def _whitener(
    case: Case, motion: Motion, weight: np.ndarray, simulated: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """A linear map after which noise is white and of unit size and calibration is gone.

    Gain, offset and curve are free; each cycle's zero is free as far as it jitters (a row each
    holds it to its deviation).
    """
    noise = case.noise
    scale = np.sqrt(weight) / (noise.sigma_deg * np.sqrt(1.0 - noise.correlation**2))
    cycles = np.unique(motion.cycle)

    def whiten(values: np.ndarray, held: np.ndarray) -> np.ndarray:
        before = np.vstack([np.zeros((1, values.shape[1])), values[:-1]])
        white = scale[:, None] * (values - noise.correlation * before)
        return np.vstack([white, held])

    columns = calibration_columns(simulated, case.tolerance_shape_deg > 0)
    free = whiten(columns, np.zeros((len(cycles), columns.shape[1])))
    if noise.jitter_deg > 0:
        zeros = (motion.cycle[:, None] == cycles).astype(float)
        free = np.hstack([free, whiten(zeros, np.eye(len(cycles)) / noise.jitter_deg)])
    basis, _ = np.linalg.qr(free)

    def whitened(values: np.ndarray) -> np.ndarray:
        flat = whiten(values[:, None], np.zeros((len(cycles), 1)))[:, 0]
        return np.asarray(flat - basis @ (basis.T @ flat))

    return whitened
