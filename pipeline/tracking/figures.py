"""Figures of a run, for the screen (PNG) and for print (PDF); the one file that knows matplotlib.

Colours are Okabe and Ito's, told apart by every kind of colour vision; a line style or a marker
always says the same as the colour.
"""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pipeline.atomically import write_atomically

COLOURS = {
    "measured": "#6E6E6E",
    "desired": "#000000",
    "nominal": "#D55E00",
    "compensated": "#0072B2",
    "cw": "#0072B2",
    "ccw": "#009E73",
    "as_printed": "#CC79A7",
    "other": "#E69F00",
    "faint": "#C8C8C8",
}
MARKERS = {"nominal": "s", "compensated": "o", "as_printed": "^", "cw": "o", "ccw": "D"}
NAMES = {
    "nominal": "nominal",
    "compensated": "compensated",
    "as_printed": "algorithm as printed",
    "cw": "ascending (cw)",
    "ccw": "descending (ccw)",
}
STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.labelsize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "figure.titlesize": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.grid": True,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.6,
    "pdf.fonttype": 42,
}
WIDTH_IN = 7.2
PNG_DPI = 200
CRITERION_LINEAR = 10.0

mpl.rcParams.update(STYLE)  # type: ignore[arg-type]


def new_figure(
    rows: int = 1,
    columns: int = 1,
    *,
    height_in: float = 3.4,
    width_in: float = WIDTH_IN,
    sharex: bool | str = False,
    sharey: bool | str = False,
    height_ratios: list[float] | None = None,
    width_ratios: list[float] | None = None,
) -> tuple[Figure, np.ndarray]:
    """A figure in the house style and its axes, shape (rows, columns)."""
    figure = Figure(figsize=(width_in, height_in), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(
        rows,
        columns,
        squeeze=False,
        sharex=sharex,  # type: ignore[arg-type]
        sharey=sharey,  # type: ignore[arg-type]
        height_ratios=height_ratios,
        width_ratios=width_ratios,
    )
    return figure, axes


def save_figure(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Write `name`.png and `name`.pdf, each whole or not at all; the paths written.

    The PNG lays the figure out, and there its parts stay: each picture more would take as long.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for suffix in ("png", "pdf"):
        path = folder / f"{name}.{suffix}"
        write_atomically(path, figure_bytes(figure, suffix))
        paths.append(path)
        figure.set_layout_engine(None)  # "none" would draw each picture twice
    return paths


def figure_bytes(figure: Figure, suffix: str = "png") -> bytes:
    """The figure as an encoded PNG or PDF; the same data give the same bytes."""
    buffer = io.BytesIO()
    metadata: dict[str, Any] = {"CreationDate": None} if suffix == "pdf" else {"Software": None}
    figure.savefig(buffer, format=suffix, dpi=PNG_DPI, metadata=metadata)
    return buffer.getvalue()


def selection_figure(
    selection: pd.DataFrame, chosen: Mapping[str, Mapping[str, int]], criterion: str
) -> Figure:
    """BIC, AIC and held-out error over the number of components, a row of panels for each axis.

    `selection` has axis, model (nominal, cw, ccw), k, bic, aic, heldout_rmse_deg; `chosen` gives
    each model's K by axis. BIC and AIC are shown above their least value, logarithmically from 10.
    """
    names = list(dict.fromkeys(selection["axis"]))
    figure, axes = new_figure(len(names), 3, height_in=0.7 + 2.1 * len(names), sharex=True)
    panels = (("bic", "BIC", "above its minimum"), ("aic", "AIC", "above its minimum"),
              ("heldout_rmse_deg", "held-out error", "RMSE [deg]"))  # fmt: skip
    for row, axis in zip(axes, names, strict=True):
        for panel, (column, title, label) in zip(row, panels, strict=True):
            for model, table in selection[selection["axis"] == axis].groupby("model", sort=False):
                _selection_line(panel, table, column, str(model), chosen[axis][str(model)])
            if column != "heldout_rmse_deg":
                panel.set_yscale("symlog", linthresh=CRITERION_LINEAR)
            panel.set_title(f"{axis}: {title}")
            panel.set_ylabel(label)
            panel.set_ylim(bottom=0.0)
            panel.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=6))
    for panel in axes[-1]:
        panel.set_xlabel("number of components K")
    _shared_legend(figure, axes[0, 0], 3)
    chosen_by = criterion.upper() if criterion in ("bic", "aic") else criterion
    figure.suptitle(f"How many components each model needs (filled: chosen by {chosen_by})")
    return figure


