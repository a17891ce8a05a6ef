"""What a diagnosis says beside its names: where the residual lies, and what to record next."""

from dataclasses import replace

import numpy as np

from pipeline.discrepancy.location.locate import Located, locate
from pipeline.discrepancy.model.result import Diagnosis, Evidence, Location, NextExperiment
from pipeline.discrepancy.next_experiment import Proposal, next_experiment
from pipeline.physics.force_units import position_behind, position_unit


def with_account(
    diagnosis: Diagnosis, evidence: Evidence, commands_file: str
) -> tuple[Diagnosis, Evidence, Proposal | None]:
    """The diagnosis with its locations and next experiment; `commands_file` will hold its commands.

    Only rows that a fit may use are looked at: held-out rows have no say.
    """
    located = located_in(evidence, evidence.residual_before)
    proposal = next_experiment(evidence, diagnosis.verdict)
    location = tuple(Location(p.coordinate, p.share, p.p_value, p.where) for p in located)
    proposed = None
    if proposal is not None:
        file = None if proposal.commands is None else commands_file
        proposed = NextExperiment(proposal.why, file)
    return (
        replace(diagnosis, location=location, next_experiment=proposed),
        replace(evidence, located=located),
        proposal,
    )


def located_in(evidence: Evidence, residual: np.ndarray) -> tuple[Located, ...]:
    """Where a residual, shape (n,), of the rows that a fit may use lies, outliers among them.

    It is looked for along the command, also where a simulation's trace drives the mechanism; of a
    force, along the position.
    """
    looked_at = np.where(evidence.train, residual, np.nan)
    recording = evidence.recording
    others = {n: u for n, u in evidence.motion.others.items() if n != evidence.drive}
    drive = recording.values(evidence.drive)
    motion = replace(evidence.motion, drive=drive, others=others)
    unit = recording.channel(evidence.measurement).unit
    drive_unit = recording.channel(evidence.drive).unit
    seen = evidence.before
    if motion.kinetics is not None:
        seen = np.zeros(len(motion))
        motion = replace(motion, drive=position_behind(motion.time_s, drive, drive_unit))
        drive_unit = position_unit(drive_unit)
    return tuple(locate(looked_at, motion, seen, unit, drive_unit))
