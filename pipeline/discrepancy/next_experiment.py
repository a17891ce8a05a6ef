"""The next experiment: the block of motion that best separates explanations that tie."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
import pandas as pd
from scipy.special import ndtr

from pipeline.discrepancy.blocks import Block, Habit, blocks, exploring, habit_of, repeated
from pipeline.discrepancy.model.model import Hypothesis
from pipeline.discrepancy.model.result import Evidence
from pipeline.discrepancy.noise.noise import NoiseModel
from pipeline.number_words import worded
from pipeline.physics.catalogue import BENDS
from pipeline.physics.differentiation import differentiate
from pipeline.physics.force_units import position_behind
from pipeline.physics.frame_lag import FrameLag
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.piece import Piece

DECISIVE = 4.5
ENOUGH_POWER = 0.95
LONGER = 2.2
HOPELESS = 0.3
LEAST_PROBABILITY = 0.005
MOST_RIVALS = 4
DIFFERENCE = 1e-3
FREEDOM = 3.0


@dataclass(frozen=True)
class Proposal:
    """What to record next.

    commands: `time_s` and the commands under their recording names; None where no motion helps.
    why: in words. power: probability that the explanations which tie will be told apart; None
    where nothing ties and the block explores.
    """

    why: str
    commands: pd.DataFrame | None
    power: float | None


@dataclass(frozen=True)
class Weighed:
    """A block, its motion, and for each pair of rivals (p,): distance D and how far apart (rms)."""

    block: Block
    motion: Motion
    distance: np.ndarray
    apart: np.ndarray

    @property
    def power(self) -> np.ndarray:
        return np.array([power_of(float(distance)) for distance in self.distance])

    @property
    def minutes(self) -> float:
        return float(np.ptp(self.motion.time_s)) / 60.0


@dataclass(frozen=True)
class Reading:
    """A mechanism's answer (n,) to a block and its slopes (n, p), both also whitened.

    slopes: for one usual size of each parameter that may be refitted.
    """

    answer: np.ndarray
    slopes: np.ndarray
    white_answer: np.ndarray
    white_slopes: np.ndarray


def next_experiment(evidence: Evidence, verdict: str) -> Proposal | None:
    """What to record after a verdict; None where nothing is open or the drive never moved."""
    drive = Drive.of(evidence)
    if drive.habit is None or verdict == "no_mismatch":
        return None
    if verdict in ("partly_explained", "unknown_physics"):
        return explore(drive, drive.habit)
    rivals = rivals_of(evidence.hypotheses)
    if len(rivals) < 2 and verdict == "ambiguous":
        rivals = [*evidence.hypotheses[:2]]
    if len(rivals) > 1:
        return separate(evidence, drive, drive.habit, rivals)
    if verdict != "ambiguous":
        return None
    return Proposal("no motion would separate what bends one and the same curve", None, 0.0)


def separate(
    evidence: Evidence, drive: "Drive", habit: Habit, rivals: Sequence[Hypothesis]
) -> Proposal:
    """The block that best tells rivals (two or more) apart, not much longer than has to be.

    Each is taken as true in turn; how far another one, all its parameters and the calibration
    refitted, stays from it in whitened units, D, gives the log likelihood ratio N(D^2 / 2, D^2),
    and the power is the chance that it exceeds 4.5, the worst pair's counted (T-optimality:
    Atkinson and Fedorov, Biometrika 62, 1975). Pairs that no block separates are said, and left
    out. Blocks keep to the range that was recorded; one that would hardly decide runs twice.
    """
    weighed = [weigh(block, drive, evidence, rivals) for block in blocks(habit)]
    pairs = list(combinations(rivals, 2))
    hopeful = np.max([w.power for w in weighed], axis=0) >= HOPELESS
    alike = [pair for pair, hope in zip(pairs, hopeful, strict=True) if not hope]
    if not np.any(hopeful):
        return Proposal(f"no motion within the recorded range would {told_apart(rivals)}: "
                        + why_alike(rivals), None, 0.0)  # fmt: skip
    best = choice_of(weighed, hopeful)
    if best.power[hopeful].min() < ENOUGH_POWER:
        best = weigh(repeated(best.block), drive, evidence, rivals)
    apart = [pair for pair, hope in zip(pairs, hopeful, strict=True) if hope]
    power, rms = float(best.power[hopeful].min()), float(best.apart[hopeful].min())
    unit = evidence.recording.channel(evidence.measurement).unit
    who = told_apart_pairs(apart) if alike else told_apart(rivals)
    why = (
        f"would {who}: {best.block.says}, {length(best.minutes)}. "
        f"They would differ by {rms:.2g} {unit} there (noise {evidence.noise.deviation:.2g} "
        f"{unit}), which decides with a probability of {min(power, 0.99):.2f}"
    )
    if alike:
        why += f". No motion would {told_apart_pairs(alike)}"
    return Proposal(why, drive.table(best.block), power)


def explore(drive: "Drive", habit: Habit) -> Proposal:
    """A block that varies what a recording can vary, where no explanation fits."""
    block = exploring(habit)
    minutes = length(sum(float(s.dwell_s.sum()) for s in block.segments) / 60.0)
    why = f"would show what the unexplained rest depends on: {block.says}, {minutes}"
    return Proposal(why, drive.table(block), None)


def rivals_of(hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The likely explanations that have names and of which none only adds names to another.

    What only adds names to one stands for that where it is likelier.
    """
    likely = [h for h in hypotheses if h.probability >= LEAST_PROBABILITY and h.names]
    least = [h for h in likely if not any(set(o.names) < set(h.names) for o in likely)]
    fullest = []
    for one in least:
        rest = [set(h.names) for h in least if h.names != one.names]
        more = [h for h in likely if set(h.names) > set(one.names)]
        own = [h for h in more if not any(names <= set(h.names) for names in rest)]
        fullest.append(max([one, *own], key=lambda h: h.probability))
    return sorted(fullest, key=lambda h: -h.probability)[:MOST_RIVALS]


