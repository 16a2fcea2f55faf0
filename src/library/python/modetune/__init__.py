# SPDX-License-Identifier: GPL-3.0-or-later
"""modetune: what to change so that a mechanism's natural frequencies land where they must.

    import modetune
    result = modetune.solve("studies/inceptor_tuning_1.json")
    modes = modetune.modes("problems/inceptor.json", "installed", set={"K_T1": 2e4})
    modetune.report(result).save("report.html")

Models and studies are files (a path) or what such files hold (a dict); what is wrong with them
is an Error that says where. Results are in SI units. The same question has the same answer, for
any number of workers.
"""
from __future__ import annotations

import ctypes
import json
import operator
import os
import queue
import threading
import warnings
from contextlib import contextmanager
from ctypes import byref, c_char_p, c_double, c_int, c_void_p, sizeof
from typing import (
    TYPE_CHECKING, Any, Callable, ContextManager, Iterator, Mapping, Optional, Sequence, Union,
)

from ._library import (
    PROGRESS, Diagnostic, Error, ErrStruct, Files, SolveOptions, check, encoded, lib, made,
    one_thread, text_made, text_of, version,
)
from ._models import Model, PathLike, Value, named, sets_of
from ._page import Report
from ._progress import Progress, Silent, teller

if TYPE_CHECKING:
    from .types import Result

__all__ = ["Diagnostic", "Doubt", "Error", "Model", "Report", "modes", "report", "solve"]
__version__ = version

WISH_END = 2  # of mt_stop_request
MOST_START_S = 1.0  # a thread that has begun by then is waited for as long as it takes
MOST_SEED = 2**31 - 1


def __dir__() -> list[str]:
    """What is meant for others, and what every module has."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})


class Doubt(UserWarning):
    """What is hardly meant in a model, said as the command line says it."""


class _Search:
    """A study read, solved and deleted by a thread of its own, so that Ctrl-C and the progress
    reach this one. That thread alone holds what C has made: wherever this one is interrupted,
    nothing is deleted under the search."""

    def __init__(self, question: Callable[[], ContextManager[c_void_p]], workers: int,
                 show: Silent) -> None:
        self._question = question
        self._show = show
        self._said: "queue.SimpleQueue[Optional[str]]" = queue.SimpleQueue()
        self._answer = ""
        self._failure: Optional[BaseException] = None
        self._wish = c_int(0)
        self._tell = PROGRESS(lambda _, text: self._said.put(text_of(text)))
        self._options = SolveOptions(
            size=sizeof(SolveOptions), threads=workers,
            stop=ctypes.cast(lib.mt_stop_request_at, c_void_p),
            stop_context=ctypes.cast(ctypes.pointer(self._wish), c_void_p), progress=self._tell)
        self._turn = threading.Lock()  # who has it decides whether there is a search
        self._over = threading.Event()  # the thread's last word

    def _solve(self) -> None:
        with self._question() as study, made(
                "mt_study_solve", "mt_result_delete", study, byref(self._options)) as result:
            self._answer = text_made("mt_result_json", result)

    def _work(self) -> None:
        try:
            if self._turn.acquire(blocking=False):
                self._solve()
        except BaseException as failure:  # told by the thread that asked
            self._failure = failure
        finally:
            self._said.put(None)
            self._over.set()

    def _is_over(self, thread: threading.Thread) -> bool:
        """Wait for the thread's last word."""
        self._wish.value = WISH_END
        # a thread whose start was interrupted may never come, or find that it is late
        if not self._over.wait(MOST_START_S) and self._turn.acquire(blocking=False):
            return True
        self._over.wait()
        thread.join()
        return True

    def run(self) -> str:
        thread = threading.Thread(target=self._work, name="modetune", daemon=True)
        pressed: Optional[KeyboardInterrupt] = None
        over = False
        try:
            thread.start()
            for text in iter(self._said.get, None):
                self._show.show(text)
        finally:  # also where it was interrupted, or the caller's function failed
            while not over:
                try:
                    over = self._is_over(thread)
                except KeyboardInterrupt as again:
                    pressed = again
            self._show.close()
        if pressed is not None or self._failure is not None:
            raise pressed or self._failure  # type: ignore[misc]
        return self._answer


@contextmanager
def _study(path: bytes, given: dict[str, str], sets: list[str],
           seed: Optional[int]) -> Iterator[c_void_p]:
    with Files(given, sets, seed) as read, one_thread:
        with made("mt_study_read", "mt_study_delete", path, byref(read.options),
                  listed=read.diagnostics) as question:
            yield question


