#!/usr/bin/env python3
"""Measures the compiled code of kernels of another project, as leviosim's own was measured, and writes it as a header.

usage: measure_kernels.py SCENES.h NAME.h [--isa SET,SET…] [-- FLAGS]
       measure_kernels.py src/exposure_scenes.h src/exposure_code.h

SCENES.h defines `template <class P> void scenes()`: it makes inputs, and then calls kernels while a
P::Function named "scene: …" lives. What is measured are the P::Functions within. They are counted on the host, compiled by
Debian's cross compilers, and traced under QEMU; Machines are for stages, not for scenes. NAME.h gets a function NAME() for
leviosim::Workload::code. Sets: rv32imfc, rv32imfc_xpulp, thumb2, armv6; without --isa, those for which compilers are
installed. FLAGS go to the compilers. Exit status 2, with what is missing in a line, where it cannot be measured."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

NAME = pathlib.Path(sys.argv[0]).name  # leviosim-measure, where it is installed
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LAYOUTS = ("0", "4", "8", "12")
# Instruction set → programs with their packages, and the emulator with its options (measure.sh).
RISCV = (("riscv64-unknown-elf-g++", "gcc-riscv64-unknown-elf"), ("qemu-riscv32", "qemu-user"))
ARM = (("arm-none-eabi-g++", "gcc-arm-none-eabi"), ("qemu-arm", "qemu-user"))
SETS = {
    "rv32imfc": (RISCV, ["qemu-riscv32"]),
    "rv32imfc_xpulp": (RISCV, ["qemu-riscv32"]),
    "thumb2": (ARM, ["qemu-arm", "-cpu", "cortex-a15"]),
    "armv6": (ARM, ["qemu-arm", "-cpu", "arm1176"]),
}
FILES = {
    RISCV: ("/usr/lib/picolibc/riscv64-unknown-elf/lib", "picolibc-riscv64-unknown-elf"),
    ARM: ("/usr/include/capstone/capstone.h", "libcapstone-dev"),
}


class Refused(Exception):
    pass


def missing_for(isa):
    """@returns what is missing and the packages that hold it, or nothing"""
    programs, _ = SETS[isa]
    file, package = FILES[programs]
    missing = [pair for pair in programs if shutil.which(pair[0]) is None]
    if not os.path.exists(file):
        missing.append((file, package))
    if not missing:
        return None
    names, packages = zip(*missing)
    return f"missing: {', '.join(names)}; apt-get install {' '.join(packages)}"


def chosen(named):
    if named is None:
        if missing_for("rv32imfc"):
            raise Refused(missing_for("rv32imfc"))
        for isa in filter(missing_for, SETS):
            print(f"{NAME}: without {isa}; {missing_for(isa)}", file=sys.stderr)
        return [isa for isa in SETS if not missing_for(isa)]
    for isa in named:
        if isa not in SETS:
            raise Refused(f"--isa {isa}: expected one of {', '.join(SETS)}")
        if missing_for(isa):
            raise Refused(missing_for(isa))
    if "rv32imfc" not in named:
        raise Refused("--isa: expected rv32imfc among them, from which sizes of code are taken")
    return named


def called(words, **options):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          **options)
    if done.returncode != 0:
        lines = done.stdout.strip().splitlines()
        fault = next((line for line in lines if "error" in line), lines[-1] if lines else "")
        raise Refused(f"{pathlib.Path(str(words[0])).name} failed: {fault}")
    return done.stdout


def make(variables, targets):
    called(["make", "-s", "-C", HERE, f"-j{os.cpu_count()}", *variables, *targets])


def measured(scenes, isas, flags, work):
    """@returns the rows of each instruction set's table"""
    (work / "inputs.bin").write_bytes(b"x")  # scenes of kernels make their own
    headers = [f"-I{scenes.parent}", f"-I{ROOT.parents[1]}/include/leviosim", *flags]
    common = [f"KERNELS={scenes}", f"KERNEL_FLAGS={' '.join(headers)}", f"INPUTS={work}/inputs.bin",
              f"LAYOUTS={' '.join(LAYOUTS)}"]
    make([*common, f"OUT={work}"], [work / "counts"])
    (work / "counted.tsv").write_text(called([work / "counts", work / "inputs.bin"]))
    tables = {}
    for isa in isas:
        out, plugin = work / isa, work / ("trace.so" if isa.startswith("rv32") else "trace_arm.so")
        out.mkdir()
        make([f"ISA={isa}", f"OUT={work}"], [plugin])
        programs = [f"scenes_at_{layout}" for layout in LAYOUTS] + ["scenes_uncontracted"]
        make([*common, f"ISA={isa}", f"OUT={out}"], [out / name for name in programs])
        for name in programs:
            called([*SETS[isa][1], "-plugin", f"{plugin},program={out}/{name},out={out}/{name}.tsv", out / name])
        called([sys.executable, HERE / "report.py", "--isa", isa, "--work", out, "--counts", work / "counted.tsv", "--root",
                ROOT, "--kernels", out / "table.csv", "--layouts", *LAYOUTS])
        rows = [line for line in (out / "table.csv").read_text().splitlines() if not line.startswith("#")]
        if len(rows) < 2:
            raise Refused(f"{scenes}: no P::Function ran in a scene; expected kernels with names within \"scene: …\"")
        tables[isa] = "\n".join(rows)
    return tables


HEADER = """\
// Compiled code of the kernels in {scenes}: made by leviosim-measure, not edited by hand.
#pragma once

#include <vector>

#include "platform_models/loader/compiled_code.h"

/// For leviosim::Workload::code.
inline std::vector<leviosim::platform::CodeTable> {name}() {{
  return {{
{tables}  }};
}}
"""


def measure(words):
    flags, isas = [], None
    if "--" in words:
        words, flags = words[: words.index("--")], words[words.index("--") + 1 :]
    if "--isa" in words[:-1]:
        at = words.index("--isa")
        isas, words = words[at + 1].split(","), words[:at] + words[at + 2 :]
    if len(words) != 2 or any(word.startswith("-") for word in words):
        raise Refused("expected SCENES.h NAME.h [--isa SET,SET…] [-- FLAGS]; --help says more")
    scenes, target = (pathlib.Path(word).absolute() for word in words)
    if not scenes.is_file():
        raise Refused(f"{scenes}: no such file")
    if not target.stem.isidentifier():
        raise Refused(f"{target}: expected a name that is one of C++, since a function is called as the file is")
    isas = chosen(isas)
    with tempfile.TemporaryDirectory(prefix="leviosim-measure-") as folder:
        tables = measured(scenes, isas, flags, pathlib.Path(folder))
    text = "".join(f'      {{"{isa}", R"csv(\n{rows}\n)csv"}},\n' for isa, rows in tables.items())
    partial = target.with_name(target.name + ".new")
    partial.write_text(HEADER.format(scenes=scenes.name, name=target.stem, tables=text))
    partial.replace(target)
    rows = sum(line.count("\n") for line in tables.values())
    print(f"{words[1]}: {rows} rows of {len(tables)} instruction sets: {', '.join(tables)}")


def main():
    if sys.argv[1:2] in (["--help"], ["-h"]):
        print(__doc__.replace("measure_kernels.py", NAME))
        return 0
    try:
        measure(sys.argv[1:])
        return 0
    except (Refused, OSError) as refusal:
        print(f"{NAME}: {refusal}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