@dataclass(frozen=True)
class Drive:
    """How commands make the drive of a mechanism: the command itself, or a trace that follows it.

    leader: the command that drives most. weights: what each command adds to the drive, with
    `offset`, where a simulation's trace drives. beside: commands that terms see as other ones.
    unit: the leader's.
    """

    leader: str
    habit: Habit | None
    names: Sequence[str]
    homes: Mapping[str, float]
    weights: Mapping[str, float]
    offset: float
    beside: Sequence[str]
    radian: float
    zeros: Mapping[str, float]
    begin_s: float
    cycle: int
    force: bool
    unit: str

    @staticmethod
    def of(evidence: Evidence) -> "Drive":
        """From the recording and the motion that the hypotheses were fitted to."""
        recording, motion = evidence.recording, evidence.motion
        commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
        weights, offset = {evidence.drive: 1.0}, 0.0
        if evidence.drive not in commands or not evidence.static:
            columns = np.column_stack([*commands.values(), np.ones(len(motion))])
            solved = np.linalg.lstsq(columns, motion.drive, rcond=None)[0]
            weights, offset = dict(zip(commands, solved[:-1], strict=True)), float(solved[-1])
        leader = max(weights, key=lambda n: abs(weights[n]) * float(np.ptp(commands[n])))
        others = {n: u for n, u in commands.items() if n != leader}
        habit = habit_of(motion.time_s, commands[leader], others)
        moved = habit.others if habit else {}
        return Drive(
            leader=leader,
            habit=habit,
            names=tuple(commands),
            homes={n: moved[n][1] if n in moved else float(u[0]) for n, u in commands.items()},
            weights=weights,
            offset=offset,
            beside=tuple(motion.others),
            radian=motion.radian,
            zeros=motion.zeros,
            begin_s=float(motion.time_s[-1]),
            cycle=int(motion.cycle[-1]) + 1,
            force=motion.kinetics is not None,
            unit=recording.channel(leader).unit,
        )

    def table(self, block: Block) -> pd.DataFrame:
        """`time_s` from 0 and every command, a row for each sample."""
        dwell_s = np.concatenate([s.dwell_s for s in block.segments])
        time_s = np.cumsum(dwell_s) - dwell_s[0]
        columns = {"time_s": np.round(time_s, digits(float(dwell_s.min()), 3))}
        for name in self.names:
            still = self.homes[name]
            parts = [
                s.drive if name == self.leader else s.others.get(name, np.full(len(s.drive), still))
                for s in block.segments
            ]
            column = np.concatenate(parts)
            columns[name] = np.round(column, digits(float(np.ptp(column)), 6))
        return pd.DataFrame(columns)

    def motion(self, block: Block) -> Motion:
        """What the block would put into a mechanism, in time after the recording."""
        table = self.table(block)
        drive = sum((w * table[n].to_numpy() for n, w in self.weights.items()),
                    np.full(len(table), self.offset))  # fmt: skip
        cycle = np.repeat(np.arange(len(block.segments)), [len(s.drive) for s in block.segments])
        kinetics = None
        if self.force:
            drive = position_behind(table["time_s"].to_numpy(), drive, self.unit)
            found = differentiate(table["time_s"].to_numpy(), drive, np.inf)
            kinetics = Kinetics(found.velocity, found.acceleration, np.zeros(len(drive)))
        return Motion(
            drive=np.ascontiguousarray(drive),
            time_s=table["time_s"].to_numpy() + self.begin_s,
            cycle=self.cycle + cycle,
            others={n: table[n].to_numpy() for n in self.beside},
            radian=self.radian,
            zeros=self.zeros,
            kinetics=kinetics,
        )


