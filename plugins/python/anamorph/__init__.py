# SPDX-License-Identifier: Apache-2.0
"""Image warping with a proven tolerance, on numpy arrays.

Each operation is a function of its name: pano, lens, map, warp, morph and the others. Sources are arrays of shape (height, width) or
(height, width, channels), whatever shows itself as one (the buffer protocol, DLPack in the processor's memory, PIL's images),
OpenImageIO's ImageBuf, names of files, Images (arrays with names of channels, windows and metadata), or Pictures. Keywords are the
keys of recipes; where a key is a word of Python, as `from`, it has an underscore behind it. help(anamorph.pano) lists them.

    view = anamorph.pano(panorama, to="rectilinear", fov=90, yaw=30, size=(1024, 768))

A Picture is opened once and drawn as often as one likes, any part of it:

    picture = anamorph.Picture("pano", panorama, fov=90, size=(1024, 768))
    picture.reached()["anamorph:max_error"]   # in pixels of the source
    tile = picture.draw(roi=(0, 0, 256, 256))

What cannot be taken is an Error, a ValueError whose `parameter` is the key that is to blame.
"""
import inspect as _inspect
import keyword as _keyword
import numbers as _numbers
import os as _os
import sys as _sys
from pkgutil import extend_path as _extend_path

import numpy as _numpy

from . import _core
from ._checks import encoded as _encoded
from ._checks import error as _error
from ._checks import integer as _integer
from ._checks import integers as _integers
from ._checks import json_of as _json_of
from ._core import Error

# The VTK modules are of a folder of the same name, which may be elsewhere.
__path__ = _extend_path(__path__, __name__)

__version__ = _core.version
_OPERATIONS = {operation["name"]: operation for operation in _core.operations()}
_TABLES = {name: {key["name"]: key for key in operation["keys"]} for name, operation in _OPERATIONS.items()}
_DTYPES = frozenset(map(_numpy.dtype, _core.dtypes))  # of this machine's byte order
_CONVERTED = frozenset(map(_numpy.dtype, ("uint8", "uint16", "float16", "float32")))
operations = tuple(_OPERATIONS)


class Image:
    """An array with what it does not say of itself.

    pixels: an array of shape (height, width) or (height, width, channels).
    channels: names of the channels; by default Y, RGB or RGBA. One that is called A is alpha.
    unassociated: are colours not yet multiplied by alpha? PIL's and OpenCV's are not, OpenEXR's are.
    corner: x and y of the first pixel, where the array is the data window of a larger or smaller picture.
    display: the display window, (x0, y0, x1, y1); by default the array's own.
    metadata: attributes by their names in OpenImageIO, such as {"oiio:ColorSpace": "lin_srgb"}.
    """

    def __init__(self, pixels, *, channels=(), unassociated=False, corner=(0, 0), display=None, metadata=None):
        self.pixels = _pixels(pixels, "pixels")
        self.channels = tuple(channels)
        for channel in self.channels:
            if not isinstance(channel, str):
                raise TypeError(f"channels: {channel!r} must be a str")
        self.unassociated = bool(unassociated)
        self.corner = _integers("corner", corner, 2)
        self.display = (0, 0, 0, 0) if display is None else _integers("display", display, 4)
        if display is not None and (self.display[2] <= self.display[0] or self.display[3] <= self.display[1]):
            raise ValueError(f"display={display}: must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1")
        self.metadata = dict(metadata or {})
        for name, value in self.metadata.items():
            if not isinstance(name, str):
                raise TypeError(f"metadata: the name {name!r} must be a str")
            if not isinstance(value, (int, float, str)):
                raise TypeError(f"metadata[{name!r}] is a {type(value).__name__}: must be an int, a float or a str")


