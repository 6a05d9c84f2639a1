"""Interactive pages against the command: the engine in WebAssembly, in headless Chromium, gives every
statistic of 50 settings as `leviosim replay` does, bit for bit, and the page answers with them.

    page_test.py LEVIOSIM        exit status 77 where the engine or the browser is missing
"""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from browser import BROWSER, Page

LEVIOSIM = ""
DATA = os.path.join(os.path.dirname(__file__), "../../../shared/data")
# Two or three values of each resource, pairs of them, and accelerators; cores are as recorded.
SINGLE = {
    "cluster.fpu.units": ["1", "2", "8"], "cluster.fpu.dividers": ["2", "4"],
    "cluster.fpu.mapping": ["dynamic"], "cluster.fpu.int64_units": ["1"],
    "cluster.l1.banks": ["4", "8", "32"], "cluster.l1.size": ["160KiB", "256KiB"],
    "cluster.icache.size": ["0B", "256B", "1KiB", "4KiB"],
    "cluster.icache.shared_size": ["1KiB", "8KiB", "64KiB"],
    "cluster.icache.shared_miss": ["12", "24"], "cluster.icache.refill_width": ["4", "16"],
    "cluster.icache.refills": ["1", "8"], "cluster.icache.master_size": ["512B"],
    "cluster.dma.bytes_per_cycle": ["4", "32"], "cluster.dma.first_data": ["30"],
    "cluster.events.offload": ["1500"], "cluster.events.barrier": ["12"],
    "cluster.events.fork_master": ["40"], "cluster.l1.stream_conflicts": ["0"],
    "cluster.fpu.collisions": ["0"], "isa.ops.load_l2.stall": ["7"],
    "cluster.clock": ["100MHz", "240MHz", "333MHz"], "controller.clock": ["50MHz", "123MHz"],
    "controller.icache.size": ["4KiB"], "l2.size": ["2MiB"], "isa.ops.popcount.issue": ["4"],
    "energy.core.instruction": ["7pJ"],
}
TOGETHER = [
    ["cluster.clock=240MHz", "controller.clock=240MHz", "supply.voltage=0.65V"],
    ["cluster.fpu.units=1", "cluster.fpu.dividers=4"],
    ["cluster.icache.shared_size=8KiB", "cluster.icache.size=1KiB", "cluster.clock=200MHz"],
    ["cluster.l1.banks=8", "cluster.dma.bytes_per_cycle=4"],
    ["cluster.fpu.units=8", "cluster.l1.banks=64", "cluster.icache.shared_size=16KiB",
     "cluster.icache.refill_width=32", "controller.clock=185MHz"],
]
WANTED = 50


def program(*words, status=0):
    done = subprocess.run([LEVIOSIM, *words], capture_output=True, text=True)
    if done.returncode != status:
        raise AssertionError(f"{words}: {done.stderr}")
    return done


def is_band(name):
    """Of a time: the page leaves bands of times out. Those of energy and area it has."""
    return name.endswith((".low", ".high")) and not name.startswith(("energy.", "area."))


def canvas(title):
    return f"document.querySelector('canvas[aria-label^=\"{title}\"]')"


def chart(title):
    return f"Chart.getChart({canvas(title)})"


def click(title, dataset, index):
    """Statements that click on an element of a chart."""
    return f"""const where = {canvas(title)}, at = where.getBoundingClientRect();
        const {{x, y}} = {chart(title)}.getDatasetMeta({dataset}).data[{index}];
        where.dispatchEvent(new MouseEvent('click', {{bubbles: true, clientX: at.left + x,
                                                     clientY: at.top + y}}));"""


def column(file, name):
    with open(file, encoding="utf-8") as text:
        return [row[name] for row in csv.DictReader(text)]


