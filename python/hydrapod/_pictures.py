"""Small pictures (SVG) of results for notebooks: no library is needed. plot_…() draw the large ones."""

from __future__ import annotations

import html
from typing import Any, Callable, Dict, List, NamedTuple, Optional

import numpy as np

from . import _core

_width, _height, _edge, _most = 360, 110, 4, 300  # points [px], and points of a curve at most
_flexible, _rigid, _grey = "#0072b2", "#d55e00", "#8a949e"


class Curve(NamedTuple):
    """A line; steps of x that are NaN interrupt it."""

    x: Any
    y: Any
    colour: str


def _picture(curves: List[Curve], below: str, *, log: bool = False, zero: bool = False) -> str:
    """The curves with one scale; below: what they are. zero: the scale begins there. Empty without a finite point."""
    drawn = []
    for x, y, colour in curves:
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        here = np.arange(len(x))
        if len(x) > _most:  # the least and the most of each part, so that no peak is lost
            here = np.unique([part[pick(y[part])] for part in np.array_split(here, _most // 2)
                              for pick in (np.argmin, np.argmax)])
        with np.errstate(divide="ignore", invalid="ignore"):
            drawn.append((np.log10(x[here]) if log else x[here], y[here], colour))
    xs, ys = (np.concatenate([curve[k][np.isfinite(curve[0]) & np.isfinite(curve[1])] for curve in drawn] or [[]])
              for k in (0, 1))
    if not len(xs):
        return ""
    low, high = (0.0 if zero else ys.min()), ys.max()

    def pixels(values: Any, least: float, most: float, size: int) -> Any:
        return _edge + (values - least) / (most - least if most > least else 1.0) * (size - 2 * _edge)

    parts = []
    for x, y, colour in drawn:
        at = np.stack([pixels(x, xs.min(), xs.max(), _width), _height - pixels(y, low, high, _height)], axis=1)
        begins = True
        path = ""
        for point in at:
            if np.isfinite(point).all():
                path += f"{'M' if begins else 'L'}{point[0]:.1f} {point[1]:.1f}"
            begins = not np.isfinite(point).all()
        parts.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.3"/>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{_width}" height="{_height}" role="img" '
            f'style="display:block;border-bottom:1px solid {_grey}">{"".join(parts)}</svg>'
            f'<small style="color:{_grey}">{html.escape(below)}</small>')


def _decibel(H: Any) -> Any:
    with np.errstate(divide="ignore"):
        return 20.0 * np.log10(np.abs(H))


def _band(f: Any) -> str:
    return f"{f[0]:.3g} Hz to {f[-1]:.3g} Hz"


def _stems(f: Any, heights: Any, colour: str) -> Curve:
    stems = np.stack([f, f, np.full(len(f), np.nan)], axis=1)
    return Curve(stems.ravel(), np.stack([np.zeros(len(f)), heights, np.zeros(len(f))], axis=1).ravel(), colour)


def _modes(m: Any) -> str:
    felt, rigid = m.frequency_hz[np.array(m.moves_platform, dtype=bool)], m.rigid.frequency_hz
    return _picture([_stems(felt, np.ones(len(felt)), _flexible), _stems(rigid, np.full(len(rigid), 0.6), _rigid)],
                    "modes that move the platform; short: with rigid legs; logarithmic in Hz", log=True, zero=True)


def _bode(b: Any) -> str:
    return _picture([Curve(b.omega, _decibel(b.H_rigid[:, 0, 0]), _rigid),
                     Curve(b.omega, _decibel(b.H[:, 0, 0]), _flexible)],
                    f"x from x, dB, {_band(b.frequency_hz)}; orange: rigid legs", log=True)


def _command_response(r: Any) -> str:
    return _picture([Curve(r.omega, _decibel(r.H[:, 0, 0]), _flexible)],
                    f"x from the commanded x, dB, {_band(r.omega / (2.0 * np.pi))}", log=True)


def _frf(f: Any) -> str:
    return _picture([Curve(f.frequency_hz, _decibel(f.H[:, 0, 0]), _flexible)],
                    f"{f.outputs[0]} from {f.inputs[0]}, dB, {_band(f.frequency_hz)}")


def _identified(r: Any) -> str:
    level = _decibel(r.mode_indicator[:, 0])
    found = _stems(r.frequency_hz, np.full(len(r.frequency_hz), level[np.isfinite(level)].max(initial=0.0)), _rigid)
    least = np.where(found.y == 0.0, level[np.isfinite(level)].min(initial=0.0), found.y)
    return _picture([Curve(found.x, least, _rigid), Curve(r.line_frequency_hz, level, _flexible)],
                    f"mode indicator, dB, {_band(r.line_frequency_hz)}; orange: modes")


def _simulation(s: Any) -> str:
    most = int(np.argmax(np.nanmax(np.abs(s.motion) / [1.0, 1.0, 1.0, 0.5, 0.5, 0.5], axis=0))) if len(s.time) else 0
    return _picture([Curve(s.time, s.command[:, most], _rigid), Curve(s.time, s.motion[:, most], _flexible)],
                    f"{('x', 'y', 'z', 'rx', 'ry', 'rz')[most]} over {s.simulated:.4g} s; orange: commanded")


_pictures: Dict[type, Callable[[Any], str]] = {
    _core.Modes: _modes, _core.Bode: _bode, _core.CommandResponse: _command_response, _core.Frf: _frf,
    _core.Identified: _identified, _core.Simulation: _simulation}


def picture(result: Any) -> str:
    """SVG with a line of text, or nothing."""
    draw: Optional[Callable[[Any], str]] = _pictures.get(type(result))
    return "" if draw is None else draw(result)