def loops_figure(predictions: Mapping[str, pd.DataFrame]) -> Figure:
    """Measured loops of the test cycles with each model's mean and +-2 deviations.

    Above the loop as it is; below the same without the nominal mean, which opens it.
    `predictions`: axis -> table of `stages.evaluation.predict_cycles`.
    """
    figure, axes = new_figure(
        2, len(predictions), height_in=5.8, sharex="col", height_ratios=[1.25, 1.0]
    )
    for (upper, lower), (axis, table) in zip(axes.T, predictions.items(), strict=True):
        _loop_panel(upper, table, opened=False)
        _loop_panel(lower, table, opened=True)
        upper.set_title(f"{axis}: the loop")
        upper.set_ylabel("bending angle [deg]")
        lower.set_title(f"{axis}: the loop without its nominal curve")
        lower.set_ylabel("angle − nominal [deg]")
        lower.set_xlabel("command [deg of motor shaft]")
    _shared_legend(figure, axes[0, 0], 4 if len(predictions) > 1 else 2)
    figure.suptitle("Hysteresis on the test cycles (bands, thin lines: ± 2 standard deviations)")
    return figure


def loop_picture(axis: str, predictions: pd.DataFrame) -> bytes:
    """One axis of `loops_figure` alone as an encoded PNG, for the review."""
    figure = loops_figure({axis: predictions})
    figure.set_size_inches(4.4, 5.2)
    figure.suptitle("")
    return figure_bytes(figure)


def errors_figure(predictions: Mapping[str, pd.DataFrame]) -> Figure:
    """Prediction errors over the test cycles' samples, with their distribution beside.

    `predictions`: axis -> table of `stages.evaluation.predict_cycles`.
    """
    height_in = 0.9 + 1.9 * len(predictions)
    figure, axes = new_figure(
        len(predictions), 2, height_in=height_in, sharey="row", width_ratios=[3.4, 1.0]
    )
    for (left, right), (axis, table) in zip(axes, predictions.items(), strict=True):
        errors = {
            method: (table["measured_deg"] - table[f"{method}_deg"]).to_numpy(float)
            for method in ("nominal", "compensated")
        }
        reach = np.nanmax(np.abs(np.concatenate(list(errors.values())))) + 1e-6
        for method, error in errors.items():
            colour = COLOURS[method]
            left.plot(error, MARKERS[method], ms=2.6, mfc="none", mew=0.6, color=colour,
                      label=NAMES[method])  # fmt: skip
            right.hist(error[np.isfinite(error)], bins=np.linspace(-reach, reach, 41),
                       orientation="horizontal", density=True, histtype="stepfilled",
                       fc=(colour, 0.3), ec=colour)  # fmt: skip
        _mark_cycles(left, table["cycle"].to_numpy())
        left.axhline(0.0, color="black", lw=0.8)
        nominal, compensated = (np.sqrt(np.nanmean(error**2)) for error in errors.values())
        left.set_title(f"{axis}: RMSE {nominal:.2f} deg nominal, {compensated:.2f} deg compensated")
        left.set_ylabel("measured − predicted [deg]")
        right.set_title("distribution")
        right.set_xticks([])
        right.grid(visible=False)
    axes[-1, 0].set_xlabel("sample of the test cycles (dotted: a new cycle)")
    _shared_legend(figure, axes[0, 0], 2)
    figure.suptitle("Prediction error on cycles that no fit has seen")
    return figure


def tracking_figure(landings: Mapping[str, Mapping[str, pd.DataFrame]]) -> Figure:
    """Closed loop: desired and measured angle over the targets, and the error below.

    `landings`: axis -> method -> table of `stages.evaluation.land`.
    """
    figure, axes = new_figure(2, len(landings), height_in=4.8, sharex="col")
    for (upper, lower), (axis, methods) in zip(axes.T, landings.items(), strict=True):
        target = next(iter(methods.values()))["target_deg"].to_numpy(float)
        upper.plot(target, color=COLOURS["desired"], lw=1.0, label="desired")
        for method, table in methods.items():
            measured = table["measured_deg"].to_numpy(float)
            upper.plot(measured, ls="", label=NAMES[method], **_dots(method))
            error = measured - table["target_deg"].to_numpy(float)
            lower.plot(error, ls="-", lw=0.4, **_dots(method))
        lower.axhline(0.0, color="black", lw=0.8)
        upper.set_title(f"{axis}: bending angle")
        upper.set_ylabel("angle [deg]")
        lower.set_title(f"{axis}: error against the desired angle")
        lower.set_ylabel("measured − desired [deg]")
        lower.set_xlabel("target, in the order of sending")
    _shared_legend(figure, axes[0, 0], 4)
    figure.suptitle("Closed loop: where the robot lands, seen by the camera")
    return figure


