"""What shows how far a long task is."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Optional

from ._errors import ComputationError, InputError


@contextmanager
def all_or_none(progress: Optional[Callable[[float], Optional[bool]]], *, parts: bool = False) -> Iterator[Any]:
    """What to give a task as `progress`: a task that was stopped raises ComputationError and gives no part of a result
    as if it were the whole. parts: its results say themselves that they are parts."""
    if progress is None:
        yield None
        return
    if not callable(progress):
        raise TypeError(f"progress: expected a callable that gets the share done, got {progress!r}")
    stopped = False
    ask = progress

    def told(share: float) -> bool:
        nonlocal stopped
        stop = bool(ask(share))
        stopped = stopped or stop and share < 1.0
        return stop

    try:
        yield told
    except (ComputationError, InputError):
        if stopped:
            raise ComputationError("interrupted: progress asked to stop") from None
        raise
    if stopped and not parts:
        raise ComputationError("interrupted: progress asked to stop")


def progress_bar(label: str = "") -> "ProgressBar":
    """A callable for `progress=`: a bar of tqdm where it is installed, else percentages on the standard error.

        hydrapod.montecarlo(machine, vary, progress=hydrapod.progress_bar("samples"))

    It is for one task; make another one for the next.
    """
    return ProgressBar(label)


class ProgressBar:
    """See progress_bar(). `share`: the largest share that was told, 0 to 1."""

    def __init__(self, label: str = ""):
        self.share = 0.0
        self._label = label
        self._bar: Optional[Any] = None
        try:
            from tqdm.auto import tqdm  # type: ignore[import]

            self._bar = tqdm(total=100.0, desc=label or None, unit="%",
                             bar_format="{l_bar}{bar}| {elapsed}<{remaining}")
        except ImportError:
            pass

    def __call__(self, share: float) -> None:
        before, self.share = self.share, max(self.share, float(share))
        if self._bar is not None:
            self._bar.update(100.0 * (self.share - before))
            if self.share >= 1.0:
                self._bar.close()
        elif int(100 * self.share) > int(100 * before):
            end = "\n" if self.share >= 1.0 else ""
            print(f"\r{self._label + ': ' if self._label else ''}{100 * self.share:3.0f} %", end=end, file=sys.stderr,
                  flush=True)
