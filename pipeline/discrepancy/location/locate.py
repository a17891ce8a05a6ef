"""Where a residual lies: the share that each coordinate explains, how surely, and in words."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from pipeline.discrepancy.location import coordinates as along
from pipeline.discrepancy.location.coordinates import Ground, ground_of
from pipeline.discrepancy.location.where import Profile, Scene, describe, describe_spikes
from pipeline.discrepancy.noise.serial import (
    SerialNoise,
    fit_serial_noise,
    lengths,
    orthonormal,
    without,
)
from pipeline.discrepancy.problem.spikes import Spikes, lone_spikes
from pipeline.physics.motion import Motion

SIGNIFICANT = 0.05
LEAST_SHARE = 0.005
FEWEST_SAMPLES = 40
FEWEST_FOR_DETAIL = 600
MOST_ROWS = 4000
LEAST_P = 1e-12
ORDER_DRAWS = 2000
MOST_CYCLES = 24
BETWEEN_CYCLES = ("time", "cycle")
TRAVEL_ALONE, TRAVEL_AFTER_DIRECTION = 0.3, 0.6


@dataclass(frozen=True)
class Located:
    """One coordinate's part in a residual.

    share: of the residual's sum of squares, what noise alone would have given taken off, and
    beyond the coordinates that go before it (see `locate`). p_value: of no part at all, adjusted
    for the number of coordinates (Holm). where: in words, None where the part is not sure.
    """

    coordinate: str
    share: float
    p_value: float
    where: str | None
    profile: Profile


@dataclass(frozen=True)
class Part:
    """A tested coordinate: sum of squares beyond noise, its own p, and its say on each row (m,)."""

    coordinate: str
    squares: float
    p_value: float
    fitted: np.ndarray


def locate(
    residual: np.ndarray, motion: Motion, position: np.ndarray, unit: str, drive_unit: str
) -> list[Located]:
    """Coordinates that the motion varies, largest share first; none below 40 measured samples.

    residual: (n,) measurement minus simulation [unit], NaN where not measured. position: (n,) the
    simulated measurement; the residual's offset and its gain on `position` are taken out first.

    The coordinate that explains most (time, cycle and travel, which catch much, must explain more)
    among those that do so surely is taken out first, and the
    others are judged by what is then left; so shares add up to at most 1, and one cause is not
    reported under many names. Tests are F tests of piecewise linear functions after whitening by
    the noise that is left beside all of them together (`serial.py`), with each cycle's own offset
    free: neither correlation nor a zero that jitters from cycle to cycle passes for structure.
    What differs between cycles is tested against their scatter. A zero that wanders is structure
    over time, and noise to every other coordinate. The tests of one coordinate are joined by
    Cauchy's combination (Liu and Xie, J. Am. Stat. Assoc. 115, 2020), all by Holm's.
    """
    known = np.flatnonzero(np.isfinite(residual))
    if len(known) < FEWEST_SAMPLES:
        return []
    spikes = lone_spikes(residual[known])
    rows, values, row = thinned(residual, known[~spikes.lone])
    ground = ground_of(motion, position).rows(rows)
    work = Work(ground, values, row)
    parts = parts_of(work)
    spiked = float(np.sum(spikes.height[spikes.lone] ** 2))
    if np.any(spikes.lone):
        heights = np.where(spikes.lone, spikes.height, 0.0)
        parts.append(
            Part(
                "single_frames",
                spiked * len(rows) / len(known),
                max(spikes.p_value, LEAST_P),
                heights,
            )
        )
    scene = Scene(ground, values, unit, drive_unit)
    return _located(parts, work, scene, spikes)


class _Columns:
    """One test's columns, as they are and whitened, clear of all that was taken out so far."""

    def __init__(self, raw: np.ndarray, white: np.ndarray) -> None:
        self.raw, self.white = raw, white
        self.raw_length, self.white_length = lengths(raw), lengths(white)

    def clear_of(self, raw_basis: np.ndarray, white_basis: np.ndarray) -> None:
        self.raw = without(self.raw, raw_basis)
        self.white = without(self.white, white_basis)

    def raw_basis(self) -> np.ndarray:
        return orthonormal(self.raw, self.raw_length)

    def white_basis(self) -> np.ndarray:
        return orthonormal(self.white, self.white_length)


