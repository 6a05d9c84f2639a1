"""The Python module gives what the command gives: the same files, the same refusals. Run by ctest with the
program and the folder of the module; where the module was not built, the tests are skipped (exit status 77)."""

import contextlib
import io
import json
import os
import runpy
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
from unittest import mock

PROGRAM, MODULE, EXAMPLES = sys.argv[1:4]
BUILD = os.path.dirname(PROGRAM)
if not os.path.isdir(os.path.join(MODULE, "leviosim")):
    print(f"skipped: there is no module in {MODULE}; tools/build.sh python leviosim_python builds it")
    sys.exit(77)
sys.path.insert(0, MODULE)
import numpy as np  # noqa: E402

import leviosim  # noqa: E402

FOLDER = tempfile.TemporaryDirectory()
os.environ["XDG_CACHE_HOME"] = os.path.join(FOLDER.name, "cache")
DATA = os.path.join(FOLDER.name, "flight")


def command(*words):
    return subprocess.run([PROGRAM, *words], cwd=FOLDER.name, capture_output=True, text=True)


def setUpModule():
    assert command("synth", "--duration", "2", "--out", DATA).returncode == 0


def files_of(folder):
    found = {}
    for name in os.listdir(folder):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = file.read()
    found.pop(".leviosim-files", None)
    found.pop("manifest.json")  # names the command line and the host
    return found


