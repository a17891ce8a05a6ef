"""Shaft to joint: drum clearance, two wires in their sheaths, and the joint that they bend.

At every substep the joint stands where all torques balance; what remembers are the drum in its
clearance, the bristles of the sheath (each sticks until its torque reaches a threshold), the
dashpots of the body and the wear of the clearance. Torques are in units of the joint's bending
stiffness times a degree. The joint is searched for by its uptake q, the drum angle at which it
stands in the ideal plant: joint = gain q + cubic q^3.
"""

import numpy as np
from numba import njit

from pipeline.concealed.gear import error_deg

MOVE_SUBSTEPS = 2
DWELL_SHARES = np.array([0.02, 0.04, 0.07, 0.10, 0.13, 0.17, 0.21, 0.26])
BENDING_STIFFNESS = 1.0
NEWTON_STEPS = 60
TOLERANCE_DEG = 1e-8
REACH_DEG = 40.0
CONSTANTS = (
    "wire_stiffness", "toe_share", "toe_deg", "pretension_deg", "straightening_deg", "gain",
    "cubic", "nominal_wire_stiffness", "capstan", "grip_up", "grip_down", "weight", "mounting_rad",
    "pad_stiffness", "pad_deg", "pad_skin_deg", "pad_side", "stop_stiffness", "stop_high_deg",
    "stop_low_deg", "stop_skin_deg",
)  # fmt: skip
(WIRE, TOE_SHARE, TOE, PRETENSION, STRAIGHTENING, GAIN, CUBIC, NOMINAL_WIRE, CAPSTAN, GRIP_UP,
 GRIP_DOWN, WEIGHT, MOUNTING, PAD, PAD_AT, PAD_SKIN, PAD_SIDE, STOP, STOP_HIGH, STOP_LOW,
 STOP_SKIN) = range(len(CONSTANTS))  # fmt: skip
CAPSTAN_DEG = 45.0


@njit(cache=True)
def tension(elongation: float, c: np.ndarray) -> tuple[float, float]:
    """Tension of one wire and its slope; none while slack, soft at first where it has a toe."""
    x, dx = elongation, 1.0
    if c[STRAIGHTENING] > 0.0:
        z = elongation / c[STRAIGHTENING]
        if z < 30.0:
            x = c[STRAIGHTENING] * np.log1p(np.exp(z))
            dx = 1.0 / (1.0 + np.exp(-z))
    elif x <= 0.0:
        return 0.0, 0.0
    if c[TOE] <= 0.0:
        return c[WIRE] * x, c[WIRE] * dx
    soft = 1.0 - c[TOE_SHARE]
    fade = np.exp(-x / c[TOE])
    return c[WIRE] * (x - soft * c[TOE] * (1.0 - fade)), c[WIRE] * (1.0 - soft * fade) * dx


@njit(cache=True)
def indentation(depth: float, skin_deg: float) -> tuple[float, float]:
    """Indentation (and its slope) of a pad that starts soft over `skin_deg`."""
    if depth <= 0.0:
        return 0.0, 0.0
    if depth < skin_deg:
        return 0.5 * depth * depth / skin_deg, depth / skin_deg
    return depth - 0.5 * skin_deg, 1.0


@njit(cache=True)
def rubbing(moved: float, grip: float, c: np.ndarray, held: np.ndarray, reach: np.ndarray,
            stiffness: np.ndarray) -> tuple[float, float]:  # fmt: skip
    """Torque of the bristles on a joint that has moved by `moved`, and its slope."""
    torque, slope = 0.0, 0.0
    up, down = c[GRIP_UP] * grip, c[GRIP_DOWN] * grip
    for i in range(len(held)):
        z = held[i] + moved
        if z > reach[i] * up:
            torque += stiffness[i] * reach[i] * up
        elif z < -reach[i] * down:
            torque -= stiffness[i] * reach[i] * down
        else:
            torque += stiffness[i] * z
            slope += stiffness[i]
    return torque, slope


