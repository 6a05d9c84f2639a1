"""tools/research/image_statistics.py where what it should print is known: pictures with noise, blur and light that were
put into them, points at known depths, and a drawn flight. Run by ctest with the program and the sources; skipped (exit
status 77) where a package of Python is missing."""

import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCES = (pathlib.Path(word).absolute() for word in sys.argv[1:3])
SCRIPT = SOURCES / "tools/research/image_statistics.py"
sys.path.insert(0, str(SCRIPT.parent))
try:
    import numpy as np
    import PIL.Image

    import feature_tracks
    import image_statistics
except ImportError as error:
    print(f"skipped: {error}; apt-get install python3-numpy python3-pil")
    sys.exit(77)

X, Y = np.meshgrid(np.arange(160), np.arange(120))


def picture(grey):
    return np.clip(np.round(np.broadcast_to(grey, X.shape)), 0, 255)


class Pictures(unittest.TestCase):
    def test_noise_beside_texture(self):
        checker = 60 * ((X < 80) & ((X // 3 + Y // 3) % 2 == 0))  # in the left half; what is left is smooth
        for noise in (2.0, 6.0):
            grey = 100 + 0.3 * Y + checker + noise * np.random.default_rng(1).normal(size=X.shape)
            self.assertAlmostEqual(image_statistics.noise_level(picture(grey)), noise, delta=0.2 * noise)

    def test_width_of_blurred_edges(self):
        for sigma in (0.6, 0.9, 1.2):  # edges 20 px apart
            bright = np.array([0.5 * math.erfc(-((x % 20) - 10.5) / (sigma * math.sqrt(2))) for x in range(160)])
            edges = picture(40 + 160 * np.where(np.arange(160) // 20 % 2 == 0, bright, 1 - bright))
            expected = 1 / math.erf(0.5 / (sigma * math.sqrt(2)))  # of the slope over one pixel
            for image in (edges, edges.T):
                self.assertAlmostEqual(image_statistics.edge_width(image), expected, delta=0.1 * expected)

    def test_light(self):
        figures = image_statistics.picture_figures(picture(np.where(X < 40, 10, np.where(X < 60, 255, 130))))
        self.assertEqual(figures["dark pixels"], 25)
        self.assertEqual(figures["glaring pixels"], 12.5)
        self.assertEqual(figures["brightness"], 0.25 * 10 + 0.125 * 255 + 0.625 * 130)

    def test_a_picture_without_anything_has_no_noise_edges_or_features(self):
        flat = picture(100)
        self.assertEqual(image_statistics.noise_level(flat), 0)
        self.assertTrue(np.isnan(image_statistics.edge_width(flat)))
        self.assertEqual(feature_tracks.Tracker().add(flat)["features"], 0)

    def test_tracks_follow_a_picture_that_moves_by_parts_of_a_pixel(self):
        rng = np.random.default_rng(1)
        waves = [(rng.uniform(-0.9, 0.9), rng.uniform(-0.9, 0.9), rng.uniform(0, 6.3)) for _ in range(20)]
        tracker, steps = feature_tracks.Tracker(), (0.0, 1.3, 2.6, 3.9)
        for step in steps:
            tracker.add(128 + sum(9 * np.cos(a * (X - step) + b * (Y + 0.5 * step) + c) for a, b, c in waves))
        whole = [track for track in tracker.tracks if len(track) == len(steps)]
        self.assertGreater(len(whole), 100)
        moves = np.array([track[-1][1] - track[0][1] for track in whole])
        np.testing.assert_allclose(np.median(moves, axis=0), [3.9, -1.95], atol=0.02)
        self.assertLess(np.quantile(np.abs(moves - [3.9, -1.95]), 0.9), 0.15)


class Geometry(unittest.TestCase):
    CAMERA = image_statistics.Camera(114.0, 114.0, 80.0, 60.0)

    def moving(self, depth):
        """A camera that moves to the right by 5 cm a frame, turns by 0.01 rad, and looks at a point: pixels, poses."""
        poses = np.tile(np.eye(4), (8, 1, 1))
        for i in range(8):
            c, s = math.cos(0.01 * i), math.sin(0.01 * i)
            poses[i, :3] = [[c, 0, s, 0.05 * i], [0, 1, 0, 0], [-s, 0, c, 0]]
        x, y, z, _ = (np.linalg.inv(poses) @ [0.1, -0.1, depth, 1]).T
        return np.stack([114 * x / z + 80, 114 * y / z + 60], 1)[None], poses[None]

    def test_depth_from_near_to_far(self):
        for depth in (0.3, 1.0, 3.0, 10.0):
            errors, depths = feature_tracks.triangulate(*self.moving(depth), self.CAMERA)
            self.assertAlmostEqual(depths[0, 0], depth, delta=1e-3 * depth)
            self.assertLess(np.abs(errors).max(), 1e-3)

    def test_far_points_have_errors_but_no_depth(self):
        errors, depths = feature_tracks.triangulate(*self.moving(200), self.CAMERA)
        self.assertTrue(np.isnan(depths).all())
        self.assertLess(np.abs(errors).max(), 1e-3)

    def test_one_wrong_observation_is_the_only_outlier(self):
        pixels, poses = self.moving(2)
        pixels[0, 5] += [3, 6]
        errors, _ = feature_tracks.triangulate(pixels, poses, self.CAMERA)
        wrong = np.linalg.norm(errors[0], axis=1) > feature_tracks.OUTLIER_PX
        self.assertEqual(np.nonzero(wrong)[0].tolist(), [5])

    def test_poses_lie_between_samples_and_end_with_them(self):
        half = math.sqrt(0.5)
        truth = np.array([[0.0, 0, 0, 0, 1, 0, 0, 0], [0.02, 2, 0, 0, -half, 0, 0, -half]])  # -q is the rotation q
        poses = image_statistics.camera_poses(truth, np.eye(4), np.array([0.0, 0.01, 0.02, 0.1]))
        self.assertAlmostEqual(poses[1, 0, 3], 1)
        self.assertAlmostEqual(math.degrees(math.atan2(poses[1, 1, 0], poses[1, 0, 0])), 45)
        self.assertTrue(np.isnan(poses[3]).all())


def run(*words):
    done = subprocess.run([sys.executable, "-B", SCRIPT, *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


class Flights(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.flight = str(pathlib.Path(cls.scratch.name) / "flight")
        words = ["synth", "--out", cls.flight, "--duration", "2", "--quiet"]
        subprocess.run([PROGRAM, *words], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_a_drawn_flight_shows_its_room(self):
        status, out, err = run(self.flight)
        self.assertEqual((status, err), (0, ""))
        rows = {line[:28].strip(): line[36:].split() for line in out.splitlines()}
        tenth, _, ninth_tenth = map(float, rows["depth"])  # the path keeps to the middle of a room of 8 x 6 x 4 m
        self.assertGreater(tenth, 0.8)
        self.assertLess(ninth_tenth, 8)
        self.assertLess(float(rows["error against true poses"][1]), 0.1)
        self.assertGreater(float(rows["matches with the last frame"][1]), 100)
        self.assertTrue(1 < float(rows["noise"][1]) < 2.5, "2 grey levels, which undistortion averages")

    def test_a_flight_without_true_poses_has_the_figures_of_its_pictures(self):
        (truth,) = pathlib.Path(self.flight).rglob("state_groundtruth_estimate0/data.csv")
        text = truth.read_text()
        truth.unlink()
        status, out, err = run(self.flight, self.flight, "--frames", "0:3")
        truth.write_text(text)
        self.assertEqual((status, err), (0, ""))
        rows = {line[:28].strip(): line[36:].split() for line in out.splitlines()}
        self.assertEqual(rows["depth"], ["-"] * 7)
        self.assertEqual(rows["brightness"][-1], "1.00")
        self.assertIn("in short: all medians agree within a quarter", out)

    def test_errors_are_one_line(self):
        for words, part in (([], "DIR"), (["nowhere"], "nowhere: no folder cam0"),
                            ([self.flight, "--size", "9"], "--size '9'"),
                            ([self.flight, "--size", "999x999"], "larger than the pictures"),
                            ([self.flight, "--frames", "900:901"], "no frames in 900:901")):
            status, out, err = run(*words)
            self.assertEqual((status, out), (2, ""))
            self.assertIn(part, err.splitlines()[-1])
        bad = pathlib.Path(self.scratch.name) / "bad/cam0"
        (bad / "data").mkdir(parents=True)
        (bad / "data.csv").write_text("#timestamp,filename\n1000,1.png\n")
        yaml = next(pathlib.Path(self.flight).rglob("cam0/sensor.yaml")).read_text()
        (bad / "sensor.yaml").write_text(yaml)
        (bad / "data/1.png").write_bytes(b"\x89PNG\r\n\x1a\nno picture")
        self.assertEqual(run(str(bad.parent))[0], 2)
        PIL.Image.new("L", (20, 10)).save(bad / "data/1.png")
        self.assertIn("1.png: L (20, 10); expected grey of", run(str(bad.parent))[2])
        (bad / "sensor.yaml").write_text(yaml.replace("intrinsics", "intrinsic"))
        self.assertIn("sensor.yaml: intrinsics: expected 4 numbers in brackets", run(str(bad.parent))[2])

    def test_the_former_command_names_the_script(self):
        for words in (["image-statistics", self.flight], ["help", "image-statistics"]):
            done = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            named = done.stderr.split("'")[3].split()[0]
            self.assertTrue((SOURCES / named).is_file(), done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