class Module(unittest.TestCase):
    def assert_same_files(self, run, folder):
        own = os.path.join(FOLDER.name, "own-" + os.path.basename(folder))
        run.write(own)
        expected, found = files_of(folder), files_of(own)
        self.assertEqual(sorted(expected), sorted(found))
        for name, content in expected.items():
            if name != "work.trace":  # whose header names the program that wrote it
                self.assertEqual(content, found[name], name)

    def test_a_run_and_its_replay_leave_the_files_of_the_commands(self):
        chip = leviosim.Platform("gap9", {"cluster.fpu.units": 2})
        run = leviosim.run(chip, data=DATA, frames="0:12", record=True)
        folder = os.path.join(FOLDER.name, "run")
        done = command("run", "-p", "cluster.fpu.units=2", "--data", DATA, "--frames", "0:12", "--record", "--out", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_same_files(run, folder)
        slow = {"cluster.fpu.units": 1}
        again = os.path.join(FOLDER.name, "replay")
        done = command("replay", folder, "-p", "cluster.fpu.units=1", "--out", again)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_same_files(leviosim.replay(folder, set=slow), again)
        self.assertEqual(run.replay(set=slow)["frame.latency.p50"], leviosim.replay(folder, set=slow)["frame.latency.p50"])

    def test_a_folder_is_loaded_compared_checked_and_shown(self):
        folder = os.path.join(FOLDER.name, "loaded")
        done = command("run", "--data", DATA, "--frames", "0:12", "--record", "--out", folder, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        loaded = leviosim.load(folder)
        self.assertEqual(len(loaded.table("frames")["frame"]), 12)
        self.assertEqual(len(loaded.trajectory[0]), 12)
        slow = loaded.replay(set={"cluster.clock": "240MHz"})
        found = leviosim.compare(loaded, slow)
        self.assertEqual(found["figures"][0]["name"], "frame time, mean")
        self.assertIn("another clock +", found["why"][0]["text"])
        budget = os.path.join(FOLDER.name, "limits.yaml")
        with open(budget, "w") as file:
            file.write("budgets:\n  - limits: [L1 peak <= 1 kB, L2 peak <= 1 MB]\n")
        self.assertEqual(leviosim.check(loaded, budget)["not_met"], 1)
        self.assertEqual(leviosim.compare(folder, slow), found)
        self.assertEqual(leviosim.check(folder, budget), leviosim.check(loaded, budget))
        self.assertIn(" ms</td>".replace(" ", "<td>"), loaded._repr_html_())
        self.assertRegex(repr(loaded), r"<leviosim.Run of 12 frames, [0-9.]+ ms a frame>")
        self.assertFalse([name for name in dir(leviosim) if name.startswith("_") and not name.startswith("__")])
        self.assertNotIn("np", dir(leviosim))
        with self.assertRaisesRegex(leviosim.InputError, "expected the folder of a run"):
            leviosim.load(DATA + "-none")

    def test_plot_draws_all_frames_or_says_what_it_needs(self):
        run = leviosim.run(leviosim.Platform("gap9"), data=DATA, frames="0:4")
        pyplot = types.ModuleType("matplotlib.pyplot")
        drawn = []
        pyplot.gca = lambda: types.SimpleNamespace(plot=lambda x, y: drawn.append((x, y)), set=lambda **labels: None)
        matplotlib = types.ModuleType("matplotlib")
        matplotlib.pyplot = pyplot
        with mock.patch.dict(sys.modules, {"matplotlib": matplotlib, "matplotlib.pyplot": pyplot}):
            run.plot()
        frames, latencies = drawn[0]
        np.testing.assert_array_equal(frames, run.table("frames")["frame"])
        np.testing.assert_allclose(latencies * 1e6, run.table("frames")["latency_ns"])
        with mock.patch.dict(sys.modules, {"matplotlib": None}):
            with self.assertRaisesRegex(leviosim.InputError, "apt-get install python3-matplotlib"):
                run.plot()

    def test_tune_finds_the_lowest_clock_that_meets_the_limits(self):
        rows, lowest = leviosim.tune(leviosim.Platform("gap9"), ["370MHz", "50MHz"], fps=20, data=DATA, ate=1)
        self.assertEqual(list(rows["clock"]), ["50MHz", "370MHz"])
        self.assertEqual(lowest, "370MHz")
        self.assertGreater(rows["missed_share"][0], 0.05)

    def test_a_native_run_leaves_the_files_of_the_command(self):
        folder = os.path.join(FOLDER.name, "native")
        done = command("run", "--native", "--profile", "next", "-p", "workload.window=6", "--data", DATA, "--out", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_same_files(leviosim.run(data=DATA, profile="next", set={"workload.window": 6}), folder)

    def test_whatif_is_the_table_of_the_command(self):
        run = leviosim.run(leviosim.Platform("gap9"), data=DATA, frames="0:8", record=True)
        table = run.whatif("cluster.fpu.units=1,8")
        self.assertEqual(list(table["variant"]), ["as it is", "cluster.fpu.units=1", "cluster.fpu.units=8"])
        self.assertGreater(table["frame_mean_ms"][1], table["frame_mean_ms"][0])

    def test_tables_are_arrays_and_statistics_say_what_they_are(self):
        run = leviosim.run(leviosim.Platform("gap9"), data=DATA, frames="0:8")
        frames = run.table("frames")
        self.assertEqual(frames["frame"].dtype, np.int64)
        self.assertEqual(list(frames["frame"]), list(range(8)))
        self.assertEqual(frames["source"].dtype.kind, "U")
        t, position, attitude = run.trajectory
        self.assertEqual((t.shape, position.shape, attitude.shape), ((8,), (8, 3), (8, 4)))
        self.assertTrue(np.allclose(np.linalg.norm(attitude, axis=1), 1))
        self.assertEqual(run.statistics["frames.count"].value, 8)
        self.assertTrue(all(s.description for s in run.statistics.values()))

    def test_platforms_are_read_and_changed(self):
        gap9 = leviosim.Platform("gap9")
        self.assertIn("gap9", leviosim.platforms())
        self.assertEqual(gap9["cluster.workers"], 8)
        self.assertEqual(gap9.with_({"cluster.workers": 4})["cluster.workers"], 4)
        self.assertEqual(gap9.parameters()["cluster.clock"]["unit"], "MHz")
        self.assertGreater(len(gap9.area()), 2)
        shown = command("platforms", "show", "gap9", "--yaml").stdout
        self.assertEqual(gap9.yaml(), shown)
        self.assertIn("next", leviosim.profiles())
        window = [p for p in leviosim.workload_parameters("next") if p["name"] == "workload.window"]
        self.assertEqual(window[0]["value"], "12")

    def test_evaluation_is_that_of_the_command(self):
        run = leviosim.run(data=DATA)
        folder = os.path.join(FOLDER.name, "evaluated")
        run.write(folder)
        found = leviosim.evaluate(folder, DATA, relative=[])
        self.assertEqual(found["accuracy.ate.rmse"].value, run["accuracy.ate.rmse"])

    def test_bad_input_is_refused_with_the_line_of_the_command(self):
        def refusal(act):
            with self.assertRaises(leviosim.InputError) as caught:
                act()
            return str(caught.exception)

        for words, act in (
            (["--platform", "gap99"], lambda: leviosim.Platform("gap99")),
            (["-p", "cluster.fpus=1"], lambda: leviosim.Platform("gap9", {"cluster.fpus": 1})),
            (["--profile", "best"], lambda: leviosim.run(leviosim.Platform("gap9"), data=DATA, profile="best")),
            (["--frames", "9:3"], lambda: leviosim.run(leviosim.Platform("gap9"), data=DATA, frames="9:3")),
        ):
            refused = command("run", "--data", DATA, "--out", "refused", *words)
            self.assertEqual(refused.returncode, 2)
            self.assertEqual(refused.stderr.strip(), "leviosim: " + refusal(act))
        self.assertIn("record=True", refusal(lambda: leviosim.run(data=DATA, frames="0:3").replay()))
        self.assertIsInstance(leviosim.InputError("x"), ValueError)

    def test_progress_is_told_and_may_end_the_run(self):
        seen = []
        leviosim.run(data=DATA, frames="0:5", progress=lambda done, total: seen.append((done, total)))
        self.assertEqual(seen, [(k, 5) for k in range(1, 6)])

        def stop(done, total):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            leviosim.run(data=DATA, progress=stop)

    def test_other_threads_of_the_interpreter_run_meanwhile(self):
        ticks = []
        done = threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(1)
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        before = len(ticks)
        leviosim.run(leviosim.Platform("gap9"), data=DATA, frames="0:10")
        during = len(ticks) - before
        done.set()
        thread.join()
        self.assertGreater(during, 5)

    def test_ctrl_c_ends_a_run(self):
        def interrupt(done, total):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            leviosim.run(data=DATA, progress=interrupt)

    def example(self, name):
        """Runs a notebook in this process. @returns its variables, and what it printed"""
        words, sys.argv, here = sys.argv, [name, DATA], os.getcwd()
        os.chdir(FOLDER.name)
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                found = runpy.run_path(os.path.join(EXAMPLES, name), run_name="__main__")
        finally:
            sys.argv = words
            os.chdir(here)
        return found, printed.getvalue()

    def commanded(self, *words):
        folder = os.path.join(FOLDER.name, f"commanded-{len(os.listdir(FOLDER.name))}")
        done = command(*words, "--out", folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return folder

    def test_every_notebook_is_tested(self):
        tested = {name[len("test_notebook_"):] + ".py" for name in dir(self) if name.startswith("test_notebook_")}
        self.assertEqual(tested, {name for name in os.listdir(EXAMPLES) if name.endswith(".py")})

    def test_notebook_whatif(self):
        found, printed = self.example("whatif.py")
        recorded = self.commanded("run", "--platform", "gap9", "--data", DATA, "--record")
        self.assert_same_files(found["run"], recorded)
        self.assert_same_files(found["point"], self.commanded("replay", recorded, "-p", "cluster.fpu.units=8"))
        done = command("whatif", recorded, "cluster.fpu.units=1,2,8", "cluster.l1.banks=8,32", "--json")
        for row in json.loads(done.stdout)["rows"]:
            self.assertIn(f"{row['variant']:28} {row['frame_mean_ms']:8.2f} ms\n", printed)

    def test_notebook_tuning(self):
        found, printed = self.example("tuning.py")
        clock = found["settings"]["MHz"]
        folder = self.commanded("run", "--platform", "gap9", "-p", f"cluster.clock={clock}MHz", "-p",
                                f"controller.clock={clock}MHz", "--profile", "next", "--data", DATA, "--fps", "20",
                                "--deadline", "drop")
        self.assert_same_files(found["run"], folder)
        self.assertIn(f"{clock} MHz: 0 of ", printed)

    def test_notebook_accuracy(self):
        found, printed = self.example("accuracy.py")
        folder = self.commanded("run", "--native", "--profile", "next", "--data", DATA)
        self.assert_same_files(found["run"], folder)
        self.assertIn("poses over", printed)

    def test_notebook_own_kernel(self):
        if subprocess.run(["cmake", "--install", BUILD, "--prefix", os.path.join(FOLDER.name, "installed")],
                          capture_output=True).returncode != 0:
            self.skipTest(f"{BUILD} holds no library; tools/build.sh release leviosim leviosim_library builds it")
        installed = os.path.join(FOLDER.name, "installed")
        os.environ["CMAKE_PREFIX_PATH"] = installed
        os.environ["PROJECT"] = os.path.join(installed, "share/doc/libleviosim-dev/examples/outside")
        found, printed = self.example("own_kernel.py")
        self.assert_same_files(found["run"], self.commanded("replay", "own-kernel/recorded"))
        self.assert_same_files(found["point"], self.commanded(
            "replay", "own-kernel/recorded", "-p", "cluster.l1.banks=32", "-p", "cluster.dma.bytes_per_cycle=16"))
        times = found["times"]
        self.assertGreater(times[16, 4], 1.2 * times[16, 8])  # transfers are the limit
        self.assertEqual(printed.count("\n"), 1 + 5 + 1 + 3, printed)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
