# SPDX-License-Identifier: Apache-2.0
"""Maps: from points of a picture to points of its source, with no pixels.

    lens = anamorph.Map("lens", (1920, 1080), lens="brown:k1=-0.2", fov=70)
    u, v = lens.points(0.5, 0.5)
    x, y = lens.inverse().points(u, v)              # back
    both = lens.compose(anamorph.Map("warp", (1920, 1080), mesh=sheet))
"""
import numpy as _numpy

from ._checks import integers as _integers

__all__ = ["Map"]

# Newton's iteration begins at the nearest of so many points of the picture, each way, and ends where a source point is met to so many
# pixels for each pixel of the source's larger side.
_STARTS = 65
_TRIES = 4
_CELLS = 64
_STEPS = 40
_MET = 1e-12


class Map:
    """The map of an operation: where in its source each point of the picture lies.

    operation: its name. source: the size of the source, (width, height), or an array or Image. keys: as of the operation.
    All points are in pixels from the upper left corner of the display window, x right, y down, the first pixel's centre at (0.5, 0.5), and NaN where
    there is none. `size` is that of the picture, `source_size` that of the source, (width, height). `window` is what is drawn of the picture,
    (x0, y0, x1, y1), and more than `size` with overscan; `source_window` is what there is of the source.
    """

    def __init__(self, operation, source, **keys):
        from . import Picture

        if _numpy.ndim(source) == 0 and isinstance(source, (int, float)):
            raise ValueError(f"source={source}: must be (width, height), an array or an Image")
        if isinstance(source, tuple):
            width, height = _integers("source", source, 2)
            if width < 1 or height < 1:
                raise ValueError(f"source={source}: must be (width, height), each at least 1")
            source = _numpy.zeros((height, width), _numpy.uint8)
        self._set(Picture(operation, source, **keys), source, keys)

    def _set(self, picture, source, keys):
        self._picture, self._keys, self._source = picture, keys, source
        self.size, self.window = _from_display(picture.display, picture.window)
        self.source_size, self.source_window = _windows(source)
        self._points, self._jacobians = picture.source_points, picture.jacobians

    @classmethod
    def from_stmap(cls, stmap, source_size):
        """The map that an array of shape (height, width, 2) holds, as output="stmap" draws it: u and v from 0 to 1 on the source, v down. Between
        pixels it is a cubic (.warp). All of the array is its picture's display window."""
        return cls("warp", tuple(source_size), mesh=_numpy.asarray(stmap, _numpy.float32))

    @classmethod
    def from_functions(cls, points, jacobians, size, source_size, *, window=None, source_window=None):
        """A map of your own: points(x, y) gives (u, v), jacobians(x, y) the derivatives as jacobians() does, both of arrays of double. What is
        proven of an operation's map is not of it. Windows are by default the sizes'."""
        made = cls.__new__(cls)
        made._picture, made._points, made._jacobians = None, points, jacobians
        made.size, made.source_size = _integers("size", size, 2), _integers("source_size", source_size, 2)
        made.window = (0, 0, *made.size) if window is None else _integers("window", window, 4)
        made.source_window = (0, 0, *made.source_size) if source_window is None else _integers("source_window", source_window, 4)
        return made

    def points(self, x, y):
        """The source points (u, v) of points of the picture: by the formula, in double."""
        x, y = _numpy.broadcast_arrays(_numpy.asarray(x, float), _numpy.asarray(y, float))
        return self._points(x, y)

    def jacobians(self, x, y):
        """Their derivatives: [[du/dx, du/dy], [dv/dx, dv/dy]], two axes behind those of x and y."""
        x, y = _numpy.broadcast_arrays(_numpy.asarray(x, float), _numpy.asarray(y, float))
        return self._jacobians(x, y)

    def centers(self):
        """The centres of the pixels of the window, (x, y), arrays (height, width), as those of bounds() and of all else that is drawn."""
        x0, y0, x1, y1 = self.window
        return tuple(_numpy.meshgrid(_numpy.arange(x0, x1) + 0.5, _numpy.arange(y0, y1) + 0.5))

    def bounds(self):
        """The proven bound of each pixel of the window, in source pixels: an array (height, width)."""
        return self._drawn("bound")

    def coverage(self):
        """How much of each pixel the source covers, 0 to 1: an array (height, width)."""
        return self._drawn("coverage")

    def explain(self):
        """What the picture says of itself and what was reached, as anamorph:tol, anamorph:max_error and anamorph:chain."""
        picture = self._of_operation("explain")
        return {**picture.said, **picture.reached()}

    def compose(self, inner):
        """This map, and `inner` of where it leads: the picture of this one of the picture of `inner`. Two operations are joined as pictures of
        pictures are, with a bound of the whole; other maps are evaluated one after the other."""
        if tuple(self.source_size) != tuple(inner.size):
            raise ValueError(f"inner makes a picture of {inner.size}: must be of this map's source, {self.source_size}")
        if self._picture is not None and inner._picture is not None:
            from . import Error, Picture

            try:
                joined = Picture(self._picture.operation, inner._picture, **self._keys)
                joined.source_points(0.5, 0.5)
            except Error:
                joined = None
            if joined is not None and " of " in joined.said.get("anamorph:chain", "") and ":" not in joined.said["anamorph:chain"]:
                made = Map.__new__(Map)
                made._set(joined, inner._source, self._keys)
                made.source_size, made.source_window = inner.source_size, inner.source_window
                return made
        return Map.from_functions(lambda x, y: inner.points(*self.points(x, y)),
                                  lambda x, y: inner.jacobians(*self.points(x, y)) @ self.jacobians(x, y), self.size, inner.source_size,
                                  window=self.window, source_window=inner.source_window)

    def inverse(self):
        """The map from points of the source to points of the picture. Each is found by Newton's iteration and met to 1e-12 of the source's
        size; where several points of the picture show one of the source it is one of them, and NaN where none was found."""
        return Map.from_functions(self._found, self._of_inverse, self.source_size, self.size, window=self.source_window,
                                  source_window=self.window)

    def to_stmap(self):
        """The map as an array (height, width, 2) of float32, as output="stmap" draws it: for mesh= of anamorph.warp, or a file of other programs.
        (-1, -1) where there is no source point."""
        u, v = self.points(*self.centers())
        stmap = _numpy.stack([u / self.source_size[0], v / self.source_size[1]], -1)
        return _numpy.where(_numpy.isfinite(stmap).all(-1, keepdims=True), stmap, -1).astype(_numpy.float32)

    def draw(self, source, **more):
        """Draws an array through the map: one of all that the source's window has, of its display window, or an Image. The result has the pixels
        of the window. `more`: keys of the operation, such as filter; of inverses and other maps that are no operation's, of .warp by to_stmap()."""
        from . import Picture, apply

        source = self._placed(source)
        if self._picture is None or isinstance(self._source, Picture) or "anamorph:chain" in self._picture.said:
            return apply("warp", source, mesh=self.to_stmap(), **more)
        return apply(self._picture.operation, source, **{**self._keys, **more})

    def __repr__(self):
        of = self._picture.said.get("anamorph:chain", self._picture.operation) if self._picture is not None else "functions"
        return f"<anamorph.Map {of} {self.size[0]}x{self.size[1]} of {self.source_size[0]}x{self.source_size[1]}>"

    def _placed(self, source):
        """A source with the windows that an array of its size has here."""
        from . import Image

        x0, y0, x1, y1 = self.source_window
        size, whole = _windows(source)[0], (x1 - x0, y1 - y0)
        if isinstance(source, Image) and source.display[2] > source.display[0] or size == self.source_size:
            if size != self.source_size:
                raise ValueError(f"source has a display window of {size}: must be {self.source_size}, (width, height)")
            return source
        if size != whole:
            also = "" if whole == self.source_size else f" or, with what lies around, {whole}"
            raise ValueError(f"source is {size}: must be {self.source_size}{also}, (width, height)")
        if isinstance(source, Image):
            return Image(source.pixels, channels=source.channels, unassociated=source.unassociated, corner=(x0, y0), display=(0, 0, *self.source_size),
                         metadata=source.metadata)
        return Image(source, corner=(x0, y0), display=(0, 0, *self.source_size))

    def _of_operation(self, what):
        if self._picture is None:
            raise ValueError(f"{what}: must be of an operation's map, not of an inverse or of functions")
        return self._picture

    def _drawn(self, output):
        from . import Picture

        picture = self._of_operation("bounds" if output == "bound" else output)
        if "anamorph:chain" in picture.said:
            raise ValueError(f"{output}: must be of one operation's map: of a chain, anamorph.Picture(..., output={output!r}) draws it")
        return Picture(picture.operation, self._source, **{**self._keys, "output": output}).draw()

    def _starts(self):
        """Points spread over the window, and their source points."""
        x0, y0, x1, y1 = self.window
        between = (_numpy.arange(_STARTS) + 0.5) / _STARTS
        x, y = _numpy.meshgrid(x0 + between * (x1 - x0), y0 + between * (y1 - y0))
        points = _numpy.stack([x.ravel(), y.ravel()], -1)
        sources = _numpy.stack(self.points(points[:, 0], points[:, 1]), -1)
        known = _numpy.isfinite(sources).all(-1)
        return points[known], sources[known]

    def _found(self, u, v):
        wanted = _numpy.stack([u.ravel(), v.ravel()], -1)
        found = _numpy.full(wanted.shape, _numpy.nan)
        points, sources = self._starts()
        left = _numpy.flatnonzero(_numpy.isfinite(wanted).all(-1)) if len(points) else _numpy.empty(0, int)
        near = _nearest(sources, wanted[left]) if len(left) else None
        met = _MET * max(*self.source_size, *self.size)
        for k in range(_TRIES):
            if not len(left):
                break
            found[left] = self._newton(points[near[:, k]], wanted[left], met)
            missing = _numpy.isnan(found[left, 0])
            left, near = left[missing], near[missing]
        return found[:, 0].reshape(u.shape), found[:, 1].reshape(u.shape)

    def _newton(self, at, wanted, met):
        """Where the map meets what is wanted, from points to begin at; NaN where it does not. A step that does not come nearer is halved."""
        at = at.copy()
        rest = wanted - _numpy.stack(self.points(at[:, 0], at[:, 1]), -1)
        off = _numpy.hypot(rest[:, 0], rest[:, 1])
        stride = _numpy.ones(len(at))
        active = off > met
        for _ in range(_STEPS):
            i = _numpy.flatnonzero(active)
            if not len(i):
                break
            (a, b), (c, d) = _numpy.moveaxis(self.jacobians(at[i, 0], at[i, 1]), 0, -1)
            with _numpy.errstate(all="ignore"):
                determinant = a * d - b * c
                step = _numpy.stack([d * rest[i, 0] - b * rest[i, 1], a * rest[i, 1] - c * rest[i, 0]], -1) / determinant[:, None]
            tried = at[i] + stride[i, None] * step
            new_rest = wanted[i] - _numpy.stack(self.points(tried[:, 0], tried[:, 1]), -1)
            new_off = _numpy.hypot(new_rest[:, 0], new_rest[:, 1])
            nearer = new_off < off[i]
            taken = i[nearer]
            at[taken], rest[taken], off[taken] = tried[nearer], new_rest[nearer], new_off[nearer]
            stride[i] = _numpy.where(nearer, _numpy.minimum(1, 2 * stride[i]), stride[i] / 2)
            active[i] = (off[i] > met) & (stride[i] > 1e-6)
        x0, y0, x1, y1 = self.window
        inside = (at >= (x0, y0)).all(-1) & (at <= (x1, y1)).all(-1)
        # Rounding alone may stop it a little before.
        return _numpy.where(((off <= 1e3 * met) & inside)[:, None], at, _numpy.nan)

    def _of_inverse(self, u, v):
        x, y = self._found(u, v)
        (a, b), (c, d) = _numpy.moveaxis(self.jacobians(x, y).reshape(-1, 2, 2), 0, -1)
        with _numpy.errstate(all="ignore"):
            inverse = _numpy.stack([d, -b, -c, a], -1) / (a * d - b * c)[:, None]
        return inverse.reshape(x.shape + (2, 2))


