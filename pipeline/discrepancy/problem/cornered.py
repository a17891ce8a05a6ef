"""Motions whose commands went on beyond their samples: they turned between two of them."""

from dataclasses import replace

from pipeline.physics.corners import corners_of
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.motion import Motion


def moved_on(motion: Motion) -> Motion | None:
    """The motion with where its commands turned between samples; None where none did.

    A robot that steps and waits is at each sample's command, and at no other.
    """
    if motion.kinetics is not None or motion.usual_dwell_s >= STEP_AND_WAIT_S:
        return None
    corners = corners_of(motion.time_s, motion.drive, motion.others)
    return None if corners is None else replace(motion, corners=corners)
