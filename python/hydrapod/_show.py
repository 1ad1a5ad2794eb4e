"""How results show themselves: as tables of text, and as tables and small pictures in notebooks."""

from __future__ import annotations

import html
import operator
from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np

from . import _core, _pictures

Table = Tuple[str, List[str], Sequence[Sequence[str]], str]  # heading, titles, rows, words below


def _model_modes(m: Any) -> Table:
    rows = [(str(k + 1), f"{f:.3f}", f"{100 * z:.2f} %", label)
            for k, (f, z, label) in enumerate(zip(m.frequency_hz, m.damping_ratio, m.labels))]
    return f"{len(rows)} modes", ["mode", "Hz", "damping", "motion, compliance"], rows, ""


def _modes(m: Any) -> Table:
    return (*_model_modes(m)[:3], m.answer.strip())


def _system(s: Any) -> Table:
    rows = [(f"{abs(p) / (2 * np.pi):.3f}", f"{100 * z:.2f} %", f"{p.real:.4g}", words)
            for p, z, words in zip(s.poles, s.damping_ratio, s.participation)]
    return (f"{len(s.states)} states, {'closed' if s.closed else 'open'} loop",
            ["Hz", "damping", "Re 1/s", "participation"], rows, s.verdict)


def _check(c: Any) -> Table:
    rows = [(pose, f"{load:.4g} kg" if np.isfinite(load) else "–", f"{force:.4g} N")
            for pose, load, force in zip(c.poses, c.buckling_payload, np.abs(c.axial_force).max(axis=1))]
    return "check", ["pose", "buckling payload", "largest axial force"], rows, "\n".join([*c.warnings, c.verdict])


def _sensitivity(s: Any) -> Table:
    best = np.argsort(-np.nanmax(np.abs(s.percent_per_percent), axis=0))[:12]
    rows = [(s.parameters[k], *(f"{v:.3f}" for v in s.percent_per_percent[:6, k])) for k in best]
    titles = ["% per %"] + [f"{omega / (2 * np.pi):.3f} Hz" for omega in s.omega[:6]]
    return f"{len(s.parameters)} parameters, {len(s.omega)} modes", titles, rows, ""


def _identified(r: Any) -> Table:
    rows = [(f"{f:.4f} ± {1.96 * df:.2g}", f"{100 * z:.3f} ± {196 * dz:.2g} %", f"{q:.2f}", motion)
            for f, df, z, dz, q, motion in zip(r.frequency_hz, r.frequency_deviation_hz, r.damping_ratio,
                                               r.damping_deviation, r.quality, r.motion)]
    return (f"{len(rows)} identified modes (± is half the 95 % interval)",
            ["Hz", "damping", "quality", "motion"], rows, "\n".join(r.warnings))


def _calibrated(c: Any) -> Table:
    rows = [(name, f"{v:.6g} ± {d:.2g} {unit}", verdict) for name, v, d, unit, verdict in
            zip(c.parameters, c.values, c.deviations, c.units, c.verdicts)]
    return f"calibration, misfit {c.misfit:.4g}", ["parameter", "value", ""], rows, "\n".join(c.remarks)


def _diagnosed(d: Any) -> Table:
    rows = [(name, f"{bic - d.bic[0]:.1f}") for name, bic in list(zip(d.hypotheses, d.bic))[:8]]
    return "diagnosis", ["hypothesis", "ΔBIC"], rows, "\n".join(d.summary)


def _compared(c: Any) -> Table:
    rows = [(str(one.thing + 1), str(one.first + 1), str(one.second + 1), f"{one.mac:.2f}", f"{one.frequency_hz:.3f}",
             f"{100 * one.frequency_difference_hz / one.frequency_hz:+.2f} %", one.frequency_verdict, one.label)
            for one in _compared_records(c)]
    things = "\n".join(f"{k + 1}: {name} ({what})" for k, (name, what) in enumerate(zip(c.things, c.descriptions)))
    return (f"{len(c.things)} things", ["thing", "of first", "its own", "MAC", "Hz", "difference", "", "motion"], rows,
            things)


