"""What a diagnosis notes beside its names: what was left out, moved or assumed, with its count."""

import numpy as np

from pipeline.discrepancy.judgement.calibration_note import calibration_note
from pipeline.discrepancy.judgement.first_slip import start_note
from pipeline.discrepancy.judgement.loudness import loud_note
from pipeline.discrepancy.judgement.slipped_again import slip_note, undated_note
from pipeline.discrepancy.judgement.structure import rounded
from pipeline.discrepancy.judgement.verdict import intolerable
from pipeline.discrepancy.judgement.walking_zero import walk_in_a_cycle
from pipeline.discrepancy.model.result import Evidence, root_mean
from pipeline.discrepancy.problem.fitted import LOOSE_GAIN
from pipeline.discrepancy.problem.inputs import input_shares, said_shares
from pipeline.discrepancy.problem.one_wire import held_by_one, loaded_by
from pipeline.discrepancy.problem.problem import Problem
from pipeline.discrepancy.search.accuracy import hidden
from pipeline.discrepancy.search.explain import Explanation
from pipeline.discrepancy.search.weighing import Choice
from pipeline.number_words import worded
from pipeline.physics.differentiation import Derivatives
from pipeline.recording import Recording

WORTH_SAYING, NEARER = 0.25, 0.7
ONE_WIRE = "One wire holds the joint here, two in the simulation, which moves it farther"


def notes(
    problem: Problem, explanation: Explanation, best: Choice, evidence: Evidence, every: int
) -> tuple[str, ...]:
    """What was left out or assumed, with its count."""
    out = []
    if intolerable(best):
        gain, offset = best.fit.nuisance[:2]
        out.append(calibration_note(float(gain), float(offset), problem.around.angle_unit))
    out += replaced_note(problem, best) or free_gain_note(problem, best)
    out += start_note(best.fit)
    out += doubled_note(evidence.recording)
    out += other_simulations_note(evidence.recording, evidence.measurement)
    out += sample_notes(problem)
    if problem.counted:
        out.append(
            f"{problem.drive} was recorded in counts of {worded(problem.counted)} "
            f"{problem.around.drive_unit}, and the measurement does not go in such steps: the "
            "smoothest motion within half a count drives the terms."
        )
    if problem.motion.corners is not None:
        out.append(
            f"The commands turned, set out or stopped {len(problem.motion.corners.time_s)} times "
            "between two samples. What remembers its way was followed to where their straight "
            "lines meet, which explains better what was measured or simulated."
        )
    out += course_note(problem)
    if problem.own:
        unit = problem.around.angle_unit
        out.append(
            f"The simulation is {worded(problem.own)} {unit} (RMS) off a curve of {problem.drive}, "
            "and the measurement goes along with that: it is no mismatch. Predictions of other "
            "commands are without it."
        )
    if problem.read is not None and problem.levels is not None:
        out.append(
            f"The sensor reads in steps of {worded(problem.levels.step)} "
            f"{problem.around.angle_unit}: what a reading is off by that follows the motion, but "
            "is no mismatch. It was taken off, and belongs to the noise."
        )
    if problem.rough:
        out.append(
            f"{problem.drive} was recorded with noise of its own ({problem.rough:.2g} "
            f"{problem.around.drive_unit}), which the measurement does not follow: the smoothest "
            "motion within it drives the terms."
        )
    outliers = int((np.isfinite(problem.measured) & ~evidence.used).sum())
    if outliers:
        out.append(f"{outliers} samples stand off from their neighbours and were not counted.")
    if problem.derivatives is not None:
        out += force_notes(problem, problem.derivatives, every)
    else:
        errors, unit = problem.measured - evidence.after, problem.around.angle_unit
        out += slip_note(problem, best, evidence.after)
        out += undated_note(best, evidence)
        if not rounded(explanation, best):
            out += loud_note(errors, evidence.after, problem.train, unit)
        if every > 1:
            out.append(f"Terms were fitted on one sample in {every} and all reversals.")
    if not problem.static:
        out.append(
            "The simulation is no static curve of one command: terms act on its trace. What acts "
            "on the drive before it (play, ripple, slips in the transmission) could not be put in "
            "front of it, and is fitted as if it came after."
        )
        out += nearer_note(problem, evidence)
    out += driven_note(problem, evidence)
    out += walking_note(problem, best)
    if explanation.prior.repeats == 0:
        out.append("No cycle repeats another: the noise was learnt from what is rough alone.")
    return tuple(out)


