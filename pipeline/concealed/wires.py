"""Shaft to joint: drum clearance, two wires in their sheaths, and the joint that they bend.

At every substep the joint stands where all torques balance; what remembers are the drum in its
clearance, the bristles of the sheath (each sticks until its torque reaches a threshold), the
dashpots of the body and the wear of the clearance. Torques are in units of the joint's bending
stiffness times a degree.
"""

import numpy as np
from numba import njit

MOVE_SUBSTEPS = 4
DWELL_SHARES = np.array([0.02, 0.08, 0.25, 0.65])
BENDING_STIFFNESS = 1.0
NEWTON_STEPS = 40
ANGLE_TOLERANCE_DEG = 1e-9


@njit(cache=True)
def tension(elongation: float, stiffness: float, toe_share: float, toe_deg: float,
            round_deg: float) -> tuple[float, float]:  # fmt: skip
    """Tension of one wire and its slope; none while slack, soft at first where it has a toe."""
    x, dx = elongation, 1.0
    if round_deg > 0.0:
        z = elongation / round_deg
        if z < 30.0:
            x = round_deg * np.log1p(np.exp(z))
            dx = 1.0 / (1.0 + np.exp(-z))
    elif x <= 0.0:
        return 0.0, 0.0
    if toe_deg <= 0.0:
        return stiffness * x, stiffness * dx
    fade = np.exp(-x / toe_deg)
    force = stiffness * (x - (1.0 - toe_share) * toe_deg * (1.0 - fade))
    return force, stiffness * (1.0 - (1.0 - toe_share) * fade) * dx


@njit(cache=True)
def pad(depth: float, skin_deg: float) -> tuple[float, float]:
    """Indentation (and its slope) of a pad that starts soft over `skin_deg`."""
    if depth <= 0.0:
        return 0.0, 0.0
    if depth < skin_deg:
        return 0.5 * depth * depth / skin_deg, depth / skin_deg
    return depth - 0.5 * skin_deg, 1.0


@njit(cache=True)
def uptake(joint: float, gain: float, cubic: float) -> tuple[float, float]:
    """Drum angle q with gain q + cubic q^3 = joint, and its slope."""
    q = joint / gain
    for _ in range(6):
        q -= (gain * q + cubic * q * q * q - joint) / (gain + 3.0 * cubic * q * q)
    return q, 1.0 / (gain + 3.0 * cubic * q * q)


@njit(cache=True)
def bristle_torque(joint: float, last: float, held: np.ndarray, reach: np.ndarray,
                   stiffness: np.ndarray, up: float, down: float) -> tuple[float, float]:  # fmt: skip
    """Torque of the bristles against the joint if it went from `last` to `joint`, and its slope."""
    torque, slope = 0.0, 0.0
    for i in range(len(held)):
        z = held[i] + joint - last
        if z > reach[i] * up:
            torque += stiffness[i] * reach[i] * up
        elif z < -reach[i] * down:
            torque -= stiffness[i] * reach[i] * down
        else:
            torque += stiffness[i] * z
            slope += stiffness[i]
    return torque, slope


@njit(cache=True)
def balance(drum: float, joint: float, last: float, outer: float, c: np.ndarray,
            held: np.ndarray, reach: np.ndarray, stiffness: np.ndarray,
            dashpot: np.ndarray, dashpot_k: np.ndarray, shrink: np.ndarray) -> tuple[float, float]:  # fmt: skip
    """Sum of the torques on the joint and its slope (never positive but for gravity)."""
    wire, toe_share, toe_deg, pretension, round_deg, gain, cubic, nominal_wire = c[:8]
    q, dq = uptake(joint, gain, cubic)
    back = BENDING_STIFFNESS / (2.0 * nominal_wire)
    e = drum - q + back * joint
    de = -dq + back
    t1, k1 = tension(pretension + e, wire, toe_share, toe_deg, round_deg)
    t2, k2 = tension(pretension - e, wire, toe_share, toe_deg, round_deg)
    torque = t1 - t2 - BENDING_STIFFNESS * joint + outer
    slope = (k1 + k2) * de - BENDING_STIFFNESS
    grip = 1.0 + c[8] * abs(joint) / 45.0
    rubbing, ds = bristle_torque(joint, last, held, reach, stiffness, c[9] * grip, c[10] * grip)
    torque -= rubbing
    slope -= ds
    for m in range(len(dashpot)):
        torque -= dashpot_k[m] * (joint - dashpot[m]) * shrink[m]
        slope -= dashpot_k[m] * shrink[m]
    torque += c[11] * (np.sin(np.deg2rad(joint) + c[12]) - np.sin(c[12]))
    slope += c[11] * np.cos(np.deg2rad(joint) + c[12]) * np.pi / 180.0
    side = c[16]
    depth, dd = pad(side * joint - c[14], c[15])
    torque -= side * c[13] * depth
    slope -= c[13] * dd
    depth, dd = pad(joint - c[18], c[20])
    torque -= c[17] * depth
    slope -= c[17] * dd
    depth, dd = pad(-joint - c[19], c[20])
    torque += c[17] * depth
    slope -= c[17] * dd
    return torque, slope


