"""Simulation of a run: the recording with the simulation that the configuration names."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException
from yaml import MarkedYAMLError, YAMLError

from pipeline.config import Config, SimulatedAxis, SimulationConfig
from pipeline.errors import LoopgapError, UsageError, refusal
from pipeline.recording import Recording, load_recording
from pipeline.stages.simulation import simulate

LONG_GAP = 5.0  # times the median step


def with_simulation(config: Config, recording: Recording) -> Recording:
    """The recording with a simulation of every measurement; a trace's resampling is said."""
    settings, heldout = config.simulation, config.diagnosis.heldout
    cutoff_hz = config.diagnosis.cutoff_hz
    lacking = [
        c.name
        for c in recording.with_role("measurement")
        if recording.simulation_of(c.name) is None
    ]
    if asked_for(settings) and not lacking:
        print("  the recording brings its own simulation of each measurement: "
              f"simulation={settings.kind} is not used")  # fmt: skip
    if settings.kind == "trace" and lacking:
        trace = read_trace(settings.path, lacking)
        _say(trace, recording)
        return simulate(settings, recording, heldout, trace, cutoff_hz)
    if settings.kind == "mechanism" and settings.path is not None:
        settings = replace(settings, axes={**settings.axes, **read_axes(settings.path)})
    return simulate(settings, recording, heldout, cutoff_hz=cutoff_hz)


def asked_for(settings: SimulationConfig) -> bool:
    """Whether somebody named this simulation; else it is the twin's, or none."""
    return settings.kind not in ("recorded", "mechanism") or settings.path is not None


def _say(trace: pd.DataFrame, recording: Recording) -> None:
    own, wanted = trace["time_s"].to_numpy(float), recording.values("time_s")
    outside = int(((wanted < own[0]) | (wanted > own[-1])).sum())
    left = f"; {outside} rows of the recording are outside its times and left out"
    print(
        f"  simulation: {len(own)} samples, one each {np.median(np.diff(own)):.4g} s, resampled to "
        f"the recording's times (straight between samples){left if outside else ''}"
    )
    for name in trace.columns.drop("time_s"):
        steps = np.diff(own[np.isfinite(trace[name].to_numpy(float))])
        if steps.max() > LONG_GAP * np.median(steps):
            print(f"    {name}: its longest gap, {steps.max():.4g} s, is bridged straight, too")


def read_trace(path: str | None, measurements: list[str]) -> pd.DataFrame:
    """`time_s` and a column for each measurement, from a recording's folder or a csv or parquet.

    A recording's own simulation channels stand for their measurements; in a file each column is
    called as its measurement. UsageError or LoopgapError where something is missing.
    """
    if path is None or not Path(path).exists():
        raise UsageError(
            refusal("simulation.path", "a recording's folder, a csv or a parquet file", repr(path),
                    "Say simulation=trace simulation.path=FILE.")
        )  # fmt: skip
    place = Path(path)
    if place.is_dir():
        recording = load_recording(place)
        table = recording.samples.rename(
            columns={c.name: c.of for c in recording.with_role("simulation") if c.of}
        )
        table = table.loc[:, ~table.columns.duplicated(keep="last")]
    else:
        try:
            read = pd.read_parquet if place.suffix == ".parquet" else pd.read_csv
            table = read(place)
        except (OSError, ValueError, UnicodeDecodeError) as error:
            raise LoopgapError(
                refusal(path, "a table", str(error), "Write the file anew.")
            ) from error
    wanted = ["time_s", *measurements]
    missing = [n for n in wanted if n not in table]
    if missing:
        raise LoopgapError(
            refusal(path, f"columns {', '.join(wanted)}", f"no {missing[0]}; there are "
                    f"{', '.join(map(str, table.columns))}",
                    "Name each column after the measurement that it simulates.")
        )  # fmt: skip
    numbers = table[wanted].apply(pd.to_numeric, errors="coerce")
    for name in wanted:
        text = np.flatnonzero(numbers[name].isna() & table[name].notna())
        if text.size:
            raise LoopgapError(
                refusal(f"{path}, column {name!r}, row {text[0]} (from 0)", "a number",
                        repr(str(table[name].iloc[text[0]])), "Correct it or leave it empty.")
            )  # fmt: skip
    _refuse_falling(path, numbers["time_s"].to_numpy(float))
    for name in measurements:
        if np.isfinite(numbers[name].to_numpy(float)).sum() < 2:
            raise LoopgapError(
                refusal(f"{path}, column {name!r}", "numbers", "fewer than two", "Correct it.")
            )
    return numbers


def _refuse_falling(path: str, time_s: np.ndarray) -> None:
    if len(time_s) < 2:
        raise LoopgapError(
            refusal(path, "at least two rows", str(len(time_s)), "Give the whole trace.")
        )
    falls = np.flatnonzero(~(np.diff(time_s) > 0))
    if falls.size:
        k = int(falls[0])
        raise LoopgapError(
            refusal(f"{path}, column 'time_s', row {k + 1} (from 0)", "rising numbers",
                    f"{time_s[k + 1]:g} after {time_s[k]:g}", "Sort the rows; leave none empty.")
        )  # fmt: skip


def read_axes(path: str) -> dict[str, SimulatedAxis]:
    """Mechanisms by measurement from a YAML file, see conf/simulation/mechanism.yaml."""
    try:
        raw = OmegaConf.to_container(OmegaConf.load(path))
        if not isinstance(raw, dict) or not raw:
            raise ValueError("no mapping from measurements to mechanisms")
        schema = OmegaConf.structured(SimulationConfig)
        merged = OmegaConf.merge(schema, {"axes": {k: _axis(v) for k, v in raw.items()}})
        axes = OmegaConf.to_object(merged)
    except (
        OSError,
        YAMLError,
        OmegaConfBaseException,
        ValueError,
        TypeError,
        AttributeError,
    ) as error:
        raise UsageError(
            refusal(path, "measurement: {command, gain, cubic, terms: [- name: {width: 3}]}",
                    _first_words(error), "See conf/simulation/mechanism.yaml.")
        ) from error  # fmt: skip
    assert isinstance(axes, SimulationConfig)
    return axes.axes


def _first_words(error: Exception) -> str:
    """What is wrong, in a line; of broken YAML the problem and its line."""
    if isinstance(error, MarkedYAMLError) and error.problem_mark is not None:
        return f"in line {error.problem_mark.line + 1}: {error.problem}"
    return str(error).splitlines()[0]


def _axis(entry: dict[str, Any]) -> dict[str, Any]:
    terms = entry.get("terms") or {}
    if isinstance(terms, list):
        listed = [{term: {}} if isinstance(term, str) else term for term in terms]
        named = [(name, values) for term in listed for name, values in term.items()]
        terms = dict(named)
        if len(terms) < len(named):
            raise ValueError(f"a term twice among {', '.join(name for name, _ in named)}")
    numbers = {k: {n: float(x) for n, x in (v or {}).items()} for k, v in terms.items()}
    return {**entry, "terms": numbers}
