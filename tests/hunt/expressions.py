# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions of parameters, read anew in Python: numbers may be arrays, one entry per design."""
import math
import re
from functools import lru_cache

import numpy as np

FUNCTIONS = {"sqrt": np.sqrt, "exp": np.exp, "ln": np.log, "sin": np.sin, "cos": np.cos, "tan": np.tan, "abs": np.abs,
             "min": np.minimum, "max": np.maximum, "pi": math.pi, "deg": math.pi / 180.0, "rpm": 1.0 / 60.0,
             "choose": np.where, "__builtins__": {}}


@lru_cache(maxsize=4096)
def _code(text):
    # "if" is a word of Python's; a condition is a number here, whatever its branches are worth
    return compile(re.sub(r"\bif\(", "choose(", text.replace("^", "**")), text, "eval")


def evaluate(value, values):
    """A number of a file, or an expression of the parameters in `values`."""
    return eval(_code(value), FUNCTIONS, values) if isinstance(value, str) else value


def names(value):
    """What an expression depends on."""
    return set(re.findall(r"[A-Za-z_]\w*", value)) - set(FUNCTIONS) - {"if", "and", "or", "not"} if isinstance(value, str) else set()


def parameters(model, overrides):
    """All parameters of a model, those in `overrides` replaced; each may depend on those before it."""
    values = {}
    for name, given in model.get("parameters", {}).items():
        given = given["value"] if isinstance(given, dict) else given
        values[name] = overrides[name] if name in overrides else evaluate(given, values)
    return values
