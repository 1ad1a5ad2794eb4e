"""One evaluation by Dakota's files."""

from __future__ import annotations

from typing import List, Mapping, NamedTuple, Optional

from . import _checks, _core
from ._checks import Texts
from ._machine import Machine
from ._records import Path
from ._studies import _paths
from ._tasks import _core_of


class Evaluation(NamedTuple):
    """One evaluation by Dakota's files."""

    text: str  #: the results file
    failure: str  #: why it says FAIL; empty: it does not
    by_differences: List[str]  #: outputs whose gradients are central differences
    id: str  #: eval_id of the parameters file


def evaluate(machine: Machine, parameters: Path, results: Optional[Path] = None, *,
             variables: Mapping[str, str] = {}, functions: Texts = ()) -> Evaluation:
    """One evaluation for Dakota, or for any program that speaks its files: parameters in, results out.

    parameters: Dakota's parameters file, standard or aprepro format. results: file to write. variables:
    {NAME: "PATH" or "PATH [unit]"}, what a variable of that file is; others are paths, with values in SI. functions:
    output of each function, in their order; default: their labels.

    Result, an Evaluation: text (frequencies of undamped modes, with elastomers of damped ones [Hz]; others [SI]),
    failure, by_differences, id. A design that has no outputs is no error: the text says FAIL. Raises InputError for a file that cannot be read, an unknown variable,
    output or request. Source: docs/howto/study.md. C++: tasks::evaluate in hydrapod/tasks/study.hpp.
    """
    core, asked = _core_of(machine), _checks.path(parameters, "parameters")
    given, target = _paths(variables, "variables"), _checks.output_or_none(results, "results", core.path, asked)
    done = Evaluation(*_core.evaluate(
        core, asked,
        [f"{name}={_checks.word(what, f'variables of {name}')}" for name, what in given.items()],
        _checks.words(functions, "functions")))
    if target is not None:
        _core.write_text(target, done.text)
    return done
