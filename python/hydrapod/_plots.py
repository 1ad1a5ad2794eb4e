"""Plots with matplotlib (optional: pip install hydrapod[plots]), in the style of the report.

Each function returns the matplotlib Figure and draws into `figure` where one is given. Nothing is shown or
written: use figure.savefig(path), or the notebook's display.
"""

from __future__ import annotations

import os
import textwrap
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

from . import _checks
from ._core import Bode, CommandResponse, Diagnosed, Identified, Modes, Study

flexible, rigid, good, grey = "#0072b2", "#d55e00", "#009e73", "#8a949e"  # told apart by the colour-blind
directions = ("x", "y", "z", "rx", "ry", "rz")


def _expect(thing: Any, *types: type) -> None:
    if not isinstance(thing, types):
        raise TypeError(f"expected {' or '.join(t.__name__ for t in types)}, got {type(thing).__name__}")


def _figure(figure: Any, width: float, height: float) -> Any:
    """A figure of its own, which no window shows and nobody has to close."""
    if figure is not None:
        if not hasattr(figure, "subplots") or not hasattr(figure, "suptitle"):
            raise TypeError(f"figure: expected a Figure of matplotlib, got {figure!r}")
        return figure
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # type: ignore[import]
    from matplotlib.figure import Figure  # type: ignore[import]

    made = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(made)
    return made


def _style(axes: Any, *, grid: str = "both") -> Any:
    for spine in axes.spines.values():
        spine.set_color("#444444")
        spine.set_linewidth(0.8)
    axes.tick_params(labelsize=8, color="#444444")
    if grid:
        axes.grid(True, axis=grid, color="#d0d0d0", linewidth=0.5)
    axes.set_axisbelow(True)
    return axes


def _titles(figure: Any, title: str, subtitle: str) -> None:
    width = int(12.5 * figure.get_figwidth())  # letters in a line
    lines = [title, *textwrap.wrap(subtitle, width)] if subtitle else [title]
    figure.suptitle("\n".join(lines), x=0.012, ha="left", fontsize=10)


def _decibel(values: Any) -> Any:
    return 20.0 * np.log10(np.maximum(np.abs(values), 1e-300))


def _phase(values: Any) -> Any:
    """[°], without a line from -180 to 180 where it jumps."""
    degrees = np.degrees(np.angle(values))
    degrees[1:][np.abs(np.diff(degrees)) > 180.0] = np.nan
    return degrees