def _at_poses(m: Any) -> Table:
    rows = [(*(f"{f:.3f}" if np.isfinite(f) else "–" for f in row), label)
            for row, label in zip(m.frequency_hz, m.labels)]
    return f"{len(rows)} modes at {len(m.poses)} poses", [*(f"{pose} Hz" for pose in m.poses), "motion"], rows, ""


def _at_amplitudes(m: Any) -> Table:
    rows = [(str(number + 1), direction, *(f"{f:.3f}" if np.isfinite(f) else "–" for f in row))
            for number, direction, row in zip(m.numbers, m.directions, m.frequency_hz)]
    return (f"{len(rows)} modes at {len(m.amplitudes)} amplitudes",
            ["mode", "motion", *(f"{1e3 * a:.4g} mm: Hz" for a in m.amplitudes)], rows, "")


def _part(s: Any) -> Table:
    done = "is complete" if s.complete else "was interrupted; resume goes on with it"
    return (f"{s.kind}, part {s.part[0]} of {s.part[1]}", [], [],
            f"the part {done}\nits rows are in {s.rows_file}; join puts the parts together when all of them are there")


def _study(s: Any) -> Table:
    if s.part is not None:
        return _part(s)

    def cells(name: str) -> Tuple[str, ...]:
        values = s[name][np.isfinite(s[name])]
        if not len(values):
            return name, "–", "–", "–", "–"
        return (name, f"{values.mean():.6g}", f"{values.std():.3g}", f"{values.min():.6g}", f"{values.max():.6g}")

    names = [name for name in s.names if name not in ("status", "direction")]
    missed = [f"{text}: missed with probability {p:.4g}" for text, p in
              zip(s.requirements, s.probability_of_missing)] if s.complete else ["interrupted"]
    return (f"{s.kind}, {len(s.values)} rows", ["column", "mean", "deviation", "least", "most"],
            [cells(name) for name in names], "\n".join(missed))


def _design(d: Any) -> Table:
    rows = [(name, f"{present:.6g}", f"{value:.6g}", where) for name, present, value, where in (
        *((f"{path} [{unit}]", present, value, "changed") for path, unit, present, value in
          zip(d.paths, d.units, d.present, d.values)),
        *zip(d.aims, d.aim_present, d.aim_values, ["aim"] * len(d.aims)),
        *((text, present, value, f"worst at {pose}") for text, present, value, pose in
          zip(d.requirements, d.worst_present, d.worst, d.worst_poses)))]
    verdict = "meets all requirements" if d.feasible else "no design meets all requirements; this violates them least"
    return (f"{verdict}, {d.evaluations} designs", ["number", "present", "design", ""], rows,
            f"trade-off of {len(d.front_aims)} points" if len(d.front_aims) else "")


def _record_overview(r: Any) -> Table:
    rows = [(name, unit, role, f"{mean:.5g}", f"{rms:.5g}", f"{peak:.5g}", f"{f:.4g}" if f else "–", str(limit or ""),
             str(missing or "")) for name, unit, role, mean, rms, peak, f, limit, missing in
            zip(r.channels, r.units, r.roles, r.mean, r.rms, r.peak, r.strongest_frequency_hz, r.at_limit,
                r.missing + r.infinite)]
    return (f"{len(rows)} channels, {r.samples} samples at {r.sample_rate:.9g} Hz",
            ["channel", "unit", "role", "mean", "RMS", "peak", "strongest Hz", "at limit", "missing"], rows,
            "\n".join(r.warnings))


