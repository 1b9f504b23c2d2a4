"""Progress bars of runs and studies."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import _native


def is_seen() -> bool:
    """Whether a progress bar can be shown: on a terminal or in a notebook. A log would get a line per update."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return getattr(shell, "kernel", None) is not None or (sys.stderr is not None and sys.stderr.isatty())


class Progress:
    """A progress bar over the time of a run, if requested and visible."""

    def __init__(self, wanted: bool) -> None:
        self._wanted = wanted and is_seen()
        self._bar: Any = None

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.close()

    def show(self, place: _native.Place | None) -> None:
        """Update the progress of the run, if it has advanced."""
        if not self._wanted or place is None:
            return
        step, time, end, dt, increments, iterations, (opened, stick, slip) = place
        if self._bar is None:
            from tqdm.auto import tqdm

            form = "{l_bar}{bar}| {elapsed}<{remaining}{postfix}"
            self._bar = tqdm(total=100.0, bar_format=form)
        text = f"t {time:.6g} dt {dt:.2e} {iterations} iter"
        if opened + stick + slip:
            text += f" open {opened} stick {stick} slip {slip}"
        self._bar.set_description_str(step, refresh=False)
        self._bar.set_postfix_str(text, refresh=False)
        # A run that was resumed has come some way already.
        self._bar.update(max(0.0, 100.0 * time / end - self._bar.n) if end > 0.0 else 0.0)
        self._bar.refresh()
