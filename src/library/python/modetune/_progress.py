# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a long search is told: a callback, a cell of a notebook, or one line of a terminal."""
from __future__ import annotations

import sys
from typing import Any, Callable, Union

Progress = Union[None, bool, Callable[[str], None]]


class Silent:
    """Tells nobody."""

    def show(self, text: str) -> None:
        pass

    def close(self) -> None:
        pass


class Told(Silent):
    """Tells a function of the caller's."""

    def __init__(self, function: Callable[[str], None]) -> None:
        self._function = function

    def show(self, text: str) -> None:
        self._function(text)


class Line(Silent):
    """One line of standard error, written over and empty in the end."""

    def __init__(self) -> None:
        self._width = 0

    def show(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

    def close(self) -> None:
        if self._width > 0:
            sys.stderr.write("\r" + " " * self._width + "\r")
            sys.stderr.flush()


class Cell(Silent):
    """One output of a notebook's cell, replaced and empty in the end."""

    def __init__(self, display: Callable[..., Any]) -> None:
        self._display = display
        self._handle: Any = None

    def show(self, text: str) -> None:
        shown = {"text/plain": text}
        if self._handle is None:
            self._handle = self._display(shown, raw=True, display_id=True)
        else:
            self._handle.update(shown, raw=True)

    def close(self) -> None:
        if self._handle is not None:
            self._handle.update({"text/plain": ""}, raw=True)


def _display_of_kernel() -> Any:
    """IPython's display where this runs in a kernel of it (a notebook), else None."""
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if getattr(shell, "kernel", None) is None:
        return None
    from IPython.display import display  # type: ignore[import-not-found]
    return display


def teller(wish: Progress) -> Silent:
    """None: a notebook or a terminal is told, nobody else; True: standard error in any case."""
    if callable(wish):
        return Told(wish)
    display = None if wish is False else _display_of_kernel()
    if display is not None:
        return Cell(display)
    if wish or (wish is None and sys.stderr is not None and sys.stderr.isatty()):
        return Line()
    return Silent()
