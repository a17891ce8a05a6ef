"""Intervals: how far each parameter may move before the fit gets worse."""

import numpy as np
from scipy.linalg import block_diag

from pipeline.discrepancy.fitting.fit import Fit, parameters_of
from pipeline.discrepancy.fitting.moments import moments, moments_of, moved
from pipeline.discrepancy.model.result import Estimate
from pipeline.discrepancy.noise.family import NoiseFamily, Place
from pipeline.discrepancy.problem.problem import Problem
from pipeline.physics.catalogue import BEND
from pipeline.physics.mechanism import Trace
from pipeline.physics.piece import Piece
from pipeline.physics.term import Parameter
from pipeline.recording import branch_of

MEASURED = " measured"
DEVIATIONS = 1.96
FALL = 3.84
PATIENCE = 6
NEGLIGIBLE = 0.01
STRETCHES = 12
LONGEST_MOVE = 0.2
NEAR_HOME, STEEPEST = 0.05, 2.0


def covariance_of(fit: Fit) -> np.ndarray:
    """Covariance of nuisances and then all term parameters, Gauss-Newton under the whitened noise.

    With the priors of both; inflated where the innovations are larger than they should be.
    """
    excess = max(float(np.mean(fit.innovations**2)), 1.0)
    slopes = np.hstack([fit.calibrating, fit.slopes])
    return bounded(excess * inverted(slopes, precisions(fit)), fit)


def bounded(covariance: np.ndarray, fit: Fit) -> np.ndarray:
    """The covariance (m, m) with no parameter of a term more open than its bounds are apart.

    A parameter that moves nothing where it stands would else be open without end.
    """
    apart = [np.full(len(fit.nuisance), np.inf)]
    apart += [box.high - box.low for box in (fit.ground.box(p.term) for p in fit.pieces)]
    deviations = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    shrunk = np.minimum(np.concatenate(apart) / deviations, 1.0)
    return np.asarray(covariance * np.outer(shrunk, shrunk))


def precisions(fit: Fit) -> np.ndarray:
    """Of the priors of nuisances and then all term parameters, (m, m)."""
    own = [np.diag(fit.ground.box(piece.term).precision) for piece in fit.pieces]
    return np.asarray(block_diag(fit.ground.precision, *own))


def inverted(slopes: np.ndarray, precision: np.ndarray) -> np.ndarray:
    """Covariance (m, m) for whitened slopes (k, m) and the precision of priors (m, m)."""
    normal = slopes.T @ slopes + precision
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    inverse = np.linalg.pinv(normal / np.outer(scale, scale), rcond=1e-10, hermitian=True)
    return np.asarray(inverse / np.outer(scale, scale))


def wide_covariance(fit: Fit, place: Place, family: NoiseFamily) -> np.ndarray:
    """The same, with what is not known of the noise, and of the form of what was fitted.

    It is averaged over the noises that the residual leaves likely. Where a term has not quite the
    form of the real thing, what is left repeats with command and direction: a sandwich (White,
    Econometrica 48, 1980) over stretches of these tells how far that moves each parameter, and
    widens it where that is further.
    """
    residual = fit.ground.problem.measured - fit.predicted
    noises = [n for n in family.likely(residual, place) if n[0] > NEGLIGIBLE]
    total = sum(weight for weight, _ in noises)
    precision = precisions(fit)
    average = np.zeros((len(precision), len(precision)))
    for weight, noise in noises:
        slopes = fit.ground.with_noise(noise).whiten(fit.changes)
        average += weight / total * inverted(slopes, precision)
    own, seen = np.diag(average), np.diag(repeated_misfit(fit))
    wider = np.sqrt(np.maximum(np.divide(seen, own, out=np.ones_like(own), where=own > 0), 1.0))
    return bounded(average * np.outer(wider, wider), fit)


def repeated_misfit(fit: Fit) -> np.ndarray:
    """Covariance of all parameters by what the innovations have in common along the command."""
    slopes, drive = np.hstack([fit.calibrating, fit.slopes]), fit.ground.problem.motion.drive
    place = (drive - drive.min()) / max(float(np.ptp(drive)), 1e-300) * STRETCHES
    stretch = 2 * np.minimum(place.astype(int), STRETCHES - 1) + (branch_of(drive) > 0)
    number = np.unique(stretch[fit.ground.used], return_inverse=True)[1]
    count = int(number.max()) + 1
    scores = np.zeros((count, slopes.shape[1]))
    np.add.at(scores, number, slopes * fit.innovations[:, None])
    meat = scores.T @ scores * count / max(count - slopes.shape[1], 1)
    precision = precisions(fit)
    inverse = inverted(slopes, precision)
    return np.asarray(inverse @ (meat + precision) @ inverse)


def stated(fit: Fit, piece: Piece) -> np.ndarray:
    """A term's parameters as they are told: what is seen in the measurement, in its own unit."""
    scales = [told_per(fit, p) for p in parameters_of(fit.ground, piece.term)]
    return np.asarray(piece.values * scales)


def told_per(fit: Fit, parameter: Parameter) -> float:
    """What is told of a parameter over its value: see `Parameter`."""
    around = fit.ground.problem.around
    if parameter.at_drive:
        return around.angle_span / max(around.drive_span, 1e-300)
    gain = float(fit.nuisance[0]) if parameter.measured else 1.0
    return gain * steepness(fit.ground.problem) if parameter.at_home else gain


