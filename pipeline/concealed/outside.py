"""Effects that the catalogue has no name for; each changes the joint's angle along a motion."""

from collections.abc import Callable

import numpy as np

from pipeline.concealed.motions import Motion

Parameters = dict[str, float]


def thermal_gain(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """The wires' length follows the room's heating: the gain swings with a period of its own."""
    swing = np.sin(2 * np.pi * motion.time_s / p["period_s"] + p["phase"])
    return np.asarray(joint * (1.0 + p["strength"] * swing))


def sticky_spots(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """The joint is caught at some spots, and each time torn off at another, chaotic, distance.

    joint, and what is returned: (n,) [deg].
    """
    spots = np.cumsum(np.random.default_rng(int(p["spots"])).uniform(4.0, 14.0, 16)) - 70.0
    out = np.array(joint)
    caught, level = np.nan, p["level"]
    for i in range(1, len(joint)):
        low, high = sorted((joint[i - 1], joint[i]))
        passed = spots[(spots > low) & (spots <= high)]
        if abs(joint[i] - caught) > p["strength"] * (0.6 + 0.8 * level):
            caught = np.nan
        if np.isnan(caught) and len(passed):
            caught, level = passed[0], 3.99 * level * (1.0 - level)
        out[i] = joint[i] if np.isnan(caught) else caught
    return out


def snap_through(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """A strip buckles sideways at one angle and back at another: two states, a jump between."""
    out = np.empty_like(joint)
    buckled = 0.0
    for i, angle in enumerate(joint):
        if angle > p["up_deg"]:
            buckled = 1.0
        elif angle < p["down_deg"]:
            buckled = 0.0
        out[i] = angle + p["strength"] * buckled * np.cos(np.deg2rad(p["fold"] * angle))
    return out


def swing_memory(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """On the way back the gain depends on how far the swing went that has just ended."""
    command = motion.pitch_deg
    out = np.empty_like(joint)
    extreme, direction = 0.0, 1.0
    for i in range(len(joint)):
        step = command[i] - command[i - 1] if i else 0.0
        if step * direction < 0:
            extreme, direction = command[i - 1], -direction
        back = direction * command[i] < 0 if extreme else False
        weight = abs(extreme) / 50.0 if direction < 0 else -0.6 * abs(extreme) / 50.0
        out[i] = joint[i] * (1.0 + p["strength"] * weight * (0.4 if back else 1.0))
    return out


def parity_bump(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """The sensor interpolates otherwise in every other cycle."""
    bump = np.sin(2 * np.pi * joint / p["period_deg"]) + 0.5 * np.cos(joint / 9.0)
    return np.asarray(joint + p["strength"] * bump * (motion.cycle % 2))


def delayed_echo(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """How far the joint was bent minutes ago, either way, still presses: a hose that fills."""
    bent = np.abs(joint)
    past = np.interp(motion.time_s - p["delay_s"], motion.time_s, bent, left=0.0)
    older = np.interp(motion.time_s - 2.3 * p["delay_s"], motion.time_s, bent, left=0.0)
    return np.asarray(joint + p["strength"] * (past - 0.7 * older))


def rough_guide(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """A worn guide: a fixed random profile over the angle, another one for each direction."""
    rng = np.random.default_rng(int(p["profile"]))
    knots = np.arange(-80.0, 80.5, p["grain_deg"])
    up, down = rng.standard_normal((2, len(knots)))
    rising = np.gradient(motion.pitch_deg) >= 0
    profile = np.where(rising, np.interp(joint, knots, up), np.interp(joint, knots, down))
    return np.asarray(joint + p["strength"] * profile)


def wearing_gain(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """The drum wears where it turns most: command and travel multiply."""
    travel = np.cumsum(np.abs(np.diff(motion.pitch_deg, prepend=0.0)))
    worn = travel / 1800.0
    return np.asarray(joint * (1.0 - p["strength"] * worn * (1.0 + 0.8 * np.tanh(joint / 20.0))))


def step_resonance(motion: Motion, joint: np.ndarray, p: Parameters) -> np.ndarray:
    """The link still rings when its frame is taken; how much depends on the step's length."""
    step = np.abs(np.diff(motion.pitch_deg, prepend=motion.pitch_deg[:1]))
    ratio = step / p["resonant_step_deg"]
    ringing = ratio**2 / np.sqrt((1.0 - ratio**2) ** 2 + (0.25 * ratio) ** 2)
    return np.asarray(
        joint + p["strength"] * ringing * np.sin(np.deg2rad(2.5 * joint) + p["phase"])
    )


OUTSIDE: dict[str, Callable[[Motion, np.ndarray, Parameters], np.ndarray]] = {
    f.__name__: f
    for f in (
        thermal_gain, sticky_spots, snap_through, swing_memory, parity_bump, delayed_echo,
        rough_guide, wearing_gain, step_resonance,
    )
}  # fmt: skip