class Picture:
    """The picture of an operation: opened once, drawn as often as one likes, any part of it, by any threads.

    operation: its name, one of anamorph.operations.
    sources: as the functions take them, in the order of their keys. A Picture as the only source is not drawn first where that can be
        avoided: both maps are joined, and its source is sampled once (`said["anamorph:chain"]` tells, concatenate=0 turns it off).
    keys: as recipes have them. Arrays are taken for keys that name images, dicts and lists for keys that name JSON files.
    subimage: of an operation that makes several pictures, from 0 to subimages - 1.
    threads: how many may draw, this one among them; 0 for all that OpenImageIO has.

    Arrays are not copied unless they have to be, and must not change while the picture is used.
    """

    def __init__(self, operation, *sources, subimage=0, threads=0, **keys):
        if operation not in _OPERATIONS:
            raise _error("operation", f"operation={operation}: must be one of {', '.join(operations)}")
        keys = {_key_of(name): value for name, value in keys.items() if value is not None}
        _check_sources_are_no_keys(_OPERATIONS[operation], keys)
        table = _TABLES[operation]
        texts, images = {}, {}
        values = [(_encoded(name), _encoded(_text_of(table.get(name), name, value, texts, images), name))
                  for name, value in keys.items()]
        opened = [source._core if isinstance(source, Picture) else _source_of(source) for source in sources]
        self._threads = _integer("threads", threads or 0)
        if self._threads < 0:
            raise ValueError(f"threads={threads}: must be at least 0")
        self._core = _core.Picture(operation, values, opened, texts, images, _integer("subimage", subimage or 0), self._threads)
        self._flat = _is_flat(sources[0]) if sources else True
        self.operation = operation

    @property
    def window(self):
        """The data window, (x0, y0, x1, y1): the pixels that draw() draws."""
        return tuple(self._core.window)

    @property
    def display(self):
        """The display window, (x0, y0, x1, y1)."""
        return tuple(self._core.display)

    @property
    def channels(self):
        """The names of the channels."""
        return tuple(self._core.channels)

    @property
    def dtype(self):
        """The type of the pixels."""
        return _numpy.dtype(self._core.dtype)

    @property
    def subimages(self):
        """How many pictures the operation makes."""
        return self._core.subimages

    @property
    def said(self):
        """What the picture says of itself before it is drawn: the tolerance, lenses that were looked up, what was joined."""
        return self._core.said

    @property
    def shape(self):
        """The shape of what draw() returns."""
        return self._shape(self.window)

    def reached(self):
        """What was reached over the whole picture: anamorph:max_error, a proven bound in source pixels, and what else the operation
        tells."""
        return self._core.reached(self._threads)

    def draw(self, roi=None, *, out=None, progress=None):
        """Draws the picture, or the pixels from (x0, y0) to before (x1, y1), roi=(x0, y0, x1, y1), counted as the windows are: black
        beyond the data window. `out`: an array of the same shape, or an ImageBuf; colours become the type that it has, as
        OpenImageIO converts them. `progress`: a function that is called with the number of rows that were drawn since, such as
        tqdm's update. Returns the array."""
        roi = self.window if roi is None else _integers("roi", roi, 4)
        x0, y0, x1, y1 = roi
        if x1 <= x0 or y1 <= y0:
            raise ValueError(f"roi={roi}: must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1")
        if progress is not None and not callable(progress):
            raise TypeError("progress must be callable")
        shape = self._shape(roi)
        if out is None or _is_imagebuf(out):
            pixels = _numpy.empty(shape, self.dtype)
        else:
            pixels = out
            if not isinstance(out, _numpy.ndarray):
                raise TypeError(f"out is a {type(out).__name__}: must be an array or an ImageBuf")
            if out.shape != shape:
                raise ValueError(f"out has the shape {out.shape}: must be {shape}")
            if not out.flags.writeable:
                raise ValueError("out is read-only: must be writeable")
            if out.dtype not in _DTYPES:
                raise TypeError(f"out has the dtype {out.dtype}: must be one of {', '.join(_core.dtypes)}")
        drawn = pixels if pixels.ndim == 3 else pixels[:, :, None]
        # Sources are read while pixels are written.
        plain = pixels is not out or (_is_plain(drawn) and not any(_numpy.may_share_memory(drawn, array) for array in self._core.arrays))
        to = drawn if plain else _numpy.empty(drawn.shape, drawn.dtype)
        self._core.draw(to, x0, y0, self._threads, progress)
        if not plain:
            drawn[...] = to
        if out is not None and _is_imagebuf(out):
            _write_imagebuf(out, drawn, self, roi)
            return out
        return pixels

    def source_points(self, x, y):
        """The source points of points of the picture, by the formula in double: arrays u and v of the shape of x and y. All are in
        pixels, x and u to the right, y and v down from the display window's corner, the first pixel's centre at (0.5, 0.5). NaN where
        there is no source point, and beside the picture."""
        x, y = _numpy.broadcast_arrays(_numpy.asarray(x, float), _numpy.asarray(y, float))
        u, v = self._core.source_points(x.ravel(), y.ravel(), self._threads)
        return u.reshape(x.shape), v.reshape(x.shape)

    def jacobians(self, x, y):
        """The derivatives of source_points: an array of the shape of x and y with two axes more, [[du/dx, du/dy], [dv/dx, dv/dy]]."""
        x, y = _numpy.broadcast_arrays(_numpy.asarray(x, float), _numpy.asarray(y, float))
        return self._core.jacobians(x.ravel(), y.ravel(), self._threads).reshape(x.shape + (2, 2))

    def __array__(self, dtype=None, copy=None):
        drawn = self.draw()
        return drawn if dtype is None else drawn.astype(dtype)

    def __repr__(self):
        x0, y0, x1, y1 = self.window
        return f"<anamorph.Picture {self.operation} {x1 - x0}x{y1 - y0} {','.join(self.channels)} {self.dtype}>"

    def _shape(self, roi):
        x0, y0, x1, y1 = roi
        count = len(self._core.channels)
        flat = count == 1 and (self._flat or self._core.kind != "color")
        return (y1 - y0, x1 - x0) if flat else (y1 - y0, x1 - x0, count)


