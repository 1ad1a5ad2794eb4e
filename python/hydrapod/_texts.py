"""What help() says of results: their classes and attributes, with shapes and [units]."""

from __future__ import annotations

from typing import Any, Dict, Tuple

from . import _core

_model_modes = {
    "frequency_hz": "Natural frequencies (n,) [Hz], ascending: |pole| / 2π, with damping.",
    "omega": "The same (n,) [rad/s].",
    "damping_ratio": "Share of critical damping (n,), 0.02 for 2 %.",
    "poles": "Eigenvalues (n,) [1/s], complex, one of each pair.",
    "labels": "What moves in each mode and what gives way, in words: a list of n texts.",
    "moves_platform": "Whether the platform feels each mode: a list of n bools.",
    "stable": "Whether all modes are stable.",
    "shapes": "Mode shapes (dof, n) in `coordinates`, φᴴ M φ = 1. Complex where damping makes them so, else real.",
    "coordinates": "Names of the coordinates: a list of dof texts; the first six are the platform's x … rz.",
    "M": "Mass matrix (dof, dof) [kg, kg m, kg m²].",
    "K": "Stiffness matrix (dof, dof) [N/m, N, N m], with what gravity and oil forces add to it.",
    "C": "Damping matrix (dof, dof) [N s/m, N s, N m s], without the modal damping ratio: see damping_matrix().",
    "modal_damping_ratio": "Damping ratio of the machine file that holds for all modes; 0: none.",
}
_warnings = {"warnings": "What is to be kept in mind: a list of sentences."}
_lines = {
    "frequency_hz": "Lines (L,) [Hz].",
    "omega": "The same (L,) [rad/s].",
}

