# SPDX-License-Identifier: Apache-2.0
"""Values that callers give, checked and written as the core takes them."""
import json as _json
import numbers as _numbers

import numpy as _numpy

from ._core import Error, encoded, integer, integers

__all__ = ["encoded", "error", "flat_list", "integer", "integers", "json_of", "number_text"]


def error(parameter, message):
    made = Error(message)
    made.parameter = parameter
    return made


def number_text(key, value):
    """A number that is no int and no float of Python, or an int that is too long, as a recipe has it."""
    if isinstance(value, (_numpy.bool_, _numbers.Integral)):
        return str(int(value))
    if isinstance(value, _numpy.floating):
        return str(value)  # its own fewest digits
    if isinstance(value, _numbers.Real):
        return repr(float(value))
    raise TypeError(f"{key}={value!r}: a {type(value).__name__} is no value of a key")


def flat_list(values):
    return _numpy.ravel(values).tolist()


def plain_json(value):
    if isinstance(value, (_numpy.ndarray, _numpy.generic)):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} has no place in JSON")


def json_of(key, value):
    try:
        return _json.dumps(value, allow_nan=False, default=plain_json)
    except (TypeError, ValueError) as refused:
        raise error(key, f"{key}: cannot be written as JSON: {refused}") from None