class Work:
    """A residual, raw and whitened, and the coordinates that wait to explain what is left of it.

    ground: coordinates of the m rows. values: (m,) residual. row: (m,) row numbers that tell where
    rows are missing in between.
    """

    def __init__(self, ground: Ground, values: np.ndarray, row: np.ndarray) -> None:
        self.row = row
        self.cycles = along.cycle_columns(coarse_cycles(ground.cycle))
        bases = bases_of(ground, self.cycles, detail=len(values) >= FEWEST_FOR_DETAIL)
        calibration = np.column_stack([np.ones(len(values)), _steady(ground.position)])
        nuisance = np.hstack([calibration, self.cycles])
        quick = np.hstack(
            [nuisance, *(b for c, each in bases.items() if c != "time" for b in each)]
        )
        self.noise = fit_serial_noise(values, row, quick)
        whole = np.hstack([quick, *bases.get("time", [])])
        self.freedom = len(values) - orthonormal(whole).shape[1]
        self.left, self.white_left = values, self._white(values[:, None])[:, 0]
        self.waiting = {
            coordinate: [_Columns(basis, self._white(basis)) for basis in each]
            for coordinate, each in bases.items()
        }
        self._take_out(orthonormal(calibration), orthonormal(self._white(nuisance)))
        self.squares = float(self.left @ self.left)
        slow = np.hstack([np.zeros((len(values), 0)), *bases.get("time", [])])
        self.noise_beside_time, self.time_p_value = _time_test(values, row, quick, slow)

    def part(self, coordinate: str) -> Part:
        """What a waiting coordinate explains of what is left."""
        columns = self.waiting[coordinate]
        basis = columns[0].raw_basis()
        for further in columns[1:]:
            basis = np.hstack([basis, orthonormal(without(further.raw, basis), further.raw_length)])
        fitted = basis @ (basis.T @ self.left)
        noise = self.noise_beside_time if coordinate in BETWEEN_CYCLES else self.noise
        expected = noise.sigma**2 * noise.excess(basis, self.row)
        tests = (
            [self._test(each) for each in columns] if coordinate != "time" else [self.time_p_value]
        )
        untouched = all(c in self.waiting for c in BETWEEN_CYCLES)
        if coordinate in BETWEEN_CYCLES and untouched and self.cycles.shape[1] >= 3:
            tests.append(order_p_value(self.cycles.T @ self.left / self.cycles.sum(axis=0)))
        squares = max(0.0, float(fitted @ fitted) - expected)
        return Part(coordinate, squares, combined(tests), fitted)

    def take(self, coordinate: str) -> None:
        """Leave what a coordinate explains out of all that follows."""
        taken = self.waiting[coordinate]
        for columns in taken:
            self._take_out(columns.raw_basis(), columns.white_basis())
        del self.waiting[coordinate]

    def varied(self, coordinate: str) -> bool:
        """Whether a coordinate says anything beyond what was taken out already."""
        return any(columns.raw_basis().shape[1] for columns in self.waiting[coordinate])

    def _take_out(self, raw: np.ndarray, white: np.ndarray) -> None:
        self.left = without(self.left, raw)
        self.white_left = without(self.white_left, white)
        for each in self.waiting.values():
            for columns in each:
                columns.clear_of(raw, white)

    def _white(self, columns: np.ndarray) -> np.ndarray:
        return self.noise.whiten(columns, self.row)

    def _test(self, columns: _Columns) -> float:
        return f_test(self.white_left, columns.white_basis(), self.noise.sigma, self.freedom)