def steepness(problem: Problem) -> float:
    """Slope of the nominal curve where the drive is at 0 over its mean slope.

    1 where the drive does not pass 0, and where the curve as good as stands still there, or leaps.
    """
    curve, around = problem.curve, problem.around
    near = NEAR_HOME * around.drive_span
    if not around.drive_low + near < 0.0 < around.drive_low + around.drive_span - near:
        return 1.0
    below, above = curve(np.array([-near, near]))
    found = float(above - below) / (2.0 * near * curve.slope)
    return found if 1.0 / STEEPEST < found < STEEPEST else 1.0


def estimates(fit: Fit, covariance: np.ndarray) -> list[tuple[Piece, tuple[Estimate, ...]]]:
    """Every term's parameters as they are told, with 95 % intervals within their bounds."""
    out = []
    k = len(fit.nuisance)
    for i, piece in enumerate(fit.pieces):
        own = []
        parameters = parameters_of(fit.ground, piece.term)
        for j, (p, value) in enumerate(zip(parameters, piece.values, strict=True)):
            scale = told_per(fit, p)
            variance = scale**2 * covariance[k, k]
            if p.measured:
                by_gain = value * (steepness(fit.ground.problem) if p.at_home else 1.0)
                variance += by_gain**2 * covariance[0, 0] + 2.0 * scale * by_gain * covariance[0, k]
            if p.unit == "s" and piece.term.site != "sensor":
                variance += arrival_s(fit.ground.problem.around.dwell_s, float(value)) ** 2
            if p.moment:
                low, high = moment_interval(fit, i, j)
                low, high = min(low, float(value)), max(high, float(value))
            else:
                reach = DEVIATIONS * np.sqrt(max(variance, 0.0))
                low, high = sorted((scale * p.low, scale * p.high))
                low, high = max(scale * value - reach, low), min(scale * value + reach, high)
            own.append(Estimate(p.name, scale * float(value), float(low), float(high), p.unit))
            if p.place and not bent_beyond_the_joint(fit):
                own.append(as_measured(fit, p, float(value), covariance, k))
            k += 1
        out.append((piece, tuple(own)))
    return out


def bent_beyond_the_joint(fit: Fit) -> bool:
    """Whether the sensor bends what the joint does, so that calibration alone tells no reading."""
    return any(p.term.group == BEND and p.term.site == "sensor" for p in fit.pieces)


def as_measured(
    fit: Fit, place: Parameter, angle: float, covariance: np.ndarray, k: int
) -> Estimate:
    """What the measurement reads at a simulated angle, by the calibration, with its interval.

    covariance: (m, m) of nuisances, then parameters, of which this one is the k-th.
    """
    nuisances, nuisance = fit.ground.nuisances, fit.nuisance
    middles = {b.command: np.array([b.middle]) for b in nuisances.beside}
    at = np.array([angle])
    (columns,) = nuisances.columns(Trace(at, at, at, {}), middles)
    slopes = np.append(columns, nuisance[0])
    rows = [*range(len(nuisance)), k]
    read = float(columns @ nuisance)
    reach = DEVIATIONS * float(np.sqrt(max(slopes @ covariance[np.ix_(rows, rows)] @ slopes, 0.0)))
    return Estimate(place.name + MEASURED, read, read - reach, read + reach, place.unit)


def arrival_s(dwell_s: float, late_s: float) -> float:
    """How much of the time that a command took to arrive [s, RMS] a time constant may hold.

    No recording tells how long that was: up to a fifth of a dwell, say. Of a mean delay d before
    each of its dwells D a lag T takes d T / D (1 - exp(-D / T)) as its own, to first order of d:
    all of it where it outlasts many dwells, little where each dwell sees the whole motion. An old
    frame is no arrival: it shows a pose, whenever that was asked for.
    """
    if dwell_s <= 0.0 or late_s <= 0.0:
        return 0.0
    taken = late_s / dwell_s * -np.expm1(-dwell_s / late_s)
    return float(0.5 * LONGEST_MOVE * dwell_s / np.sqrt(3.0) * taken)


def moment_interval(fit: Fit, place: int, parameter: int) -> tuple[float, float]:
    """The fitted samples between which the slip lies, as far as the cost tells them apart [s].

    Noise parts those that fit as well: a few that do not are passed over.
    """
    time_s = fit.ground.problem.motion.time_s[fit.ground.used]
    times = moments(fit)
    near = int(np.argmin(np.abs(times - fit.pieces[place].values[parameter])))

    def farthest(way: int) -> int:
        found = k = near
        while 0 <= k + way < len(times) and abs(k + way - found) <= PATIENCE:
            k += way
            if moved(fit, place, parameter, times[k]).cost < fit.cost + FALL:
                found = k
        return found

    first, last = farthest(-1), farthest(1)
    return float(time_s[first]), float(time_s[last + 1])


def undated(fit: Fit, time_s: np.ndarray) -> np.ndarray:
    """At which times (n,) a fitted slip may or may not have happened, a mask."""
    out = np.zeros(len(time_s), dtype=bool)
    for k, piece in enumerate(fit.pieces):
        for j in moments_of(fit, piece):
            low, high = moment_interval(fit, k, j)
            out |= (time_s > low) & (time_s < high)
    return out