def _frequency_axis(axes: Any, frequencies: Any) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter  # type: ignore[import]

    axes.set_xlim(frequencies[0], frequencies[-1])
    if not (frequencies[0] > 0.0 and frequencies[-1] > 3.0 * frequencies[0]):
        return
    axes.set_xscale("log")
    wide = frequencies[-1] > 300.0 * frequencies[0]
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.6g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def plot_modes(modes: Modes, *, platform_only: bool = True, figure: Any = None) -> Any:
    """Frequencies with flexible and rigid legs, and where the elastic energy of each mode is.

    platform_only: leave out the local modes of seals, which do not move the platform.
    """
    _expect(modes, Modes)
    document = modes.to_dict()
    shown = [mode for mode in document["modes"] if mode["moves_platform"] or not platform_only]
    figure = _figure(figure, 9.0, 1.6 + 0.42 * len(shown))
    left, right = figure.subplots(1, 2, sharey=True, gridspec_kw={"width_ratios": (1.5, 1.0)})
    rows = np.arange(len(shown))
    partners = [mode.get("rigid", {}).get("omega_rad_s", np.nan) / (2.0 * np.pi) for mode in shown]
    for row, mode, partner in zip(rows, shown, partners):
        left.plot([mode["frequency_hz"], partner], [row, row], color="#c8c8c8", linewidth=1.2, zorder=1)
    left.plot(partners, rows, "^", mfc="none", color=rigid, markersize=7, label="rigid legs, most similar mode")
    left.plot([mode["frequency_hz"] for mode in shown], rows, "o", color=flexible, markersize=6,
              label="flexible legs")
    for row, mode in zip(rows, shown):
        left.annotate(f"{mode['frequency_hz']:.2f}", (mode["frequency_hz"], row), textcoords="offset points",
                      xytext=(0, 7), ha="center", fontsize=7, color=flexible)
    left.set_yticks(rows, [f"{mode['number']}  {mode['label']}" for mode in shown])
    left.set_ylim(len(shown) - 0.4, -0.7)
    left.set_xlim(0.0, 1.08 * np.nanmax([*partners, *(mode["frequency_hz"] for mode in shown)]))
    left.set_xlabel("Hz", fontsize=9)
    _style(left, grid="x")
    begin = np.zeros(len(shown))
    axial = shown[0]["strain_energy"].get("axial", "oil") if shown else "oil"
    parts = (("oil", "#56b4e9", axial), ("guide_sleeve", "#e69f00", "guide sleeves"),
             ("piston_ring", "#cc79a7", "piston rings"), ("base_mount", grey, "base mount"),
             ("payload", "#009e73", "payload"), ("bending", "#d55e00", "bending of rods and cases"))
    for key, colour, name in parts:
        share = np.array([100.0 * mode["strain_energy"].get(key, 0.0) for mode in shown])
        if share.max(initial=0.0) > 0.0:
            right.barh(rows, share, left=begin, height=0.6, color=colour, label=name)
            begin = begin + share
    right.set_xlabel("elastic energy, %", fontsize=9)
    right.set_xlim(0.0, 100.0)
    _style(right, grid="x")
    for axes in (left, right):
        axes.legend(fontsize=8, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    _titles(figure, f"{document['machine']['name']}: modes, pose {document['pose']['name']}",
            f"{document['model']} model; machine: {document['machine']['state']}")
    return figure


def _entries(given: Optional[Sequence[Tuple[str, str]]]) -> List[Tuple[int, int]]:
    pairs = [(d, d) for d in directions] if given is None else list(given)
    if not pairs:
        raise ValueError("entries: expected at least one pair (output, input)")
    for pair in pairs:
        if not isinstance(pair, (tuple, list)) or len(pair) != 2 or not set(pair) <= set(directions):
            raise ValueError(f"entries: expected pairs (output, input) of {', '.join(directions)}, got {pair!r}")
    return [(directions.index(o), directions.index(i)) for o, i in pairs]


def _pairs_of_axes(figure: Any, count: int) -> List[Tuple[Any, Any]]:
    """Magnitude above phase, three in a row."""
    columns = min(3, count)
    rows = (count + columns - 1) // columns
    grid = figure.subplots(2 * rows, columns, squeeze=False, gridspec_kw={"height_ratios": (2.0, 1.0) * rows})
    cells = [(grid[2 * (k // columns)][k % columns], grid[2 * (k // columns) + 1][k % columns])
             for k in range(rows * columns)]
    for pair in cells[count:]:
        for axes in pair:
            axes.set_visible(False)
    for above, below in cells[:count]:
        above.sharex(below)
        above.tick_params(labelbottom=False)
        below.set_ylim(-190.0, 190.0)
        below.set_yticks((-180, -90, 0, 90, 180))
        _style(above), _style(below)
    for k, (above, below) in enumerate(cells[:count]):
        if k % columns == 0:
            above.set_ylabel("dB", fontsize=9)
            below.set_ylabel("phase °", fontsize=9)
        below.set_xlabel("Hz", fontsize=9)
    return cells[:count]


def _legend(figure: Any, axes: Any, columns: int = 3) -> None:
    """Below the axes, where titles of any length leave it free; above them where the figure has another layout."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine  # type: ignore[import]

    handles, labels = axes.get_legend_handles_labels()
    engine = figure.get_layout_engine()
    below = isinstance(figure, Figure) and isinstance(engine, ConstrainedLayoutEngine)
    if below:
        share = 0.3 / figure.get_figheight()  # a line of the legend and its margins [inch]
        engine.set(rect=(0.0, share, 1.0, 1.0 - share))
    figure.legend(handles, labels, loc="lower center" if below else "upper right", fontsize=8, frameon=False,
                  ncols=min(columns, len(labels)))


def _bode_size(count: int) -> Tuple[float, float]:
    columns = min(3, count)
    return 1.0 + 3.4 * columns, 1.0 + 3.6 * ((count + columns - 1) // columns)


def plot_bode(bode: Any, entries: Optional[Sequence[Tuple[str, str]]] = None, *, figure: Any = None) -> Any:
    """Magnitude and phase with flexible and rigid legs, or (CommandResponse) from the command to the pose.

    entries: pairs (output, input) of x … rz; default: the six direct responses.
    """
    _expect(bode, Bode, CommandResponse)
    pairs = _entries(entries)
    document = bode.to_dict()
    figure = _figure(figure, *_bode_size(len(pairs)))
    curves: List[Tuple[Any, str, Any, str]] = [(bode.H, flexible, "-", "flexible legs")]
    if isinstance(bode, Bode):
        curves.append((bode.H_rigid, rigid, (0, (6, 3)), "rigid legs"))
    else:
        curves[0] = (bode.H, flexible, "-", "platform from command")
    cells = _pairs_of_axes(figure, len(pairs))
    for (o, i), (above, below) in zip(pairs, cells):
        for H, colour, dashes, name in curves:
            above.plot(bode.frequency_hz, _decibel(H[:, o, i]), color=colour, linestyle=dashes, linewidth=1.4,
                       label=name)
            below.plot(bode.frequency_hz, _phase(H[:, o, i]), color=colour, linestyle=dashes,
                       linewidth=1.0)
        above.set_title(f"{directions[o]} from {directions[i]}", fontsize=9)
        _frequency_axis(below, bode.frequency_hz)
    _legend(figure, cells[0][0])
    _titles(figure, f"{document['machine']['name']}: {document['output']} from {document['input']}",
            f"pose {document['pose']['name']}, {document['model']} model; machine: {document['machine']['state']}"
            + ("" if bode.stable else "; unstable, so that no steady vibration exists"))
    return figure


def plot_fit(identified: Identified, entries: Optional[Sequence[Tuple[str, str]]] = None, *, most: int = 12,
             figure: Any = None) -> Any:
    """Measured responses with their 95 % band, and those of the identified modes.

    entries: pairs (output, input) by name; default: the direct ones of a square response, else all, at most `most`.
    """
    _expect(identified, Identified)
    most = _checks.whole(most, "most", 1)
    outputs, inputs = identified.outputs, identified.inputs
    if entries is not None:
        if not len(entries):
            raise ValueError("entries: expected at least one pair (output, input)")
        for pair in entries:
            if not isinstance(pair, (tuple, list)) or len(pair) != 2:
                raise ValueError(f"entries: expected pairs (output, input), got {pair!r}")
            output, input = pair
            if output not in outputs or input not in inputs:
                raise ValueError(f"entries: no response {output!r} from {input!r}; outputs are {', '.join(outputs)}, "
                                 f"inputs {', '.join(inputs)}")
        pairs = [(outputs.index(output), inputs.index(input)) for output, input in entries]
    elif len(outputs) == len(inputs):
        pairs = [(k, k) for k in range(len(outputs))][:most]
    else:
        pairs = [(o, i) for o in range(len(outputs)) for i in range(len(inputs))][:most]
    H, fit, lines = identified.H, identified.H_modes, identified.line_frequency_hz
    deviation, radius = identified.deviation, identified.radius_95
    figure = _figure(figure, *_bode_size(len(pairs)))
    cells = _pairs_of_axes(figure, len(pairs))
    for (o, i), (above, below) in zip(pairs, cells):
        size = np.abs(H[:, o, i])
        if len(deviation):
            band = radius * deviation[:, o, i]
            above.fill_between(lines, _decibel(np.maximum(size - band, 0.1 * size)), _decibel(size + band),
                               color="#c8dcec", linewidth=0.0, label="95 %")
        above.plot(lines, _decibel(size), color=flexible, linewidth=1.0, label="measured")
        above.plot(lines, _decibel(fit[:, o, i]), color=rigid, linewidth=1.2, linestyle=(0, (4, 2)), label="modes")
        below.plot(lines, np.degrees(np.angle(H[:, o, i])), ".", color=flexible, markersize=1.2)
        below.plot(lines, _phase(fit[:, o, i]), color=rigid, linewidth=1.0, linestyle=(0, (4, 2)))
        for f in identified.frequency_hz:
            above.axvline(f, color="#222222", linewidth=0.5, linestyle=":")
        above.set_title(f"{outputs[o]} from {inputs[i]}", fontsize=9)
        _frequency_axis(below, lines)
    _legend(figure, cells[0][0])
    all_of_them = len(outputs) * len(inputs)
    shown = "" if len(pairs) == all_of_them else f"; shown: {len(pairs)} of {all_of_them} responses"
    _titles(figure, f"{len(identified.frequency_hz)} identified modes",
            ", ".join(os.path.basename(path) for path in identified.to_dict()["records"]) + shown)
    return figure


#: what agrees with the order below: the word of the JSON, marker, size, colour, the legend's word
_marks = (("new", "o", 2.5, grey, "new"), ("frequency", "^", 4.5, "#c79a00", "frequency agrees"),
          ("damping", "D", 3.5, "#b5530a", "and damping"), ("vector", "o", 3.5, flexible, "and shape"))


def plot_stabilisation(identified: Identified, *, figure: Any = None) -> Any:
    """Poles over the model order, marked by what agrees with the order below, and the mode indicator."""
    _expect(identified, Identified)
    figure = _figure(figure, 9.6, 5.6)
    axes = _style(figure.subplots())
    other = axes.twinx()
    other.plot(identified.line_frequency_hz, _decibel(identified.mode_indicator), color="#a9b2bd", linewidth=0.8,
               zorder=0)
    other.set_ylabel("mode indicator: singular values of H, dB", fontsize=9)
    other.tick_params(labelsize=8)
    axes.set_zorder(other.get_zorder() + 1)
    axes.patch.set_visible(False)
    poles = [(pole["frequency_hz"], order["order"], pole["agrees"], pole["cluster"] is not None)
             for order in identified.to_dict()["stabilisation"] for pole in order["poles"] if pole["stable"]]
    for word, marker, size, colour, label in _marks:
        here = [(f, n) for f, n, agrees, _ in poles if agrees == word]
        if here:
            axes.plot(*zip(*here), marker, markersize=size, color=colour, mfc="none" if word == "new" else colour,
                      label=label)
    taken = [(f, n) for f, n, _, member in poles if member]
    if taken:
        axes.plot(*zip(*taken), "o", markersize=6.5, mfc="none", color="#222222", label="of a mode")
    for f in identified.frequency_hz:
        axes.axvline(f, color="#222222", linewidth=0.7, linestyle=":")
    axes.set_xlim(identified.line_frequency_hz[0], identified.line_frequency_hz[-1])
    axes.set_ylim(bottom=0)
    axes.set_xlabel("Hz", fontsize=9)
    axes.set_ylabel("model order", fontsize=9)
    _legend(figure, axes, 6)
    _titles(figure, "Stabilisation", f"{len(identified.frequency_hz)} identified modes")
    return figure


def _shown_unit(unit: str) -> Tuple[float, str]:
    return {"m": (1e3, "mm"), "rad": (180.0 / np.pi, "°")}.get(unit, (1.0, unit))


def _end_of_stroke(axes: Any, study: Study, grids: Any) -> None:
    """Where pistons come to their stops, if that is in the grid."""
    if "stroke" not in study.names:
        return
    left = np.ma.masked_invalid(np.array(study["stroke"]).reshape(study.shape))  # type: ignore[no-untyped-call]
    if left.count() and left.min() < 0.0 < left.max():
        axes.contour(grids[0], grids[1], left, levels=[0.0], colors="#00a0a0", linestyles="dashed", linewidths=2.0)
        axes.plot([], [], color="#00a0a0", linestyle="dashed", linewidth=2.0, label="end of stroke")
        axes.legend(fontsize=8, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0))


def plot_map(study: Study, value: str = "lowest", *, figure: Any = None) -> Any:
    """A column over the grid of a sweep or a map: a line over one input, a heat map over two. Grey: no value.

    Dashed: the end of the stroke.
    """
    _expect(study, Study)
    if study.part is not None:
        raise ValueError("plot_map: this is part {} of {} of a study; join puts the parts together".format(*study.part))
    if study.kind == "montecarlo" or len(study.shape) != study.input_count or study.input_count > 2:
        raise ValueError("plot_map: expected a grid over one or two inputs, of sweep() or workspace_map()")
    if not study.complete:
        raise ValueError(f"plot_map: the study was interrupted; it has {len(study)} rows, not the whole grid")
    values = study[value]
    unit = study.units[study.names.index(value)] if value in study.names else "1"
    label = f"{value} [{unit}]" if unit != "1" else value
    figure = _figure(figure, 7.2, 5.6)
    axes = _style(figure.subplots(), grid="both" if study.input_count == 1 else "")
    scales = [_shown_unit(study.units[k]) for k in range(study.input_count)]
    names = [f"{study.names[k]} [{scales[k][1]}]" for k in range(study.input_count)]
    grids = [np.array(study.values[:, k]).reshape(study.shape) * scales[k][0] for k in range(study.input_count)]
    if study.input_count == 1:
        axes.plot(grids[0], values, "o-", color=flexible, markersize=3.5, linewidth=1.4)
        if grids[0].min() > 0.0 and grids[0].max() > 20.0 * grids[0].min():
            axes.set_xscale("log")
        axes.set_ylabel(label, fontsize=9)
    else:
        masked: Any = np.ma
        field = masked.masked_invalid(np.array(values).reshape(study.shape))
        axes.set_facecolor("#b0b0b0")
        mesh = axes.pcolormesh(grids[0], grids[1], field, shading="nearest", cmap="viridis")
        if field.count() and field.min() < field.max():
            lines = axes.contour(grids[0], grids[1], field, levels=8, colors="white", linewidths=0.7)
            axes.clabel(lines, fontsize=7)
        _end_of_stroke(axes, study, grids)
        figure.colorbar(mesh, ax=axes, label=label)
        axes.set_ylabel(names[1], fontsize=9)
    axes.set_xlabel(names[0], fontsize=9)
    document = study.to_dict()
    _titles(figure, f"{document['machine']['name']}: {value}",
            f"pose {document['pose']['name']}, {document['model']} model; machine: {document['machine']['state']}")
    return figure


def plot_diagnosis(diagnosed: Diagnosed, *, most: int = 14, figure: Any = None) -> Any:
    """Measured frequencies beside rigid-leg model and best hypothesis, and how far hypotheses are from the best."""
    _expect(diagnosed, Diagnosed)
    most = _checks.whole(most, "most", 1)
    document = diagnosed.to_dict()
    if not document.get("hypotheses"):
        raise ValueError("plot_diagnosis: nothing was measured; expected a diagnosis with measured data")
    measured, hypotheses = document["measured_modes"], document["hypotheses"][:most]
    figure = _figure(figure, 9.6, 4.2 + 0.28 * len(hypotheses))
    above, below = figure.subplots(2, 1, gridspec_kw={"height_ratios": (3.4, 0.9 + 0.28 * len(hypotheses))})
    x = np.arange(1, len(measured) + 1)
    number = [mode["frequency_hz"] for mode in measured]
    rigids = [np.nan if mode.get("rigid_hz") is None else mode["rigid_hz"] for mode in measured]
    above.plot(x, rigids, "^", mfc="none", color="#999999", markersize=8, label="rigid")
    above.errorbar(x, number, [2.0 * mode["deviation_hz"] for mode in measured], fmt="o", mfc="none", color=rigid,
                   capsize=4, markersize=8, label="measured (95 %)")
    above.plot(x, [mode["fitted_hz"] for mode in measured], "o", color=flexible, markersize=4,
               label="best hypothesis")
    above.set_xticks(x, [f"{mode['direction'] or k}\n{mode['pose']}" for k, mode in zip(x, measured)])
    above.set_ylim(0.0, 1.1 * np.nanmax([*number, *rigids]))
    above.set_ylabel("Hz", fontsize=9)
    above.legend(fontsize=8, frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    _style(above, grid="y")
    rows = np.arange(len(hypotheses))
    colours = [good if one["equally_good"] else "#999999" if not one["causes"] else flexible for one in hypotheses]
    below.barh(rows, [np.log10(1.0 + max(0.0, one["bic_above_best"])) for one in hypotheses], color=colours,
               height=0.7)
    for row, one in zip(rows, hypotheses):
        if one["bic_above_best"] < 0.5:
            below.annotate("best" if row == 0 else "", (0.0, row), textcoords="offset points", xytext=(4, -3),
                           fontsize=8, color=good)
    ticks = [0, 1, 10, 100, 1000, 10000, 100000, 1000000]
    highest = max(one["bic_above_best"] for one in hypotheses)
    ticks = [tick for tick in ticks if tick <= max(10.0, 3.0 * highest)]
    below.set_xticks(np.log10(1.0 + np.array(ticks)), [f"{tick:g}" for tick in ticks])
    below.set_yticks(rows, [one["name"] for one in hypotheses], fontsize=8)
    below.set_ylim(len(hypotheses) - 0.4, -0.6)
    below.set_xlabel("BIC above the best (green: equally good)", fontsize=9)
    _style(below, grid="x")
    _titles(figure, f"{document['machine']['name']}: {document['finding']}", document["summary"][0])
    return figure
