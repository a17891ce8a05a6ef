"""Loops with memory beside SciPy: python benchmarks/loops.py

1800 samples, nine cycles of +-60 deg, one thread, best of 200 in turn. `loop` is the compiled loop
alone, as if no cycle came again, `again` the same where all are known to be alike, and `term` all
that a fit pays for one answer of a mechanism then. Peers: scipy.signal.lfilter as the quickest
recursion at hand (a first-order lag and nothing else), and scipy.integrate.solve_ivp (LSODA, rtol
1e-6) on a Bouc-Wen loop over the same motion, the usual way to simulate friction with pre-sliding.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import timing
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from pipeline.physics import balance as at_joint
from pipeline.physics.catalogue import term
from pipeline.physics.mechanism import Mechanism
from pipeline.physics.motion import Motion
from pipeline.physics.piece import Piece
from pipeline.physics.play_operator import play
from pipeline.physics.second_order_lag import swung

SAMPLES, CYCLES, ROUNDS = 1800, 9, 200
WANTED_US = 20.0
LOOPS = {
    "friction": {"friction": [5.0, 4.0, 0.7]},
    "creep": {"creep": [0.2, 9.0]},
    "lag": {"response_lag": [2.0]},
    "friction, creep": {"friction": [5.0, 4.0, 0.7], "creep": [0.2, 9.0]},
    "friction, creep, lag": {
        "friction": [5.0, 4.0, 0.7], "creep": [0.2, 9.0], "response_lag": [2.0],
    },
    "stop": {"end_stop": [30.0, 0.3, 0.02]},
    "friction, stop": {"friction": [5.0, 4.0, 0.7], "end_stop": [30.0, 0.3, 0.02]},
    "gravity": {"gravity": [4.0, 0.4]},
    "compliance": {"compliance": [0.3, 10.0, 0.1, 0.2]},
    "slack": {"slack": [8.0, 0.0, 0.2, 0.05]},
    "slack, creep": {"slack": [8.0, 0.0, 0.2, 0.05], "creep": [0.2, 9.0]},
    "loaded wire": {"creep/loaded wire": [0.1, 30.0, 0.05, 0.5, 0.0]},
    "friction, loaded wire": {
        "friction": [5.0, 4.0, 0.7], "creep/loaded wire": [0.1, 30.0, 0.05, 0.5, 0.0],
    },
}  # fmt: skip


def cycles() -> Motion:
    """The motion that all are timed on."""
    phase = np.arange(SAMPLES) * CYCLES / SAMPLES % 1.0
    drive = 60.0 * np.interp(phase, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    rows = np.arange(SAMPLES)
    return Motion(drive, 3.0 * rows, rows * CYCLES // SAMPLES)


def loop_of(mechanism: Mechanism, motion: Motion) -> Callable[[], object]:
    """What a mechanism in balance runs in compiled loops, ready to be called again."""
    solve, given = at_joint.solve, []
    at_joint.solve = lambda *arguments: (given.extend(arguments), solve(*arguments))[1]
    mechanism.respond(motion)
    at_joint.solve = solve
    return lambda: solve(*given)


def bouc_wen(motion: Motion) -> np.ndarray:
    """The hysteretic part of a Bouc-Wen loop along a motion, (n,)."""
    time, drive = motion.time_s, motion.drive
    speed = np.diff(drive) / np.diff(time)
    last = len(speed) - 1

    def slope(t: float, z: np.ndarray) -> np.ndarray:
        v = speed[min(int(t / time[1]), last)]
        return v - 0.5 * abs(v) * z / 4.0 - 0.5 * v * abs(z) / 4.0

    return solve_ivp(slope, (time[0], time[-1]), [0.0], "LSODA", time, rtol=1e-6, max_step=3.0).y[0]


def main() -> None:
    motion = cycles()
    pole = np.exp(-3.0 / 2.0)
    dwell_s = motion.dwell_s + 0.005 * np.sin(np.arange(SAMPLES))
    rivals: dict[str, Callable[[], object]] = {
        "play": lambda: play(motion.drive, 2.0, 0.0),
        "lag, second order": lambda: swung(
            motion.drive, dwell_s, 0.0 * dwell_s, 0.8, 0.3, 0.0, np.zeros(2)
        ),
        "scipy lfilter (lag)": lambda: lfilter([1.0 - pole], [1.0, -pole], motion.drive),
    }
    alone = replace(motion, cycle=np.zeros_like(motion.cycle))
    alike, whole = {}, {}
    for name, parts in LOOPS.items():
        pieces = [Piece(term(*n.split("/")), np.array(values)) for n, values in parts.items()]
        mechanism = Mechanism(pieces=pieces)
        rivals[name] = loop_of(mechanism, alone)
        alike[name] = loop_of(mechanism, motion)
        whole[name] = lambda m=mechanism: m.respond(motion)
    timing.ROUNDS = ROUNDS
    loops, again, terms = (timing.best_s(these) for these in (rivals, alike, whole))
    timing.ROUNDS = 3
    loops |= timing.best_s({"scipy solve_ivp (Bouc-Wen)": lambda: bouc_wen(motion)})
    head = "".join(f"{column:>10}" for column in ("loop", "again", "term"))
    print(f"{'':27}{head}  us for {SAMPLES} samples, wanted <= {WANTED_US:g}")
    for name, time_s in loops.items():
        more = [times[name] for times in (again, terms) if name in times]
        print(f"{name:27}" + "".join(f"{1e6 * t:10.1f}" for t in (time_s, *more)))


if __name__ == "__main__":
    main()