def commands_figure(landings: Mapping[str, Mapping[str, pd.DataFrame]]) -> Figure:
    """Inverse commands of each method over the targets, and what they add to the nominal inverse.

    `landings`: axis -> method -> table with target_deg, command_deg, status, of which one method
    is `nominal`. Targets that did not converge are crossed.
    """
    figure, axes = new_figure(2, len(landings), height_in=4.8, sharex="col")
    for (upper, lower), (axis, methods) in zip(axes.T, landings.items(), strict=True):
        nominal = methods["nominal"]["command_deg"].to_numpy(float)
        for method, table in methods.items():
            command = table["command_deg"].to_numpy(float)
            stuck = np.flatnonzero(table["status"] != "converged")
            for panel, values in ((upper, command), (lower, command - nominal)):
                panel.plot(values, lw=0.8, label=NAMES[method], **_dots(method))
                panel.plot(stuck, values[stuck], "x", color=COLOURS["desired"], ms=5)
        upper.set_title(f"{axis}: command")
        upper.set_ylabel("command [deg of shaft]")
        lower.set_title(f"{axis}: added to the nominal command")
        lower.set_ylabel("command − nominal [deg]")
        lower.set_xlabel("target, in the order of sending")
    _shared_legend(figure, axes[0, 0], 4)
    figure.suptitle("Commands from the inverse (crosses: not converged)")
    return figure


def _loop_panel(panel: Axes, table: pd.DataFrame, opened: bool) -> None:
    base = table["nominal_deg"] if opened else 0.0
    panel.plot(table["command_deg"], table["measured_deg"] - base, ".", ms=2.5, alpha=0.6,
               color=COLOURS["measured"], label="measured")  # fmt: skip
    branches = (
        ("nominal", "nominal", "--", table),
        ("compensated", "cw", "-", table[table["direction"] == 1]),
        ("compensated", "ccw", "-", table[table["direction"] == -1]),
    )
    for method, name, line, branch in branches:
        curve = branch.drop_duplicates("command_deg").sort_values("command_deg")
        command = curve["command_deg"].to_numpy(float)
        mean = curve[f"{method}_deg"].to_numpy(float)
        if opened:
            mean = mean - curve["nominal_deg"].to_numpy(float)
        reach = 2.0 * curve[f"{method}_std_deg"].to_numpy(float)
        colour = COLOURS[name]
        if name == "nominal":
            panel.plot(command, mean - reach, command, mean + reach, color=colour, lw=0.6, ls=line)
        else:
            panel.fill_between(command, mean - reach, mean + reach, color=colour, alpha=0.2, lw=0)
        panel.plot(command, mean, color=colour, ls=line, label=NAMES[name])


def _selection_line(panel: Axes, table: pd.DataFrame, column: str, model: str, k: int) -> None:
    values = table[column].to_numpy(float)
    if column != "heldout_rmse_deg":
        values = values - np.nanmin(values)
    marker = MARKERS.get(model, "s")
    colour = COLOURS[model]
    panel.plot(table["k"], values, color=colour, marker=marker, ms=3.5, mfc="white", lw=1.2,
               label=NAMES[model], clip_on=False)  # fmt: skip
    at = (table["k"] == k).to_numpy()
    panel.plot(
        table["k"][at], values[at], color=colour, marker=marker, ms=6.5, ls="", clip_on=False
    )


def _dots(method: str) -> dict[str, Any]:
    return {"marker": MARKERS[method], "ms": 2.8, "color": COLOURS[method], "mfc": "none",
            "mew": 0.8}  # fmt: skip


def _mark_cycles(panel: Axes, cycle: np.ndarray) -> None:
    for begin in np.flatnonzero(np.diff(cycle) != 0) + 0.5:
        panel.axvline(begin, color="#9A9A9A", lw=0.8, ls=":")


def _shared_legend(figure: Figure, panel: Axes, columns: int) -> None:
    handles, labels = panel.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, markerscale=1.5)
