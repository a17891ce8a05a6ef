"""Seeded random cases: which effects hide in them, how large, under what noise."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

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

SMALLEST, LARGEST = 0.7, 10.0
SMALLEST_OUTSIDE = 2.0
EFFECTS_OF = {"none": 0, "one": 1, "two": 2, "three": 3}
KINDS = (*EFFECTS_OF, "outside")
EXCITATIONS = ("plain", "rich")
BENDS = frozenset({"compliance", "gravity", "camera_tilt", "lens_distortion"})
EXCLUSIVE = (
    BENDS | {"slack"},
    frozenset({"contact", "end_stop", "slack"}),
    frozenset({"backlash", "friction", "tension_loss"}),
    frozenset({"lost_steps", "drift"}),
)
EXCLUSIVE_PLAIN = (
    frozenset({"backlash", "friction", "tension_loss", "creep", "frame_lag"}),
    BENDS | {"slack", "contact", "end_stop"},
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
            names = candidates(excitation) if kind != "outside" else _outside_names(excitation)
            queue.extend(str(name) for name in rng.permutation(names))
        turns.append(None if kind == "none" else queue.pop())
    return turns


def candidates(excitation: str) -> list[str]:
    """Names that a motion of this kind can show."""
    names = [*CATALOGUE, "marker_outliers"]
    return [name for name in names if excitation == "rich" or name != "coupling"]


def _outside_names(excitation: str) -> list[str]:
    return list(OUTSIDE if excitation == "rich" else OUTSIDE_PLAIN)


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
    noise = _noise(rng, walk=kind == "none" and rng.random() < 0.25)
    total = float(np.hypot(noise.sigma_deg, noise.jitter_deg))
    hidden: list[Hidden] = []
    for effect_name in names:
        outside = effect_name in OUTSIDE
        least = SMALLEST_OUTSIDE if outside else SMALLEST
        size = float(np.exp(rng.uniform(np.log(least), np.log(LARGEST))))
        if effect_name == "marker_outliers":
            noise = _mistakes(rng, noise, size * total)
            hidden.append(Hidden(Effect("marker_outliers", {}, (), 1.0), 1.0, size, size))
            continue
        effect = _effect(rng, motion, plant, effect_name)
        found = sized(effect, plant, motion.head(RECORDED_CYCLES), size * total)
        if found is None:
            return None
        hidden.append(Hidden(effect, found[0], found[1] / total, found[1] / total))
    bend, tolerance = _bend(rng, set(names), excitation)
    case = Case(
        name=name, kind=kind, excitation=excitation, motion=motion, nominal=nominal,
        hidden=tuple(hidden), noise=noise, gain_error=float(rng.uniform(-0.035, 0.035)),
        offset_deg=float(rng.uniform(-1.6, 1.6)), bend_deg=bend, tolerance_shape_deg=tolerance,
        homing_deg=homing, seed=seed,
    )  # fmt: skip
    case = _beside(case, total)
    if any(h.beside_over_noise < SMALLEST for h in case.hidden):
        return None
    return case


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


def sized(
    effect: Effect, plant: Plant, motion: Motion, rms_deg: float
) -> tuple[float, float] | None:
    """Size at which the effect stands out by `rms_deg`, and the rms reached; None if it can't."""
    before = respond(plant, motion)
    simulated = plant.nominal.angle_deg(motion.pitch_deg)
    size = 0.02 * effect.largest
    for _ in range(12):
        found = stands_out(respond(place(plant, effect, size), motion) - before, simulated)
        if abs(found / rms_deg - 1.0) < 0.03:
            return size, found
        change = float(np.clip((rms_deg / max(found, 1e-9)) ** 0.9, 0.1, 6.0))
        if size >= effect.largest and change > 1.0:
            return None
        size = min(size * change, effect.largest)
    return (size, found) if abs(found / rms_deg - 1.0) < 0.2 else None


def stands_out(change: np.ndarray, simulated: np.ndarray) -> float:
    """rms of a change of the angle after gain and offset are refitted; both (n,)."""
    columns = np.column_stack([np.ones(len(simulated)), simulated])
    rest = change - columns @ np.linalg.lstsq(columns, change, rcond=None)[0]
    return float(np.sqrt(np.mean(rest**2)))


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
        beside = stands_out(whole - respond(others.plant(), motion), simulated) / total
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


def _mistakes(rng: np.random.Generator, noise: Noise, rms_deg: float) -> Noise:
    """Few mistaken frames, each at least six deviations off, of that rms together."""
    least = 6.0 * noise.sigma_deg
    share = min(float(rng.uniform(0.004, 0.02)), (rms_deg / least) ** 2)
    size = rms_deg / np.sqrt(share)
    return replace(
        noise, mistaken_share=share, mistaken_deg=float(size), decoy=bool(rng.random() < 0.5)
    )


def _bend(
    rng: np.random.Generator, names: set[str], excitation: str
) -> tuple[tuple[float, float, float], float]:
    """A smooth error of the simulated curve in a quarter of the cases, and what to declare."""
    if rng.random() < 0.75 or names & (BENDS | {"slack"}) or names & set(OUTSIDE):
        return (0.0, 0.0, 0.0), 0.0
    weights = rng.standard_normal(3)
    size = float(rng.uniform(0.05, 0.3))
    bend = size * weights / np.linalg.norm(weights)
    return (float(bend[0]), float(bend[1]), float(bend[2])), round(1.5 * size + 0.02, 2)