@njit(cache=True)
def obstacles(joint: float, c: np.ndarray) -> tuple[float, float]:
    """Torque of pad and stops on the joint, and its slope."""
    torque, slope = 0.0, 0.0
    if c[PAD] > 0.0:
        depth, dd = indentation(c[PAD_SIDE] * joint - c[PAD_AT], c[PAD_SKIN])
        torque -= c[PAD_SIDE] * c[PAD] * depth
        slope -= c[PAD] * dd
    if c[STOP] > 0.0:
        high, dh = indentation(joint - c[STOP_HIGH], c[STOP_SKIN])
        low, dl = indentation(-joint - c[STOP_LOW], c[STOP_SKIN])
        torque += c[STOP] * (low - high)
        slope -= c[STOP] * (dl + dh)
    return torque, slope


@njit(cache=True)
def balance(uptake: float, payout: float, last: float, outer: float, c: np.ndarray,
            held: np.ndarray, reach: np.ndarray, stiffness: np.ndarray,
            branch_torque: float, branch_slope: float) -> tuple[float, float]:  # fmt: skip
    """Sum of the torques on the joint, and its slope over the uptake.

    Dashpot branches and drag pull with `branch_torque - branch_slope * joint`.
    """
    joint = c[GAIN] * uptake + c[CUBIC] * uptake**3
    gain = c[GAIN] + 3.0 * c[CUBIC] * uptake**2
    back = BENDING_STIFFNESS / (2.0 * c[NOMINAL_WIRE])
    e = payout - uptake + back * joint
    t1, k1 = tension(c[PRETENSION] + e, c)
    t2, k2 = tension(c[PRETENSION] - e, c)
    torque = t1 - t2 - BENDING_STIFFNESS * joint + outer + branch_torque - branch_slope * joint
    slope = -BENDING_STIFFNESS - branch_slope
    if len(held):
        grip = 1.0 + c[CAPSTAN] * abs(joint) / CAPSTAN_DEG
        rub, dr = rubbing(joint - last, grip, c, held, reach, stiffness)
        torque -= rub
        slope -= dr
    if c[WEIGHT] != 0.0:
        pose = np.deg2rad(joint) + c[MOUNTING]
        torque += c[WEIGHT] * (np.sin(pose) - np.sin(c[MOUNTING]))
        slope += c[WEIGHT] * np.cos(pose) * np.pi / 180.0
    stop, ds = obstacles(joint, c)
    return torque + stop, (k1 + k2) * (back * gain - 1.0) + (slope + ds) * gain


@njit(cache=True)
def balanced(start: float, payout: float, last: float, outer: float, c: np.ndarray,
             held: np.ndarray, reach: np.ndarray, stiffness: np.ndarray,
             branch_torque: float, branch_slope: float) -> float:  # fmt: skip
    """Uptake at which the torques balance: Newton from `start`, kept inside a bracket."""
    low, high = start - REACH_DEG, start + REACH_DEG
    uptake = start
    for _ in range(NEWTON_STEPS):
        torque, slope = balance(
            uptake, payout, last, outer, c, held, reach, stiffness, branch_torque, branch_slope
        )
        step = -torque / slope if slope < 0.0 else 2.0 * REACH_DEG
        if abs(step) < TOLERANCE_DEG:
            return uptake + step
        if torque > 0.0:
            low = uptake
        else:
            high = uptake
        uptake = uptake + step if low < uptake + step < high else 0.5 * (low + high)
    return uptake