def apply(operation, *sources, out=None, roi=None, subimage=0, threads=0, progress=None, **keys):
    """Draws the picture of an operation, by its name: Picture(operation, *sources, ...).draw(...)."""
    return Picture(operation, *sources, subimage=subimage, threads=threads, **keys).draw(roi, out=out, progress=progress)


def _key_of(name):
    return name[:-1] if name.endswith("_") and _keyword.iskeyword(name[:-1]) else name


def _check_sources_are_no_keys(operation, keys):
    for name in operation["sources"]:
        names_images = name == operation["main_file"] and isinstance(keys.get(name), (str, _os.PathLike))
        if name in keys and not names_images:
            raise _error(name, f"{name}: sources are no keys: must be given first, in the order {', '.join(operation['sources'])}")


def _number_text(key, value):
    if isinstance(value, (int, float)):  # most are: abstract classes take longer to ask
        return str(int(value)) if isinstance(value, int) else repr(float(value))
    if isinstance(value, (_numpy.bool_, _numbers.Integral)):
        return str(int(value))
    if isinstance(value, _numpy.floating):
        return str(value)  # its own fewest digits
    if isinstance(value, _numbers.Real):
        return repr(float(value))
    raise TypeError(f"{key}={value!r}: a {type(value).__name__} is no value of a key")


def _text_of(row, key, value, texts, images):
    """The value of a key as a recipe has it. What is no text, but stands for a file, is put into `texts` and `images`."""
    kind = row["type"] if row else "text"
    if isinstance(value, str):
        return value
    if isinstance(value, _os.PathLike):
        return _os.fspath(value)
    if kind in ("image", "file") and isinstance(value, (dict, list)):
        name = f"<{key}>.json"
        texts[name] = _json_of(key, value)
        return name
    if kind == "image" and not isinstance(value, _numbers.Number):
        name = f"<{key}>"
        images[name] = _source_of(value, key)
        return name
    if kind == "file":
        raise TypeError(f"{key} is a {type(value).__name__}: must be the name of a file, or the dict or list that a JSON file holds")
    if isinstance(value, (tuple, list, _numpy.ndarray)):
        separator = "x" if kind == "extent" else ","
        flat = isinstance(value, (tuple, list)) and all(isinstance(part, (int, float)) for part in value)
        parts = value if flat else _numpy.ravel(value).tolist()
        return separator.join([_number_text(key, part) for part in parts])
    return _number_text(key, value)