def _compared_records(compared: Any) -> Any:
    """A row per pair of modes, as a NumPy record array; things and modes count from 0."""
    columns = {name: np.asarray(column) if len(column) else np.zeros(0)
               for name, column in compared.columns.items()}
    count = len(columns["thing"])
    table = np.empty(count, dtype=[(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        table[name] = column
    return table.view(np.recarray)


def _compared_to_pandas(compared: Any) -> Any:
    """A row per pair of modes, as a pandas.DataFrame."""
    import pandas  # type: ignore[import]

    return pandas.DataFrame(compared.columns)


def _doubt(response: Any, words: str) -> str:
    return "" if response.stable else f"; {words}, so that no steady vibration exists"


def _plain(words: Callable[[Any], str]) -> Callable[[Any], Table]:
    return lambda result: (words(result), [], [], "")


_tables: Dict[type, Callable[[Any], Table]] = {
    _core.Modes: _modes,
    _core.ModelModes: _model_modes,
    _core.Superelement: _plain(lambda s: f"{len(s.coordinates)} coordinates, {len(s.coordinates) - 6} of them modes of "
                                         "the legs"),
    _core.System: _system,
    _core.Check: _check,
    _core.Sensitivity: _sensitivity,
    _core.Identified: _identified,
    _core.Calibrated: _calibrated,
    _core.Diagnosed: _diagnosed,
    _core.Compared: _compared,
    _core.ModesAtPoses: _at_poses,
    _core.ModesAtAmplitudes: _at_amplitudes,
    _core.Study: _study,
    _core.Design: _design,
    _core.MachineStateSpace: _plain(lambda s: f"{len(s.states)} states, {len(s.inputs)} inputs, {len(s.outputs)} "
                                              f"outputs, " + (f"every {1e3 * s.sample_time:g} ms" if s.sample_time
                                                              else "continuous")),
    _core.RootLocus: _plain(lambda r: f"root locus over {r.key}, {len(r.values)} values, limits {r.limits}"),
    _core.Bode: _plain(lambda b: f"6×6 response at {len(b.omega)} frequencies, {b.frequency_hz[0]:.4g} Hz "
                                 f"to {b.frequency_hz[-1]:.4g} Hz, flexible and rigid legs"
                                 + _doubt(b, "the machine is unstable at this pose")),
    _core.CommandResponse: _plain(lambda r: f"command to pose at {len(r.omega)} frequencies"
                                            + _doubt(r, "the loop is unstable")),
    _core.Frf: _plain(lambda f: f"responses of {len(f.outputs)} outputs to {len(f.inputs)} inputs at "
                                f"{len(f.frequency_hz)} lines"),
    _core.Simulation: _plain(lambda s: f"{s.simulated:.6g} s simulated of {s.until:.6g} s: "
                                       f"{' + '.join(s.commands) or 'rest'}"
                                       + ("" if s.finished else f"; ended early: {s.message}")),
    _core.RecordOverview: _record_overview,
    _core.Served: _plain(lambda s: f"{s.time:.6g} s at {s.place}, {s.samples} samples; platform {s.state}"
                                   + (f"; ended early: {s.message}" if s.message else "")),
    _core.Report: _plain(lambda r: f"report of {len(r.html)} characters; .write(path) writes the page"),
}


def text(result: Any) -> str:
    heading, titles, rows, below = _tables[type(result)](result)
    lines = [f"<{type(result).__name__}: {heading}>"]
    if titles:
        table = [titles, *rows]
        widths = [max(len(row[k]) for row in table) for k in range(len(titles))]
        lines += ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in table]
    return "\n".join([*lines, below] if below else lines)


def page(result: Any) -> str:
    if isinstance(result, _core.Report):
        return (f'<iframe sandbox="allow-scripts" style="width:100%;height:720px;border:0" '
                f'srcdoc="{html.escape(result.html, quote=True)}"></iframe>')
    heading, titles, rows, below = _tables[type(result)](result)
    cells = "".join(f"<th>{html.escape(title)}</th>" for title in titles)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    table = f"<table><thead><tr>{cells}</tr></thead><tbody>{body}</tbody></table>" if titles else ""
    after = "<p>{}</p>".format(html.escape(below).replace("\n", "<br>")) if below else ""
    return (f"<div><b>{html.escape(type(result).__name__)}</b>: {html.escape(heading)}{_pictures.picture(result)}{table}"
            f"{after}</div>")


def _cell(value: Any) -> str:
    """A field of a tuple in a few words: a number, a short list, the shape of an array."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)) and len(value) <= 8:
        return ", ".join(_cell(one) for one in value)
    if isinstance(value, (list, tuple)):
        return f"{len(value)}: {_cell(value[0])}, …"
    if isinstance(value, np.ndarray):
        return _cell(value.tolist()) if value.ndim == 1 and len(value) <= 8 else " × ".join(map(str, value.shape))
    return str(value)


def fields(result: Any) -> str:
    """A named tuple in notebooks: a row per field."""
    body = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(_cell(value))}</td></tr>"
                   for name, value in zip(result._fields, result))
    return f"<div><b>{html.escape(type(result).__name__)}</b><table><tbody>{body}</tbody></table></div>"


def _record_array(modes: Any) -> Any:
    """A row per mode, as a NumPy record array: frequency_hz, damping_ratio, omega, moves_platform, label."""
    names = ("frequency_hz", "damping_ratio", "omega", "moves_platform")
    labels = np.array(modes.labels, dtype=str)
    columns = [np.asarray(getattr(modes, name)) for name in names] + [labels]
    fields = [(name, column.dtype) for name, column in zip([*names, "label"], columns)]
    table = np.empty(len(labels), dtype=fields)
    for (name, _), column in zip(fields, columns):
        table[name] = column
    return table.view(np.recarray)


def _to_pandas(modes: Any) -> Any:
    """A row per mode, as a pandas.DataFrame (needs pandas)."""
    import pandas

    return pandas.DataFrame.from_records(_record_array(modes))


def _damping_matrix(modes: Any) -> Any:
    """C + M Φ diag(2 ζ ω) Φᵀ M (dof, dof), ζ: modal damping ratio of the machine, Φ and ω: modes without damping."""
    model = modes.flexible if isinstance(modes, _core.Modes) else modes
    M, K, C = (np.array(matrix) for matrix in (model.M, model.K, model.C))
    ratio = model.modal_damping_ratio
    if ratio == 0.0:
        return C
    L = np.linalg.cholesky(M)
    inverse = np.linalg.inv(L)
    squares, vectors = np.linalg.eigh(inverse @ K @ inverse.T)
    omega = np.sqrt(np.maximum(squares, 0.0))
    return C + L @ (vectors * (2.0 * ratio * omega)) @ vectors.T @ L.T


def attach_fields(tuples: Sequence[Any]) -> None:
    """Gives named tuples a table for notebooks."""
    for one in tuples:
        one._repr_html_ = fields


def _not_pickled(result: Any, protocol: Any = None) -> Any:
    kept = "its to_dict() or " if isinstance(result, _core.Result) else ""
    raise TypeError(f"a {type(result).__name__} can be neither copied nor pickled; keep {kept}the machine it was made of")


def attach() -> None:
    """Gives the classes of the extension what is written in Python."""
    shown: List[Any] = [_core.Result, _core.ModelModes, _core.Superelement]
    for result in shown:
        result.__repr__ = text
        result._repr_html_ = page
        result.__reduce_ex__ = _not_pickled
    modes: Any = _core.Modes
    for name in ("frequency_hz", "omega", "damping_ratio", "poles", "labels", "moves_platform", "stable",
                 "shapes", "coordinates", "M", "K", "C", "modal_damping_ratio"):
        setattr(modes, name, property(operator.attrgetter(f"flexible.{name}")))
    modes.to_records = _record_array
    modes.to_pandas = _to_pandas
    modes.damping_matrix = _damping_matrix
    compared: Any = _core.Compared
    compared.to_records = _compared_records
    compared.to_pandas = _compared_to_pandas
    rigid: Any = _core.ModelModes
    rigid.damping_matrix = _damping_matrix