@njit(cache=True)
def joint_path(shaft: np.ndarray, slip: np.ndarray, gear: np.ndarray, outer: np.ndarray,
               interval_s: np.ndarray, move_s: float, c: np.ndarray, clearance: np.ndarray,
               reach: np.ndarray, stiffness: np.ndarray, dashpot_k: np.ndarray,
               dashpot_s: np.ndarray, viscosity_s: float) -> np.ndarray:  # fmt: skip
    """Joint angle [deg] at the end of each interval, shape (n,).

    `shaft` [deg], the wires' `slip` on the drum [deg] and `outer` torque, all (n,), are reached
    linearly in the first `move_s` of an interval. `gear` is what is uneven about the drum
    (gear.GEAR). `c` are the CONSTANTS. `clearance` is (half width [deg], growth per degree of
    travel, travel at which the growth saturates (0: never), travel before it starts).
    `viscosity_s` is the time constant of the body's drag on the ideal wires (0: none).
    """
    out = np.empty(len(shaft))
    held = np.zeros(len(reach))
    dashpot = np.zeros(len(dashpot_k))
    drum, uptake, joint, travel = shaft[0], shaft[0], 0.0, 0.0
    before, slip_before, outer_before = shaft[0], slip[0], outer[0]
    waits = len(dashpot_k) > 0 or viscosity_s > 0.0
    for i in range(len(shaft)):
        for k in range(MOVE_SUBSTEPS + (len(DWELL_SHARES) if waits else 0)):
            share, dt = 1.0, move_s / MOVE_SUBSTEPS
            if k < MOVE_SUBSTEPS:
                share = (k + 1.0) / MOVE_SUBSTEPS
                travel += abs(shaft[i] - before) / MOVE_SUBSTEPS
            else:
                dt = (interval_s[i] - move_s) * DWELL_SHARES[k - MOVE_SUBSTEPS]
            theta = before + share * (shaft[i] - before)
            half = worn_half_width(clearance, travel)
            drum = min(max(drum, theta - half), theta + half)
            push = outer_before + share * (outer[i] - outer_before)
            payout = drum + error_deg(drum, gear) + slip_before + share * (slip[i] - slip_before)
            branch = dashpot_k * np.exp(-dt / dashpot_s)
            drag = 0.0
            if viscosity_s > 0.0:
                spring = sprung(
                    uptake, payout, joint, push, c, held, reach, stiffness, branch.sum()
                )
                drag = held_back(dt, viscosity_s * 2.0 * c[NOMINAL_WIRE] / c[GAIN], spring)
            uptake = balanced(
                uptake, payout, joint, push, c, held, reach, stiffness,
                (branch * dashpot).sum() + drag * joint, branch.sum() + drag,
            )  # fmt: skip
            new = c[GAIN] * uptake + c[CUBIC] * uptake**3
            drag_along(held, new - joint, 1.0 + c[CAPSTAN] * abs(new) / CAPSTAN_DEG, c, reach)
            dashpot += (new - dashpot) * (1.0 - np.exp(-dt / dashpot_s))
            joint = new
        before, slip_before, outer_before = shaft[i], slip[i], outer[i]
        out[i] = joint
    return out


@njit(cache=True)
def held_back(dt: float, viscosity: float, spring: float) -> float:
    """Stiffness with which drag holds a joint where it was, beside springs of stiffness `spring`.

    viscosity: torque over speed. Exact on linear springs: the joint covers
    1 - exp(-dt spring / viscosity) of its way.
    """
    return spring / np.expm1(dt * spring / viscosity)


@njit(cache=True)
def sprung(uptake: float, payout: float, last: float, outer: float, c: np.ndarray,
           held: np.ndarray, reach: np.ndarray, stiffness: np.ndarray,
           branch_slope: float) -> float:  # fmt: skip
    """Stiffness of all that holds the joint but drag, where it stands; at least a millionth."""
    slope = balance(uptake, payout, last, outer, c, held, reach, stiffness, 0.0, branch_slope)[1]
    return max(-slope / (c[GAIN] + 3.0 * c[CUBIC] * uptake**2), 1e-6)


@njit(cache=True)
def drag_along(held: np.ndarray, moved: float, grip: float, c: np.ndarray,
               reach: np.ndarray) -> None:  # fmt: skip
    """Bend the bristles with the joint, as far as they hold; `held` is changed."""
    for i in range(len(held)):
        z = held[i] + moved
        held[i] = min(max(z, -reach[i] * c[GRIP_DOWN] * grip), reach[i] * c[GRIP_UP] * grip)


@njit(cache=True)
def worn_half_width(clearance: np.ndarray, travel: float) -> float:
    """Half of the play after so much travel of the shaft."""
    worn = max(travel - clearance[3], 0.0)
    if clearance[2] > 0.0:
        worn = clearance[2] * (1.0 - np.exp(-worn / clearance[2]))
    return max(clearance[0] + clearance[1] * worn, 0.0)
