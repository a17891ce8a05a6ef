"""The uneven gear between the motor's shaft and the drum."""

import numpy as np
from numba import njit

GEAR = ("mesh_deg", "mesh_period_deg", "mesh_phase", "mesh_overtone")
AMPLITUDE, PERIOD, PHASE, OVERTONE = range(len(GEAR))


@njit(cache=True)
def error_deg(turned_deg, gear):  # type: ignore[no-untyped-def]
    """Error [deg] of what is paid out at `turned_deg` (one angle or many), none at 0.

    An eccentric wheel and the overtone of its teeth; `gear` are the numbers of `GEAR`.
    """
    turn = 2 * np.pi * turned_deg / gear[PERIOD] + gear[PHASE]
    error = np.sin(turn) + gear[OVERTONE] * np.sin(2 * turn + 0.7)
    start = np.sin(gear[PHASE]) + gear[OVERTONE] * np.sin(2 * gear[PHASE] + 0.7)
    return gear[AMPLITUDE] * (error - start)
