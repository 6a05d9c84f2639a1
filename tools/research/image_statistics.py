#!/usr/bin/env python3
"""What the pictures of recordings are like, side by side: light, noise, sharpness, corners, and how features that are
tracked from frame to frame agree with the true poses. README.md says what each quantity is.

    tools/research/image_statistics.py DIR... [--size 160x120] [--frames A:B]

Reads ASL folders (EuRoC, what `leviosim synth` draws) and prepares their pictures as a run does. The features are those
of this script, not of a profile. Left out: other formats, disturbances. Needs python3-numpy and python3-pil."""

import argparse
import collections
import csv
import pathlib
import re
import sys

try:
    import numpy as np
    from PIL import Image

    from feature_tracks import Tracker, geometry_figures, sample
except ImportError as error:
    print(f"image_statistics: {error}; apt-get install python3-numpy python3-pil", file=sys.stderr)
    sys.exit(2)

UNITS = {  # of each quantity
    "features": "number", "matches with the last frame": "number", "features like another one": "%",
    "length of the track": "frames", "error against true poses": "px", "... along the edge": "px",
    "... across the edge": "px", "outliers": "%", "depth": "m", "depth, far over near": "ratio",
    "corner strength": "grey/px", "roundness of corners": "ratio", "brightness": "grey", "contrast": "grey",
    "contrast in 8x8 px": "grey", "dark pixels": "%", "glaring pixels": "%", "noise": "grey", "width of edges": "px",
}
DARK, GLARE = 20, 250  # grey levels below and above


class InputError(Exception):
    pass


Camera = collections.namedtuple("Camera", "fx fy cx cy")  # px
# Pictures as read_picture() takes them, the camera of the prepared pictures, and its pose (world from camera, 4x4) at
# each frame, NaN if unknown.
Recording = collections.namedtuple("Recording", "name pictures camera poses")


def numbers(file, text, key, count):
    found = re.search(rf"\b{key}:[^\[]*\[([^\]]*)\]", text)
    try:
        values = [float(word) for word in found.group(1).split(",")]
        assert len(values) == count and np.isfinite(values).all()
    except (AttributeError, ValueError, AssertionError):
        raise InputError(f"{file}: {key}: expected {count} numbers in brackets") from None
    return values


def rows(file, columns):
    """Of a CSV file without its comments: the first columns, as text."""
    with open(file, newline="") as lines:
        for number, row in enumerate(csv.reader(lines), 1):
            if row and not row[0].startswith("#"):
                if len(row) < columns:
                    raise InputError(f"{file}:{number}: {len(row)} columns; expected {columns}")
                yield [word.strip() for word in row[:columns]]


def rotation(q):
    """Of quaternions (n, 4), in the order w, x, y, z."""
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    return np.moveaxis(np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                                 [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                                 [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]), 2, 0)


def camera_poses(truth, t_body_camera, times):
    """World from camera for each time, between samples by a straight line; NaN more than 20 ms from a sample."""
    poses = np.full((len(times), 4, 4), np.nan)
    if len(truth) == 0:
        return poses
    stamps = truth[:, 0]
    q = truth[:, 4:8].copy()
    q[1:] *= np.cumprod(np.where((q[1:] * q[:-1]).sum(1) < 0, -1, 1))[:, None]  # of q and -q the one near the last
    at = np.stack([np.interp(times, stamps, column) for column in (*truth[:, 1:4].T, *q.T)], 1)
    around = np.clip(np.searchsorted(stamps, times)[:, None] + [-1, 0], 0, len(truth) - 1)
    nearest = np.abs(times[:, None] - stamps[around])
    world_body = np.tile(np.eye(4), (len(times), 1, 1))
    world_body[:, :3, :3], world_body[:, :3, 3] = rotation(at[:, 3:]), at[:, :3]
    known = nearest.min(1) <= 20e-3
    poses[known] = world_body[known] @ t_body_camera
    return poses


def distorted(x, y, k):
    """Where the lens puts the point (x, y, 1): radial-tangential, as in traces/datasets/camera_model.h."""
    r2 = x * x + y * y
    radial = 1 + k[0] * r2 + k[1] * r2 * r2
    return (x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
            y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y)


