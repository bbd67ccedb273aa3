# SPDX-License-Identifier: Apache-2.0
"""Values that callers give, checked and written as the core takes them."""
import json as _json

import numpy as _numpy

from ._core import Error


def error(parameter, message):
    made = Error(message)
    made.parameter = parameter
    return made


def encoded(text, name="a key"):
    """Bytes, since names of files may be any."""
    if "\0" in text:
        raise error(name, f"{name}: must have no NUL character")
    return text.encode("utf-8", "surrogateescape")


def plain_json(value):
    if isinstance(value, (_numpy.ndarray, _numpy.generic)):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} has no place in JSON")


def json_of(key, value):
    try:
        return _json.dumps(value, allow_nan=False, default=plain_json)
    except (TypeError, ValueError) as refused:
        raise error(key, f"{key}: cannot be written as JSON: {refused}") from None


def integer(name, value):
    try:
        number = value.__index__()
    except (AttributeError, TypeError):
        raise TypeError(f"{name}={value!r}: must be an integer") from None
    if not -2**31 <= number < 2**31:
        raise ValueError(f"{name}={number}: must be an integer of 32 bits")
    return number


def integers(name, values, count):
    try:
        values = tuple(values)
    except TypeError:
        values = ()
    if len(values) != count:
        raise ValueError(f"{name}: must be {count} integers")
    return tuple(integer(name, value) for value in values)