def solve(study: Union[PathLike, Mapping[str, Any]], *,
          set: Optional[Mapping[str, Value]] = None, seed: Optional[int] = None,  # noqa: A002
          files: Optional[Mapping[str, Union[str, Mapping[str, Any]]]] = None,
          workers: Optional[int] = None, progress: Progress = None) -> Result:
    """Answer a study, and give its result as result.json has it.

    study     path of a study, or what one holds; then the files that it names are found from
              the present folder, or are among `files`
    set       parameters of its model that get other values: numbers, or expressions of the
              file's values ("1.1*k")
    seed      what the search draws its starts from, instead of what the study says
    files     files by the names that others call them by: what they hold, or their texts
    workers   how many search; the result does not depend on it. None: one for each processor
    progress  a function of one line of text; None: a notebook or a terminal is told; False

    Raises Error where there is no answer; not to meet the goals is an answer (its "status").
    An interrupt, or an exception of `progress`, ends the search.
    """
    seed = None if seed is None else operator.index(seed)
    if seed is not None and not 0 <= seed <= MOST_SEED:
        raise ValueError(f"seed must be from 0 to {MOST_SEED}")
    path, given = named(study, "study.json", files)
    count = len(os.sched_getaffinity(0)) if workers is None else workers
    sets = sets_of(set)
    search = _Search(lambda: _study(path, given, sets, seed), count, teller(progress))
    return json.loads(search.run())


def _array(rows: list[Any]) -> Any:
    """An array where NumPy can be imported, else the list."""
    try:
        import numpy
    except ImportError:
        return rows
    return numpy.array(rows, dtype=float)


def _matrix(rows: list[list[float]], columns: int) -> Any:
    """The same of rows, of which there may be none."""
    made_of = _array(rows)
    return made_of if isinstance(made_of, list) else made_of.reshape(len(rows), columns)


def _doubts(listed: Sequence[Diagnostic], configuration: str) -> list[Diagnostic]:
    """Those that are not about other configurations."""
    def is_meant(pointer: Optional[str]) -> bool:
        parts = (pointer or "").split("/")
        return parts[1:2] != ["configurations"] or parts[2:3] == [configuration]

    return [item for item in listed if item.severity == "warning" and is_meant(item.pointer)]


def _parameters(model: c_void_p, wanted: Optional[Sequence[str]]) -> list[bytes]:
    """Names; of all parameters those that do not follow others."""
    if wanted is not None:
        return [encoded(name) for name in wanted]
    return [lib.mt_model_parameter_name(model, i)
            for i in range(lib.mt_model_parameter_count(model))
            if not lib.mt_model_parameter_follows(model, i)]


def _units(model: c_void_p, names: list[bytes]) -> list[Optional[str]]:
    units = {lib.mt_model_parameter_name(model, i): lib.mt_model_parameter_unit(model, i)
             for i in range(lib.mt_model_parameter_count(model))}
    return [text_of(units.get(name)) for name in names]


def _shapes(mechanism: c_void_p, modes_listed: int, channels: int) -> list[list[float]]:
    rows, err = [], ErrStruct()
    row = (c_double * channels)()
    for mode in range(1, modes_listed + 1):
        check(lib.mt_mechanism_shape(mechanism, mode, row, byref(err)), err)
        rows.append(list(row))
    return rows


def _slopes(mechanism: c_void_p, modes_listed: int, inputs: int) -> list[list[float]]:
    if modes_listed == 0 or inputs == 0:
        return [[] for _ in range(modes_listed)]
    err = ErrStruct()
    by_column = (c_double * (modes_listed * inputs))()
    check(lib.mt_mechanism_sensitivities(mechanism, modes_listed, by_column, byref(err)), err)
    return [list(by_column[mode::modes_listed]) for mode in range(modes_listed)]