class InteractivePage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.runs = {}
        for profile, seconds in (("next", "3"), ("levio", "1")):
            data = cls.path("flight-" + profile)
            program("synth", "--out", data, "--duration", seconds)
            program("run", "--profile", profile, "--data", data, "--record", "--quiet",
                    "--out", cls.path(profile), *(["--film"] if profile == "next" else []))
            program("report", cls.path(profile), "--interactive", "-o", cls.page(profile))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    @classmethod
    def page(cls, name):
        return cls.path(name + ".html")

    def opened(self, profile, fragment="", **look):
        page = Page(f"file://{self.page(profile)}#{fragment}", **look)
        self.addCleanup(page.__exit__)
        page.wait("document.body.dataset.ready")
        return page

    def settings(self, page):
        lists = [[f"{path}={value}"] for path, values in SINGLE.items() for value in values]
        lists += TOGETHER + [one["settings"] for one in page.run("window.page.data.switches")]
        return lists

    def compare(self, page, profile, lines):
        script = f"""(() => {{ const e = window.page.engine; e.set({json.dumps(lines)});
                     const all = e.flight(true).statistics, some = e.flight().statistics;
                     return {{all, some}}; }})()"""
        seen = page.run(script)
        overrides = [word for line in lines for word in ("-p", line)]
        out = self.path("replayed")
        program("replay", self.path(profile), *overrides, "--out", out, "--force", "--quiet")
        with open(os.path.join(out, "run.json"), encoding="utf-8") as file:
            expected = {name: value[0] for name, value in json.load(file)["statistics"].items()
                        if not is_band(name)}
        for name, value in expected.items():
            self.assertIn(name, seen["all"], lines)
            # Both print the shortest decimal that reads back as the number: equal numbers, equal bytes.
            self.assertEqual(seen["all"][name], value, f"{name} with {lines}")
        self.assertEqual(set(seen["all"]), set(expected))
        for name, value in seen["some"].items():
            if "single" not in name:
                self.assertEqual(value, expected[name], f"{name} with {lines}")

    def test_statistics_equal_the_command_for_fifty_settings(self):
        page = self.opened("next")
        settings = self.settings(page)
        self.assertGreaterEqual(len(settings), WANTED)
        for lines in settings:
            self.compare(page, "next", lines)
        page = self.opened("levio")
        for lines in settings[::10]:
            self.compare(page, "levio", lines)

    def test_what_cannot_run_is_refused_in_the_words_of_the_command(self):
        page = self.opened("next")
        for line in ("cluster.fpu.unit=2", "cluster.l1.banks=3", "cluster.workers=4",
                     "cluster.clock=9GHz", "supply.voltage=0.7V", "cluster.fpu.units=2parrots"):
            words = page.run(f"""(() => {{ try {{ window.page.engine.set([{json.dumps(line)}]); }}
                             catch (error) {{ return error.message; }} return ''; }})()""")
            refused = program("replay", self.path("next"), "-p", line, "--out", self.path("none"),
                              status=2).stderr
            self.assertTrue(words, line)
            # Names of files differ.
            self.assertIn(words.replace("the recording", "").split(":")[-1].strip()[:40], refused)
        # And the engine goes on.
        self.compare(page, "next", ["cluster.fpu.units=2"])

    def test_work_that_does_not_fit_is_refused_with_its_stage(self):
        page = self.opened("next")
        failure = page.run("""(() => { const e = window.page.engine; e.set(['cluster.l1.size=32KiB']);
            try { e.flight(); } catch (error) { return error.message; } return ''; })()""")
        self.assertIn("bytes of L1", failure)
        self.assertIn("bytes of L1", page.run(
            "window.page.knobs.nodes.map((n) => n.textContent).join(), "
            "[...document.querySelectorAll('.marks i.cannot')].map((i) => i.title).join()"))
        self.compare(page, "next", [])

    def test_a_faster_camera_moves_the_deadline_alone(self):
        page = self.opened("next")
        counts = page.run("""(() => { const e = window.page.engine;
            const at = (lines) => { e.set(lines); return e.flight().statistics; };
            return [at([]), at(['fps=200']), at([`fps=${1e9 / window.page.data.period_ns}`])]; })()""")
        recorded, fast, same = counts
        self.assertEqual(recorded, same)
        self.assertEqual(fast["run.frame_period"], 5_000_000)
        self.assertEqual(fast["frame.cycles.parallel.mean"], recorded["frame.cycles.parallel.mean"])
        # Instants are whole nanoseconds, at other places of the time line.
        self.assertLess(abs(fast["frame.time.mean"] - recorded["frame.time.mean"]), 1)
        self.assertGreater(fast["frames.waited"], recorded["frames.waited"])

    def test_the_address_keeps_the_setting_and_the_command_repeats_it(self):
        page = self.opened("next", "cluster.fpu.units=2&cluster.l1.banks=8&frame=7")
        self.assertEqual(page.run("window.page.setting.lines()"),
                         ["cluster.fpu.units=2", "cluster.l1.banks=8"])
        self.assertIn("frame=7", page.run("location.hash"))
        command = page.run("window.page.setting.command()").split()
        self.assertEqual(command[:2], ["leviosim", "whatif"])
        rows = json.loads(program(*command[1:], "--json", "--quiet").stdout)
        self.assertIn("cluster.fpu.units=2", json.dumps(rows))
        shown = page.run("document.querySelector('.tiles').textContent")
        mean = page.run("window.page.now.statistics['frame.time.mean']")
        self.assertIn(f"{mean / 1e6:.4g}", shown)

    def test_a_setting_that_cannot_run_says_so_and_the_page_goes_on(self):
        page = self.opened("next", "cluster.l1.size=16KiB")
        self.assertIn("Cannot run", page.run("document.querySelector('[role=alert]').textContent"))
        self.assertEqual(page.complaints, [])
        page.run("delete document.body.dataset.ready; window.page.back()")
        page.wait("document.body.dataset.ready")
        self.assertEqual(page.run("document.querySelector('[role=alert]').textContent"), "")

    def test_moving_a_slider_by_the_keyboard_changes_the_answer(self):
        page = self.opened("next")
        before = page.run("document.querySelector('.tiles').textContent")
        page.run("delete document.body.dataset.ready; document.getElementById('knob-0').focus()")
        page.press("Home", number=36)
        page.wait("document.body.dataset.ready")
        after = page.run("document.querySelector('.tiles').textContent")
        self.assertNotEqual(before, after)
        self.assertIn("cluster.clock", page.run("location.hash"))

    def test_changes_have_a_price_accelerators_as_a_whole(self):
        page = self.opened("next", "gap9-hamming=on&cluster.fpu.units=2&fps=40")
        prices = page.run("[...document.querySelectorAll('.knob strong')].map((p) => p.textContent)")
        self.assertEqual(len(prices), 3, prices)
        self.assertIn("−", prices[0])  # fewer units
        self.assertRegex(prices[2], r"\+.*mm²")
        self.assertEqual(page.run("window.page.now.statistics['run.frame_period']"), 25_000_000)
        self.assertNotIn("fps", page.run("window.page.setting.command()"))
        said = page.run("document.body.textContent")
        self.assertIn("With cluster.fpu.units=2, fps=40, units of gap9-hamming, frame", said)
        self.assertEqual(page.complaints, [])

    def test_the_smallest_chip_found_is_in_time_and_no_single_change_that_is_makes_a_smaller_one(self):
        page = self.opened("next")
        page.run("findSmallest(window.page)")
        found = page.run("({late: window.page.now.late, area: window.page.area})")
        self.assertEqual(found["late"], 0)
        self.assertIn("never late", page.run("window.page.parts.status.textContent"))
        areas = page.run("""(() => { const {engine: e, data} = window.page, areas = [];
            const period = data.period_ns;
            const lines = data.knobs.filter((knob) => knob.path !== 'fps').flatMap(
                (knob) => knob.values.map((value) => `${knob.path}=${value}`));
            for (const line of lines) {
              try {
                const area = e.set([line]).area_mm2;
                if (e.flight().statistics['frame.time.worst'] <= period) areas.push(area);
              } catch {}
            }
            return areas; })()""")
        self.assertGreater(len(areas), 10)
        self.assertLessEqual(found["area"], min(areas))
        self.assertEqual(page.complaints, [])

    def test_a_search_ends_when_somebody_moves_a_slider(self):
        page = self.opened("next")
        said = page.run("""(async () => { const search = findSmallest(window.page);
            const slider = document.getElementById('knob-4');
            slider.value = 0;
            slider.dispatchEvent(new Event('input'));
            await search;
            return window.page.parts.status.textContent; })()""")
        self.assertNotIn("smallest", said)
        self.assertEqual(len(page.run("window.page.setting.lines()")), 1)

    def test_a_click_on_the_latencies_shows_that_frame_in_time_on_both_chips(self):
        page = self.opened("levio", "cluster.fpu.units=1&frame=2")
        page.run("""(() => { delete document.body.dataset.ready;
            %s })()""" % click("Latency of each frame", 0, 9))
        page.wait("document.body.dataset.ready")
        self.assertIn("frame=9", page.run("location.hash"))
        outcomes = page.run("[window.page.bars.recorded, window.page.bars.now]")
        ends = []
        for outcome in outcomes:
            spans = [span for span in outcome["spans"] if not span["controller"]]
            self.assertEqual([span["stage"] for span in spans],
                             [span["stage"] for span in outcomes[0]["spans"] if not span["controller"]])
            for before, after in zip(spans, spans[1:]):
                self.assertLessEqual(before["end_ns"], after["begin_ns"])
            ends.append(spans[-1]["end_ns"])
            self.assertLessEqual(ends[-1], outcome["statistics"]["frame.time.mean"])
            self.assertGreater(ends[-1], 0.9 * outcome["statistics"]["frame.time.mean"])
        self.assertGreater(ends[1], ends[0])  # one FPU takes longer
        drawn = page.run(chart("The selected frame in time") + ".data.labels")
        self.assertIn("cluster, recorded", drawn)
        self.assertIn("cluster, now", drawn)

    # What all views show of the selected frame.
    FRAME = """(() => { const p = window.page, film = document.querySelector('.film canvas');
        return {set: p.setting.frame, gantt: p.bars.number, box: Number(p.parts.frame.value),
                said: Number(/^Frame (\\d+)/.exec(p.parts.seen.textContent)[1]),
                film: Number(/^Frame (\\d+)/.exec(film.getAttribute('aria-label'))[1])}; })()"""

    def test_space_plays_arrows_step_and_all_views_show_that_frame(self):
        page = self.opened("next", "frame=5")
        def shown(number):
            page.wait(f"Object.values({self.FRAME}).every((frame) => frame === {number})", 10)
        shown(5)
        page.press("ArrowRight", number=39)
        shown(6)
        page.press("ArrowLeft", number=37)
        page.press("ArrowLeft", number=37)
        shown(4)
        page.press(" ", "Space", 32)
        page.wait("window.page.setting.frame > 12", 20)
        self.assertIn("Stop", page.run("window.page.player.button.textContent"))
        page.press(" ", "Space", 32)
        stopped = page.run("window.page.setting.frame")
        page.run("new Promise((done) => setTimeout(done, 400))")
        shown(stopped)
        page.press(" ", "Space", 32)
        page.wait("!window.page.player.timer", 20)  # to the end of the flight
        shown(59)
        # The label of the deadline still has its room above the bars.
        self.assertGreaterEqual(page.run(chart("The selected frame in time") + ".chartArea.top"), 16)
        page.press(" ", "Space", 32)  # and from its begin again
        page.wait("window.page.setting.frame < 30 && window.page.setting.frame > 2", 20)
        self.assertEqual(page.complaints, [])

    def test_keys_of_sliders_stay_theirs(self):
        page = self.opened("next", "frame=5")
        page.run("document.getElementById('knob-0').focus()")
        page.press("ArrowRight", number=39)
        page.press(" ", "Space", 32)
        self.assertEqual(page.run("window.page.setting.frame"), 5)
        self.assertFalse(page.run("Boolean(window.page.player.timer)"))
        self.assertEqual(len(page.run("window.page.setting.lines()")), 1)

    def test_a_click_on_the_path_selects_the_frame_that_was_there(self):
        for profile in ("next", "levio"):  # with a film and without
            page = self.opened(profile, "frame=0")
            title = "Trajectory from above"
            estimate = page.run(chart(title) + ".data.datasets.findIndex((d) => d.label === 'estimate')")
            page.run("(() => { delete document.body.dataset.ready; %s })()" % click(title, estimate, 17))
            page.wait("document.body.dataset.ready")
            frame = page.run("window.page.setting.frame")
            x, y = page.run("""(() => { const path = window.page.data.flight.path;
                const at = path.frame.indexOf(window.page.setting.frame);
                const far = (i) => Math.hypot(path.estimate_x_m[i] - path.estimate_x_m[17],
                                              path.estimate_y_m[i] - path.estimate_y_m[17]);
                return [far(at), far(0)]; })()""")
            self.assertLess(x, 1e-3, frame)

    def test_the_film_shows_the_features_that_the_run_counted(self):
        page = self.opened("next", "frame=0")
        number = [int(n) for n in column(os.path.join(self.path("next"), "frames.csv"), "features")]
        for frame in (0, 21, 59):
            page.run(f"window.page.select({frame})")
            page.wait(f"{self.FRAME}.film === {frame}", 10)
            label = page.run("document.querySelector('.film canvas').getAttribute('aria-label')")
            self.assertEqual(sum(int(n) for n in re.findall(r"(\d+) (?:only|matched|landmark,|new)", label)),
                             number[frame], label)
        drawn = page.run("""(() => { const canvas = document.querySelector('.film canvas');
            const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
            let grey = 0, coloured = 0;
            for (let i = 0; i < data.length; i += 4)
              if (Math.abs(data[i] - data[i + 2]) < 8) ++grey; else ++coloured;
            return [grey, coloured]; })()""")
        self.assertGreater(drawn[0], 10000)
        self.assertGreater(drawn[1], 500)
        points = page.run(chart("Trajectory from above") +
                          ".data.datasets.find((d) => d.label === 'map points').data.length")
        self.assertGreater(points, 50)

    def test_without_a_truth_the_path_is_the_estimates(self):
        folder = self.path("no-truth")
        shutil.copytree(self.path("flight-levio"), folder)
        shutil.rmtree(os.path.join(folder, "mav0", "state_groundtruth_estimate0"))
        program("run", "--profile", "levio", "--data", folder, "--record", "--quiet", "--out",
                self.path("blind"))
        program("report", self.path("blind"), "--interactive", "-o", self.page("blind"))
        page = self.opened("blind", "frame=3")
        labels = page.run(chart("Trajectory from above") + ".data.datasets.map((d) => d.label)")
        self.assertNotIn("here, truth", labels)
        page.press(" ", "Space", 32)
        page.wait("window.page.setting.frame === 19", 20)
        self.assertEqual(page.complaints, [])

    def test_a_run_without_poses_has_a_page_that_plays(self):
        folder = self.path("no-poses")
        shutil.copytree(self.path("levio"), folder)
        for name in (".leviosim-files", "errors.csv"):
            os.remove(os.path.join(folder, name))
        with open(os.path.join(folder, "trajectory.tum"), "w", encoding="utf-8") as file:
            file.write("# timestamp tx ty tz qx qy qz qw\n")
        program("report", folder, "--interactive", "-o", self.page("no-poses"))
        page = self.opened("no-poses", "frame=3")
        self.assertIsNone(page.run(canvas("Trajectory from above")))
        page.press("ArrowRight", number=39)
        page.wait("window.page.setting.frame === 4", 10)
        self.assertEqual(page.complaints, [])

    def test_what_is_no_film_of_the_run_is_refused_in_a_line(self):
        def refused(folder):
            words = program("report", folder, "--interactive", "-o", self.path("none.html"),
                            status=2).stderr
            self.assertEqual(words.strip().count("\n"), 0, words)
            self.assertIn("flight.film", words)
            return words
        folder = self.path("hostile")
        shutil.copytree(self.path("next"), folder)
        film = os.path.join(folder, "flight.film")
        with open(film, "rb") as file:
            whole = file.read()
        for bytes_ in (whole[:-7], b"", b"LEVIOFM\n" + whole[8:3000], os.urandom(1000)):
            with open(film, "wb") as file:
                file.write(bytes_)
            refused(folder)
        with open(film, "wb") as file:  # whole sections, too few
            file.write(whole[:16] + whole[16:16 + 12 + int.from_bytes(whole[16:20], "little")])
        self.assertIn("has 1 frames; expected 60", refused(folder))
        self.assertFalse(os.path.exists(self.path("none.html")))

    def test_other_numbers_of_cores_are_told_with_the_command(self):
        page = self.opened("next")
        slider = "[...document.querySelectorAll('.knob')].find((k) => k.textContent.includes('cluster.workers'))"
        self.assertTrue(page.run(f"{slider}.querySelector('input').disabled"))
        words = page.run(f"[...{slider}.querySelectorAll('code')].at(-1).textContent").split()
        self.assertEqual(words[:3], ["leviosim", "whatif", self.path("next")])
        self.assertEqual(words[3], "cluster.workers=1,2,4,16,32,64")

    def test_twenty_values_of_a_slider_are_timed_while_it_moves(self):
        page = self.opened("levio")
        seconds = page.run("""(() => { const slider = document.getElementById('knob-0');
            const began = performance.now();
            for (let i = 0; i < 20; ++i) {
              slider.value = i;
              slider.dispatchEvent(new Event('input'));
            }
            return (performance.now() - began) / 1e3; })()""")
        self.assertEqual(page.run("window.page.setting.at[0]"), 19)
        print(f"{20 / seconds:.0f} updates a second of levio's selected frame", file=sys.stderr)

    def test_pages_of_a_real_flight_have_their_sizes(self):
        data = os.path.join(os.environ.get("LEVIOSIM_DATA", DATA), "euroc", "MH_01_easy_t05_t20")
        if not os.path.isdir(data):
            self.skipTest(f"{data} is not there")
        for profile, most in (("next", 2.5e6), ("levio", 9e6)):
            sizes = []
            for film in ([], ["--film"]):
                run = self.path(f"real-{profile}{len(film)}")
                program("run", "--profile", profile, "--data", data, "--record", *film, "--quiet",
                        "--out", run)
                program("report", run, "--interactive", "-o", self.page(run))
                sizes.append(os.path.getsize(self.page(run)))
            print(f"{profile}: {sizes[0] / 1e6:.2f} MB, film {(sizes[1] - sizes[0]) / 1e6:.2f} MB",
                  file=sys.stderr)
            self.assertLessEqual(sizes[0], most)
            self.assertLessEqual(sizes[1] - sizes[0], 1.5e6)

    def test_it_is_drawn_without_errors_requests_or_overflow(self):
        for width in (1280, 390):
            for dark in (False, True):
                with self.subTest(width=width, dark=dark):
                    page = self.opened("levio", "cluster.fpu.units=1", width=width, dark=dark)
                    self.assertEqual(page.complaints, [])
                    self.assertLessEqual(page.run("document.documentElement.scrollWidth"), width)
                    self.assertEqual(page.run("document.querySelectorAll('canvas').length"), 4)
                    self.assertEqual(page.run("document.querySelectorAll('.verdict').length"), 1)
                    ink = page.run("getComputedStyle(document.documentElement).getPropertyValue('--ink').trim()")
                    self.assertEqual(ink, "#e4e9ef" if dark else "#1b2430")


if __name__ == "__main__":
    LEVIOSIM = sys.argv.pop(1)
    if not os.path.exists(BROWSER):
        print(f"skipped: {BROWSER} is not installed (package chromium)")
        sys.exit(77)
    asked = subprocess.run([LEVIOSIM, "report", "none", "--interactive", "-o", "none.html"],
                           capture_output=True, text=True)
    if "built without the engine" in asked.stderr:
        print("skipped: " + asked.stderr.strip())
        sys.exit(77)
    unittest.main()
