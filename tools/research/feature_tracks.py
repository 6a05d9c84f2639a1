"""Features followed from frame to frame, and how they agree with true poses: corners, patches that must agree, points
where the true rays meet. Images are arrays (height, width) of grey levels; pixels are (x, y), whole numbers at their
centres."""

import collections

import numpy as np

OUTLIER_PX = 2.0
PATCH = np.stack(np.meshgrid(np.arange(-4, 5), np.arange(-4, 5)), -1).reshape(-1, 2)  # offsets x, y of 9x9 px
BORDER, SEARCH_PX, ELSEWHERE_PX = 7, 16.0, 8.0
RESEMBLING, AGREEING = 0.7, 0.9  # correlations of patches: a pixel apart at most, and aligned
LEAST_PARALLAX, NEAREST_M = np.radians(1), 0.05


def sample(image, x, y):
    """Between pixels, bilinear; beyond the border the border's."""
    x, y = np.clip(x, 0, image.shape[1] - 1.001), np.clip(y, 0, image.shape[0] - 1.001)
    i, j = x.astype(int), y.astype(int)
    a, b = x - i, y - j
    top = (1 - a) * image[j, i] + a * image[j, i + 1]
    return (1 - b) * top + b * ((1 - a) * image[j + 1, i] + a * image[j + 1, i + 1])


Features = collections.namedtuple("Features", "pixels strength roundness edge patches")


def window_mean(image, radius):
    padded = np.pad(image, radius, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, (2 * radius + 1,) * 2).mean((2, 3))


def patches_at(image, pixels):
    """Without mean, and of length 1: their products are correlations. (n, 81)"""
    patch = sample(image, *(pixels[:, None, :] + PATCH).transpose(2, 0, 1))
    patch -= patch.mean(1, keepdims=True)
    return patch / np.maximum(np.linalg.norm(patch, axis=1, keepdims=True), 1e-9)


def find_features(image):
    """Corners: where the smaller eigenvalue of gradients in 7x7 px (Shi and Tomasi 1994) is the largest within 3x3."""
    gy, gx = np.gradient(image)
    xx, xy, yy = (window_mean(product, 3) for product in (gx * gx, gx * gy, gy * gy))
    half, mean = np.hypot((xx - yy) / 2, xy), (xx + yy) / 2
    small = np.maximum(mean - half, 0)
    largest = np.lib.stride_tricks.sliding_window_view(np.pad(small, 1), (3, 3)).max((2, 3))
    found = (small >= 4) & (small == largest)  # 2 grey/px
    found[:BORDER], found[-BORDER:], found[:, :BORDER], found[:, -BORDER:] = (False,) * 4
    y, x = np.nonzero(found)
    across = 0.5 * np.arctan2(2 * xy, xx - yy)[y, x]
    pixels = np.stack([x, y], 1).astype(float)
    return Features(pixels, np.sqrt(small[y, x]), small[y, x] / (mean + half)[y, x],
                    np.stack([-np.sin(across), np.cos(across)], 1), patches_at(image, pixels))


def share_alike(features):
    """Of the features: how many have one elsewhere in the picture that looks alike."""
    far = np.linalg.norm(features.pixels[:, None] - features.pixels, axis=2) > ELSEWHERE_PX
    return (far & (features.patches @ features.patches.T > AGREEING)).any(1).mean() if len(far) else np.nan


def match(before, now):
    """Pairs of features that are each other's most alike within SEARCH_PX: indices into both."""
    if len(before.pixels) == 0 or len(now.pixels) == 0:
        return np.zeros((0, 2), int)
    near = np.linalg.norm(before.pixels[:, None] - now.pixels, axis=2) <= SEARCH_PX
    alike = np.where(near, before.patches @ now.patches.T, -1)
    best = alike.argmax(1)
    mutual = (alike.argmax(0)[best] == np.arange(len(best))) & (alike.max(1) > RESEMBLING)
    return np.stack([np.nonzero(mutual)[0], best[mutual]], 1)


def align(old, new, start, guess):
    """Where the patches of `old` at `start` lie in `new`, near `guess` (Lucas and Kanade 1981), and which agree."""
    at, wanted = guess.copy(), sample(old, *(start[:, None, :] + PATCH).transpose(2, 0, 1))
    wanted -= wanted.mean(1, keepdims=True)
    for _ in range(6):
        x, y = (at[:, None, :] + PATCH).transpose(2, 0, 1)
        seen = sample(new, x, y)
        slope = np.stack([sample(new, x + 0.5 * i, y + 0.5 * (1 - i)) - sample(new, x - 0.5 * i, y - 0.5 * (1 - i))
                          for i in (1, 0)], 2)
        slope -= slope.mean(1, keepdims=True)  # the patch's mean moves with it
        rest = wanted - (seen - seen.mean(1, keepdims=True))
        normal = slope.swapaxes(1, 2) @ slope + 1e-6 * np.eye(2)
        at += np.clip(np.linalg.solve(normal, slope.swapaxes(1, 2) @ rest[..., None])[..., 0], -1, 1)
    correlation = (patches_at(old, start) * patches_at(new, at)).sum(1)
    return at, (correlation > AGREEING) & (np.abs(at - guess) < 2).all(1)


