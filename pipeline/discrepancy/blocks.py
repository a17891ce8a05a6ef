"""Blocks of motion that an experiment may consist of, within the range that was recorded."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from pipeline.physics.held import STEP_AND_WAIT_S

MOST_ROWS_A_CYCLE = 400
HOLD_SAMPLES = 14
LARGE_STEPS = 5.0


@dataclass(frozen=True)
class Habit:
    """How a recording was driven: range and home of the drive, its step, and the dwell.

    others: (low, home, high) of each other command that moved.
    """

    low: float
    high: float
    home: float
    step: float
    dwell_s: float
    others: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)

    @property
    def waits(self) -> bool:
        """Whether the drive steps and waits, so that other steps and shorter waits do no harm."""
        return self.dwell_s >= STEP_AND_WAIT_S


@dataclass(frozen=True)
class Segment:
    """Samples in their order: drive, seconds before each, and the other commands, each (n,)."""

    drive: np.ndarray
    dwell_s: np.ndarray
    others: Mapping[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Block:
    """A motion with a name for people, as segments one after the other."""

    says: str
    segments: Sequence[Segment]


def habit_of(
    time_s: np.ndarray, drive: np.ndarray, others: Mapping[str, np.ndarray]
) -> Habit | None:
    """How a recording was driven; None where the drive never moved."""
    steps = np.abs(np.diff(drive))
    if not np.any(steps > 0):
        return None
    step = float(np.median(steps[steps > 0]))
    dwell_s = float(np.median(np.diff(time_s))) or 1.0
    rows = 2.0 * float(np.ptp(drive)) / step
    coarser = max(1.0, rows / MOST_ROWS_A_CYCLE)
    moved = {n: u for n, u in others.items() if np.ptp(u) > 0}
    return Habit(
        low=float(np.min(drive)),
        high=float(np.max(drive)),
        home=_home(drive, step),
        step=step * coarser,
        dwell_s=dwell_s * coarser,
        others={
            n: (float(u.min()), _home(u, 0.05 * float(np.ptp(u))), float(u.max()))
            for n, u in moved.items()
        },
    )


def _home(command: np.ndarray, step: float) -> float:
    """Where a command began; 0 where that is within two steps."""
    return 0.0 if abs(command[0]) <= 2.0 * step else float(command[0])


def blocks(habit: Habit) -> Iterator[Block]:
    """Every block worth weighing: usual cycles, between which a probe stands three times."""
    usual = full_cycle(habit)
    yield Block("the same cycles again", [usual] * 6)
    for says, probe in probes(habit):
        yield Block(f"usual cycles with {says} between them",
                    [usual, *probe, usual, usual, *probe, *probe])  # fmt: skip


def repeated(block: Block) -> Block:
    """The whole block twice."""
    return Block(f"{block.says}, all of it twice", [*block.segments, *block.segments])


def exploring(habit: Habit) -> Block:
    """Everything in one block: usual, small, slow and large-stepped cycles, and the other axes."""
    usual = full_cycle(habit)
    varied = [*nested_loops(habit, (0.5, 0.2)), full_cycle(habit, steps=4.0, dwell=5.0)]
    if habit.waits:
        varied.append(full_cycle(habit, steps=LARGE_STEPS))
    varied += [both(habit, name) for name in habit.others]
    says = "usual cycles with smaller, slower and coarser ones between them"
    return Block(says, [usual, *varied, usual, usual, *varied, *varied])


def probes(habit: Habit) -> Iterator[tuple[str, list[Segment]]]:
    """What may stand between usual cycles, each from home to home."""
    half = 0.5 * (habit.high - habit.low)
    middle = 0.5 * (habit.high + habit.low)
    yield "smaller and smaller loops", nested_loops(habit, (0.6, 0.35, 0.2, 0.1))
    yield "small loops", nested_loops(habit, (0.12, 0.06, 0.12, 0.06))
    ends = [middle + 0.5 * half, middle - 0.5 * half]
    for reach, size in ((0.08, "small"), (0.25, "medium")):
        yield f"{size} loops on both sides of home", [side_loops(habit, ends, reach * half)]
    yield "a slow cycle of long waits", [full_cycle(habit, steps=4.0, dwell=5.0)]
    yield "a small loop of long waits", [loop(habit, 0.25, dwell=4.0)]
    yield "a small loop of fine steps", [loop(habit, 0.15, steps=0.2)]
    yield "stops of many samples", [holds(habit)]
    if habit.waits:
        quick, slow = full_cycle(habit, dwell=0.3), full_cycle(habit, steps=4.0, dwell=5.0)
        large, fine = full_cycle(habit, steps=LARGE_STEPS), loop(habit, 0.08, steps=0.2)
        yield "a quick cycle of short waits", [quick]
        yield "a cycle of large steps", [large]
        says = "stops of many samples, a quick cycle and a small loop of fine steps"
        yield says, [holds(habit), quick, fine]
        yield "a quick, a slow and a large-stepped cycle", [quick, slow, large]
        small = nested_loops(habit, (0.35, 0.12))
        yield "small loops, a slow cycle and large steps", [*small, slow, large]
    for name in habit.others:
        yield f"{short(name)} moving alone", [other_alone(habit, name)]
        yield f"both axes moving ({short(name)} too)", [both(habit, name)]


def full_cycle(habit: Habit, steps: float = 1.0, dwell: float = 1.0) -> Segment:
    """Home, upper end, lower end, home; steps and dwells as multiples of the usual ones."""
    corners = [habit.home, habit.high, habit.low, habit.home]
    return path(corners, steps * habit.step, dwell * habit.dwell_s)


def loop(habit: Habit, reach: float, steps: float = 1.0, dwell: float = 1.0) -> Segment:
    """As a full cycle, over a share of the way to each end."""
    high = habit.home + reach * (habit.high - habit.home)
    low = habit.home + reach * (habit.low - habit.home)
    return path([habit.home, high, low, habit.home], steps * habit.step, dwell * habit.dwell_s)


def nested_loops(habit: Habit, reaches: Sequence[float]) -> list[Segment]:
    """Loops about home, one after the other."""
    return [loop(habit, reach) for reach in reaches]


def side_loops(habit: Habit, centres: Sequence[float], reach: float) -> Segment:
    """Two loops about each centre on the way of one large cycle."""
    corners = [habit.home]
    for centre in centres:
        way = 1.0 if centre >= habit.home else -1.0
        corners += [centre + way * reach, centre - way * reach] * 2 + [centre + way * reach]
    return path([*corners, habit.home], habit.step, habit.dwell_s)


def holds(habit: Habit) -> Segment:
    """To each end and back with many samples at each stop, half-way and there.

    A drive that waits goes there in large steps, but in no leaps: what stretches or hangs slack
    only then would be new.
    """
    high, low = habit.high - habit.home, habit.low - habit.home
    stops = [0.0, 0.5 * high, high, 0.5 * high, 0.0, 0.5 * low, low, 0.5 * low, 0.0]
    step = habit.step * (LARGE_STEPS if habit.waits else 1.0)
    parts = []
    for start, stop in pairwise(stops):
        way = path([habit.home + start, habit.home + stop], step, habit.dwell_s)
        parts += [way.drive, np.full(HOLD_SAMPLES, habit.home + stop)]
    drive = np.concatenate(parts)
    return Segment(drive, np.full(len(drive), habit.dwell_s))


def other_alone(habit: Habit, name: str) -> Segment:
    """A usual cycle, then another axis goes to its ends and back while the drive stands at home."""
    usual = full_cycle(habit)
    low, home, high = habit.others[name]
    count = max(len(usual.drive) // 2, 8)
    swing = np.interp(np.arange(1, count + 1) / count, [0.0, 0.25, 0.75, 1.0],
                      [home, high, low, home])  # fmt: skip
    drive = np.concatenate([usual.drive, np.full(count, habit.home)])
    other = np.concatenate([np.full(len(usual.drive), home), swing])
    return Segment(drive, np.full(len(drive), habit.dwell_s), {name: other})


def both(habit: Habit, name: str) -> Segment:
    """A usual cycle while another axis swings two and a half times and comes home."""
    usual = full_cycle(habit)
    low, home, high = habit.others[name]
    corners = [home, high, low, high, low, high, home]
    turn = np.arange(1, len(usual.drive) + 1) / len(usual.drive)
    swing = np.interp(turn, np.linspace(0.0, 1.0, len(corners)), corners)
    return Segment(usual.drive, usual.dwell_s, {name: swing})


def path(corners: Sequence[float], step: float, dwell_s: float) -> Segment:
    """From corner to corner in equal steps of at most `step`; the first corner is no sample."""
    parts = []
    for start, stop in pairwise(corners):
        count = int(np.ceil(abs(stop - start) / step - 1e-9))
        if count:
            parts.append(start + (stop - start) * np.arange(1, count + 1) / count)
    drive = np.concatenate(parts) if parts else np.array([corners[-1]])
    return Segment(drive, np.full(len(drive), dwell_s))


def short(channel: str) -> str:
    """`yaw` for `yaw_command_deg`."""
    return channel.partition("_command")[0] or channel