def _pixels(pixels, name):
    """An array of two or three axes of a type that pictures have."""
    if hasattr(pixels, "__dlpack__") and not isinstance(pixels, _numpy.ndarray):
        pixels = _numpy.from_dlpack(pixels)
    array = _numpy.asarray(pixels)
    if array.dtype not in _DTYPES:
        raise TypeError(f"{name} has the dtype {array.dtype}: must be one of {', '.join(_core.dtypes)}")
    if array.ndim not in (2, 3):
        raise ValueError(f"{name} has the shape {array.shape}: must be (height, width) or (height, width, channels)")
    if array.size == 0:
        raise ValueError(f"{name} has the shape {array.shape}: must have pixels")
    return array


def _is_plain(array):
    """Do the channels of a pixel stand next to each other, and pixels and rows behind each other, aligned?"""
    rows, columns, channels = array.strides
    if array.dtype not in _CONVERTED and (rows | columns | array.ctypes.data) % 4:
        return False  # pixels that are only moved are moved four bytes at a time where that fits
    return (channels == array.itemsize and columns >= array.shape[2] * array.itemsize and rows >= 0
            and array.flags.aligned and (rows >= columns * array.shape[1] or array.shape[0] == 1))


def _is_imagebuf(value):
    """Is it OpenImageIO's? Its module is not imported for that: who has none has no image of it."""
    module = _sys.modules.get("OpenImageIO")
    return module is not None and isinstance(value, module.ImageBuf)


def _is_flat(source):
    if isinstance(source, Picture):
        return source._flat
    if isinstance(source, Image):
        return source.pixels.ndim == 2
    if isinstance(source, (str, _os.PathLike)) or _is_imagebuf(source):
        return True
    return (source.ndim if isinstance(source, _numpy.ndarray) else _numpy.ndim(source)) == 2


def _source_of(source, name="a source"):
    if isinstance(source, (str, _os.PathLike)):
        return _core.file_source(_encoded(_os.fsdecode(source), name))
    if _is_imagebuf(source):
        source = _read_imagebuf(source)
    array = source.pixels if isinstance(source, Image) else _pixels(source, name)
    if array.ndim == 2:
        array = array[:, :, None]
    if not _is_plain(array):
        array = _numpy.ascontiguousarray(array)
    if not isinstance(source, Image):
        return _core.array_source(array, (), False, (0, 0), (0, 0, 0, 0), ())
    return _core.array_source(array, [_encoded(channel, "channels") for channel in source.channels], source.unassociated, source.corner, source.display,
                              [(_encoded(name, "metadata"), _encoded(value, name) if isinstance(value, str) else value)
                               for name, value in source.metadata.items()])


def _read_imagebuf(image):
    """An ImageBuf as an Image: a copy, since its module and this one may have been built with different OpenImageIOs."""
    spec = image.spec()
    if image.has_error or spec.width < 1 or str(spec.format) == "unknown":
        raise Error(f"the source image cannot be read: {image.geterror() or 'it is not initialised'}")
    if spec.deep or spec.depth > 1:
        raise Error("the source image is deep or a volume: must be a flat image")
    kept = {attribute.name: attribute.value for attribute in spec.extra_attribs
            if isinstance(attribute.value, (int, float, str))}
    pixels = image.get_pixels(spec.format)
    if pixels is None:
        raise Error(f"the source image cannot be read: {image.geterror()}")
    return Image(pixels, channels=spec.channelnames,
                 unassociated=bool(spec.get_int_attribute("oiio:UnassociatedAlpha")), corner=(spec.x, spec.y),
                 display=(spec.full_x, spec.full_y, spec.full_x + spec.full_width, spec.full_y + spec.full_height),
                 metadata=kept)


