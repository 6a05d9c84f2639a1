"""tools/check_counting.py finds the planted kernels that go round the counters, and nothing in the workloads. Run by ctest
with the folder of the sources; with --all, over all of the workloads instead of those files that include most kernels."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

SOURCES = pathlib.Path(sys.argv[1]).absolute()
ALL = "--all" in sys.argv
FLAGS = ["--", "-std=c++20", "-I.", "-I/usr/include/eigen3"]
TRAPS = "tests/tools/counting_traps.cpp"
KINDS = ("a view's memory", "a plain pointer", "an array that counts no load", "work::value() in an index", "index arithmetic",
         "a loop on plain numbers")
MOST = ("levio/vision/levio_extractor.cpp", "levio/geometry/epnp.cpp", "graph/anchored_landmarks.cpp",
        "vio/inertial_part.cpp", "next/loop/place_search.cpp", "vision/matcher.cpp")

if shutil.which("clang-query") is None:
    print("skipped: the program clang-query is missing; apt-get install clang-tools")
    sys.exit(77)


def check(*words, path=None):
    environment = dict(os.environ, PATH=path) if path is not None else None
    return subprocess.run([sys.executable, SOURCES / "tools/check_counting.py", *words], cwd=SOURCES, capture_output=True,
                          text=True, env=environment)


class CheckCounting(unittest.TestCase):
    def test_each_trap_is_found_and_nothing_beside_it(self):
        done = check(TRAPS, *FLAGS)
        self.assertEqual(done.returncode, 1, done.stderr)
        found = {}
        for line in done.stdout.splitlines()[:-1]:
            number, text = re.match(rf"{TRAPS}:(\d+): (.*)", line).groups()
            found.setdefault(int(number), []).append(text)
        planted = {}
        for number, line in enumerate((SOURCES / TRAPS).read_text().splitlines(), 1):
            if "; // trap: " in re.sub(r"\s+//", " //", line):
                planted[number] = line.split("// trap: ")[1]
        self.assertEqual(set(found), set(planted), done.stdout)
        for number, kind in planted.items():
            self.assertTrue(any(kind in text for text in found[number]), f"{kind} in {found[number]}")
        for kind in KINDS:
            self.assertIn(kind, planted.values())

    def test_our_own_workloads_go_round_nothing(self):
        files = [f"workload/{name}" for name in MOST]
        if ALL:
            files = sorted(str(p.relative_to(SOURCES)) for p in (SOURCES / "workload").rglob("*.cpp"))
        done = check(*files, "tests/examples/outside/exposure.h", *FLAGS, "-xc++", "-I/usr/include/opencv4")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)

    def refused(self, done, part):
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(part, done.stderr)

    def test_what_cannot_be_checked_is_refused(self):
        self.refused(check("none.cpp", *FLAGS), "none.cpp: no such file")
        self.refused(check(), "expected [-p BUILD] FILE...")
        self.refused(check("-p", "none", TRAPS), "holds no compile_commands.json")
        self.refused(check(TRAPS, "--", "-std=c++20"), "Clang cannot read it")
        self.refused(check(TRAPS, *FLAGS, path="/none"), "apt-get install clang-tools")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
