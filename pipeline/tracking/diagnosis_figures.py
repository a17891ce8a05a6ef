"""Pictures of a diagnosis: loop before and after, errors over time, where they lie, what is next.

Each is as wide as a telephone, so that its letters can be read there; colours mean the same as in
`figures.py`: the simulation as it came is `nominal`, the corrected one `compensated`.
"""

import io
import re
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pipeline.discrepancy.location.locate import Located
from pipeline.discrepancy.model.result import Evidence
from pipeline.discrepancy.problem.inputs import input_shares
from pipeline.tracking.figures import COLOURS, STYLE, new_figure

WIDTH_IN = 3.9
HEIGHT_IN = 2.9
MOST_DOTS = 450
FEWEST_DOTS = 20
MOST_LOCATIONS = 3
CURVES = {
    "all": ("desired", "-", "mean"),
    "ascending": ("cw", "-", "ascending"),
    "descending": ("ccw", "--", "descending"),
}
CURRENT_COLOURS = {"#000000": "currentColor", "#ffffff": "var(--paper)"}


def diagnosis_figures(evidence: Evidence, commands: pd.DataFrame | None) -> dict[str, Figure]:
    """Every picture of one measurement's diagnosis by name; commands: the proposed ones."""
    figures = {
        "loop": loop_figure(evidence),
        "residual": residual_figure(evidence),
        "time": time_figure(evidence),
    }
    sure = [located for located in evidence.located if located.where is not None]
    for located in sure[:MOST_LOCATIONS]:
        figures[f"where_{located.coordinate.replace(':', '_')}"] = where_figure(located)
    if commands is not None:
        figures["next"] = commands_figure(commands)
    return figures


def loop_figure(evidence: Evidence) -> Figure:
    """Measurement and simulation, before and after, over the drive, in one held-out cycle."""
    figure, panel = _one_panel()
    shown = _one_cycle(evidence)
    drive, line, dots = evidence.motion.drive, _spread(shown), _spread(evidence.used & shown)
    panel.plot(drive[dots], evidence.measured[dots], ".", ms=5, color=COLOURS["measured"],
               label="measured", zorder=1)  # fmt: skip
    for values, colour, style, label in (
        (evidence.before, "nominal", "--", "as it came"),
        (evidence.after, "compensated", "-", "corrected"),
    ):
        panel.plot(drive[line], values[line], ls=style, color=COLOURS[colour], lw=1.1, label=label)
    panel.set_xlabel(_label(evidence))
    panel.set_ylabel(f"{spoken(evidence.measurement)} [{_unit(evidence)}]")
    _legend(figure, panel)
    return figure


def overview_figure(everything: Sequence[Evidence]) -> Figure:
    """A row for each measurement: over time with the held-out rows shaded, and over its command."""
    figure, axes = new_figure(len(everything), 2, height_in=2.1 * len(everything))
    for (over_time, over_command), evidence in zip(axes, everything, strict=True):
        recording, seconds = evidence.recording, evidence.motion.time_s - evidence.motion.time_s[0]
        commands = {c.name: recording.values(c.name) for c in recording.with_role("command")}
        known = np.isfinite(evidence.measured) & np.isfinite(evidence.before)
        command = next(iter(input_shares(evidence.measured, commands, known)), evidence.drive)
        for panel, x in ((over_time, seconds), (over_command, commands[command])):
            panel.plot(x, evidence.measured, ".", ms=3, color=COLOURS["measured"], label="measured")
            for values, colour, style, label in _answers(evidence):
                panel.plot(x, values, ls=style, lw=1.1, color=COLOURS[colour], label=label)
        for number, (begin, end) in enumerate(_runs(evidence.heldout)):
            over_time.axvspan(seconds[begin], seconds[end], color=COLOURS["faint"], alpha=0.35,
                              lw=0, zorder=0, label=None if number else "held out")  # fmt: skip
        over_time.set_ylabel(f"{spoken(evidence.measurement)} [{_unit(evidence)}]")
        over_command.set_xlabel(f"{spoken(command)} [{recording.channel(command).unit}]")
    axes[-1, 0].set_xlabel("time [s]")
    _legend(figure, axes[0, 0])
    return figure