@njit(cache=True)
def solve_joint(drum: float, last: float, outer: float, c: np.ndarray, held: np.ndarray,
                reach: np.ndarray, stiffness: np.ndarray, dashpot: np.ndarray,
                dashpot_k: np.ndarray, shrink: np.ndarray) -> float:  # fmt: skip
    """Joint angle at which the torques balance: Newton, kept inside a bracket."""
    low, high = last - 30.0, last + 30.0
    joint = last
    for _ in range(NEWTON_STEPS):
        torque, slope = balance(
            drum, joint, last, outer, c, held, reach, stiffness, dashpot, dashpot_k, shrink
        )
        if torque > 0.0:
            low = joint
        else:
            high = joint
        step = -torque / slope if slope < 0.0 else 0.0
        nxt = joint + step
        if slope >= 0.0 or nxt <= low or nxt >= high:
            nxt = 0.5 * (low + high)
        if abs(nxt - joint) < ANGLE_TOLERANCE_DEG:
            return nxt
        joint = nxt
    return joint


@njit(cache=True)
def joint_path(shaft: np.ndarray, outer: np.ndarray, interval_s: np.ndarray, move_s: float,
               c: np.ndarray, clearance: np.ndarray, reach: np.ndarray, stiffness: np.ndarray,
               dashpot_k: np.ndarray, dashpot_s: np.ndarray) -> np.ndarray:  # fmt: skip
    """Joint angle [deg] at the end of each interval, shape (n,).

    `shaft` [deg] and `outer` torque, both (n,), are reached linearly in the first `move_s` of an
    interval. `clearance` is (half width [deg], growth per degree of travel, travel at which the
    growth saturates (0: never), travel before it starts).
    """
    n = len(shaft)
    out = np.empty(n)
    held = np.zeros(len(reach))
    dashpot = np.zeros(len(dashpot_k))
    shrink = np.ones(len(dashpot_k))
    drum, joint, travel = shaft[0], 0.0, 0.0
    before, outer_before = shaft[0], outer[0]
    substeps = MOVE_SUBSTEPS + (len(DWELL_SHARES) if len(dashpot_k) else 0)
    for i in range(n):
        for k in range(substeps):
            if k < MOVE_SUBSTEPS:
                share, dt = (k + 1.0) / MOVE_SUBSTEPS, move_s / MOVE_SUBSTEPS
            else:
                share, dt = 1.0, (interval_s[i] - move_s) * DWELL_SHARES[k - MOVE_SUBSTEPS]
            theta = before + share * (shaft[i] - before)
            if k < MOVE_SUBSTEPS:
                travel += abs(shaft[i] - before) / MOVE_SUBSTEPS
            half = worn_half_width(clearance, travel)
            drum = min(max(drum, theta - half), theta + half)
            push = outer_before + share * (outer[i] - outer_before)
            for m in range(len(dashpot)):
                shrink[m] = dashpot_s[m] / (dashpot_s[m] + dt)
            new = solve_joint(
                drum, joint, push, c, held, reach, stiffness, dashpot, dashpot_k, shrink
            )
            grip = 1.0 + c[8] * abs(new) / 45.0
            for b in range(len(held)):
                z = held[b] + new - joint
                held[b] = min(max(z, -reach[b] * c[10] * grip), reach[b] * c[9] * grip)
            for m in range(len(dashpot)):
                dashpot[m] = new - (new - dashpot[m]) * shrink[m]
            joint = new
        before, outer_before = shaft[i], outer[i]
        out[i] = joint
    return out


@njit(cache=True)
def worn_half_width(clearance: np.ndarray, travel: float) -> float:
    """Half of the play after so much travel of the shaft."""
    worn = max(travel - clearance[3], 0.0)
    if clearance[2] > 0.0:
        worn = clearance[2] * (1.0 - np.exp(-worn / clearance[2]))
    return max(clearance[0] + clearance[1] * worn, 0.0)