class Tracker:
    """Takes pictures one after the other. `tracks`: lists of (frame, pixel, unit vector along the edge)."""

    def __init__(self):
        self.tracks, self.frames, self.last = [], 0, None

    def add(self, image):
        """The figures of its features."""
        now = find_features(image)
        track_of = np.full(len(now.pixels), -1)
        figures = {"features": len(now.pixels), "features like another one": 100 * share_alike(now),
                   "corner strength": now.strength, "roundness of corners": now.roundness}
        if self.last is not None:
            old_image, old, old_tracks = self.last
            pairs = match(old, now)
            at, agree = align(old_image, image, old.pixels[pairs[:, 0]], now.pixels[pairs[:, 1]])
            pairs = pairs[agree]
            now.pixels[pairs[:, 1]], track_of[pairs[:, 1]] = at[agree], old_tracks[pairs[:, 0]]
            figures["matches with the last frame"] = len(pairs)
        fresh = track_of < 0
        track_of[fresh] = len(self.tracks) + np.arange(fresh.sum())
        self.tracks += [[] for _ in range(fresh.sum())]
        for i, track in enumerate(track_of):
            self.tracks[track].append((self.frames, now.pixels[i], now.edge[i]))
        self.last, self.frames = (image, now, track_of), self.frames + 1
        return figures


def triangulate(pixels, poses, camera):
    """The points of tracks of n observations each, by robust least squares: direction (a, b, 1) and inverse depth in
    the first camera. Returns errors (tracks, n, 2) [px], NaN where no point lies in front of all cameras; and depths
    (tracks, n) [m], NaN where the rays meet at less than a degree, or nearer than lenses are sharp."""
    t_here_first = np.linalg.inv(poses) @ poses[:, :1]
    turn, move = t_here_first[..., :3, :3], t_here_first[..., :3, 3]
    of_point = np.concatenate([turn[..., :2], move[..., None]], -1)
    focal, centre = np.array(camera[:2]), np.array(camera[2:])

    def errors(point):
        d = (of_point @ point[:, None, :, None])[..., 0] + turn[..., 2]  # times depth over the first depth
        z = np.where(d[..., 2] > 0.01, d[..., 2], np.nan)
        return pixels - (focal * d[..., :2] / z[..., None] + centre), d, z

    best, least = None, np.full(len(pixels), np.inf)
    for inverse_depth in (0.02, 0.2, 2.0):
        point = np.concatenate([(pixels[:, 0] - centre) / focal, np.full((len(pixels), 1), inverse_depth)], 1)
        best = point.copy() if best is None else best
        for _ in range(15):  # of Gauss and Newton
            error, d, z = errors(point)
            slope = of_point[..., :2, :] - (d[..., :2] / z[..., None])[..., None] * of_point[..., 2:, :]
            jacobian = focal[:, None] * slope / z[..., None, None]
            weight = 1 / (1 + (error**2).sum(-1))
            a = np.einsum("tn,tnki,tnkj->tij", weight, jacobian, jacobian) + 1e-9 * np.eye(3)
            step = np.linalg.solve(a, np.einsum("tn,tnki,tnk->ti", weight, jacobian, error)[..., None])[..., 0]
            point += np.nan_to_num(step)
        cost = np.log1p((errors(point)[0] ** 2).sum(-1)).sum(1)  # NaN behind a camera, which is no better
        best[cost < least], least = point[cost < least], np.fmin(cost, least)
    error, d, z = errors(best)
    rays = (turn.swapaxes(-1, -2) @ (d / np.linalg.norm(d, axis=-1, keepdims=True))[..., None])[..., 0]
    parallax = np.arccos(np.clip((rays * rays[:, :1]).sum(-1), -1, 1)).max(1)
    error[~np.isfinite(least)] = np.nan
    meets = np.isfinite(least) & (best[:, 2] > 0) & (best[:, 2] < 1 / NEAREST_M) & (parallax >= LEAST_PARALLAX)
    return error, d[..., 2] / np.where(meets, best[:, 2], np.nan)[:, None]


def geometry_figures(tracks, poses, camera):
    known = np.isfinite(poses[:, 0, 0])
    by_length = collections.defaultdict(list)
    for track in tracks:
        by_length[len(seen := [one for one in track if known[one[0]]])].append(seen)
    parts = []  # frame, error, along, across, depth of each observation
    for length in sorted(n for n in by_length if n >= 4):  # fewer observations fit whatever was seen
        frame, pixels, edge = (np.array([[one[i] for one in track] for track in by_length[length]]) for i in range(3))
        error, depth = triangulate(pixels, poses[frame], camera)
        along = (error * edge).sum(-1)
        size = np.linalg.norm(error, axis=-1)
        across = np.sqrt(np.maximum(size**2 - along**2, 0))
        parts.append(np.stack([frame, size, np.abs(along), across, depth], -1).reshape(-1, 5))
    table = np.concatenate(parts) if parts else np.zeros((0, 5))
    table = table[np.isfinite(table[:, 1])]
    names = "error against true poses", "... along the edge", "... across the edge", "depth"
    figures = dict(zip(names, table[:, 1:].T))
    of_frames = [table[table[:, 0] == frame] for frame in range(len(poses))]
    figures["outliers"] = [100 * (one[:, 1] > OUTLIER_PX).mean() for one in of_frames if len(one) >= 10]
    depths = [one[np.isfinite(one[:, 4]), 4] for one in of_frames]
    figures["depth, far over near"] = [np.quantile(d, 0.9) / np.quantile(d, 0.1) for d in depths if len(d) >= 10]
    return figures
