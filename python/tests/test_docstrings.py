"""Docstrings say what the C++ headers say: the same first sentence, at least the same errors and units, real names."""

import inspect
import re

import pytest
from conftest import root

import hydrapod

# What has no C++ function of its own: arrays in and arrays out, other packages' objects, pictures of results.
of_python_alone = {
    "buckling", "build_machine", "forward_kinematics", "frequencies", "leg_jacobian", "leg_lengths",
    "machine_state_space", "packet_layout", "plot_bode", "plot_diagnosis", "plot_fit", "plot_map", "plot_modes",
    "plot_stabilisation", "pose_quality", "progress_bar", "sample_signals", "state_space", "static_equilibrium",
    "superelement", "multibody_text", "to_control", "to_mujoco", "to_pyuff"}
exceptions = {"base::InputError": "InputError", "base::ComputationError": "ComputationError",
              "std::invalid_argument": "ValueError"}
functions = {name: thing for name in hydrapod.__all__
             if inspect.isfunction(thing := getattr(hydrapod, name))}
of_headers = sorted(set(functions) - of_python_alone)


def one_line(text):
    return " ".join(text.split())


def plain(text):
    """Without marks of code, which both sides write in their own way."""
    return one_line(text).replace("`", "").replace('"', "")


def header_of(doc):
    """(qualified name, path) of the C++ function that a docstring names."""
    found = re.findall(r"C\+\+: ([\w:]+) in ([\w/]+\.hpp)\.", one_line(doc))
    assert len(found) == 1, "expected one 'C++: NAME in HEADER.'"
    return found[0]


def comment_of(name, header):
    """Comment and declaration of a function in a header."""
    pattern = rf"((?:^[ ]*///[^\n]*\n)+)((?:[^\n;{{}}/]*\n)*?[^\n;{{}}/]*\b{name}\([^;{{]*[;{{])"
    found = re.findall(pattern, header, re.MULTILINE)
    assert found, f"{name} is not declared, with a comment, in the header"
    comment, declaration = found[-1]
    return one_line(re.sub(r"^[ ]*///<?", "", comment, flags=re.MULTILINE)), one_line(declaration)


def options_of(declaration, header):
    """{field: units} of the structs that a function takes as options."""
    units = {}
    for struct in re.findall(r"const (?:[a-z]+::)?(\w*(?:Options|Part|Output))&", declaration):
        body = re.search(rf"^struct {struct} \{{\n(.*?)^\}};", header, re.MULTILINE | re.DOTALL)
        for field, comment in re.findall(r"(\w+)\{[^;]*\};\s*///< (.*)", body.group(1) if body else ""):
            units[field] = re.findall(r"\[[^\]]+\]", comment)
    return units


def with_references(name, doc):
    """The docstring, and those that it points to: "see frf()", "as simulate()"; and so on."""
    names, whole = {name}, doc
    while more := {other for other in re.findall(r"(\w+)\(\)", whole) if other in functions} - names:
        names |= more
        whole += " ".join(functions[other].__doc__ for other in more)
    return one_line(whole)


def mistakes(name, function, header_text):
    """What a docstring says otherwise than its header."""
    doc = function.__doc__
    cpp, path = header_of(doc)
    header = header_text(path)
    comment, declaration = comment_of(cpp.split("::")[-1], header)
    assert f"namespace hydrapod::{cpp.split('::')[0]}" in header
    whole = with_references(name, doc)
    found = []
    summary = re.match(r"(.*?[.!?])(?:\s|$)", plain(doc)).group(1)
    # the whole sentence, at the beginning of one
    if not re.search(rf"(?:^|\. ){re.escape(summary[:-1])}[.:](?:\s|$)", plain(comment)):
        found.append(f"the header does not say: {summary}")
    for cpp_error, python_error in exceptions.items():
        if cpp_error in comment and python_error not in whole:
            found.append(f"the header says {cpp_error}, which is {python_error}")
    if "Raises" not in doc and any(error in comment for error in exceptions):
        found.append("errors without 'Raises'")
    parameters = set(inspect.signature(function).parameters)
    for field, units in options_of(declaration, header).items():
        if field in parameters:
            found += [f"the header says that {field} is in {unit}" for unit in units if unit not in whole]
    for one in parameters - {"progress", "machine", "threads", "seed"}:
        if not re.search(rf"\b{one}\b", whole):
            found.append(f"{one} is not mentioned")
    arguments = re.split(r"\bResult\b", doc)[0]
    for names in re.findall(r"(?:\. |\n    )([a-z_]+(?:, [a-z_]+)*): ", arguments):
        found += [f"{one} is no parameter" for one in names.split(", ") if one not in parameters | {"default"}]
    return found


def read_header(path):
    return (root / "include" / path).read_text()


@pytest.mark.parametrize("name", of_headers)
def test_docstring_says_what_the_header_says(name):
    assert mistakes(name, functions[name], read_header) == []


def test_what_is_of_python_alone_names_no_header():
    assert of_python_alone <= set(functions)
    for name in of_python_alone:
        assert "C++:" not in functions[name].__doc__, name


def test_every_task_of_the_headers_is_there():
    """Each function of hydrapod/tasks is named by a docstring, or is a part of one that is."""
    named = {header_of(functions[name].__doc__)[0] for name in of_headers}
    parts = {"tasks::pose_of", "tasks::displacement_of", "tasks::model_of", "tasks::limits_of",  # of read_machine, rig
             "tasks::add_pose", "tasks::modes_without_overrides", "tasks::command_response", "tasks::export_files",
             "tasks::shared_responses", "tasks::observed_in", "tasks::summary_of", "tasks::is_mode_list",
             "tasks::stated_pose", "tasks::read_measured", "tasks::identified_mode", "tasks::read_goal",
             "tasks::check_run", "tasks::study_effort", "tasks::run_study", "tasks::study_row",
             "tasks::run_design", "tasks::refine_grid"}
    there = set()
    for path in (root / "include/hydrapod/tasks").glob("*.hpp"):
        declared = re.sub(r"^struct .*?^\};", "", path.read_text(), flags=re.MULTILINE | re.DOTALL)
        there |= {f"tasks::{name}" for name in re.findall(r"^(?!using|///|#)\S[^\n(]*?\b(\w+)\(", declared,
                                                          re.MULTILINE)}
    assert there - named - parts == set()
    assert parts <= there


def wrong_summary(machine):
    """Modes at the pose of the machine.

    Raises ComputationError. C++: tasks::modes in hydrapod/tasks/linear.hpp.
    """


def no_errors(machine):
    """Modes at the machine's pose, of its model beside the rigid-leg model.

    C++: tasks::modes in hydrapod/tasks/linear.hpp.
    """


def wrong_names(options, until):
    """Time simulation: mechanics, hydraulics, controller.

    option: one. Raises InputError, ComputationError. C++: tasks::simulate in hydrapod/tasks/simulation.hpp.
    """


@pytest.mark.parametrize("function, said", [
    (wrong_summary, ["does not say: Modes at the pose"]),
    (no_errors, ["base::ComputationError", "without 'Raises'"]),
    (wrong_names, ["until is in [s]", "options is not mentioned", "until is not mentioned", "option is no parameter"])])
def test_mistakes_are_found(function, said):
    found = sorted(mistakes("", function, read_header))
    assert len(found) >= len(said)
    for text in said:
        assert any(text in one for one in found), (text, found)
    assert len(found) == len(said), found