def digits(size: float, least: int) -> int:
    """Decimals that leave a size its first six digits or more, and at least so many."""
    return max(least, 5 - math.floor(math.log10(size))) if size > 0.0 else least


def weigh(block: Block, drive: Drive, evidence: Evidence, rivals: Sequence[Hypothesis]) -> Weighed:
    """What a block would tell of each pair of rivals, the worse way round, in their worst forms."""
    motion, dwell_s = drive.motion(block), float(np.median(np.diff(evidence.motion.time_s)))
    readings = [
        [
            reading_of(m.respond(motion)[0], slopes_of(m, motion), evidence.noise, motion)
            for form in (rival.mechanism, *rival.forms)
            for m in readings_of(form, dwell_s)
        ]
        for rival in rivals
    ]
    found = [
        min(w for one, other in product(*pair) for w in (apart(one, other), apart(other, one)))
        for pair in combinations(readings, 2)
    ]
    distance, rms = np.array(found).T
    return Weighed(block, motion, distance, rms)


def readings_of(mechanism: Mechanism, dwell_s: float) -> list[Mechanism]:
    """A mechanism, and the same with frames that are late by a count: alike at one dwell [s]."""
    late = [p for p in mechanism.pieces if isinstance(p.term, FrameLag) and p.term.form == "time"]
    if not late or dwell_s <= 0.0:
        return [mechanism]
    counted = Piece(FrameLag("frames"), late[0].values / dwell_s)
    pieces = tuple(counted if p is late[0] else p for p in mechanism.pieces)
    return [mechanism, replace(mechanism, pieces=pieces)]


def reading_of(
    answer: np.ndarray, slopes: np.ndarray, noise: NoiseModel, motion: Motion
) -> Reading:
    """An answer (n,) and its slopes (n, p) with the same whitened."""
    used = np.ones(len(answer), dtype=bool)
    white = noise.whiten(np.column_stack([answer, slopes]), motion.cycle, used, motion.stands)
    return Reading(answer, slopes, white[:, 0], white[:, 1:])


