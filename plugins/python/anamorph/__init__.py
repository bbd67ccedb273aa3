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
import os as _os
import sys as _sys
from pkgutil import extend_path as _extend_path

import numpy as _numpy

from . import _core
from ._checks import encoded as _encoded
from ._checks import integers as _integers
from ._core import Error

# The VTK modules are of a folder of the same name, which may be elsewhere.
__path__ = _extend_path(__path__, __name__)

__version__ = _core.version
_OPERATIONS = {operation["name"]: operation for operation in _core.operations()}
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
        self._core = _core.Picture(operation, sources, keys, subimage, threads)
        self.operation = operation

    @property
    def window(self):
        """The data window, (x0, y0, x1, y1): the pixels that draw() draws."""
        return self._core.window

    @property
    def display(self):
        """The display window, (x0, y0, x1, y1)."""
        return self._core.display

    @property
    def channels(self):
        """The names of the channels."""
        return self._core.channels

    @property
    def dtype(self):
        """The type of the pixels."""
        return self._core.dtype

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
        return self._core.shape(self._core.window)

    def reached(self):
        """What was reached over the whole picture: anamorph:max_error, a proven bound in source pixels, and what else the operation
        tells."""
        return self._core.reached()

    def draw(self, roi=None, *, out=None, progress=None):
        """Draws the picture, or the pixels from (x0, y0) to before (x1, y1), roi=(x0, y0, x1, y1), counted as the windows are: black
        beyond the data window. `out`: an array of the same shape, or an ImageBuf; colours become the type that it has, as
        OpenImageIO converts them. `progress`: a function that is called with the number of rows that were drawn since, such as
        tqdm's update. Returns the array."""
        return _draw(self._core, roi, out, progress)

    def source_points(self, x, y):
        """The source points of points of the picture, by the formula in double: arrays u and v of the shape of x and y. All are in
        pixels, x and u to the right, y and v down from the display window's corner, the first pixel's centre at (0.5, 0.5). NaN where
        there is no source point, and beside the picture."""
        x, y = _numpy.broadcast_arrays(_numpy.asarray(x, float), _numpy.asarray(y, float))
        u, v = self._core.source_points(x.ravel(), y.ravel())
        return u.reshape(x.shape), v.reshape(x.shape)

    def jacobians(self, x, y):
        """The derivatives of source_points: an array of the shape of x and y with two axes more, [[du/dx, du/dy], [dv/dx, dv/dy]]."""
        x, y = _numpy.broadcast_arrays(_numpy.asarray(x, float), _numpy.asarray(y, float))
        return self._core.jacobians(x.ravel(), y.ravel()).reshape(x.shape + (2, 2))

    def __array__(self, dtype=None, copy=None):
        drawn = self.draw()
        return drawn if dtype is None else drawn.astype(dtype)

    def __repr__(self):
        x0, y0, x1, y1 = self.window
        return f"<anamorph.Picture {self.operation} {x1 - x0}x{y1 - y0} {','.join(self.channels)} {self.dtype}>"


def apply(operation, *sources, out=None, roi=None, subimage=0, threads=0, progress=None, **keys):
    """Draws the picture of an operation, by its name: Picture(operation, *sources, ...).draw(...)."""
    return _apply(operation, sources, keys, out, roi, subimage, threads, progress)


def _apply(operation, sources, keys, out, roi, subimage, threads, progress):
    if out is None:
        return _core.apply(operation, sources, keys, subimage, threads, roi, progress)
    return _draw(_core.Picture(operation, sources, keys, subimage, threads), roi, out, progress)


def _draw(picture, roi, out, progress):
    if out is None:
        return picture.draw(roi, progress)
    region = picture.region(roi)
    if _is_imagebuf(out):
        _write_imagebuf(out, _numpy.atleast_3d(picture.draw(region, progress)), picture, region)
    else:
        _draw_to(out, picture, region, progress)
    return out


def _draw_to(out, picture, region, progress):
    if not isinstance(out, _numpy.ndarray):
        raise TypeError(f"out is a {type(out).__name__}: must be an array or an ImageBuf")
    shape = picture.shape(region)
    if out.shape != shape:
        raise ValueError(f"out has the shape {out.shape}: must be {shape}")
    if not out.flags.writeable:
        raise ValueError("out is read-only: must be writeable")
    _core.check_pixels(out, "out")
    # Sources are read while pixels are written.
    plain = _core.is_plain(out) and not any(_numpy.may_share_memory(out, array) for array in picture.arrays)
    pixels = out if plain else _numpy.empty(shape, out.dtype)
    picture.draw_to(pixels, *region[:2], progress)
    if not plain:
        out[...] = pixels


def _pixels(pixels, name):
    """An array of two or three axes of a type that pictures have."""
    if hasattr(pixels, "__dlpack__") and not isinstance(pixels, _numpy.ndarray):
        pixels = _numpy.from_dlpack(pixels)
    array = _numpy.asarray(pixels)
    _core.check_pixels(array, name)
    return array


def _is_imagebuf(value):
    """Is it OpenImageIO's? Its module is not imported for that: who has none has no image of it."""
    module = _sys.modules.get("OpenImageIO")
    return module is not None and isinstance(value, module.ImageBuf)


def _opened(source):
    """A source of a picture that is no array, as the core takes it: the core calls this."""
    return source._core if isinstance(source, Picture) else _source_of(source, "a source")


def _source_of(source, name):
    """An image that is no Picture as the core takes it; `name` is for messages."""
    if isinstance(source, (str, _os.PathLike)):
        return _core.file_source(_encoded(_os.fsdecode(source), name))
    from_imagebuf = _is_imagebuf(source)
    if from_imagebuf:
        source = _read_imagebuf(source)
    if not isinstance(source, Image):
        return _core.array_source(_pixels(source, name), name)
    return _core.image_source(source.pixels, [_encoded(channel, "channels") for channel in source.channels], source.unassociated, source.corner, source.display,
                              [(_encoded(name, "metadata"), _encoded(value, name) if isinstance(value, str) else value)
                               for name, value in source.metadata.items()], from_imagebuf or source.pixels.ndim == 2)


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

    def function(*sources, out=None, roi=None, subimage=0, threads=0, progress=None, **keys):
        return _apply(name, sources, keys, out, roi, subimage, threads, progress)

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