def _answers(evidence: Evidence) -> tuple[tuple[np.ndarray, str, str, str], ...]:
    return (
        (evidence.before, "nominal", "--", "simulation as it came"),
        (evidence.after, "compensated", "-", "corrected"),
    )


def residual_figure(evidence: Evidence) -> Figure:
    """What is off over the drive, before and after, on held-out rows, with the noise."""
    figure, panel = _one_panel()
    dots = _spread(evidence.used & _shown(evidence))
    _noise_band(panel, evidence)
    _off(panel, evidence, evidence.motion.drive, dots)
    panel.set_xlabel(_label(evidence))
    _legend(figure, panel)
    return figure


def time_figure(evidence: Evidence) -> Figure:
    """What is off over time, before and after, with the held-out rows shaded."""
    figure, panel = _one_panel()
    minutes = (evidence.motion.time_s - evidence.motion.time_s[0]) / 60.0
    _noise_band(panel, evidence)
    _off(panel, evidence, minutes, _spread(evidence.used))
    for number, (begin, end) in enumerate(_runs(evidence.heldout)):
        panel.axvspan(minutes[begin], minutes[end], color=COLOURS["faint"], alpha=0.35, lw=0,
                      zorder=0, label=None if number else "held out")  # fmt: skip
    panel.set_xlabel("time [min]")
    _legend(figure, panel)
    return figure


def where_figure(located: Located) -> Figure:
    """Mean residual of the simulation as it came over one coordinate."""
    figure, panel = _one_panel()
    panel.axhline(0.0, color=COLOURS["measured"], lw=0.8)
    for name, line in located.profile.curves.items():
        colour, style, label = CURVES.get(name, ("desired", "", name))
        look: dict[str, Any] = {"ls": style} if style else {"ls": "", "marker": "o", "ms": 3.0}
        panel.plot(line[:, 0], line[:, 1], color=COLOURS[colour], label=label, **look)
    panel.set_xlabel(spoken_label(located.profile.x_label))
    panel.set_ylabel(located.profile.y_label)
    if len(located.profile.curves) > 1:
        _legend(figure, panel)
    return figure


def commands_figure(commands: pd.DataFrame) -> Figure:
    """Proposed commands over time."""
    figure, panel = _one_panel()
    minutes = commands["time_s"].to_numpy(float) / 60.0
    names = [str(name) for name in commands if name != "time_s"]
    looks = (("compensated", "-"), ("other", "--"), ("ccw", ":"), ("nominal", "-."))
    for name, (colour, style) in zip(names, looks, strict=False):
        panel.plot(minutes, commands[name], ls=style, lw=1.0, color=COLOURS[colour],
                   label=spoken(name))  # fmt: skip
    panel.set_xlabel("time [min]")
    panel.set_ylabel("command")
    _legend(figure, panel)
    return figure


def svg_of(figure: Figure, name: str, colours: Mapping[str, str]) -> str:
    """The figure as SVG text to stand in a page: its letters are the page's, ids begin with `name`.

    colours: what stands for each colour, by its hexadecimal; black becomes the page's own colour.
    """
    buffer = io.StringIO()
    style: Any = {**STYLE, "svg.fonttype": "none", "svg.hashsalt": name}
    with mpl.rc_context(style):
        figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r' xmlns(:\w+)?="[^"]*"', "", text)
    text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{name}-", text)
    text = re.sub(r"font: [^;\"]*", _page_font, text)
    for found, instead in {**CURRENT_COLOURS, **colours}.items():
        text = re.sub(re.escape(found), instead, text, flags=re.IGNORECASE)
    head = f'class="plot" role="img" aria-label="{escape(what_is_drawn(figure))}"'
    return re.sub(r'width="[\d.]+pt" height="[\d.]+pt"', lambda _: head, text, count=1)