def _describe(mechanism: c_void_p, names: list[bytes]) -> dict[str, Any]:
    def of_modes(function: Callable[[c_void_p, int], Any]) -> list[Any]:
        return [function(mechanism, mode) for mode in range(1, listed + 1)]

    count = lib.mt_mechanism_vibration_modes(mechanism)
    # beside an unstable or undecided mode no mode has an index
    listed = count if lib.mt_mechanism_multiplicity(mechanism, 1) > 0 else 0
    channels = lib.mt_mechanism_channels(mechanism)
    return {
        "hz": _array(of_modes(lib.mt_mechanism_hz)),
        "error_hz": _array(of_modes(lib.mt_mechanism_error_hz)),
        "multiplicity": of_modes(lib.mt_mechanism_multiplicity),
        "rigid_body_modes": lib.mt_mechanism_rigid_body_modes(mechanism),
        "unstable_modes": lib.mt_mechanism_unstable_modes(mechanism),
        "undecided_modes": lib.mt_mechanism_undecided_modes(mechanism),
        "channels": [text_of(lib.mt_mechanism_channel(mechanism, i)) for i in range(channels)],
        "shapes": _matrix(_shapes(mechanism, listed, channels), channels),
        "parameters": [name.decode() for name in names],
        "values": _array([lib.mt_mechanism_value(mechanism, name) for name in names]),
        "hz_per_unit": _matrix(_slopes(mechanism, listed, len(names)), len(names)),
    }


def modes(model: Union[PathLike, Mapping[str, Any]], configuration: Optional[str] = None,
          set: Optional[Mapping[str, Value]] = None, *,  # noqa: A002
          parameters: Optional[Sequence[str]] = None) -> dict[str, Any]:
    """The natural modes of one configuration of a model, with all that is known of them.

    model          path of a model, or what one holds
    configuration  its name; None: the model's only one
    set            parameters that get other values, as in solve
    parameters     what to take derivatives by; None: all that do not follow others

    A dict, arrays being NumPy's where it can be imported and lists elsewhere: "configuration";
    "hz", "error_hz" (a bound of what rounding may have made of it) and "multiplicity" of each
    vibration mode, by ascending frequency; "rigid_body_modes", "unstable_modes" and
    "undecided_modes", how many there are (beside one of the last two no vibration mode has an
    index, and none is listed); "shapes", modes x channels, mass-normalised, and the names of
    the "channels", the directions of all sensors; "parameters" with their "units" and "values",
    and "hz_per_unit", modes x parameters, the exact derivatives (nan where there is none).

    Raises Error, and warns (modetune.Doubt) of what is hardly meant.
    """
    path, given = named(model, "model.json", None)
    with Files(given, sets_of(set), None) as read, one_thread:
        with made("mt_model_read", "mt_model_delete", path, byref(read.options),
                  listed=read.diagnostics) as loaded:
            asked = None if configuration is None else encoded(configuration)
            which = asked or lib.mt_model_configuration_name(loaded, 0)
            for doubt in _doubts(read.diagnostics.all(), which.decode()):
                warnings.warn(str(doubt), Doubt, stacklevel=2)
            names = _parameters(loaded, parameters)
            with made("mt_mechanism_new", "mt_mechanism_delete", loaded, asked, len(names),
                      (c_char_p * len(names))(*names)) as mechanism:
                return {"configuration": which.decode(), "units": _units(loaded, names),
                        **_describe(mechanism, names)}


def _solved_model(answer: c_void_p, path: bytes) -> ContextManager[c_void_p]:
    """The model of a result at the path; none where it is not found as it was solved."""
    return made("mt_result_model", "mt_model_delete", answer, path, None)


@contextmanager
def _model(model: Union[PathLike, Mapping[str, Any]]) -> Iterator[c_void_p]:
    path, given = named(model, "model.json", None)
    with Files(given, [], None) as read:
        with made("mt_model_read", "mt_model_delete", path, byref(read.options),
                  listed=read.diagnostics) as loaded:
            yield loaded


def report(result: Union[PathLike, Mapping[str, Any]],
           model: Union[PathLike, Mapping[str, Any], None] = None) -> Report:
    """The report of a result (as solve gives it, or the path of a result.json) as a page.

    model  path of the model that was solved, or what it holds: the page then shows the
           mechanism and its modes. None: of a result by its path the file that it names, where
           that lies near it and has not changed

    A notebook shows it; `.html` is its text, `.save(path)` writes it. Raises Error where that
    is no result, or no model.
    """
    path, given = named(result, "result.json", None)
    with Files(given, [], None) as read, one_thread:
        with made("mt_result_read", "mt_result_delete", path, byref(read.options),
                  listed=read.diagnostics) as answer:
            if model is None and isinstance(result, Mapping):
                return Report(text_made("mt_result_page", answer, None))
            with _solved_model(answer, path) if model is None else _model(model) as solved:
                return Report(text_made("mt_result_page", answer, solved))
