"""Seeded random cases: which effects hide in them, how large, under what noise."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pipeline.concealed.beyond import left_over
from pipeline.concealed.effects import CATALOGUE, Effect, outside_effect, place
from pipeline.concealed.motions import (
    RECORDED_CYCLES,
    Motion,
    plain_motion,
    rich_motion,
)
from pipeline.concealed.noise import Noise
from pipeline.concealed.outside import OUTSIDE
from pipeline.concealed.plant import Nominal, Plant, respond
from pipeline.concealed.sizing import sized, stands_out

SMALLEST, LARGEST = 0.7, 10.0
SMALLEST_OUTSIDE = 2.0
SMALLEST_BEYOND = 1.0
SMALLEST_OF_SMALL = 0.03
EFFECTS_OF = {"none": 0, "walk": 0, "one": 1, "two": 2, "three": 3, "small": 1}
KINDS = (*EFFECTS_OF, "outside")
EXCITATIONS = ("plain", "rich")
BENDS = frozenset({"compliance", "gravity", "camera_tilt", "lens_distortion"})
KINKS = frozenset({"slack", "contact", "end_stop"})
EXCLUSIVE = (
    BENDS | {"slack"},
    frozenset({"contact", "end_stop"}),
    frozenset({"backlash", "friction", "tension_loss"}),
    frozenset({"lost_steps", "drift"}),
    frozenset({"creep", "response_lag", "frame_lag"}),
)
EXCLUSIVE_PLAIN = (
    frozenset({"backlash", "friction", "tension_loss", "creep", "response_lag", "frame_lag"}),
)
OUTSIDE_PLAIN = tuple(name for name in OUTSIDE if name != "step_resonance")


@dataclass(frozen=True)
class Hidden:
    """An effect at its size, and how far it stands out: rms over the noise, calibration refitted.

    `alone_over_noise` is against a plant without effects, `beside_over_noise` against the same
    plant without this one.
    """

    effect: Effect
    size: float
    alone_over_noise: float
    beside_over_noise: float


@dataclass(frozen=True)
class Case:
    """Everything that makes one concealed recording."""

    name: str
    kind: str
    excitation: str
    motion: Motion
    nominal: Nominal
    hidden: tuple[Hidden, ...]
    noise: Noise
    gain_error: float
    offset_deg: float
    bend_deg: tuple[float, float, float]
    tolerance_shape_deg: float
    homing_deg: float
    seed: int

    def plant(self) -> Plant:
        """The plant with all that is hidden."""
        plant = Plant(nominal=self.nominal, homing_deg=self.homing_deg)
        for hidden in self.hidden:
            plant = place(plant, hidden.effect, hidden.size)
        return plant


def draw_cases(seed: int, counts: Mapping[str, int]) -> list[Case]:
    """As many cases of each kind (`KINDS`) as asked, half of them plain; the same for a seed.

    `none` hides nothing, `walk` nothing but a zero that walks at random, `small` one effect below
    what a diagnosis must find, `outside` one for which the catalogue has no name.
    Kinds and excitations are mixed in the list, so that a name tells nothing.
    """
    wanted = [(k, EXCITATIONS[i % 2]) for k in KINDS for i in range(counts.get(k, 0))]
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(wanted))
    seeds = rng.integers(1, 2**62, size=len(wanted))
    turns = _turns(rng, wanted)
    cases: list[Case] = []
    for number, index in enumerate(order):
        kind, excitation = wanted[index]
        name = f"case-{number:03d}"
        cases.append(draw_case(int(seeds[index]), name, kind, excitation, turns[index]))
    return cases


def _turns(rng: np.random.Generator, wanted: list[tuple[str, str]]) -> list[str | None]:
    """First effect of each case: all names come equally often in each kind and excitation."""
    queues: dict[tuple[str, str], list[str]] = {}
    turns: list[str | None] = []
    for kind, excitation in wanted:
        queue = queues.setdefault((kind, excitation), [])
        if not queue:
            names = _first_names(kind, excitation)
            queue.extend(str(name) for name in rng.permutation(names))
        turns.append(queue.pop() if kind == "outside" or EFFECTS_OF[kind] else None)
    return turns


def candidates(excitation: str) -> list[str]:
    """Names that a motion of this kind can show."""
    names = [*CATALOGUE, "marker_outliers"]
    return [name for name in names if excitation == "rich" or name != "coupling"]


def _first_names(kind: str, excitation: str) -> list[str]:
    if kind == "outside":
        return list(OUTSIDE if excitation == "rich" else OUTSIDE_PLAIN)
    return [n for n in candidates(excitation) if kind != "small" or n != "marker_outliers"]


def draw_case(seed: int, name: str, kind: str, excitation: str, first: str | None) -> Case:
    """One case; drawn anew until each of its effects stands out by itself and beside the others."""
    rng = np.random.default_rng(seed)
    while True:
        case = _try_case(rng, seed, name, kind, excitation, first)
        if case is not None:
            return case


def _try_case(rng: np.random.Generator, seed: int, name: str, kind: str, excitation: str,
              first: str | None) -> Case | None:  # fmt: skip
    motion = plain_motion(rng) if excitation == "plain" else rich_motion(rng)
    nominal = Nominal(float(rng.uniform(0.66, 0.78)), float(rng.uniform(-3e-6, 5e-6)))
    homing = float(rng.choice([0.0, 0.0, rng.choice([-1.0, 1.0]) * rng.uniform(5.0, 30.0)]))
    plant = Plant(nominal=nominal, homing_deg=homing)
    names = _names(rng, kind, excitation, first)
    noise = _noise(rng, walk=kind == "walk")
    total = float(np.hypot(noise.sigma_deg, noise.jitter_deg))
    bend, tolerance = _bend(rng, kind, set(names))
    hidden: list[Hidden] = []
    for effect_name in names:
        least, most = (total * bound for bound in _bounds(kind, effect_name))
        if effect_name == "marker_outliers":
            rms = float(np.exp(rng.uniform(np.log(least), np.log(most))))
            noise = with_mistakes(rng, noise, rms)
            hidden.append(Hidden(Effect(effect_name, {}, (), 1.0), 1.0, rms / total, rms / total))
            continue
        effect = _effect(rng, motion, plant, effect_name)
        bends = _curve_is_free(effect_name, set(names), tolerance)
        found = sized(effect, plant, motion.head(RECORDED_CYCLES), least, most, bends, rng)
        if found is None:
            return None
        hidden.append(Hidden(effect, found[0], found[1] / total, found[1] / total))
    case = Case(
        name=name, kind=kind, excitation=excitation, motion=motion, nominal=nominal,
        hidden=tuple(hidden), noise=noise, gain_error=float(rng.uniform(-0.035, 0.035)),
        offset_deg=float(rng.uniform(-1.6, 1.6)), bend_deg=bend, tolerance_shape_deg=tolerance,
        homing_deg=homing, seed=seed,
    )  # fmt: skip
    case = _beside(case, total)
    if kind != "small" and any(h.beside_over_noise < SMALLEST for h in case.hidden):
        return None
    if kind == "outside" and _beyond_over_noise(case, total) < SMALLEST_BEYOND:
        return None
    return case


def _beyond_over_noise(case: Case, total: float) -> float:
    """What is left of the outside effect when catalogue effects have had their share."""
    motion = case.motion.head(RECORDED_CYCLES)
    inside = replace(case, hidden=tuple(h for h in case.hidden if h.effect.name not in OUTSIDE))
    change = respond(case.plant(), motion) - respond(inside.plant(), motion)
    rng = np.random.default_rng([case.seed, 2])
    return left_over(change, Plant(nominal=case.nominal), motion, rng) / total


def _curve_is_free(name: str, names: set[str], tolerance_deg: float) -> bool:
    """Whether a smooth curve is fitted beside the effect: declared, or bent by another one."""
    return tolerance_deg > 0 or (name in KINKS and bool(names & BENDS))


def _bounds(kind: str, name: str) -> tuple[float, float]:
    """Smallest and largest size over the noise."""
    if name in OUTSIDE:
        return SMALLEST_OUTSIDE, LARGEST
    return (SMALLEST_OF_SMALL, SMALLEST) if kind == "small" else (SMALLEST, LARGEST)


def _names(rng: np.random.Generator, kind: str, excitation: str, first: str | None) -> list[str]:
    """The effects of a case: `first`, and others that data of this kind can tell from it."""
    if first is None:
        return []
    wanted = EFFECTS_OF.get(kind, 2 if rng.random() < 0.25 else 1)
    names = [first]
    groups = EXCLUSIVE + (EXCLUSIVE_PLAIN if excitation == "plain" else ())
    for name in rng.permutation(candidates(excitation)):
        clash = any(name in group and set(names) & group for group in groups)
        if len(names) < wanted and str(name) not in names and not clash:
            names.append(str(name))
    return names


def _effect(rng: np.random.Generator, motion: Motion, plant: Plant, name: str) -> Effect:
    if name in OUTSIDE:
        return outside_effect(rng, motion, name)
    return CATALOGUE[name](rng, motion, plant)


def _beside(case: Case, total: float) -> Case:
    """The case with `beside_over_noise` found for each effect."""
    motion = case.motion.head(RECORDED_CYCLES)
    simulated = case.nominal.angle_deg(motion.pitch_deg)
    whole = respond(case.plant(), motion)
    hidden = []
    for h in case.hidden:
        if h.effect.name == "marker_outliers":
            hidden.append(h)
            continue
        others = replace(case, hidden=tuple(o for o in case.hidden if o is not h))
        names = {o.effect.name for o in case.hidden}
        bends = _curve_is_free(h.effect.name, names, case.tolerance_shape_deg)
        beside = stands_out(whole - respond(others.plant(), motion), simulated, bends) / total
        hidden.append(replace(h, beside_over_noise=beside))
    return replace(case, hidden=tuple(hidden))


def _noise(rng: np.random.Generator, walk: bool) -> Noise:
    """Half of the cases have correlated noise, half jitter, half lost frames."""
    sigma = float(rng.uniform(0.12, 0.32))
    half = rng.random(3) < 0.5
    return Noise(
        sigma_deg=sigma,
        correlation=float(rng.uniform(0.3, 0.8)) if half[0] else 0.0,
        jitter_deg=float(sigma * rng.uniform(0.1, 0.4)) if half[1] else 0.0,
        lost_share=float(rng.uniform(0.005, 0.04)) if half[2] else 0.0,
        walk_deg=float(sigma * rng.uniform(0.5, 2.0)) if walk else 0.0,
    )


def with_mistakes(rng: np.random.Generator, noise: Noise, rms_deg: float) -> Noise:
    """Few mistaken frames, each at least six deviations off, of that rms together."""
    least = 6.0 * noise.sigma_deg
    share = min(float(rng.uniform(0.004, 0.02)), (rms_deg / least) ** 2)
    size = rms_deg / np.sqrt(share)
    return replace(
        noise, mistaken_share=share, mistaken_deg=float(size), decoy=bool(rng.random() < 0.5)
    )


def _bend(
    rng: np.random.Generator, kind: str, names: set[str]
) -> tuple[tuple[float, float, float], float]:
    """A smooth error of the simulated curve in a quarter of the cases, and what to declare."""
    if rng.random() < 0.75 or names & (BENDS | {"slack"}) or kind == "outside":
        return (0.0, 0.0, 0.0), 0.0
    weights = rng.standard_normal(3)
    size = float(rng.uniform(0.05, 0.3))
    bend = size * weights / np.linalg.norm(weights)
    return (float(bend[0]), float(bend[1]), float(bend[2])), round(1.5 * size + 0.02, 2)