def open_recording(folder, size, span):
    root = next((r for r in (folder / "mav0", folder) if (r / "cam0").is_dir()), None)
    if root is None:
        raise InputError(f"{folder}: no folder cam0 or mav0/cam0; expected an ASL folder")
    file = root / "cam0/sensor.yaml"
    text = file.read_text()
    full = [int(v) for v in numbers(file, text, "resolution", 2)]
    if "equidistant" in text:
        raise InputError(f"{file}: distortion_model: expected radial-tangential")
    k = numbers(file, text, "distortion_coefficients", 4)
    fx, fy, cx, cy = numbers(file, text, "intrinsics", 4)
    factor = min(full[0] // size[0], full[1] // size[1])
    if factor < 1:
        raise InputError(f"--size {size[0]}x{size[1]}: larger than the pictures of {file}, {full[0]}x{full[1]}")
    x0, y0 = ((full[i] - size[i] * factor) // 2 for i in range(2))
    u, v = np.meshgrid(np.arange(size[0]), np.arange(size[1]))  # every k-th pixel of the undistorted picture
    shift = int(factor > 1)
    x, y = distorted((x0 + factor * u + shift - cx) / fx, (y0 + factor * v + shift - cy) / fy, k)
    frames = list(rows(root / "cam0/data.csv", 2))[slice(*span)]
    if not frames:
        raise InputError(f"{root / 'cam0/data.csv'}: no frames" + (f" in {span[0]}:{span[1]}" if span[1] else ""))
    t0 = int(frames[0][0])  # whole nanoseconds: 1.4e18 has no exact double
    times = np.array([(int(t) - t0) * 1e-9 for t, _ in frames])
    file = root / "state_groundtruth_estimate0/data.csv"
    truth = [[(int(r[0]) - t0) * 1e-9, *map(float, r[1:])] for r in rows(file, 8)] if file.exists() else []
    t_body_camera = np.reshape(numbers(file, text, "data", 16), (4, 4))
    pictures = [(root / "cam0/data" / name, full, fx * x + cx, fy * y + cy) for _, name in frames]
    camera = Camera(fx / factor, fy / factor, (cx - x0) / factor, (cy - y0) / factor)
    return Recording(folder.name, pictures, camera, camera_poses(np.reshape(truth, (-1, 8)), t_body_camera, times))


def read_picture(file, full, x, y):
    """Undistorted and made smaller, grey levels, (height, width)."""
    try:
        with Image.open(file) as picture:
            if picture.mode != "L" or picture.size != tuple(full):
                raise InputError(f"{file}: {picture.mode} {picture.size}; expected grey of {full[0]}x{full[1]}")
            grey = np.asarray(picture, float)
    except (OSError, SyntaxError, ValueError) as error:
        raise InputError(f"{file}: {error}") from None
    inside = (x >= 0) & (y >= 0) & (x <= full[0] - 1) & (y <= full[1] - 1)
    return np.where(inside, np.round(sample(grey, x, y)), 0.0)


def squares(image):
    """All squares of 8x8 px within a border of 1 px: (n, 64)."""
    h, w = ((n - 2) // 8 * 8 for n in image.shape)
    return image[1 : 1 + h, 1 : 1 + w].reshape(h // 8, 8, w // 8, 8).swapaxes(1, 2).reshape(-1, 64)


def noise_level(image):
    """Standard deviation of white noise (Immerkaer 1996) in the smoothest tenth of the squares that are lit; or NaN."""
    d = np.zeros_like(image)  # differences to which planes give nothing; of white noise: six times its deviation
    along = image[:, :-2] - 2 * image[:, 1:-1] + image[:, 2:]
    d[1:-1, 1:-1] = along[:-2] - 2 * along[1:-1] + along[2:]
    grey = squares(image).mean(1)
    rough = np.sqrt((squares(d) ** 2).mean(1))[(grey >= DARK) & (grey <= GLARE)] / 6
    return np.quantile(rough, 0.1) if len(rough) else np.nan


def edge_widths(image):
    """Of edges across rows, 12 grey/px or more, the steepest within 5 px: slope, and width (step over slope) [px]."""
    slope = np.diff(image, axis=1)
    around = np.lib.stride_tricks.sliding_window_view(np.abs(slope), 5, axis=1)
    here = around[..., 2]
    steepest = (here >= 12) & (around[..., :2].max(-1) < here) & (around[..., 3:].max(-1) <= here)
    row, column = np.nonzero(steepest)
    column += 2
    row, column = (v[(column >= 4) & (column + 6 < image.shape[1])] for v in (row, column))
    sign = np.sign(slope[row, column])
    low, high = column.copy(), column + 1
    for step in range(4):  # as far as grey levels go on to rise, or to fall
        low -= (low == column - step) & (sign * slope[row, low - 1] > 0)
        high += (high == column + 1 + step) & (sign * slope[row, high] > 0)
    steep = np.abs(slope[row, column])
    return steep, np.abs(image[row, high] - image[row, low]) / steep


def edge_width(image):
    """The median width of the steepest twentieth of the edges across rows and columns; or NaN."""
    slope, width = (np.concatenate(pair) for pair in zip(edge_widths(image), edge_widths(image.T)))
    return np.median(width[slope >= np.quantile(slope, 0.95)]) if len(slope) else np.nan


def picture_figures(image):
    return {
        "brightness": image.mean(),
        "contrast": image.std(),
        "contrast in 8x8 px": squares(image).std(1),
        "dark pixels": 100 * (image < DARK).mean(),
        "glaring pixels": 100 * (image > GLARE).mean(),
        "noise": noise_level(image),
        "width of edges": edge_width(image),
    }


def statistics(recording):
    """For each quantity: how many values, and their quantiles 0.1, 0.5 and 0.9, NaN without values."""
    values = {name: [] for name in UNITS}
    tracker = Tracker()

    def add(figures):
        for name, value in figures.items():
            values[name].append(np.atleast_1d(np.asarray(value, float)))

    for picture in recording.pictures:
        image = read_picture(*picture)
        add(picture_figures(image))
        add(tracker.add(image))
    add(geometry_figures(tracker.tracks, recording.poses, recording.camera))
    add({"length of the track": [len(track) for track in tracker.tracks for _ in track]})
    result = {}
    for name, parts in values.items():
        all_values = np.concatenate([*parts, []])
        all_values = all_values[np.isfinite(all_values)]
        quantiles = np.quantile(all_values, (0.1, 0.5, 0.9)) if len(all_values) else [np.nan] * 3
        result[name] = (len(all_values), *quantiles)
    return result


def ratio_of(name, all_statistics):
    """Of the last median to the first; NaN where one is 0 or missing."""
    first, last = all_statistics[0][name][2], all_statistics[-1][name][2]
    return last / first if first and last else np.nan


def shown(value, pattern="{:.3g}"):
    return pattern.format(value) if np.isfinite(value) else "-"


def print_table(names, all_statistics):
    several = len(names) > 1
    print(f"{'quantity':28}{'unit':8}" + "".join(f"{name:>24}" for name in names) + ("   ratio" if several else ""))
    print(" " * 36 + f"{'10 %':>8}{'50 %':>8}{'90 %':>8}" * len(names))
    differing = []
    for name, unit in UNITS.items():
        cells = [shown(v) for one in all_statistics for v in one[name][1:]]
        if several:
            ratio = ratio_of(name, all_statistics)
            cells.append(shown(ratio, "{:.2f}"))
            if ratio > 1.25 or ratio < 1 / 1.25:
                differing.append(name)
        print(f"{name:28}{unit:8}" + "".join(f"{cell:>8}" for cell in cells))
    if several:
        print("in short: " + (f"{len(differing)} of {len(UNITS)} medians differ by more than a quarter: "
                              f"{', '.join(differing)}" if differing else "all medians agree within a quarter"))


def pair(text, separator, option):
    if not re.fullmatch(rf"\d{{1,9}}{separator}\d{{1,9}}", text):
        raise InputError(f"{option} '{text}': expected two whole numbers, such as 160{separator}120")
    return tuple(int(word) for word in text.split(separator))


def main(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("DIR", nargs="+", type=pathlib.Path, help="ASL folders; ratios are to the first one")
    parser.add_argument("--size", default="160x120", metavar="WxH", help="size of the prepared pictures [160x120]")
    parser.add_argument("--frames", metavar="A:B", help="frames A to B - 1 [all]")
    options = parser.parse_args(words)
    size = pair(options.size, "x", "--size")
    span = pair(options.frames, ":", "--frames") if options.frames else (0, None)
    if min(size) < 32:
        raise InputError(f"--size {options.size}: expected at least 32x32")
    recordings = [open_recording(folder, size, span) for folder in options.DIR]
    results = [statistics(recording) for recording in recordings]
    print_table([recording.name for recording in recordings], results)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (InputError, OSError, ValueError) as error:
        print(f"image_statistics: {error}", file=sys.stderr)
        sys.exit(2)
