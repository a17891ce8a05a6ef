"""From a drawn case to its recordings and its truth."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

from pipeline.concealed.draw import Case
from pipeline.concealed.motions import RECORDED_CYCLES
from pipeline.concealed.noise import disturbance, lost, mistaken
from pipeline.concealed.plant import respond
from pipeline.recording import Channel, Recording

COMMAND, OTHER = "pitch_command_deg", "yaw_command_deg"
MEASUREMENT, SIMULATION = "pitch_angle_deg", "pitch_angle_sim_deg"
CHANNELS = (
    Channel(COMMAND, "command", "deg"),
    Channel(OTHER, "command", "deg"),
    Channel(MEASUREMENT, "measurement", "deg"),
    Channel(SIMULATION, "simulation", "deg", MEASUREMENT),
)
SOURCE = "concealed plant"


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
    """Run the plant of a case, and blur what its camera sees."""
    motion = case.motion
    recorded = motion.cycle < RECORDED_CYCLES
    span = float(motion.time_s[recorded][-1] - motion.time_s[0])
    simulated = case.nominal.angle_deg(motion.pitch_deg)
    seen = respond(case.plant(), motion, span)
    clean = (1.0 + case.gain_error) * seen + case.offset_deg + bend_deg(case, seen)
    rng = np.random.default_rng([case.seed, 1])
    n = int(recorded.sum())
    wrong = mistaken(case.noise, n, rng)
    blurred = clean[:n] + disturbance(case.noise, motion.cycle[:n], rng) + wrong
    blurred[lost(case.noise, n, rng)] = np.nan
    measured = np.full(len(clean), np.nan)
    measured[:n] = np.round(blurred, 4)
    flagged = np.zeros(len(clean), dtype=bool)
    flagged[:n] = wrong != 0
    return Realised(simulated, clean, measured, flagged, recorded)


def bend_deg(case: Case, seen_deg: np.ndarray) -> np.ndarray:
    """Smooth error of the simulated curve at an angle [deg], shape of `seen_deg`."""
    top = float(np.abs(case.nominal.angle_deg(case.motion.pitch_deg)).max())
    x = np.clip(seen_deg / top, -1.1, 1.1)
    unit = (1.5 * x**2 - 0.5, 2.5 * x**3 - 1.5 * x, (35 * x**4 - 30 * x**2 + 3) / 8)
    norms = (np.sqrt(5.0), np.sqrt(7.0), 3.0)
    return np.asarray(sum(a * b * c for a, b, c in zip(case.bend_deg, unit, norms, strict=True)))


def recordings_of(case: Case, realised: Realised) -> tuple[Recording, Recording]:
    """The recording to be diagnosed, and the same with six later cycles not measured."""
    motion = case.motion
    table = pd.DataFrame(
        {
            "time_s": motion.time_s, "cycle": motion.cycle, "step": motion.step,
            COMMAND: motion.pitch_deg, OTHER: motion.yaw_deg,
            MEASUREMENT: realised.measured_deg,
            SIMULATION: np.round(realised.simulated_deg, 4),
        }
    )  # fmt: skip
    first = table[realised.recorded]
    return Recording(first, CHANNELS, SOURCE), Recording(table, CHANNELS, SOURCE)