def doubled_note(recording: Recording) -> list[str]:
    """How many rows repeat the one before, time and all: a log may have written them twice."""
    rows = recording.samples[["time_s", *(channel.name for channel in recording.channels)]]
    doubled = int((rows.diff().iloc[1:] == 0.0).all(axis=1).sum())
    if doubled == 0:
        return []
    return [
        f"{doubled} of {len(rows)} rows repeat the one before to the last digit, time and all, and "
        "count like others: if the log wrote them twice, leave them out, or the noise looks less."
    ]


def other_simulations_note(recording: Recording, measurement: str) -> list[str]:
    """Which simulations of a measurement nobody looked at: the first one is corrected."""
    simulations = recording.with_role("simulation")
    names = [c.name for c in simulations if c.of == measurement]
    return [
        f"{name} simulates {measurement}, too, and was left out: {names[0]} was corrected."
        for name in names[1:]
    ]


def sample_notes(problem: Problem) -> list[str]:
    """Samples that count for nothing, and why."""
    out = []
    again = int(problem.stale.rows.sum())
    if again:
        why = "the sensor is slower than the log" if problem.stale.even else "it hangs now and then"
        out.append(
            f"{again} of {len(problem.measured)} samples say to the last digit what the one before "
            f"said, while the motion went on: {why}, and they do not count."
        )
    hung = int(problem.stale.hung.sum())
    if hung:
        out.append(
            f"{hung} of {len(problem.measured)} samples stand at one value while the motion went "
            "on, and then leap to where it is: the sensor hung, and they do not count."
        )
    if problem.unsettled:
        out.append(
            f"{problem.unsettled} of {len(problem.measured)} samples come after a hole in time in "
            f"which {problem.drive} went on and may have turned: they do not count until play and "
            "friction have forgotten it."
        )
    missing = int((~np.isfinite(problem.measured)).sum()) - again - hung - problem.unsettled
    if missing:
        out.append(f"{missing} of {len(problem.measured)} samples were not measured.")
    return out


def course_note(problem: Problem) -> list[str]:
    """What the simulation has beside its curve, and where named terms act."""
    if problem.course is None:
        return []
    course, more = problem.course, ""
    if held_by_one(problem):
        more = f" {ONE_WIRE}: {worded(course.farther)} times as far."
        course = loaded_by(course, 1.0 / course.farther)
    where = "before it, at the joint too" if course.sensor else "inside of it"
    if course.joint:
        where = "before the joint or beside it there"
    if course.shaft:
        where = "behind it, at the drive too"
    has = " ".join(p.term.sentence(p.values, problem.around) for p in course.pieces)
    return [
        f"The simulation itself has, of {problem.drive}: {has} "
        f"That is kept as it is: what is named acts {where}.{more}"
    ]


def free_gain_note(problem: Problem, best: Choice) -> list[str]:
    """What became of a simulation's gain that was no knowledge, see `fitted.py`."""
    gain = float(best.fit.nuisance[0])
    if problem.tolerance.gain < LOOSE_GAIN or abs(gain - 1.0) < WORTH_SAYING:
        return []
    return [
        f"The simulation's gain is {worded(gain)}: it was left free, as the simulation was fitted "
        "to this measurement, or jumps with the direction as rigid friction does."
    ]


def replaced_note(problem: Problem, best: Choice) -> list[str]:
    """That the simulation does not move, or jumps, and what stands in its place."""
    if problem.replaced is None or not problem.static:
        return []
    if np.nanmax(problem.replaced) > np.nanmin(problem.replaced):
        return [
            f"The simulation jumps with the direction of {problem.drive}, as rigid friction does: "
            "the middle of its two branches stands in its place, and what is named holds all "
            "friction, that of the simulation too."
        ]
    unit, drive = f"{problem.around.angle_unit}/{problem.around.drive_unit}", problem.motion.drive
    gain = float(best.fit.nuisance[0] * np.ptp(problem.simulated) / np.ptp(drive))
    sign = np.sign(np.polyfit(drive, problem.simulated, 1)[0])
    return [
        f"The simulation does not move: a line in {problem.drive} stands in its place, whose gain "
        f"({worded(sign * gain)} {unit}) and zero were fitted beside the names."
    ]


def walking_note(problem: Problem, best: Choice) -> list[str]:
    """How far a zero that walks goes in a cycle, in words, where that is more than the noise."""
    far = walk_in_a_cycle(best)
    if far < best.fit.ground.noise.deviation:
        return []
    return [
        f"The zero walks by about {far:.2g} {problem.around.angle_unit} in a cycle, which no "
        "commands foretell: the errors hold that too, the noise does not."
    ]


