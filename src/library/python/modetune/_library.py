# SPDX-License-Identifier: GPL-3.0-or-later
"""libmodetune as ctypes sees it: what modetune/*.h declare, and errors as exceptions."""
from __future__ import annotations

import ctypes
import os
import threading
from contextlib import contextmanager
from ctypes import (
    CFUNCTYPE, POINTER, Structure, byref, c_char_p, c_double, c_int, c_size_t, c_void_p, sizeof,
)
from pathlib import Path
from typing import Any, Iterator, NamedTuple, Optional, Union

SONAME = "libmodetune.so.1"  # a later version with this number has all that this one has


class Diagnostic(NamedTuple):
    """What was found in a file, and where; None for what has no place."""

    file: Optional[str]
    line: Optional[int]
    column: Optional[int]
    pointer: Optional[str]
    severity: str
    message: str

    def __str__(self) -> str:
        """As a compiler writes it."""
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part)
        said = f"{self.pointer}: {self.message}" if self.pointer else self.message
        return f"{place}: {self.severity}: {said}" if place else f"{self.severity}: {said}"


class Error(Exception):
    """A question that has no answer: a wrong file or argument, or a failure of the numerics.

    status is the name of the C status ("MT_E_INPUT"), diagnostics all that was found in files.
    """

    def __init__(self, message: str, status: str, diagnostics: tuple[Diagnostic, ...]) -> None:
        super().__init__(message)
        self.status = status
        self.diagnostics = diagnostics

    def __reduce__(self) -> tuple[Any, ...]:  # from a process of a pool to its parent
        return type(self), (self.args[0], self.status, self.diagnostics)


class ErrStruct(Structure):
    _fields_ = [("code", c_int), ("text", ctypes.c_char * 1024)]


class FileText(Structure):
    _fields_ = [("path", c_char_p), ("text", c_char_p)]


class ReadOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("root", c_char_p), ("files", POINTER(FileText)),
        ("n_files", c_int), ("files_only", c_int), ("diagnostics", c_void_p),
        ("sets", POINTER(c_char_p)), ("n_sets", c_int), ("seed", POINTER(c_int)),
    ]


PROGRESS = CFUNCTYPE(None, c_void_p, c_char_p)


class SolveOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("threads", c_int), ("hint", POINTER(c_double)), ("stop", c_void_p),
        ("stop_context", c_void_p), ("progress", PROGRESS), ("progress_context", c_void_p),
        ("cause", c_void_p),
    ]


TEXTS = POINTER(c_char_p)


class ModesOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("configuration", c_char_p), ("sets", TEXTS),
        ("about_m", POINTER(c_double)), ("energy_about", c_char_p), ("energy_axes", c_char_p),
        ("n_sets", c_int), ("count", c_int), ("shapes", c_int), ("damped", c_int),
        ("effective_mass", c_int), ("energy", c_int),
    ]


class MacOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("configuration_a", c_char_p), ("configuration_b", c_char_p),
        ("sets", TEXTS), ("n_sets", c_int), ("count", c_int),
    ]


class SensitivityOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("configuration", c_char_p), ("sets", TEXTS), ("n_sets", c_int),
        ("count", c_int), ("parameters", c_char_p),
    ]


class ResponseOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("configuration", c_char_p), ("sets", TEXTS), ("n_sets", c_int),
        ("n_inputs", c_int), ("inputs", TEXTS), ("outputs", TEXTS), ("n_outputs", c_int),
        ("points", c_int), ("from", c_char_p), ("to", c_char_p), ("log", c_int),
        ("keep", c_int), ("direct", c_int), ("poles", c_int), ("state_space", c_int),
        ("parameters", c_char_p), ("vibration", c_void_p),
    ]


class SweepOptions(Structure):
    _fields_ = [
        ("size", c_size_t), ("configuration", c_char_p), ("sets", TEXTS), ("drives", TEXTS),
        ("holds", TEXTS), ("n_sets", c_int), ("n_drives", c_int), ("n_holds", c_int),
        ("grid", c_int), ("frequencies", c_int), ("count", c_int),
    ]


ERR = POINTER(ErrStruct)
OUT = POINTER(c_void_p)
NEW = (c_void_p,)
READ = (c_int, c_char_p, POINTER(ReadOptions), OUT, ERR)
NUMBER_OF_MODE = (c_double, c_void_p, c_int)
TEXT_OF_ITEM = (c_char_p, c_void_p, c_int)
COUNT = (c_int, c_void_p)
DELETE = (None, c_void_p)

