#!/usr/bin/env python3
"""Frame time, energy and area over the size of L1, as a picture: reads the sweep.csv of a sweep over
profile, size and platform.cluster.l1.size, and prints SVG. A curve a profile and image size; areas
are of the chip, so that all curves have one.

    l1_knee.py SWEEP.csv >PICTURE.svg
"""

import csv
import math
import sys

PANELS = [("frame time, ms", "objective.frame_time"), ("energy of a frame, mJ", "objective.energy"),
          ("area of the chip, mm²", "objective.area")]
COLOURS = ["#1f6fb2", "#d1651f", "#2e8b57", "#8a4fbf"]
WIDTH, HEIGHT, LEFT, TOP, GAP = 250, 190, 48, 34, 62


def kibibytes(text):
    return float(text.removesuffix("KiB"))


def curves(rows, column):
    """{"levio, 160x120": [(KiB, value)]}; without values, those of points that failed."""
    found = {}
    for row in rows:
        if row["status"] == "done" and row[column]:
            name = f"{row['profile']}, {row['size']}"
            found.setdefault(name, []).append((kibibytes(row["platform.cluster.l1.size"]), float(row[column])))
    return {name: sorted(points) for name, points in found.items()}


def step_of(top):
    """A round distance of lines, of which there are three to six."""
    power = 10.0 ** math.floor(math.log10(top / 3))
    return next(power * m for m in (1, 2, 5, 10) if top / (power * m) <= 6)


def panel(x, title, lines, sizes):
    """From 0 up, so that heights compare."""
    step = step_of(max(v for points in lines.values() for _, v in points))
    top = step * math.ceil(max(v for points in lines.values() for _, v in points) / step)
    low, high = math.log2(min(sizes)), math.log2(max(sizes))
    place_x = lambda kib: x + (math.log2(kib) - low) / (high - low) * WIDTH
    place_y = lambda value: TOP + HEIGHT * (1 - value / top)
    out = [f'<text x="{x}" y="{TOP - 12}" class="title">{title}</text>']
    for k in range(int(round(top / step)) + 1):
        y = place_y(k * step)
        out.append(f'<path d="M{x} {y:.1f}h{WIDTH}" class="rule"/>'
                   f'<text x="{x - 6}" y="{y + 4:.1f}" text-anchor="end">{k * step:g}</text>')
    for kib in sizes:
        out.append(f'<text x="{place_x(kib):.1f}" y="{TOP + HEIGHT + 16}" text-anchor="middle">{kib:g}</text>')
    for (name, points), colour in zip(lines.items(), COLOURS):
        path = "L".join(f"{place_x(kib):.1f} {place_y(value):.1f}" for kib, value in points)
        out.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="2"><title>{name}</title></path>')
        out += [f'<circle cx="{place_x(kib):.1f}" cy="{place_y(value):.1f}" r="2.5" fill="{colour}"/>'
                for kib, value in points]
    return out


def picture(rows):
    sizes = sorted({kibibytes(row["platform.cluster.l1.size"]) for row in rows})
    names = list(curves(rows, PANELS[0][1]))
    width = LEFT + len(PANELS) * (WIDTH + GAP) - GAP + 16
    height = TOP + HEIGHT + 66
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">',
           "<style>text{font:12px sans-serif;fill:#333}.title{font-weight:bold}.rule{stroke:#ddd;fill:none}</style>",
           f'<rect width="{width}" height="{height}" fill="#fff"/>']
    for i, (title, column) in enumerate(PANELS):
        out += panel(LEFT + i * (WIDTH + GAP), title, curves(rows, column), sizes)
    y = TOP + HEIGHT + 50
    out.append(f'<text x="{LEFT}" y="{TOP + HEIGHT + 32}">L1, KiB</text>')
    for i, name in enumerate(names):
        x = LEFT + i * 170
        out.append(f'<path d="M{x} {y - 4}h24" stroke="{COLOURS[i]}" stroke-width="2"/>'
                   f'<text x="{x + 30}" y="{y}">{name}</text>')
    return "\n".join(out + ["</svg>", ""])


def main():
    with open(sys.argv[1], newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    sys.stdout.write(picture(rows))


if __name__ == "__main__":
    main()
