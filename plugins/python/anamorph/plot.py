# SPDX-License-Identifier: Apache-2.0
"""Time against error as a picture (SVG) that needs nothing to be shown: panels beside each other, both axes in powers of ten, each series
named where it ends."""
import html
import math
from typing import NamedTuple

_WIDTH, _HEIGHT = 500, 330  # of a panel
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 168, 34, 46
_COLORS = ("#0b6fb8", "#d1495b", "#3b7d3b", "#b8860b", "#7b4fa3", "#5c6b73", "#c96f1e", "#1c8c8c", "#a3466b", "#6b7a1f", "#444444")


class Point(NamedTuple):
    panel: str
    series: str
    error: float  # pixels of the source; below the plot's least it is drawn at its left edge
    time: float   # nanoseconds a pixel
    label: str = ""


def _powers(values, least=None):
    """From the power of ten below all values to the one above."""
    low = math.floor(math.log10(max(min(values), least or min(values))) + 1e-9)
    high = math.ceil(math.log10(max(values)) - 1e-9)
    return low, max(high, low + 1)


def _power_text(power):
    return f"{10 ** power:g}" if -3 <= power <= 4 else f"1e{power}"


def _spread(wanted, distance, low, high):
    """Places near the wanted ones, in the same order, at least `distance` apart where there is room."""
    order = sorted(range(len(wanted)), key=lambda i: wanted[i])
    placed, last = dict.fromkeys(order, 0.0), low - distance
    for i in order:
        last = placed[i] = max(wanted[i], last + distance)
    over = max(0, last - high)
    return [placed[i] - over for i in range(len(wanted))]


def _panel(title, points, colors, x_range, y_range, least):
    (x0, x1), (y0, y1) = x_range, y_range
    inner_width, inner_height = _WIDTH - _LEFT - _RIGHT, _HEIGHT - _TOP - _BOTTOM

    def place(point):
        x = (math.log10(max(point.error, least)) - x0) / (x1 - x0)
        y = (math.log10(point.time) - y0) / (y1 - y0)
        return _LEFT + inner_width * min(max(x, 0), 1), _TOP + inner_height * (1 - y)

    parts = [f'<text x="{_LEFT}" y="20" class="title">{html.escape(title)}</text>']
    for power in range(x0, x1 + 1):
        x = _LEFT + inner_width * (power - x0) / (x1 - x0)
        parts.append(f'<line x1="{x:.1f}" y1="{_TOP}" x2="{x:.1f}" y2="{_HEIGHT - _BOTTOM}" class="grid"/>'
                     f'<text x="{x:.1f}" y="{_HEIGHT - _BOTTOM + 16}" text-anchor="middle">{_power_text(power)}</text>')
    for power in range(y0, y1 + 1):
        y = _TOP + inner_height * (1 - (power - y0) / (y1 - y0))
        parts.append(f'<line x1="{_LEFT}" y1="{y:.1f}" x2="{_WIDTH - _RIGHT}" y2="{y:.1f}" class="grid"/>'
                     f'<text x="{_LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{_power_text(power)}</text>')
    parts.append(f'<text x="{_LEFT + inner_width / 2}" y="{_HEIGHT - 10}" text-anchor="middle">largest error, source pixels</text>'
                 f'<text transform="translate(14 {_TOP + inner_height / 2}) rotate(-90)" text-anchor="middle">ns a pixel</text>')
    series = list(dict.fromkeys(point.series for point in points))
    ends = []
    for name in series:
        mine = sorted((point for point in points if point.series == name), key=lambda point: point.error)
        places = [place(point) for point in mine]
        if len(places) > 1:
            parts.append('<polyline points="' + " ".join(f"{x:.1f},{y:.1f}" for x, y in places) + f'" fill="none" stroke="{colors[name]}" stroke-width="2"/>')
        for point, (x, y) in zip(mine, places):
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colors[name]}"><title>{html.escape(point.series)} {html.escape(point.label)}: '
                         f'{point.error:.3g} px, {point.time:.3g} ns</title></circle>')
        for point, (x, _), y in zip(mine, places, _spread([y for _, y in places], 11, _TOP, _HEIGHT - _BOTTOM)):
            parts.append(f'<text x="{x + 7:.1f}" y="{y - 2:.1f}" class="small">{html.escape(point.label)}</text>')
        ends.append(places[-1])
    names = _spread([y for _, y in ends], 13, _TOP + 4, _HEIGHT - _BOTTOM)
    for name, (x, y), at in zip(series, ends, names):
        parts.append(f'<line x1="{x + 5:.1f}" y1="{y:.1f}" x2="{_WIDTH - _RIGHT + 6}" y2="{at:.1f}" stroke="{colors[name]}" stroke-width="0.7"/>'
                     f'<text x="{_WIDTH - _RIGHT + 9}" y="{at + 4:.1f}" fill="{colors[name]}">{html.escape(name)}</text>')
    return parts


def svg(points, least=1e-5):
    """The picture of some Points; errors below `least` pixels are drawn there."""
    if not points:
        raise ValueError("points: must be at least one")
    panels = list(dict.fromkeys(point.panel for point in points))
    names = list(dict.fromkeys(point.series for point in points))
    colors = {name: _COLORS[i % len(_COLORS)] for i, name in enumerate(names)}
    x_range = _powers([max(point.error, least) for point in points], least)
    y_range = _powers([point.time for point in points])
    across = min(len(panels), 2)
    down = -(-len(panels) // across)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH * across} {_HEIGHT * down}" font-family="sans-serif" font-size="12">',
             "<style>.grid{stroke:#ddd}.title{font-weight:bold;font-size:14px}.small{font-size:10px;fill:#444}</style>",
             '<rect width="100%" height="100%" fill="white"/>']
    for i, panel in enumerate(panels):
        lines.append(f'<g transform="translate({i % across * _WIDTH} {i // across * _HEIGHT})">')
        lines += _panel(panel, [point for point in points if point.panel == panel], colors, x_range, y_range, least)
        lines.append("</g>")
    return "\n".join(lines + ["</svg>", ""])