# name: (result, arguments...)
FUNCTIONS: dict[str, tuple[Any, ...]] = {
    "mt_version": (c_char_p,),
    "mt_status_name": (c_char_p, c_int),
    "mt_diagnostics_new": (c_int, OUT, ERR),
    "mt_diagnostics_delete": DELETE,
    "mt_diagnostics_count": COUNT,
    "mt_diagnostics_severity": (c_int, c_void_p, c_int),
    "mt_diagnostics_file": TEXT_OF_ITEM,
    "mt_diagnostics_line": (c_int, c_void_p, c_int),
    "mt_diagnostics_column": (c_int, c_void_p, c_int),
    "mt_diagnostics_pointer": TEXT_OF_ITEM,
    "mt_diagnostics_message": TEXT_OF_ITEM,
    "mt_diagnostics_text": (c_char_p, c_void_p),
    "mt_model_read": READ,
    "mt_model_delete": DELETE,
    "mt_model_parameter_count": COUNT,
    "mt_model_parameter_name": TEXT_OF_ITEM,
    "mt_model_parameter_unit": TEXT_OF_ITEM,
    "mt_model_parameter_follows": (c_int, c_void_p, c_int),
    "mt_model_configuration_name": TEXT_OF_ITEM,
    "mt_model_modes": (c_int, c_void_p, POINTER(ModesOptions), OUT, ERR),
    "mt_model_mac": (c_int, c_void_p, c_void_p, POINTER(MacOptions), OUT, ERR),
    "mt_model_sensitivity": (c_int, c_void_p, POINTER(SensitivityOptions), OUT, ERR),
    "mt_model_response": (c_int, c_void_p, POINTER(ResponseOptions), OUT, ERR),
    "mt_model_sweep": (c_int, c_void_p, POINTER(SweepOptions), OUT, ERR),
    "mt_vibration_read": READ,
    "mt_vibration_delete": DELETE,
    "mt_mechanism_new": (c_int, c_void_p, c_char_p, c_int, POINTER(c_char_p), OUT, ERR),
    "mt_mechanism_delete": DELETE,
    "mt_mechanism_value": (c_double, c_void_p, c_char_p),
    "mt_mechanism_vibration_modes": COUNT,
    "mt_mechanism_rigid_body_modes": COUNT,
    "mt_mechanism_unstable_modes": COUNT,
    "mt_mechanism_undecided_modes": COUNT,
    "mt_mechanism_hz": NUMBER_OF_MODE,
    "mt_mechanism_error_hz": NUMBER_OF_MODE,
    "mt_mechanism_multiplicity": (c_int, c_void_p, c_int),
    "mt_mechanism_channels": COUNT,
    "mt_mechanism_channel": TEXT_OF_ITEM,
    "mt_mechanism_shape": (c_int, c_void_p, c_int, POINTER(c_double), ERR),
    "mt_mechanism_sensitivities": (c_int, c_void_p, c_int, POINTER(c_double), ERR),
    "mt_study_read": READ,
    "mt_study_delete": DELETE,
    "mt_study_solve": (c_int, c_void_p, POINTER(SolveOptions), OUT, ERR),
    "mt_result_delete": DELETE,
    "mt_result_read": READ,
    "mt_result_model": (c_int, c_void_p, c_char_p, POINTER(ReadOptions), OUT, ERR),
    "mt_result_json": (c_int, c_void_p, OUT, ERR),
    "mt_result_page": (c_int, c_void_p, c_void_p, OUT, ERR),
    "mt_string_delete": DELETE,
}
SEVERITIES = ("error", "warning", "note")


def _load() -> ctypes.CDLL:
    """What MODETUNE_LIBRARY names, else the library beside this file, else the system's."""
    beside = Path(__file__).with_name("libmodetune.so")
    path = os.environ.get("MODETUNE_LIBRARY") or (str(beside) if beside.exists() else SONAME)
    # read once, when OpenBLAS is loaded, and what its threads reserve then stays reserved
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    loaded = ctypes.CDLL(path)
    for name, (result, *arguments) in FUNCTIONS.items():
        function = getattr(loaded, name)
        function.restype = result
        function.argtypes = arguments
    return loaded


lib = _load()
version: str = lib.mt_version().decode()
if not SONAME.endswith(".so." + version.partition(".")[0]):
    raise ImportError(f"libmodetune {version} is not what this package is for ({SONAME})")