def force_notes(problem: Problem, found: Derivatives, every: int) -> list[str]:
    """How velocity and acceleration were found, and what a fitted row is."""
    out = ["Velocity and acceleration are central differences of the position."]
    if found.of_speed:
        out = ["Acceleration is central differences of the velocity, which is recorded."]
    if np.isfinite(found.cutoff_hz):
        out[0] = (
            f"{out[0][:-1]} after a low-pass without delay at {worded(found.cutoff_hz)} Hz "
            f"(sampled at {found.rate_hz:.4g} Hz)."
        )
    if found.resampled:
        out.append(f"Samples stand unevenly: an even grid of {found.rate_hz:.4g} Hz stood between.")
    delay = problem.delay
    if delay.value != 0.0:
        low, high = sorted(abs(1e3 * end) for end in (delay.low, delay.high))
        out.append(
            f"The force was recorded {worded(abs(1e3 * delay.value))} ms ({worded(low)} to "
            f"{worded(high)}) {'after' if delay.value > 0.0 else 'before'} the motion that it "
            "belongs to: the motion was moved there."
        )
    ends = int(np.sum(np.isfinite(problem.measured) & ~found.known))
    out.append(
        f"{ends} samples at the ends and beside holes, where the derivatives see one side, do not "
        "count."
    )
    if every > 1:
        out.append(f"Terms were fitted on means over {every} samples of force and terms alike.")
    if not problem.around.simulated:
        out.append("Nothing simulates the force: all of it counts as left out.")
    return out


def accuracy_note(explanation: Explanation, best: Choice) -> list[str]:
    """That the declared accuracy decided, and what it may hide, in words."""
    problem = explanation.problem
    unit, size = problem.around.angle_unit, smooth_error(best)
    out = [
        f"Once gain, offset and curve are right, less is left than the accuracy of the measurement "
        f"that was declared ({problem.tolerance.accuracy:g} {unit}): no name was looked for in it."
    ]
    if size is not None:
        out.append(
            f"A smooth error over every command ({worded(size)} {unit} RMS) is taken for the "
            "measurement's own and corrected with gain and offset: it foretells later samples."
        )
    found = hidden(explanation.search, best)
    if found is not None:
        name, without, with_it = found
        out.append(
            f"Within that accuracy {name} may be hidden: with it, later samples of those fitted "
            f"would be foretold to {worded(with_it)} {unit}, without it to {worded(without)} "
            f"{unit} (RMS)."
        )
    return out


def nearer_note(problem: Problem, evidence: Evidence) -> list[str]:
    """That a line in a command is nearer to the measurement than the simulation, where it is."""
    rows, recording = problem.train & evidence.used, evidence.recording
    measured = problem.measured[rows]

    def off_line(values: np.ndarray) -> float:
        if not np.ptp(values[rows]) > 0.0:
            return np.inf
        line = np.polyfit(values[rows], measured, 1)
        return float(np.std(measured - np.polyval(line, values[rows])))

    off = {c.name: off_line(recording.values(c.name)) for c in recording.with_role("command")}
    name, own = min(off, key=lambda n: off[n]), off_line(problem.simulated)
    if off[name] > NEARER * own:
        return []
    unit = problem.around.angle_unit
    return [
        f"A line in {name} alone is nearer to the measurement ({worded(off[name])} {unit}) than "
        f"one in the simulation ({worded(own)} {unit}): the simulation may lag, or move, where the "
        "mechanism does not. Without it (`simulation=affine`) more may be found."
    ]


def driven_note(problem: Problem, evidence: Evidence) -> list[str]:
    """Which commands drive the measurement, as corrected and as the simulation came, in words."""
    recording = evidence.recording
    commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
    known = np.isfinite(problem.measured) & np.isfinite(problem.simulated)
    own = input_shares(evidence.after, commands, known)
    if len(own) < 2:
        return []
    came = input_shares(problem.simulated, commands, known)
    before = f"; the simulation as it came: {said_shares(came)}" if came else ""
    return [f"{evidence.measurement} is driven {said_shares(own)}{before}."]


def smooth_error(choice: Choice) -> float | None:
    """Root mean square over the rows fitted of the smooth error; None where none is allowed."""
    fit = choice.fit
    if len(fit.nuisance) < 3:
        return None
    own = fit.ground.calibrating(fit.trace)[:, 2:] @ fit.nuisance[2:]
    return root_mean(own[fit.ground.used] ** 2)
