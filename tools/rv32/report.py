#!/usr/bin/env python3
"""Turns what the trace plugin found into the tables of the repository (see README.md)."""
import argparse
import collections
import csv

LIBRARY_PIECES = {
    "f64_add": ["__adddf3", "__subdf3"],
    "f64_mul": ["__muldf3"],
    "f64_div": ["__divdf3"],
    "f64_compare": ["__ltdf2", "__ledf2", "__gtdf2", "__gedf2", "__eqdf2", "__nedf2"],
    "f64_convert": ["__extendsfdf2", "__truncdfsf2", "__floatsidf", "__fixdfsi"],
    "popcount": ["__popcountsi2"],
    "memset": ["memset"],
    "memcpy": ["memcpy"],
}


def read(path):
    rows = collections.defaultdict(list)
    with open(path) as file:
        for line in file:
            kind, *rest = line.rstrip("\n").split("\t")
            rows[kind].append(rest)
    return rows


def is_scene(name):
    return name.startswith("scene: ")


def footprints(rows):
    """(function, after, lines, visits, refetches), means per visit."""
    table = []
    for function, after, visits, lines, refetches, _ in rows["piece"]:
        if not is_scene(function):
            n = int(visits)
            table.append((function, after, int(lines) / n, n, int(refetches) / n))
    calls, lines = collections.Counter(), collections.Counter()
    for row in rows["library"]:
        calls[row[2]] += int(row[3])
        lines[row[2]] += int(row[10])
    for name, symbols in LIBRARY_PIECES.items():
        n = sum(calls[s] for s in symbols)
        if n:
            table.append((name, "", sum(lines[s] for s in symbols) / n, n, 0.0))
    return sorted(table)


def write_footprints(rows, path, header):
    with open(path, "w") as file:
        for line in header:
            file.write(f"# {line}\n")
        file.write("function,after,lines,visits,refetches\n")
        for function, after, lines, visits, refetches in footprints(rows):
            file.write(f"{function},{after},{lines:.2f},{visits},{refetches:.2f}\n")


FOOTPRINT_HEADER = [
    "Code footprints of the workload's named functions, compiled for RV32IMFC. Made by",
    "tools/rv32/measure.sh (GCC 12.2 -O3, traced under QEMU without sampling); not edited by hand.",
    "A row is a piece of a function: from its entry (`after` empty), or from the return of the",
    "named function `after`, to its next call of a named function or its end.",
    "lines      distinct 16-byte lines fetched per visit, mean",
    "visits     how often the piece was executed",
    "refetches  lines per visit that a 512-byte cache (fully associative, LRU) loses and fetches",
    "           again, mean: large where a loop of the piece does not fit",
    "Rows f64_* are the library's routines of double precision; popcount, memset and memcpy too are",
    "library routines; calls of these do not end a piece.",
]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("raw")
    parser.add_argument("--footprints", required=True)
    arguments = parser.parse_args()
    rows = read(arguments.raw)
    write_footprints(rows, arguments.footprints, FOOTPRINT_HEADER)


if __name__ == "__main__":
    main()