class _OneThread:
    """OpenBLAS on one thread as long as anybody is inside: the bits of results depend on it.

    The library may be shared with NumPy, whose user may have wished for more.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._inside = 0
        self._before = 1
        self._get = getattr(lib, "openblas_get_num_threads", None)
        self._set = getattr(lib, "openblas_set_num_threads", None)

    def __enter__(self) -> None:
        with self._lock:
            self._inside += 1
            if self._inside == 1 and self._get is not None and self._set is not None:
                self._before = self._get()
                self._set(1)

    def __exit__(self, *raised: object) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0 and self._set is not None:
                self._set(self._before)


one_thread = _OneThread()


def encoded(text: Union[str, bytes]) -> bytes:
    """A text as C takes it, where a NUL would end it."""
    given = text.encode() if isinstance(text, str) else text
    if b"\0" in given:
        raise ValueError("a text has a NUL character")
    return given


def text_of(said: Optional[bytes]) -> Optional[str]:
    return None if said is None else said.decode("utf-8", "replace")


def _diagnostic(listed: c_void_p, i: int) -> Diagnostic:
    severity = lib.mt_diagnostics_severity(listed, i)
    return Diagnostic(
        text_of(lib.mt_diagnostics_file(listed, i)),
        lib.mt_diagnostics_line(listed, i) or None,
        lib.mt_diagnostics_column(listed, i) or None,
        text_of(lib.mt_diagnostics_pointer(listed, i)),
        SEVERITIES[severity] if severity < len(SEVERITIES) else "error",
        text_of(lib.mt_diagnostics_message(listed, i)) or "",
    )


class Diagnostics:
    """The C list that one call fills."""

    def __init__(self) -> None:
        self.handle = c_void_p()
        err = ErrStruct()
        check(lib.mt_diagnostics_new(byref(self.handle), byref(err)), err)

    def delete(self) -> None:
        lib.mt_diagnostics_delete(self.handle)
        self.handle = c_void_p()

    def all(self) -> tuple[Diagnostic, ...]:
        count = lib.mt_diagnostics_count(self.handle)
        return tuple(_diagnostic(self.handle, i) for i in range(count))

    def text(self) -> str:
        return text_of(lib.mt_diagnostics_text(self.handle)) or ""


def check(status: int, err: ErrStruct, listed: Optional[Diagnostics] = None) -> None:
    """Raise Error unless the call succeeded; of the files' faults all are told."""
    if status == 0:
        return
    found = () if listed is None else listed.all()
    message = text_of(err.text) or "failed"
    if listed is not None and any(item.severity == "error" for item in found):
        message = listed.text().rstrip("\n")
    raise Error(message, text_of(lib.mt_status_name(status)) or "", found)


@contextmanager
def made(function: str, delete: str, *arguments: Any,
         listed: Optional[Diagnostics] = None) -> Iterator[c_void_p]:
    """What a function of C makes from the arguments, deleted in the end."""
    handle, err = c_void_p(), ErrStruct()
    try:  # before the call: an interrupt may come right behind it
        check(getattr(lib, function)(*arguments, byref(handle), byref(err)), err, listed)
        yield handle
    finally:
        getattr(lib, delete)(handle)


def text_made(function: str, *owners: Any) -> str:
    """The text that a function of C makes of its owners."""
    with made(function, "mt_string_delete", *owners) as text:
        return ctypes.cast(text, c_char_p).value.decode()  # type: ignore[union-attr]


class Files:
    """Options of reading, with all that they point to."""

    def __init__(self, given: dict[str, str], sets: list[str], seed: Optional[int]) -> None:
        self.diagnostics = Diagnostics()
        texts = [FileText(encoded(os.fsencode(path)), encoded(text))
                 for path, text in given.items()]
        self._files = (FileText * len(texts))(*texts)
        self._sets = (c_char_p * len(sets))(*[encoded(text) for text in sets])
        self._seed = None if seed is None else c_int(seed)
        self.options = ReadOptions(
            size=sizeof(ReadOptions), files=self._files, n_files=len(texts),
            diagnostics=self.diagnostics.handle, sets=self._sets, n_sets=len(sets),
            seed=None if self._seed is None else ctypes.pointer(self._seed))

    def __enter__(self) -> "Files":
        return self

    def __exit__(self, *raised: object) -> None:
        self.diagnostics.delete()