def _write_imagebuf(image, pixels, picture, roi):
    oiio = _sys.modules["OpenImageIO"]
    x0, y0, x1, y1 = roi
    if not image.initialized:
        spec = oiio.ImageSpec(x1 - x0, y1 - y0, pixels.shape[2], pixels.dtype.name.replace("float16", "half")
                              .replace("float32", "float").replace("float64", "double"))
        spec.x, spec.y = x0, y0
        spec.full_x, spec.full_y = picture.display[:2]
        spec.full_width, spec.full_height = (picture.display[2] - picture.display[0],
                                             picture.display[3] - picture.display[1])
        spec.channelnames = picture.channels
        for name, value in {**picture.said, **picture.reached()}.items():
            spec.attribute(name, value)
        image.reset(spec)
    region = oiio.ROI(x0, x1, y0, y1, 0, 1, 0, pixels.shape[2])
    if not image.set_pixels(region, _numpy.ascontiguousarray(pixels)):
        raise Error(f"out: {image.geterror()}")


def _parameter_name(name):
    return name + "_" if _keyword.iskeyword(name) else name


_OF_CALLS = {"out": "an array or ImageBuf that is drawn to", "roi": "(x0, y0, x1, y1): the pixels that are drawn",
             "subimage": "of an operation that makes several pictures, which", "threads": "how many may draw; 0: all",
             "progress": "called with the number of rows that were drawn since"}


def _keys_of(operation):
    sources = set(operation["sources"]) - {operation["main_file"]}
    return [key for key in operation["keys"] if not key["of_recipes"] and key["name"] not in sources]


def _documentation(operation):
    """The text of help(), by the operation's table."""
    lines = [operation["title"] + ".", ""]
    if operation["sources"]:
        lines += ["sources: " + ", ".join(operation["sources"]) +
                  (f", of which {operation['least_sources']} must be given" if
                   operation["least_sources"] < len(operation["sources"]) else "") + ".", ""]
    for key in _keys_of(operation):
        unit = f", {key['unit']}" if key["unit"] else ""
        default = f"; by default {key['default']}" if key["default"] else ""
        lines.append(f"{_parameter_name(key['name'])}: {key['accepted']}{unit}{default}. {key['documentation']}")
    lines += [""] + [f"{name}: {text}" for name, text in _OF_CALLS.items()]
    return "\n".join(lines)


def _function(operation):
    name = operation["name"]

    def function(*sources, **keys):
        return apply(name, *sources, **keys)

    keyword = _inspect.Parameter.KEYWORD_ONLY
    keys = [_inspect.Parameter(_parameter_name(key["name"]), keyword, default=None) for key in _keys_of(operation)
            if _parameter_name(key["name"]).isidentifier()]
    calls = [_inspect.Parameter("out", keyword, default=None), _inspect.Parameter("roi", keyword, default=None),
             _inspect.Parameter("subimage", keyword, default=0), _inspect.Parameter("threads", keyword, default=0), _inspect.Parameter("progress", keyword, default=None)]
    parameters = [_inspect.Parameter("sources", _inspect.Parameter.VAR_POSITIONAL), *keys, *calls]
    if any(key["definitions"] for key in operation["keys"]):
        parameters.append(_inspect.Parameter("definitions", _inspect.Parameter.VAR_KEYWORD))
    function.__name__ = function.__qualname__ = name
    function.__signature__ = _inspect.Signature(parameters)
    function.__doc__ = _documentation(operation)
    return function


for _operation in _OPERATIONS.values():
    globals()[_operation["name"]] = _function(_operation)
del _operation

from . import figures, surfaces  # noqa: E402
from .maps import Map  # noqa: E402

__all__ = ["Error", "Image", "Map", "Picture", "apply", "figures", "operations", "surfaces", *operations]


def __getattr__(name):
    if not name.startswith("vtkAnamorph"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import vtk

    return getattr(vtk, name)
