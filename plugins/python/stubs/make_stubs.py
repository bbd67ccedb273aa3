# SPDX-License-Identifier: Apache-2.0
"""make_stubs.py FILE: writes the types of the module anamorph, those of its operations by their tables, to FILE."""
import sys

import anamorph

TYPES = {"number": "float", "whole": "int", "toggle": "bool", "choice": "str", "extent": "int | tuple[int, int] | str",
         "numbers": "float | Sequence[float]", "image": "str | PathLike[str] | ArrayLike | dict[str, Any]",
         "file": "str | PathLike[str] | dict[str, Any] | list[Any]", "text": "str | float | Sequence[float]"}

HEAD = '''# Made by make_stubs.py.
from __future__ import annotations

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, Union

import numpy
from numpy.typing import ArrayLike, NDArray

from . import figures as figures
from . import surfaces as surfaces

__version__: str
operations: tuple[str, ...]

class Error(ValueError):
    parameter: str

class Image:
    pixels: NDArray[Any]
    channels: tuple[str, ...]
    unassociated: bool
    corner: tuple[int, int]
    display: tuple[int, int, int, int]
    metadata: dict[str, int | float | str]
    def __init__(self, pixels: ArrayLike, *, channels: Sequence[str] = ..., unassociated: bool = ..., corner: tuple[int, int] = ...,
                 display: tuple[int, int, int, int] | None = ..., metadata: dict[str, int | float | str] | None = ...) -> None: ...

Source = Union[ArrayLike, str, PathLike[str], Image, "Picture"]

class Picture:
    operation: str
    def __init__(self, operation: str, *sources: Source, subimage: int = ..., threads: int = ..., **keys: Any) -> None: ...
    @property
    def window(self) -> tuple[int, int, int, int]: ...
    @property
    def display(self) -> tuple[int, int, int, int]: ...
    @property
    def channels(self) -> tuple[str, ...]: ...
    @property
    def dtype(self) -> numpy.dtype[Any]: ...
    @property
    def subimages(self) -> int: ...
    @property
    def said(self) -> dict[str, int | float | str]: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    def reached(self) -> dict[str, int | float | str]: ...
    def draw(self, roi: tuple[int, int, int, int] | None = ..., *, out: Any = ...,
             progress: Callable[[int], object] | None = ...) -> NDArray[Any]: ...
    def source_points(self, x: ArrayLike, y: ArrayLike) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]: ...
    def jacobians(self, x: ArrayLike, y: ArrayLike) -> NDArray[numpy.float64]: ...
    def __array__(self, dtype: Any = ..., copy: bool | None = ...) -> NDArray[Any]: ...

Points = tuple[NDArray[numpy.float64], NDArray[numpy.float64]]

class Map:
    size: tuple[int, int]
    source_size: tuple[int, int]
    window: tuple[int, int, int, int]
    source_window: tuple[int, int, int, int]
    def __init__(self, operation: str, source: tuple[int, int] | Source, **keys: Any) -> None: ...
    @classmethod
    def from_stmap(cls, stmap: ArrayLike, source_size: tuple[int, int]) -> Map: ...
    @classmethod
    def from_functions(cls, points: Callable[..., Points], jacobians: Callable[..., NDArray[numpy.float64]], size: tuple[int, int],
                       source_size: tuple[int, int], *, window: tuple[int, int, int, int] | None = ...,
                       source_window: tuple[int, int, int, int] | None = ...) -> Map: ...
    def points(self, x: ArrayLike, y: ArrayLike) -> Points: ...
    def jacobians(self, x: ArrayLike, y: ArrayLike) -> NDArray[numpy.float64]: ...
    def centers(self) -> Points: ...
    def bounds(self) -> NDArray[Any]: ...
    def coverage(self) -> NDArray[Any]: ...
    def explain(self) -> dict[str, int | float | str]: ...
    def compose(self, inner: Map) -> Map: ...
    def inverse(self) -> Map: ...
    def to_stmap(self) -> NDArray[numpy.float32]: ...
    def draw(self, source: ArrayLike, **more: Any) -> NDArray[Any]: ...

def apply(operation: str, *sources: Source, out: Any = ..., roi: tuple[int, int, int, int] | None = ..., subimage: int = ...,
          threads: int = ..., progress: Callable[[int], object] | None = ..., **keys: Any) -> NDArray[Any]: ...
'''
CALL = {"out": "Any", "roi": "tuple[int, int, int, int] | None", "subimage": "int", "threads": "int",
        "progress": "Callable[[int], object] | None"}


def stub(operation):
    own = {anamorph._parameter_name(key["name"]): TYPES[key["type"]] for key in operation["keys"]}
    parameters = []
    for name, parameter in getattr(anamorph, operation["name"]).__signature__.parameters.items():
        if parameter.kind is parameter.VAR_POSITIONAL:
            parameters.append(f"*{name}: Source")
        elif parameter.kind is parameter.VAR_KEYWORD:
            parameters.append(f"**{name}: float | str")
        elif name in own:
            parameters.append(f"{name}: {own[name]} | None = ...")
        else:
            parameters.append(f"{name}: {CALL[name]} = ...")
    return f"def {operation['name']}({', '.join(parameters)}) -> NDArray[Any]: ...\n"


with open(sys.argv[1], "w", encoding="utf-8") as file:
    file.write(HEAD)
    for operation in anamorph._OPERATIONS.values():
        file.write("\n" + stub(operation))
