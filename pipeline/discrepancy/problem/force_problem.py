"""The problem of a force against motion: derivatives, sizes, and means over blocks of samples."""

from dataclasses import replace

import numpy as np

from pipeline.config import DiagnosisConfig
from pipeline.discrepancy.problem.fitted import goes_by, tolerance_of_fit, tolerance_of_rigid
from pipeline.discrepancy.problem.known_rows import held_out_rows, refuse_unfit
from pipeline.discrepancy.problem.lone_samples import lone_samples
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.problem.repeats import driven_again, rows_of_cycles
from pipeline.discrepancy.problem.rows import Averaged, one_after_another
from pipeline.discrepancy.problem.stale import NONE_STALE, hung_samples
from pipeline.physics.force_motion import force_motion
from pipeline.physics.force_units import position_unit
from pipeline.physics.kinematics import IdentityCurve
from pipeline.physics.motion import Kinetics, Motion
from pipeline.physics.term import Surroundings
from pipeline.recording import Recording

TOP, HARDLY = 0.99, 1e-6
ROWS_A_PERIOD = 2.5
FEWEST_ROWS, MOST_ROWS, KEPT = 400, 3000, 0.8


def pose_force_problem(
    config: DiagnosisConfig,
    recording: Recording,
    measurement: str,
    position: str,
    simulated: np.ndarray,
) -> Problem:
    """What is to be explained: a force measured against `position`, given a simulation of it (n,).

    Rows at the ends, where the differentiation sees one side only, and rows beside those of which
    the simulation says nothing neither fit nor judge. Raises DiagnosisError where there is too
    little to judge.
    """
    motion, derivatives = force_motion(recording, position, simulated, config.cutoff_hz)
    came = recording.values(measurement)
    stale = replace(NONE_STALE, hung=hung_samples(came, motion.drive))
    measured = np.where(stale.hung, np.nan, came)
    said = np.isfinite(np.convolve(simulated, np.ones(3), mode="same"))
    known = np.isfinite(measured) & said & derivatives.known
    heldout = held_out_rows(config.heldout, motion, known)
    train = known & ~heldout
    refuse_unfit(config.heldout, measurement, train, known & heldout)
    tolerance = tolerance_of_fit(config.tolerance, came, simulated, motion.drive, heldout)
    tolerance = tolerance_of_rigid(tolerance, motion)
    around = _surroundings(recording, measurement, position, motion, measured[train])
    problem = Problem(
        motion=motion,
        curve=IdentityCurve(),
        measured=measured,
        simulated=motion_simulated(motion),
        train=train,
        heldout=known & heldout,
        around=around,
        tolerance=replace(tolerance, shape=config.tolerance.shape),
        drive=position,
        static=True,
        derivatives=derivatives,
        stale=stale,
    )
    return replace(problem, lone=lone_samples(problem))


def motion_simulated(motion: Motion) -> np.ndarray:
    """The force that the simulation says, (n,); of a motion that has kinetics."""
    assert motion.kinetics is not None
    return motion.kinetics.simulated


def _surroundings(
    recording: Recording, measurement: str, position: str, motion: Motion, measured: np.ndarray
) -> Surroundings:
    kinetics = motion.kinetics
    assert kinetics is not None
    resisting, accelerating = goes_by(motion)
    return Surroundings(
        drive_span=float(np.ptp(motion.drive)),
        drive_low=float(np.min(motion.drive)),
        angle_span=max(float(np.ptp(measured)), 1e-12),
        angle_low=float(np.min(measured)),
        step=float(np.median(np.abs(np.diff(motion.drive)))),
        dwell_s=float(np.median(np.diff(motion.time_s))),
        start_s=float(motion.time_s[0]),
        end_s=float(motion.time_s[-1]),
        cycles=len(np.unique(motion.cycle)),
        travel=float(np.abs(np.diff(motion.drive)).sum()),
        drive_unit=position_unit(recording.channel(position).unit),
        angle_unit=recording.channel(measurement).unit,
        top_speed=top_of(kinetics.velocity),
        top_acceleration=top_of(kinetics.acceleration),
        simulated=bool(np.any(kinetics.simulated)),
        resisting=resisting,
        accelerating=accelerating,
    )


def top_of(values: np.ndarray) -> float:
    """The size that all but few of some values (n,) stay below; of those that hardly move, all."""
    sizes = np.abs(values)
    usual, most = float(np.quantile(sizes, TOP)), float(np.max(sizes))
    return usual if usual > HARDLY * most else most


def averaged(problem: Problem, like: Averaged | None = None) -> tuple[Problem, int]:
    """The problem of a force with block means as rows, and how many samples make one.

    like: the blocks of the same samples as they were before their motion was moved.

    Blocks are as long as leaves 2.5 rows to a period of the cut-off, shorter where that would leave
    fewer than FEWEST_ROWS, and longer where there would be more than MOST_ROWS; see `block_begins`.
    The mean of a block is the low-pass before that decimation, the same for the measured force and
    for what each term adds (the parallel filter of Gautier, Janot and Vandanjon, IEEE Trans.
    Control Syst. Technol. 21 (2013) 428). A block counts as fitted where all its known samples do.
    """
    derivatives = problem.derivatives
    assert derivatives is not None
    last = int(np.flatnonzero(problem.train)[-1]) + 1
    by_cutoff = int(derivatives.rate_hz / (ROWS_A_PERIOD * derivatives.cutoff_hz))
    roomy = int(problem.train.sum()) // FEWEST_ROWS
    size = max(min(by_cutoff, roomy), -(-last // MOST_ROWS), 1)
    fine = problem.motion.rows(slice(0, max(last, size)))
    train, heldout = problem.train & ~problem.mistaken, problem.heldout & ~problem.mistaken
    known = (train | heldout)[: len(fine)]
    begins = block_begins(problem.rows(np.arange(len(fine))), size) if like is None else like.begins
    blocks = Averaged(fine, size, begins, known)
    kinetics = fine.kinetics
    assert kinetics is not None
    n = len(fine)
    motion = Motion(
        drive=blocks.mean(fine.drive),
        time_s=blocks.mean(fine.time_s),
        cycle=fine.cycle[begins],
        radian=fine.radian,
        kinetics=Kinetics(
            blocks.mean(kinetics.velocity),
            blocks.mean(kinetics.acceleration),
            blocks.mean(kinetics.simulated),
        ),
    )
    small = replace(
        problem,
        motion=motion,
        measured=blocks.mean(problem.measured[:n]),
        simulated=blocks.mean(problem.simulated[:n]),
        train=blocks.mean(train[:n].astype(float)) == 1.0,
        heldout=blocks.mean(heldout[:n].astype(float)) == 1.0,
        lone=None,
        averaged=blocks,
    )
    return small, size


def block_begins(problem: Problem, size: int) -> np.ndarray:
    """The first sample of each block of `size`, (rows,); the last few samples are left out.

    Where cycles repeat each other, blocks begin anew with each, and its last few samples are left
    out: else their means would be over other parts of the same motion, and would not repeat. Not
    where cycles are so short that less than KEPT of the blocks would be left.
    """
    evenly = one_after_another(len(problem.motion), size)
    if size == 1 or not driven_again(problem):
        return evenly
    cycles = rows_of_cycles(problem).values()
    anew = np.concatenate([rows[: len(rows) // size * size : size] for rows in cycles])
    return anew if len(anew) >= KEPT * len(evenly) else evenly
