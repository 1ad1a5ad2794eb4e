"""What can go wrong: the exceptions of hydrapod."""

from __future__ import annotations

from typing import List, NamedTuple, Tuple


class Diagnostic(NamedTuple):
    """One finding about an input. `line` and `column` count from 1; 0: not in a file."""

    severity: str
    file: str
    line: int
    column: int
    key: str
    message: str


class InputError(ValueError):
    """A file, a path, a quantity or an option that cannot be used.

    The message lists every mistake. `diagnostics` has them one by one: file (or the argument), line,
    column, key, and what would be accepted. `file`, `line`, `column`, `key` and `advice` are those of
    the first.
    """

    def __init__(self, message: str = "", diagnostics: List[Tuple[str, str, int, int, str, str]] = []):
        super().__init__(message, diagnostics)
        self.diagnostics = [Diagnostic(*one) for one in diagnostics]

    def __str__(self) -> str:
        return str(self.args[0])

    @property
    def first(self) -> Diagnostic:
        """The first of the diagnostics."""
        return self.diagnostics[0] if self.diagnostics else Diagnostic("error", "", 0, 0, "", str(self))

    @property
    def file(self) -> str:
        """Its file or argument."""
        return self.first.file

    @property
    def line(self) -> int:
        """Its line, counted from 1; 0: not in a file."""
        return self.first.line

    @property
    def column(self) -> int:
        """Its column, counted from 1; 0: not in a file."""
        return self.first.column

    @property
    def key(self) -> str:
        """Its key in the file, "legs.rod.length"."""
        return self.first.key

    @property
    def advice(self) -> str:
        """What was found and what would be accepted."""
        return self.first.message


class ComputationError(RuntimeError):
    """The input was fine and the computation cannot give a result; the message says why."""