def _nearest(sources, wanted):
    """Of each of some points _TRIES of the sources that are near, the nearest first: of those that are nearest to the middle of its cell."""
    low, high = sources.min(0), sources.max(0)
    cell = _numpy.clip((wanted - low) / _numpy.maximum(high - low, 1e-300) * _CELLS, 0, _CELLS - 1).astype(int)
    used, of = _numpy.unique(cell[:, 1] * _CELLS + cell[:, 0], return_inverse=True)
    middles = (_numpy.stack([used % _CELLS, used // _CELLS], -1) + 0.5) / _CELLS * (high - low) + low
    count = min(4 * _TRIES, len(sources))
    near = _numpy.empty((len(used), count), int)
    for begin in range(0, len(used), 256):
        distance = ((middles[begin:begin + 256, None, :] - sources[None, :, :]) ** 2).sum(-1)
        near[begin:begin + 256] = _numpy.argpartition(distance, count - 1, axis=1)[:, :count]
    best = _numpy.empty((len(wanted), min(_TRIES, count)), int)
    for begin in range(0, len(wanted), 65536):
        part = slice(begin, begin + 65536)
        some = near[of[part]]
        distance = ((sources[some] - wanted[part, None, :]) ** 2).sum(-1)
        best[part] = _numpy.take_along_axis(some, distance.argsort(1)[:, :best.shape[1]], 1)
    return _numpy.pad(best, ((0, 0), (0, _TRIES - best.shape[1])), mode="edge")


def _from_display(display, window):
    """The size of a display window, and a window counted from its corner."""
    x0, y0, x1, y1 = display
    return (x1 - x0, y1 - y0), (window[0] - x0, window[1] - y0, window[2] - x0, window[3] - y0)


def _windows(source):
    """The size of a source's display window, and its pixels' window counted from there."""
    from . import Image, Picture

    if isinstance(source, Picture):
        return _from_display(source.display, source.window)
    shape = _numpy.shape(source.pixels if isinstance(source, Image) else source)
    if len(shape) < 2:
        raise ValueError(f"source has the shape {shape}: must be (height, width) or (height, width, channels)")
    height, width = shape[:2]
    if isinstance(source, Image) and source.display[2] > source.display[0]:
        x, y = source.corner
        return _from_display(source.display, (x, y, x + width, y + height))
    return (width, height), (0, 0, width, height)
