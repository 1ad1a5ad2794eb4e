"""Results as other libraries have them: scipy.signal, python-control, pyuff."""

from __future__ import annotations

from typing import Any, Dict, List, Tuple

import numpy as np

from ._core import Bode, Frf, MachineStateSpace, ModelModes, Modes, System
from ._plant import LinearPlant
from ._records import Record

_inputs = {"command": "B_command", "valve": "B_valve", "wrench": "B_wrench"}


def _matrices(of: Any, input: str) -> Tuple[Any, Any, Any, Any]:
    if isinstance(of, (LinearPlant, MachineStateSpace)):
        return of.A, of.B, of.C, of.D
    if isinstance(of, System):
        if input not in _inputs:
            raise ValueError(f"input: expected one of {', '.join(_inputs)}, got {input!r}")
        B = getattr(of, _inputs[input])
        return of.A, B, of.C, np.zeros((of.C.shape[0], B.shape[1]))
    if isinstance(of, (Modes, ModelModes)):
        model = of.flexible if isinstance(of, Modes) else of
        n = model.M.shape[0]
        zero, one = np.zeros((n, n)), np.eye(n)
        M_inverse = np.linalg.inv(model.M)
        A = np.block([[zero, one], [-M_inverse @ model.K, -M_inverse @ of.damping_matrix()]])
        B = np.vstack([np.zeros((n, 6)), M_inverse[:, :6]])
        C = np.hstack([np.eye(6, n), np.zeros((6, n))])
        return A, B, C, np.zeros((6, 6))
    raise TypeError(f"expected a System, a MachineStateSpace, a LinearPlant or Modes, got {type(of).__name__}")


def _time_step(of: Any) -> float:
    return float(of.sample_time) if isinstance(of, MachineStateSpace) else 0.0


def state_space(of: Any, *, input: str = "command") -> Any:
    """scipy.signal.StateSpace of a System, a MachineStateSpace, a LinearPlant (of Plant.linearise()) or Modes.

    input, of a System: command (displacement of the commanded pose, without its velocity), valve or wrench.
    Modes, or its rigid: M ÿ + C ẏ + K y = F with the wrench at the mass centre as input and its motion as output. A
    MachineStateSpace with a sample time gives a system in discrete time.
    Raises TypeError for other results.
    """
    from scipy.signal import StateSpace  # type: ignore[import]

    step = _time_step(of)
    options = {"dt": step} if step > 0.0 else {}
    return StateSpace(*(np.array(matrix) for matrix in _matrices(of, input)), **options)


def to_control(of: Any, *, input: str = "command") -> Any:
    """The same as control.ss (needs python-control).

    Raises TypeError for other results.
    """
    import control  # type: ignore[import]

    step = _time_step(of)
    return control.ss(*(np.array(matrix) for matrix in _matrices(of, input)), *([step] if step > 0.0 else []))


_directions = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
#: dataset 58: time response and frequency response; kinds of numbers: general, frequency, time
_time_function, _frequency_function, _frequency_axis, _time_axis = 1, 4, 18, 17


def _direction(text: str) -> int:
    sign = -1 if text.startswith("-") else 1
    return sign * _directions.get(text.lstrip("-"), 0)


def _function(kind: int, x: Any, data: Any, response: Tuple[int, int], reference: Tuple[int, int], name: str,
              units: Tuple[str, str]) -> Dict[str, Any]:
    spectrum = kind == _frequency_function
    return {"type": 58, "binary": 0, "func_type": kind, "id1": name, "rsp_node": response[0],
            "rsp_dir": response[1], "ref_node": reference[0], "ref_dir": reference[1],
            "x": np.array(x), "data": np.array(data), "num_pts": len(x),
            "ord_data_type": 6 if np.iscomplexobj(data) else 4,
            "abscissa_spacing": 0 if spectrum else 1, "abscissa_min": float(x[0]) if len(x) else 0.0,
            "abscissa_inc": float(x[1] - x[0]) if len(x) > 1 else 0.0,
            "abscissa_spec_data_type": _frequency_axis if spectrum else _time_axis,
            "abscissa_axis_lab": "Frequency" if spectrum else "Time",
            "abscissa_axis_units_lab": "Hz" if spectrum else "s",
            "ordinate_axis_lab": name, "ordinate_axis_units_lab": units[0],
            "orddenom_axis_units_lab": units[1] or "NONE"}


def to_pyuff(of: Any) -> List[Dict[str, Any]]:
    """Datasets of a Universal File as pyuff (sdypy) has them: a list of dictionaries for UFF.write_sets().

    Record: a dataset 58 per channel; Frf and Bode: one per output and input, complex; Modes: a dataset 55 per
    mode with the platform's motion about its mass centre at node 1. Nodes count channels from 1; of Bode node 1
    is the point. pyuff is not needed. hydrapod writes such files itself: export(), Record.write().
    Raises TypeError for other results.
    """
    if isinstance(of, Record):
        return [_function(_time_function, of.time, of.samples[:, k], (k + 1, _direction(of.directions[k])), (0, 0),
                          name, (of.units[k], "")) for k, name in enumerate(of.channels)]
    if isinstance(of, Frf):
        return [_function(_frequency_function, of.frequency_hz, of.H[:, o, i], (o + 1, 0), (i + 1, 0),
                          f"{output} from {input}", ("", ""))
                for o, output in enumerate(of.outputs) for i, input in enumerate(of.inputs)]
    if isinstance(of, Bode):
        return [_function(_frequency_function, of.frequency_hz, of.H[:, o, i], (1, o + 1), (1, i + 1),
                          f"{output} from {input}", ("", ""))
                for o, output in enumerate(_directions) for i, input in enumerate(_directions)]
    if isinstance(of, Modes):
        return [_mode(of, k) for k in range(len(of.frequency_hz))]
    raise TypeError(f"expected a Record, an Frf, a Bode or Modes, got {type(of).__name__}")


def _mode(modes: Modes, k: int) -> Dict[str, Any]:
    shape = np.array(modes.shapes[:6, k])
    columns = {f"r{d + 1}": shape[d:d + 1] for d in range(6)}
    head = {"type": 55, "model_type": 1, "id1": modes.labels[k], "data_ch": 3, "spec_data_type": 8,
            "load_case": 1, "mode_n": k + 1, "node_nums": np.array([1])}
    if not np.iscomplexobj(shape):
        return {**head, "analysis_type": 2, "data_type": 2, "n_data_per_node": 6,
                "freq": float(modes.frequency_hz[k]), "modal_m": 1.0,
                "modal_damp_vis": float(modes.damping_ratio[k]), "modal_damp_his": 0.0, **columns}
    # complex shapes have three directions per node: rotations stand at node 2
    return {**head, "data_ch": 2, "analysis_type": 3, "data_type": 5, "n_data_per_node": 3,
            "eig": complex(modes.poles[k]), "modal_a": 0j, "modal_b": 0j, "node_nums": np.array([1, 2]),
            **{f"r{d + 1}": np.array([shape[d], shape[d + 3]]) for d in range(3)}}
