"""What shows how far a long task is."""

from __future__ import annotations

import sys
from typing import Any, Optional


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
