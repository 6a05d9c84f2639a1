"""tools/rv32/measure_kernels.py measures the kernel of the outside project anew, to the numbers that lie beside it, and
says what is missing where it cannot. Run by ctest with the folder of the sources; where there is no cross compiler, the
measurement is skipped (exit status 77)."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCES = pathlib.Path(sys.argv[1]).absolute()
SCRIPT = SOURCES / "tools/rv32/measure_kernels.py"
OUTSIDE = SOURCES / "tests/examples/outside"
SCENES = OUTSIDE / "exposure_scenes.h"


def measure(*words, path=None):
    environment = dict(os.environ, PATH=path) if path is not None else None
    return subprocess.run([sys.executable, SCRIPT, *words], capture_output=True, text=True, env=environment)


def table(header):
    return re.search(r'\{"rv32imfc", R"csv\((.*?)\)csv"', header.read_text(), re.DOTALL).group(1)


class Measure(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.header = pathlib.Path(self.scratch.name) / "exposure_code.h"

    def tearDown(self):
        self.scratch.cleanup()

    def refused(self, done, part):
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(part, done.stderr)
        self.assertEqual(list(pathlib.Path(self.scratch.name).iterdir()), [])

    def test_what_is_missing_is_said_in_a_line(self):
        # Files of libraries may be missing, too: they stand behind the programs.
        for part in ("missing: riscv64-unknown-elf-g++, qemu-riscv32", "; apt-get install gcc-riscv64-unknown-elf qemu-user"):
            self.refused(measure(SCENES, self.header, path="/none"), part)
        self.refused(measure(SCENES, self.header, "--isa", "thumb2", path="/none"), "apt-get install gcc-arm-none-eabi")
        self.refused(measure(SCENES, self.header, "--isa", "rv64"), "--isa rv64: expected one of rv32imfc")
        self.refused(measure(OUTSIDE / "none.h", self.header), "none.h: no such file")
        self.refused(measure(SCENES), "expected SCENES.h NAME.h")

    def test_the_kernel_of_the_outside_project_has_the_numbers_beside_it(self):
        done = measure(SCENES, self.header, "--isa", "rv32imfc")
        if "apt-get install" in done.stderr:
            self.skipTest(done.stderr.strip())
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(table(self.header), table(OUTSIDE / "exposure_code.h"))
        name, _, lines, visits, _, executed, priced, loads, *_ = table(self.header).split("\n")[2].split(",")
        self.assertEqual((name, visits, loads), ("exposure_row_sum", "40", "160.00"), "one load a pixel")
        self.assertGreater(float(executed), 4 * 160 - 1, "load, sum, counter, branch")
        self.assertLess(float(executed), 1.2 * float(priced))
        self.assertGreater(float(lines), 0)


if __name__ == "__main__":
    result = unittest.main(argv=sys.argv[:1], exit=False).result
    sys.exit(1 if not result.wasSuccessful() else 77 if result.skipped else 0)