def what_is_drawn(figure: Figure) -> str:
    """The figure in words, by its axes: `residual [deg] over command [deg]`."""
    labels = [(one.get_ylabel(), one.get_xlabel()) for one in figure.axes]
    below = next((x for _, x in reversed(labels) if x), "")
    return "; ".join(f"{y} over {x or below}" for y, x in labels if y)


def _page_font(found: re.Match[str]) -> str:
    size = re.search(r"([\d.]+)px", found.group(0))
    return f"font-size: {size.group(1)}px" if size else "font-size: 9px"


def spoken(channel: str) -> str:
    """`pitch command` for `pitch_command_deg`."""
    words = channel.split("_")
    return " ".join(words[:-1] if len(words) > 1 and len(words[-1]) <= 3 else words)


def spoken_label(label: str) -> str:
    """An axis label whose channel name is spoken; others as they are."""
    return spoken(label) if "_" in label and " " not in label else label


def _one_panel() -> tuple[Figure, Axes]:
    figure, axes = new_figure(width_in=WIDTH_IN, height_in=HEIGHT_IN)
    return figure, axes[0, 0]


def _legend(figure: Figure, panel: Axes) -> None:
    handles, labels = panel.get_legend_handles_labels()
    with mpl.rc_context(STYLE):  # type: ignore[arg-type]
        figure.legend(handles, labels, loc="outside upper left", ncols=4, markerscale=1.6,
                      columnspacing=0.8, handlelength=1.4, handletextpad=0.4)  # fmt: skip


def _unit(evidence: Evidence) -> str:
    return evidence.recording.channel(evidence.measurement).unit


def _label(evidence: Evidence) -> str:
    if evidence.static:
        unit = evidence.recording.channel(evidence.drive).unit
        return f"{spoken(evidence.drive)} [{unit}]"
    return f"simulated [{_unit(evidence)}]"


def _shown(evidence: Evidence) -> np.ndarray:
    return evidence.heldout if np.any(evidence.heldout & evidence.used) else evidence.train


def _one_cycle(evidence: Evidence) -> np.ndarray:
    """Rows of the first cycle that is shown; of all that are, where it has hardly any."""
    shown = _shown(evidence)
    cycle = evidence.motion.cycle
    first = shown & (cycle == cycle[np.argmax(shown)])
    return first if np.sum(first & evidence.used) >= FEWEST_DOTS else shown


def _spread(rows: np.ndarray) -> np.ndarray:
    found = np.flatnonzero(rows)
    if len(found) <= MOST_DOTS:
        return found
    return found[np.linspace(0, len(found) - 1, MOST_DOTS).astype(int)]


def _off(panel: Axes, evidence: Evidence, x: np.ndarray, dots: np.ndarray) -> None:
    panel.plot(x[dots], evidence.residual_before[dots], ".", ms=3, color=COLOURS["nominal"],
               label="as it came")  # fmt: skip
    panel.plot(x[dots], evidence.residual_after[dots], "x", ms=2.6, mew=0.7,
               color=COLOURS["compensated"], label="corrected")  # fmt: skip
    panel.axhline(0.0, color=COLOURS["desired"], lw=0.8)
    panel.set_ylabel(f"measured − simulated [{_unit(evidence)}]")


def _noise_band(panel: Axes, evidence: Evidence) -> None:
    reach = 2.0 * float(np.hypot(evidence.noise.deviation, evidence.noise.jitter))
    panel.axhspan(-reach, reach, color=COLOURS["measured"], alpha=0.18, lw=0, label="noise")


def _runs(rows: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of each unbroken run of True."""
    edges = np.diff(np.concatenate([[0], rows.astype(int), [0]]))
    begins, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    return list(zip(begins.tolist(), ends.tolist(), strict=True))
