"""Motions whose commands went on beyond their samples: they turned between two of them."""

from dataclasses import replace

from pipeline.physics.corners import corners_of
from pipeline.physics.held import STEP_AND_WAIT_S
from pipeline.physics.motion import Motion


def moved_on(motion: Motion) -> Motion:
    """The motion with where its commands turned between samples, if any did.

    A robot that steps and waits is at each sample's command, and at no other.
    """
    if motion.kinetics is not None or motion.usual_dwell_s >= STEP_AND_WAIT_S:
        return motion
    return replace(motion, corners=corners_of(motion.time_s, motion.drive, motion.others))