def parts_of(work: Work) -> list[Part]:
    """Each coordinate's part with its own p-value; `work` is left with the rest."""
    parts: list[Part] = []
    work.waiting = {c: b for c, b in work.waiting.items() if work.varied(c)}
    most = len(work.waiting)
    while work.waiting:
        tried = [work.part(c) for c in work.waiting]
        sure = [part for part in tried if part.p_value * most <= SIGNIFICANT]
        if not sure:
            return parts + tried
        directed = any(part.coordinate == "direction" for part in parts)
        largest = max(sure, key=_preference(directed))
        parts.append(largest)
        work.take(largest.coordinate)
        work.waiting = {c: b for c, b in work.waiting.items() if work.varied(c)}
    return parts


def bases_of(ground: Ground, cycles: np.ndarray, detail: bool) -> dict[str, list[np.ndarray]]:
    """Columns of each coordinate, one array (m, k) for each test; none where it does not vary.

    Travel, dwell and rate say how the effect of direction changes, not that there is one. detail:
    with functions of the command that are fine enough to show a ripple.
    """
    command = [along.command_columns(ground, fine=False)]
    travel = [along.travel_columns(ground), *([along.loop_columns(ground)] if detail else [])]
    dwell, rate = along.dwell_columns(ground), along.rate_columns(ground)
    position = along.position_columns(ground)
    bases = {
        "command": [*command, along.command_columns(ground, fine=True)] if detail else command,
        "direction": [along.direction_columns(ground)],
        "travel": travel,
        "dwell": [dwell],
        "rate": [] if _same(rate, dwell) else [rate],
        **{f"other_command:{n}": [along.other_columns(ground, n)] for n in ground.others},
        "image_position": [] if _same(position, command[0]) else [position],
        "time": [along.time_columns(ground)],
        "cycle": [along.with_direction(cycles, ground.direction)],
    }
    if cycles.shape[1] < 2:
        del bases["cycle"]
    varied = {c: [b for b in each if b.shape[1]] for c, each in bases.items()}
    return {c: each for c, each in varied.items() if each}


def f_test(values: np.ndarray, basis: np.ndarray, sigma: float, freedom: int) -> float:
    """p-value of white values (m,) having no part along an orthonormal basis (m, k)."""
    count = basis.shape[1]
    if count == 0 or freedom < 1 or sigma == 0.0:
        return 1.0
    explained = basis.T @ values
    ratio = float(explained @ explained) / count / sigma**2
    return max(float(fdtrc(count, freedom, ratio)), LEAST_P)


def _time_test(
    values: np.ndarray, row: np.ndarray, rest: np.ndarray, slow: np.ndarray
) -> tuple[SerialNoise, float]:
    noise = fit_serial_noise(values, row, np.hstack([rest, slow]))
    white = noise.whiten(np.column_stack([values, rest, slow]), row)
    basis = orthonormal(white[:, 1 : 1 + rest.shape[1]])
    time = white[:, 1 + rest.shape[1] :]
    added = orthonormal(without(time, basis), lengths(time))
    freedom = len(values) - basis.shape[1] - added.shape[1]
    return noise, f_test(without(white[:, 0], basis), added, noise.sigma, freedom)


def _preference(directed: bool) -> Callable[[Part], float]:
    """How readily a part is taken out: those that catch much for want of others come after.

    directed: whether direction was taken out already.
    """
    weight = {"time": 0.5, "cycle": 0.5}
    weight["travel"] = TRAVEL_AFTER_DIRECTION if directed else TRAVEL_ALONE
    return lambda part: part.squares * weight.get(part.coordinate, 1.0)


def combined(p_values: list[float]) -> float:
    """One p-value of several, however they depend on each other (Cauchy's combination)."""
    if not p_values:
        return 1.0
    tangents = [np.tan((0.5 - min(p, 0.95)) * np.pi) for p in p_values]
    mean = float(np.mean(tangents))
    tail = 1.0 / (np.pi * mean) if mean > 1e6 else 0.5 - np.arctan(mean) / np.pi
    return float(np.clip(tail, LEAST_P, 1.0))


