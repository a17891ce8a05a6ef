"""From a drawn case to its recordings and its truth."""

from dataclasses import astuple, dataclass

import numpy as np
import pandas as pd

from pipeline.concealed.draw import Case
from pipeline.concealed.motions import RECORDED_CYCLES, Motion
from pipeline.concealed.noise import disturbance, lost, mistaken
from pipeline.concealed.plant import respond
from pipeline.recording import Channel, Recording, cycles_from_reversals

COMMAND, OTHER = "pitch_command_deg", "yaw_command_deg"
MEASUREMENT, SIMULATION = "pitch_angle_deg", "pitch_angle_sim_deg"
CHANNELS = (
    Channel(COMMAND, "command", "deg"),
    Channel(OTHER, "command", "deg"),
    Channel(MEASUREMENT, "measurement", "deg"),
    Channel(SIMULATION, "simulation", "deg", MEASUREMENT),
)
SOURCE = "concealed plant"
HANDOVER_S = 3.36


@dataclass(frozen=True)
class Realised:
    """All samples of a case, the later cycles included; shape (n,) each.

    `clean_deg` is what a perfect reader would measure, `measured_deg` is NaN where no frame is.
    """

    simulated_deg: np.ndarray
    clean_deg: np.ndarray
    measured_deg: np.ndarray
    mistaken: np.ndarray
    recorded: np.ndarray


def realise(case: Case) -> Realised:
    """Run the plant of a case, and blur what its camera sees in the recorded cycles."""
    recorded = case.motion.cycle < RECORDED_CYCLES
    clean = clean_deg(case, case.motion)
    n = int(recorded.sum())
    measured, flagged = np.full(len(clean), np.nan), np.zeros(len(clean), dtype=bool)
    measured[:n], flagged[:n] = _measured(case, clean[:n], case.motion.cycle[:n], stream=1)
    simulated = case.simulated_deg(case.motion)
    return Realised(simulated, clean, measured, flagged, recorded)


def clean_deg(case: Case, motion: Motion) -> np.ndarray:
    """What a perfect reader would measure along a motion that starts like the case's own, (n,)."""
    own = case.motion.time_s[case.motion.cycle < RECORDED_CYCLES]
    seen = respond(case.plant(), motion, span_s=float(own[-1] - own[0]))
    return np.asarray((1.0 + case.gain_error) * seen + case.offset_deg + bend_deg(case, seen))


def _measured(
    case: Case, clean: np.ndarray, cycle: np.ndarray, stream: int
) -> tuple[np.ndarray, np.ndarray]:
    """Blurred angles [deg] (NaN: lost frame), and which frames mistook the marker; (n,) each."""
    rng = np.random.default_rng([case.seed, stream])
    wrong = mistaken(case.noise, len(clean), rng)
    blurred = clean + disturbance(case.noise, cycle, rng) + wrong
    blurred[lost(case.noise, len(clean), rng)] = np.nan
    return np.round(blurred, 4), wrong != 0


def follow_up(case: Case, commands: pd.DataFrame) -> Recording:
    """The recorded cycles and, after them, the plant's answer to a proposed block of commands.

    `commands` has `time_s` (from any start) and the command columns; a column that isn't there
    holds its last value. The block's cycles count on from the recorded ones.
    """
    first = case.motion.head(RECORDED_CYCLES)
    clock = commands["time_s"].to_numpy(float)
    time = first.time_s[-1] + HANDOVER_S + clock - clock[0]
    pitch, yaw = (
        commands[name].to_numpy(float) if name in commands else np.full(len(time), held[-1])
        for name, held in ((COMMAND, first.pitch_deg), (OTHER, first.yaw_deg))
    )
    cycle = RECORDED_CYCLES + cycles_from_reversals(pitch)
    block = Motion(time, cycle, np.arange(len(time)), pitch, yaw)
    motion = Motion(
        *(np.concatenate(pair) for pair in zip(astuple(first), astuple(block), strict=True))
    )
    n = len(first.time_s)
    clean = clean_deg(case, motion)
    before, _ = _measured(case, clean[:n], motion.cycle[:n], stream=1)
    after, _ = _measured(case, clean[n:], motion.cycle[n:] - RECORDED_CYCLES, stream=4)
    table = _table(motion, np.concatenate([before, after]), case.simulated_deg(motion))
    return Recording(table, CHANNELS, SOURCE)


def bend_deg(case: Case, seen_deg: np.ndarray) -> np.ndarray:
    """Smooth error of the simulated curve at an angle [deg], shape of `seen_deg`."""
    top = float(np.abs(case.nominal.angle_deg(case.motion.pitch_deg)).max())
    x = np.clip(seen_deg / top, -1.1, 1.1)
    unit = (1.5 * x**2 - 0.5, 2.5 * x**3 - 1.5 * x, (35 * x**4 - 30 * x**2 + 3) / 8)
    norms = (np.sqrt(5.0), np.sqrt(7.0), 3.0)
    return np.asarray(sum(a * b * c for a, b, c in zip(case.bend_deg, unit, norms, strict=True)))


def recordings_of(case: Case, realised: Realised) -> tuple[Recording, Recording]:
    """The recording to be diagnosed, and the same with six later cycles not measured."""
    table = _table(case.motion, realised.measured_deg, realised.simulated_deg)
    first = table[realised.recorded]
    return Recording(first, CHANNELS, SOURCE), Recording(table, CHANNELS, SOURCE)


def _table(motion: Motion, measured_deg: np.ndarray, simulated_deg: np.ndarray) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "time_s": np.round(motion.time_s, 3),
            "cycle": motion.cycle,
            "step": motion.step,
            COMMAND: motion.pitch_deg,
            OTHER: motion.yaw_deg,
            MEASUREMENT: measured_deg,
            SIMULATION: np.round(simulated_deg, 4),
        }
    )
