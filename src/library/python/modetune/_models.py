# SPDX-License-Identifier: GPL-3.0-or-later
"""A model that is read once and asked often, and how models and values come from Python."""
from __future__ import annotations

import json
import os
import weakref
from contextlib import ExitStack
from ctypes import Structure, byref, c_char_p, c_double, c_void_p, sizeof
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

from ._library import (
    ErrStruct, Files, MacOptions, ModesOptions, ResponseOptions, SensitivityOptions,
    SweepOptions, check, encoded, lib, made, one_thread, text_made,
)

if TYPE_CHECKING:
    from .types import (
        CommandMac, CommandModes, CommandResponse, CommandSensitivity, CommandSweep,
    )

PathLike = Union[str, "os.PathLike[str]"]
Value = Union[float, int, str]
ALL = 2**31 - 1  # modes


def _plain(value: Any) -> Any:
    """Scalars and arrays of NumPy, which json does not know."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in a model, study or result")


def _text(content: Union[str, Mapping[str, Any]]) -> str:
    """The text of a file."""
    if isinstance(content, str):
        return content
    return json.dumps(content, indent=2, allow_nan=False, default=_plain)


def sets_of(wanted: Optional[Mapping[str, Value]]) -> list[str]:
    """NAME=VALUE; numbers to the last bit."""
    if wanted is None:
        return []
    return [f"{name}={value if isinstance(value, str) else repr(float(value))}"
            for name, value in wanted.items()]


def named(thing: Union[PathLike, Mapping[str, Any]], name: str,
           files: Optional[Mapping[str, Union[str, Mapping[str, Any]]]]
           ) -> tuple[bytes, dict[str, str]]:
    """The path to read, and the files that are given by their texts."""
    given = {path: _text(content) for path, content in (files or {}).items()}
    if isinstance(thing, Mapping):
        return encoded(name), {name: _text(thing), **given}
    return encoded(os.fsencode(thing)), given


def _texts(wanted: Sequence[str]) -> Any:
    return (c_char_p * len(wanted))(*[encoded(text) for text in wanted])


def _listed(wanted: Union[str, Sequence[str], None]) -> list[str]:
    """One text, or several."""
    if wanted is None:
        return []
    return [wanted] if isinstance(wanted, str) else list(wanted)


def _optional(text: Optional[str]) -> Optional[bytes]:
    return None if text is None else encoded(text)


def _number(value: Optional[Value]) -> Optional[bytes]:
    """To the last bit; a text is an expression."""
    if value is None or isinstance(value, str):
        return _optional(value)
    return encoded(repr(float(value)))


def _count(wanted: Union[int, str, None]) -> int:
    return 0 if wanted is None else ALL if wanted == "all" else int(wanted)


def _common(options: Structure, wanted: Optional[Mapping[str, Value]]) -> None:
    sets = sets_of(wanted)
    options.size = sizeof(options)
    options.sets = _texts(sets)
    options.n_sets = len(sets)


class Model:
    """A model, read once: what the commands of the same names tell of it.

    Each answer is what `modetune NAME --format json` prints: a dict of the configuration that
    is named, or a list of all of them, in which one without an answer has its reason as
    "error". Members and units are those of modetune.types and `modetune schema NAME`.

        model = modetune.Model("problems/stick.json")
        for mode in model.modes("installed")["modes"]:
            print(mode["index"], mode["frequency_hz"])

    configuration  a name; None: all
    set            parameters that get other values: numbers, or expressions ("1.1*k")
    count          how many vibration modes, the lowest; "all"; None: as the command does

    Raises Error where there is no answer. Threads may share a model.
    """

    def __init__(self, model: Union[PathLike, Mapping[str, Any]], *,
                 files: Optional[Mapping[str, Union[str, Mapping[str, Any]]]] = None) -> None:
        """A path, or what such a file holds; `files` as in solve."""
        path, given = named(model, "model.json", files)
        self._handle, err = c_void_p(), ErrStruct()
        self._delete = weakref.finalize(self, lib.mt_model_delete, self._handle)
        with Files(given, [], None) as read, one_thread:
            check(lib.mt_model_read(path, byref(read.options), byref(self._handle), byref(err)),
                  err, read.diagnostics)

    def _ask(self, name: str, options: Structure, *others: c_void_p) -> Any:
        with one_thread:
            text = text_made(f"mt_model_{name}", self._handle, *others, byref(options))
        return json.loads(text)

    def modes(self, configuration: Optional[str] = None, *,
              set: Optional[Mapping[str, Value]] = None,  # noqa: A002
              count: Union[int, str, None] = None, shapes: bool = False,
              damped: bool = False, effective_mass: bool = False,
              about_m: Sequence[float] = (0.0, 0.0, 0.0), energy: bool = False,
              energy_about: Optional[str] = None,
              energy_axes: Optional[str] = None) -> CommandModes:
        """Natural modes, as `modetune modes`; with `shapes`, modes with damping, effective
        masses, those of rotations about the point about_m, and who has the `energy` of each
        mode, about a point of the model and along these axes ("principal").
        """
        about = (c_double * 3)(*about_m)
        options = ModesOptions(configuration=_optional(configuration), count=_count(count),
                               shapes=shapes, damped=damped, effective_mass=effective_mass,
                               about_m=about, energy=energy,
                               energy_about=_optional(energy_about),
                               energy_axes=_optional(energy_axes))
        _common(options, set)
        return self._ask("modes", options)

    def mac(self, other: Optional[Model] = None, configuration: Optional[str] = None,
            other_configuration: Optional[str] = None, *,
            set: Optional[Mapping[str, Value]] = None,  # noqa: A002
            count: Optional[int] = None) -> CommandMac:
        """Modes of this model (A) paired with those of the other one (B; None: this one), as
        `modetune mac`. A configuration may be None where the model has only one.
        """
        options = MacOptions(configuration_a=_optional(configuration),
                             configuration_b=_optional(other_configuration),
                             count=_count(count))
        _common(options, set)
        return self._ask("mac", options, (self if other is None else other)._handle)

    def sensitivity(self, configuration: Optional[str] = None, *,
                    set: Optional[Mapping[str, Value]] = None,  # noqa: A002
                    count: Union[int, str, None] = None,
                    parameters: Optional[Sequence[str]] = None) -> CommandSensitivity:
        """Exact derivatives of frequencies by these parameters (None: all that do not follow
        others), as `modetune sensitivity`.
        """
        options = SensitivityOptions(
            configuration=_optional(configuration), count=_count(count),
            parameters=_optional(None if parameters is None else ",".join(_listed(parameters))))
        _common(options, set)
        return self._ask("sensitivity", options)

    def response(self, inputs: Union[str, Sequence[str], None] = None,
                 outputs: Union[str, Sequence[str], None] = None,
                 configuration: Optional[str] = None, *,
                 set: Optional[Mapping[str, Value]] = None,  # noqa: A002
                 start_hz: Optional[Value] = None, end_hz: Optional[Value] = None,
                 points: Optional[int] = None, log: bool = False, keep: Optional[int] = None,
                 direct: bool = False, poles: bool = False, state_space: bool = False,
                 parameters: Optional[Sequence[str]] = None,
                 vibration: Union[PathLike, Mapping[str, Any], None] = None,
                 ) -> CommandResponse:
        """Frequency responses of `outputs` (None: all sensors) to `inputs` ("grip.x",
        "base.x"), as `modetune response`, from start_hz to end_hz.

        keep        the lowest modes that are kept (--modes); others follow statically
        parameters  whose influence on the extremes is told (--sensitivity)
        vibration   a profile, its path or what it holds; without inputs along its axis
        """
        shaking, seen = _listed(inputs), _listed(outputs)
        options = ResponseOptions(
            configuration=_optional(configuration), inputs=_texts(shaking),
            n_inputs=len(shaking), outputs=_texts(seen), n_outputs=len(seen),
            points=points or 0, log=log, keep=keep or 0, direct=direct, poles=poles,
            state_space=state_space,
            parameters=_optional(None if parameters is None else ",".join(_listed(parameters))),
            **{"from": _number(start_hz), "to": _number(end_hz)})
        _common(options, set)
        with ExitStack() as stack:
            if vibration is not None:
                path, given = named(vibration, "profile.json", None)
                read = stack.enter_context(Files(given, [], None))
                options.vibration = stack.enter_context(
                    made("mt_vibration_read", "mt_vibration_delete", path, byref(read.options),
                         listed=read.diagnostics))
            return self._ask("response", options)

    def sweep(self, drive: Union[str, Sequence[str]], configuration: Optional[str] = None, *,
              set: Optional[Mapping[str, Value]] = None,  # noqa: A002
              hold: Union[str, Sequence[str], None] = None, grid: bool = False,
              frequencies: bool = False, count: Union[int, str, None] = None) -> CommandSweep:
        """Positions along the range of a joint ("pivot=0:30*deg:4"), or of several together,
        with `grid` each with each, as `modetune sweep`; `hold` names the spring that is trimmed
        instead of a lock, of one of several joints "pivot=servo".
        """
        drives, holds = _listed(drive), _listed(hold)
        options = SweepOptions(configuration=_optional(configuration), drives=_texts(drives),
                               n_drives=len(drives), holds=_texts(holds),
                               n_holds=len(holds), grid=grid,
                               frequencies=frequencies, count=_count(count))
        _common(options, set)
        return self._ask("sweep", options)