def apart(one: Reading, other: Reading) -> tuple[float, float]:
    """How far one answer, refitted, stays from another: whitened length, and rms in its unit."""
    difference, white = other.answer - one.answer, other.white_answer - one.white_answer
    normal = one.white_slopes.T @ one.white_slopes
    normal.flat[:: len(normal) + 1] += 1.0 / FREEDOM**2
    refit = np.linalg.solve(normal, one.white_slopes.T @ white)
    left = difference - one.slopes @ refit
    rest = white - one.white_slopes @ refit
    distance = np.sqrt(rest @ rest + refit @ refit / FREEDOM**2)
    return float(distance), float(np.sqrt(np.mean(left**2)))


def power_of(distance: float) -> float:
    """Chance that a log likelihood ratio N(D^2 / 2, D^2) exceeds what decides."""
    if distance <= 0.0:
        return 0.0
    return float(ndtr(0.5 * distance - DECISIVE / distance))


def slopes_of(mechanism: Mechanism, motion: Motion) -> np.ndarray:
    """Change of the answer, (n, p), for a usual size of gain, offset and each parameter."""
    answer = mechanism.respond(motion)[0]
    columns = [answer - np.mean(answer), np.ones(len(answer)) * max(float(np.std(answer)), 1e-9)]
    for place, piece in enumerate(mechanism.pieces):
        for k, value in enumerate(piece.values):
            size = abs(float(value)) or 1.0
            values = piece.values.copy()
            values[k] += DIFFERENCE * size
            pieces = list(mechanism.pieces)
            pieces[place] = Piece(piece.term, values)
            moved = replace(mechanism, pieces=tuple(pieces)).respond(motion)[0]
            columns.append((moved - answer) / DIFFERENCE)
    out = np.column_stack(columns)
    return np.where(np.isfinite(out), out, 0.0)


def choice_of(weighed: Sequence[Weighed], pairs: np.ndarray) -> Weighed:
    """What tells the wanted pairs (mask) farthest apart, not much longer than the shortest block.

    A rival has other forms than the one that is weighed, and the real thing has none of them: what
    just suffices on paper does not. The most powerful block where none is powerful enough.
    """
    enough = [w for w in weighed if w.power[pairs].min() >= ENOUGH_POWER]
    if not enough:
        return max(weighed, key=lambda w: (w.power[pairs].min(), w.apart[pairs].min()))
    longest = LONGER * min(w.minutes for w in enough)
    return max((w for w in enough if w.minutes <= longest), key=lambda w: w.distance[pairs].min())


def told_apart(rivals: Sequence[Hypothesis]) -> str:
    """`separate backlash from friction`: the names in which rivals differ.

    `show whether friction is there, too` of two, where one has only more names.
    """
    shared = set.intersection(*(set(r.names) for r in rivals))
    own = list(dict.fromkeys(" with ".join(sorted(set(r.names) - shared)) for r in rivals))
    first, *others = own
    if len(own) == 2 and "" in own:
        return f"show whether {first or others[0]} is there, too"
    rest = " and ".join(other or "nothing" for other in others or own)
    return f"separate {first or 'nothing'} from {rest}"


def told_apart_pairs(pairs: Sequence[tuple[Hypothesis, Hypothesis]]) -> str:
    """As `told_apart`, for pairs; those of the first rival are said together."""
    first = pairs[0][0]
    together = [other for one, other in pairs if one is first]
    rest = [pair for pair in pairs if pair[0] is not first]
    words = told_apart([first, *together])
    return f"{words}, {told_apart_pairs(rest).removeprefix('separate ')}" if rest else words


def why_alike(rivals: Sequence[Hypothesis]) -> str:
    """Why no motion helps, and what would."""
    shared = set.intersection(*(set(r.names) for r in rivals))
    if all(set(r.names) - shared <= set(BENDS) for r in rivals):
        return "each bends the same curve; turn the camera or change the load"
    return "they answer alike to all that was tried"


def length(minutes: float) -> str:
    """`52 minutes`, `1.8 hours` or `40 s`."""
    if minutes >= 100.0:
        return f"{minutes / 60.0:.1f} hours"
    return f"{minutes:.0f} minutes" if minutes >= 2.0 else f"{worded(60.0 * minutes)} s"