#: class: what it is, and its attributes
_results: Dict[Any, Tuple[str, Dict[str, str]]] = {
    _core.ModelModes: ("Modes of one of the two models of Modes: its `flexible` or its `rigid`.", _model_modes),
    _core.Modes: ("Result of modes(): modes at a pose. Its attributes are those of the machine's model, `flexible`.", {
        **_model_modes,
        "flexible": "Modes of the machine's model, a ModelModes.",
        "rigid": "Modes of the model with rigid legs, a ModelModes.",
        "answer": "The lowest mode that the platform feels, in one sentence."}),
    _core.ModesAtPoses: ("Result of modes_at_poses(): m modes, each followed through p poses.", {
        "frequency_hz": "Frequencies (m, p) [Hz]; NaN where there is no such mode.",
        "mac": "Agreement of the shape with the one at the pose before (m, p), 0 to 1; NaN at the first one.",
        "numbers": "Number of the mode among those of the pose (m, p), counted from 0; -1: none.",
        "labels": "What moves, in words: a list of m texts.",
        "poses": "Names of the poses: a list of p texts."}),
    _core.ModesAtAmplitudes: ("Result of modes_at_amplitudes(): m branches of modes at k amplitudes.", {
        "amplitudes": "Of the platform joint that moves most (k,) [m].",
        "frequency_hz": "Frequencies (m, k) [Hz]; NaN where a branch does not have the amplitude.",
        "damping_ratio": "Shares of critical damping (m, k).",
        "sleeve_amplitude": "Largest motion in a guide sleeve (m, k) [m].",
        "numbers": "Numbers of the undamped modes (m,), counted from 0.",
        "directions": "Direction that each mode moves most: a list of m texts, x … rz.",
        "from_long_swings": "Whether it is a second branch, found from long swings: a list of m bools."}),
    _core.System: ("Result of system(): machine, hydraulics, controller and delay, linear about rest.", {
        "A": "State matrix (s, s) [1/s and mixed].",
        "B_command": "From the commanded displacement (s, 6) [m, rad].",
        "B_velocity": "From the commanded velocity (s, 6) [m/s, rad/s].",
        "B_valve": "From the valve commands (s, 6).",
        "B_wrench": "From force and moment about the mass centre (s, 6) [N, N m].",
        "C": "To the displacement of the platform (6, s) [m, rad].",
        "C_ground": "The same against the ground (6, s) [m, rad]; a base that gives way moves too.",
        "sampled": "Matrix of the sampled closed loop from one sample to the next.",
        "states": "Names of the states: a list of s texts.",
        "closed": "Whether the controller is part of it.",
        "poles": "Eigenvalues [1/s], complex, one of each pair, least damped in time first.",
        "damping_ratio": "Their shares of critical damping.",
        "participation": "What moves in each, in words.",
        "stable": "Whether it is stable; of a closed loop as its controller samples it.",
        "verdict": "The same in one sentence.",
        "delay": "From the sample to the valve [s].",
        "sample_time": "Of the controller [s]."}),
    _core.RootLocus: ("Result of root_locus(): poles over one number of the file.", {
        "key": "Path of the number.",
        "values": "Its values (k,) [SI].",
        "poles": "Eigenvalues at each value [1/s]: a list of k complex arrays.",
        "limits": "Values at which stability changes [SI]; empty: it does not."}),
    _core.Bode: ("Result of bode(): 6 × 6 responses of the platform at L lines.", {
        **_lines,
        "H": "Responses of the machine's model (L, 6, 6), complex, H[k, out, in], x … rz. "
             "Of displacements from a wrench [m/N, rad/N, m/(N m), rad/(N m)].",
        "H_rigid": "The same with rigid legs (L, 6, 6).",
        "stable": "Whether the machine is stable at this pose; else no steady vibration exists, and the responses are "
                  "those of its linear equations."}),
    _core.CommandResponse: ("Result of bode(input=\"command\"): from the commanded to the true pose at L lines.", {
        **_lines,
        "H": "Responses (L, 6, 6), complex, H[k, out, in], x … rz [1, and m and rad for one another].",
        "stable": "Whether the closed loop is stable; else no steady vibration exists, and the responses are "
                  "those of the linear equations."}),
    _core.Check: ("Result of check(): p poses.", {
        "sound": "Whether the machine is sound at all poses.",
        "verdict": "The same in one sentence.",
        "poses": "Names of the poses: a list of p texts.",
        "lengths": "Of the legs between their joints (p, 6) [m].",
        "axial_force": "In the legs at rest (p, 6) [N], positive for compression.",
        "oil_stiffness": "Of the oil columns (p, 6) [N/m].",
        "tilt": "Of the rods in their seals under the static load (p, 6) [rad].",
        "buckling_payload": "Mass on top of the platform at which the legs buckle (p,) [kg]; NaN: none was found.",
        **_warnings}),
    _core.Sensitivity: ("Result of sensitivity(): n modes, p numbers of the file.", {
        "parameters": "Paths of the numbers: a list of p texts.",
        "omega": "Frequencies of the modes (n,) [rad/s].",
        "percent_per_percent": "d ln ω / d ln p (n, p): change of the frequency in % for 1 % of the number."}),
    _core.Simulation: ("Result of simulate(): N samples of a run.", {
        "time": "(N,) [s]",
        "command": "Commanded displacement from the pose (N, 6), x, y, z [m], rx, ry, rz [rad].",
        "motion": "Displacement of the platform from the pose (N, 6) [m, rad].",
        "piston": "Position of the pistons from the base joints (N, 6) [m].",
        "drive": "Commands at the valves or motors (N, 6), shares of the full one.",
        "cap_pressure": "In the chambers at the caps (N, 6) [Pa]; (0, 6) with electric drives.",
        "rod_pressure": "In the chambers at the rods (N, 6) [Pa]; (0, 6) with electric drives.",
        "nut": "Way of the nuts (N, 6) [m], of electric drives alone.",
        "motor_speed": "(N, 6) [rad/s], of electric drives alone.",
        "torque": "Of the motors (N, 6) [N m], of electric drives alone.",
        "rms_error": "Root mean square of commanded less true displacement (6,) [m, rad].",
        "peak_error": "Its largest value (6,) [m, rad].",
        "commands": "The signals with all their keys: a list of texts.",
        "until": "End that was asked for [s].",
        "simulated": "End that was reached [s].",
        "finished": "Whether it ran to its end.",
        "message": "Why it ended early; empty: it did not.",
        "record": "File that was written; empty: none.",
        **_warnings}),
    _core.Frf: ("Result of frf(): responses of o outputs to i inputs at L lines.", {
        "frequency_hz": _lines["frequency_hz"],
        "H": "Responses (L, o, i), complex, unit of the output per unit of the input.",
        "deviation": "Standard deviations of H (L, o, i); (0, o, i) where they are not known.",
        "coherence": "Ordinary coherences (L, o, i), 0 to 1.",
        "inputs": "Names of the inputs: a list of i texts.",
        "outputs": "Names of the outputs: a list of o texts.",
        "write": "write(path) writes .json, .csv, .uff, .mat or .h5, as `hydrapod frf -o` does.",
        **_warnings}),
    _core.Identified: ("Result of identify(): n modes of o outputs and i inputs, measured at L lines.", {
        "frequency_hz": "Natural frequencies (n,) [Hz]: |pole| / 2π.",
        "frequency_deviation_hz": "Their standard deviations (n,) [Hz].",
        "damping_ratio": "Shares of critical damping (n,).",
        "damping_deviation": "Their standard deviations (n,).",
        "quality": "How much they can be relied upon (n,), 0 to 1.",
        "shapes": "Mode shapes as displacements of the outputs (o, n), complex.",
        "motion": "What moves, in words: a list of n texts.",
        "inputs": "Names of the inputs: a list of i texts.",
        "outputs": "Names of the outputs: a list of o texts.",
        "line_frequency_hz": _lines["frequency_hz"],
        "H": "Measured responses (L, o, i), complex.",
        "deviation": "Standard deviations of H (L, o, i); (0, o, i) where they are not known.",
        "radius_95": "With 95 % probability H is off by less than so many deviations.",
        "H_modes": "Responses of the modes at the lines (L, o, i), complex; NaN without modes.",
        "mode_indicator": "Singular values of H (L, k), the largest first.",
        "write": "write(path) writes .json, .csv, .uff or .mat, as `hydrapod identify -o` does.",
        **_warnings}),
    _core.Calibrated: ("Result of calibrate(): the best combination, p fitted numbers.", {
        "parameters": "Paths, tied ones with commas: a list of p texts.",
        "units": "Their SI units.",
        "values": "Fitted values (p,) [SI].",
        "deviations": "Their standard deviations (p,) [SI].",
        "verdicts": "Whether the targets determine them, in words.",
        "misfit": "Sum of the squares of the weighted differences that remain.",
        "interrupted": "Whether it was stopped; then it is the best so far.",
        "remarks": "What is to be known about the fit: a list of sentences.",
        "text": "The calibrated machine file, with its comments.",
        **_warnings}),
    _core.Diagnosed: ("Result of diagnose().", {
        "summary": "Cause, certainty and remedy: a list of sentences.",
        "finding": "The finding in one word; None without a measurement.",
        "hypotheses": "Names of the hypotheses, best first.",
        "bic": "Their Bayesian information criteria (h,): smaller is better, 10 less is very strong evidence.",
        **_warnings}),
    _core.Compared: ("Result of compare(). to_records() and to_pandas() have a row per pair of modes.", {
        "things": "Names of what was compared: a list of texts.",
        "descriptions": "What they are, in words.",
        "columns": "The pairs of modes: a dict of columns; things and modes are counted from 0.",
        "level": "Significance level of all tests of one comparison together, a share.",
        "test": "The test in one sentence.",
        **_warnings}),
    _core.Study: ("Result of montecarlo(), sweep() and workspace_map(): N rows; study[\"x\"] is a column (N,).", {
        "kind": "montecarlo, sweep or map.",
        "values": "All columns (N, columns) [SI, frequencies in Hz]; NaN where a row has no result.",
        "names": "Names of the columns.",
        "units": "Their units.",
        "meanings": "What they are, in words.",
        "input_count": "So many of the columns, the first ones, are what was varied.",
        "shape": "Counts of a grid, the last one varies fastest; else [N].",
        "complete": "Whether all rows that were asked for were computed; of a part, those of the part.",
        "part": "(i, n) of part i of n, whose rows are in rows_file alone; None: the whole study.",
        "rows_file": "File of the rows.",
        "seconds": "Time that it took [s].",
        "requirements": "Texts of the r requirements.",
        "probability_of_missing": "Share of rows that miss each requirement (r,).",
        "probability_interval": "Its 95 % interval (r, 2); NaN where there is none.",
        "worst_rows": "Row that is worst for each requirement (r,); -1: none.",
        "core_machine": "For machine(row).",
        "machine_text": "machine_text(row, label): machine file of a row, with `label` in its comment."}),
    _core.Design: ("Result of design(): c changes, a aims, r requirements.", {
        "feasible": "Whether all requirements are met; else the numbers are those of the least violation.",
        "interrupted": "Whether it was stopped; then it is the best so far.",
        "evaluations": "So many designs were computed.",
        "paths": "What was changed: a list of c texts.",
        "units": "Their SI units.",
        "values": "Their values (c,) [SI].",
        "present": "Their values in the machine file (c,) [SI].",
        "aims": "Texts of the aims.",
        "aim_values": "What they come to (a,) [SI, frequencies in Hz].",
        "aim_present": "What they are in the machine file (a,).",
        "requirements": "Texts of the requirements.",
        "worst": "Worst value for each requirement (r,) [SI, frequencies in Hz].",
        "worst_present": "The same of the machine file (r,).",
        "worst_poses": "Pose at which it is worst: a list of r texts.",
        "front_aims": "Aims of the points of a trade-off (points, a); (0, a) without one.",
        "front_values": "Changes of the points of a trade-off (points, c) [SI].",
        "text": "Machine file with the design, comments kept; empty where it is not feasible.",
        "core_machine": "For machine."}),
    _core.MachineStateSpace: ("Result of machine_state_space(): ẋ = A x + B u, y = C x + D u, about rest.", {
        "A": "(s, s)", "B": "(s, i)", "C": "(o, s)", "D": "(o, i)",
        **{f"{one}s": f"Names of the {one}s: a list of texts." for one in ("state", "input", "output")},
        **{f"{one}_units": "Their units." for one in ("state", "input", "output")},
        **{f"{one}_rest": f"Values of the {one}s at the operating point, in their units."
           for one in ("state", "input", "output")},
        "sample_time": "[s]; 0: continuous.",
        "delay": "For which a Padé approximation stands in the matrices [s]; 0: none.",
        "pade_order": "Order of that approximation; 0: none."}),
    _core.Superelement: ("Result of superelement(): platform and modes of the legs, n coordinates.", {
        "M": "Mass matrix (n, n) [SI].", "K": "Stiffness matrix (n, n) [SI].", "C": "Damping matrix (n, n) [SI].",
        "coordinates": "Names of the coordinates: a list of n texts.",
        "units": "Their units.",
        "first_left_out": "Lowest mode of the legs that is not kept [rad/s]; 0: all are kept."}),
    _core.RecordOverview: ("Result of show_record(): c channels, L lines of their spectra.", {
        "channels": "Names of the channels: a list of c texts.",
        "units": "Their SI units.",
        "roles": "excitation, drive, response or other, of each.",
        "directions": "x … rz, -x …, leg 1 … of each; empty: none.",
        "mean": "Mean of the samples that are there (c,) [unit of the channel].",
        "rms": "Root mean square about the mean (c,) [unit of the channel].",
        "lowest": "Lowest sample (c,) [unit of the channel].",
        "highest": "Highest sample (c,) [unit of the channel].",
        "peak": "Largest distance from the mean (c,) [unit of the channel].",
        "at_limit": "Samples in runs of three or more at the lowest or highest value (c,): clipping.",
        "longest_hold": "Longest run of one value (c,) [samples]; 0 of a constant channel.",
        "missing": "Samples that are missing (c,): drop-outs.",
        "infinite": "Samples that are infinite (c,).",
        "strongest_frequency_hz": "Frequency of the largest spectral density above 0 Hz (c,) [Hz]; 0: none.",
        "spectrum_frequency_hz": "Lines of the spectra (L,) [Hz].",
        "spectra": "One-sided power spectral densities by Welch's method (L, c) [unit²/Hz].",
        "format": "hdf5, mat5, mat73, csv, uff, uff-ascii, rpc or rpc-short.",
        "title": "Title of the record.",
        "sample_rate": "[Hz]",
        "start": "Time of the first sample [s].",
        "samples": "How many there are.",
        "duration": "[s]",
        **_warnings}),
    _core.Served: ("Result of serve(): the machine in real time.", {
        "place": "Where it listened: \"127.0.0.1:4747\", or the name of the shared memory.",
        "samples": "How many there were.",
        "time": "End of the run by the clock of the machine [s].",
        "sample_time": "Of the controller [s].",
        "state": "Of the platform at the end: waiting, following, holding, ramping or parked.",
        "finished": "Whether the duration was reached, or the client had gone.",
        "message": "Why it ended early; empty: it did not.",
        "record": "File that was written; empty: none.",
        "deadline_misses": "Samples that began when the next one was due.",
        **_warnings}),
    _core.Report: ("Result of report(): one HTML page. A notebook shows it in a frame.", {
        "html": "Text of the page.",
        "write": "write(path) writes the page.",
        **_warnings}),
}


def attach() -> None:
    """Gives classes and attributes of the extension their texts."""
    for cls, (text, attributes) in _results.items():
        cls.__doc__ = text
        for name, words in attributes.items():
            attribute: Any = vars(cls)[name]
            if isinstance(attribute, property):
                setattr(cls, name, property(attribute.fget, doc=words))


attach()
