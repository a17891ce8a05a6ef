"""Seeded random cases: which effects hide in them, how large, under what noise."""

from collections.abc import Iterable, Mapping
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
from pipeline.concealed.names import (
    BENDS,
    EXCITATIONS,
    KINDS,
    KINKS,
    first_names,
    further_names,
    known_names,
)
from pipeline.concealed.noise import Noise
from pipeline.concealed.outside import OUTSIDE
from pipeline.concealed.plant import Nominal, Plant, respond
from pipeline.concealed.sizing import sized, stands_out

SMALLEST, LARGEST = 0.7, 10.0
SMALLEST_OUTSIDE = 2.0
SMALLEST_BEYOND = 1.0
SMALLEST_OF_SMALL = 0.03
SMALLEST_KNOWN = 1.0


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
    """Everything that makes one concealed recording.

    `known` is what the simulation has as well, so that it runs a loop of its own.
    """

    name: str
    kind: str
    excitation: str
    motion: Motion
    nominal: Nominal
    known: tuple[Hidden, ...]
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
        return with_effects(self.bare(), self.hidden)

    def bare(self) -> Plant:
        """The plant with no more than the simulation knows."""
        return with_effects(Plant(nominal=self.nominal, homing_deg=self.homing_deg), self.known)

    def simulated_deg(self, motion: Motion) -> np.ndarray:
        """What the simulation says [deg], (n,): it begins at rest, at home."""
        if not self.known:
            return self.nominal.angle_deg(motion.pitch_deg)
        return respond(replace(self.bare(), homing_deg=0.0), motion)


def with_effects(plant: Plant, effects: Iterable[Hidden]) -> Plant:
    """The plant with some effects at their sizes."""
    for hidden in effects:
        plant = place(plant, hidden.effect, hidden.size)
    return plant


def draw_cases(seed: int, counts: Mapping[str, int]) -> list[Case]:
    """As many cases of each kind (`KINDS`) as asked, half of them plain; the same for a seed.

    `none` hides nothing, `walk` nothing but a zero that walks at random, `small` one effect below
    what a diagnosis must find, `outside` one for which the catalogue has no name. Of `known_none`
    and `known_one` the simulation has an effect itself.
    Kinds and excitations are mixed in the list, so that a name tells nothing.
    """
    wanted = [(k, EXCITATIONS[i % 2]) for k in KINDS for i in range(counts.get(k, 0))]
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(wanted))
    seeds = rng.integers(1, 2**62, size=len(wanted))
    turns = first_names(rng, wanted)
    cases: list[Case] = []
    for number, index in enumerate(order):
        kind, excitation = wanted[index]
        name = f"case-{number:03d}"
        cases.append(draw_case(int(seeds[index]), name, kind, excitation, turns[index]))
    return cases


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
    names = further_names(rng, kind, excitation, first)
    noise = _noise(rng, walk=kind == "walk")
    total = float(np.hypot(noise.sigma_deg, noise.jitter_deg))
    bend, tolerance = _bend(rng, kind, set(names))
    known: list[Hidden] = []
    for own in known_names(rng, kind, excitation, names):
        found = _sized(rng, motion, plant, own, total, (SMALLEST_KNOWN, LARGEST), bends=False)
        if found is None:
            return None
        known.append(found)
    hidden: list[Hidden] = []
    for effect_name in names:
        bounds = _bounds(kind, effect_name)
        if effect_name == "marker_outliers":
            over = float(np.exp(rng.uniform(*np.log(bounds))))
            noise = with_mistakes(rng, noise, over * total)
            hidden.append(Hidden(Effect(effect_name, {}, (), 1.0), 1.0, over, over))
            continue
        bends = _curve_is_free(effect_name, set(names), tolerance)
        found = _sized(rng, motion, plant, effect_name, total, bounds, bends)
        if found is None:
            return None
        hidden.append(found)
    case = Case(
        name=name, kind=kind, excitation=excitation, motion=motion, nominal=nominal,
        known=tuple(known), hidden=tuple(hidden), noise=noise,
        gain_error=float(rng.uniform(-0.035, 0.035)), offset_deg=float(rng.uniform(-1.6, 1.6)),
        bend_deg=bend, tolerance_shape_deg=tolerance, homing_deg=homing, seed=seed,
    )  # fmt: skip
    case = _beside(case, total)
    if kind != "small" and any(h.beside_over_noise < SMALLEST for h in case.hidden):
        return None
    if kind == "outside" and _beyond_over_noise(case, total) < SMALLEST_BEYOND:
        return None
    return case


def _sized(rng: np.random.Generator, motion: Motion, plant: Plant, name: str, total_deg: float,
           bounds: tuple[float, float], bends: bool) -> Hidden | None:  # fmt: skip
    """An effect on a plant, its rms within bounds over the noise; None where it can't have any."""
    effect = _effect(rng, motion, plant, name)
    least, most = (total_deg * bound for bound in bounds)
    found = sized(effect, plant, motion.head(RECORDED_CYCLES), least, most, bends, rng)
    if found is None:
        return None
    size, rms = found
    return Hidden(effect, size, rms / total_deg, rms / total_deg)


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


def _effect(rng: np.random.Generator, motion: Motion, plant: Plant, name: str) -> Effect:
    if name in OUTSIDE:
        return outside_effect(rng, motion, name)
    return CATALOGUE[name](rng, motion, plant)


def _beside(case: Case, total: float) -> Case:
    """The case with `beside_over_noise` found for each effect."""
    motion = case.motion.head(RECORDED_CYCLES)
    simulated = case.simulated_deg(motion)
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