def holm(p_values: list[float]) -> list[float]:
    """p-values adjusted so that any false one among them stays as rare as stated (Holm 1979)."""
    order = np.argsort(p_values)
    raised = np.array(p_values)[order] * np.arange(len(p_values), 0, -1)
    adjusted = np.empty(len(p_values))
    adjusted[order] = np.minimum(1.0, np.maximum.accumulate(raised))
    return [float(p) for p in adjusted]


def order_p_value(means: np.ndarray) -> float:
    """p-value of a trend or a step in means, shape (c,), against any order of equal normal ones."""
    rng = np.random.default_rng(0)
    drawn = _order(rng.standard_normal((ORDER_DRAWS, len(means))))
    found = _order(means[None, :])[0]
    return float((1 + np.sum(drawn >= found)) / (1 + ORDER_DRAWS))


def _order(means: np.ndarray) -> np.ndarray:
    count = means.shape[1]
    centred = means - means.mean(axis=1, keepdims=True)
    squares = np.sum(centred**2, axis=1)
    size = np.arange(1, count)
    steps = np.cumsum(centred, axis=1)[:, :-1] ** 2 * count / (size * (count - size))
    line = np.arange(count) - (count - 1) / 2
    trend = (centred @ line) ** 2 / (line @ line)
    best = np.maximum(trend, steps.max(axis=1))
    return np.divide(best, squares, out=np.zeros_like(best), where=squares > 0)


def coarse_cycles(cycle: np.ndarray) -> np.ndarray:
    """Cycle of each row, neighbouring ones grouped so that at most 24 remain, shape (m,)."""
    number = np.unique(cycle, return_inverse=True)[1]
    size = -(-(int(number.max()) + 1) // MOST_CYCLES)
    return number // size


def thinned(residual: np.ndarray, kept: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """At most 4000 rows of the kept ones: their index, the residual's mean there, row numbers.

    kept: (k,) rising indices into residual. Neighbouring samples are averaged.
    """
    size = -(-len(residual) // MOST_ROWS)
    if size == 1:
        return kept, residual[kept], kept
    block = kept // size
    number, first, count = np.unique(block, return_index=True, return_counts=True)
    return kept[first + count // 2], np.add.reduceat(residual[kept], first) / count, number


def _same(columns: np.ndarray, others: np.ndarray) -> bool:
    if columns.shape[1] == 0 or others.shape[1] == 0:
        return False
    left = without(columns, orthonormal(others))
    return float(np.sum(left**2)) < 0.05 * float(np.sum((columns - columns.mean(axis=0)) ** 2))


def _steady(position: np.ndarray) -> np.ndarray:
    usable = np.all(np.isfinite(position)) and along.varies(position)
    return position - position.mean() if usable else np.ones(len(position))


def _located(parts: list[Part], work: Work, scene: Scene, spikes: Spikes) -> list[Located]:
    adjusted = holm([part.p_value for part in parts])
    steady = work.squares or 1.0
    total = steady + sum(part.squares for part in parts if part.coordinate == "single_frames")
    said = {
        part.coordinate: part.fitted
        for part, p_value in zip(parts, adjusted, strict=True)
        if p_value <= SIGNIFICANT and part.squares >= LEAST_SHARE * steady
    }
    found = []
    for part, p_value in zip(parts, adjusted, strict=True):
        if part.coordinate == "single_frames":
            words, profile = describe_spikes(spikes, scene)
        else:
            words, profile = describe(part.coordinate, part.fitted, said, work.left, scene)
        where = words if part.coordinate in said else None
        found.append(
            Located(part.coordinate, min(1.0, part.squares / total), p_value, where, profile)
        )
    return sorted(found, key=lambda entry: (entry.where is None, -entry.share))
