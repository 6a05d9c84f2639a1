#!/usr/bin/env python3
"""Turns what the traces and the counts say into the tables of the repository (see README.md)."""
import argparse
import collections
import csv
import pathlib
import re

# Routines by the operation that they stand for, and those of which the code is told apart.
LIBRARY = {
    "f64_add": ["__adddf3", "__subdf3"],
    "f64_mul": ["__muldf3"],
    "f64_div": ["__divdf3"],
    "f64_compare": ["__ltdf2", "__ledf2", "__gtdf2", "__gedf2", "__eqdf2", "__nedf2", "__aeabi_dcmplt",
                    "__aeabi_dcmple", "__aeabi_dcmpgt", "__aeabi_dcmpge", "__aeabi_dcmpeq"],
    "f64_convert": ["__extendsfdf2", "__truncdfsf2"],
    "f32_add": ["__addsf3", "__subsf3"],
    "f32_mul": ["__mulsf3"],
    "f32_div": ["__divsf3"],
    "f32_sqrt": ["digit_by_digit_sqrtf"],
    "f32_compare": ["__ltsf2", "__lesf2", "__gtsf2", "__gesf2", "__eqsf2", "__nesf2"],
    "f32_convert": ["__floatsisf", "__fixsfsi"],
    "popcount": ["__popcountsi2"],
    "memset": ["memset", "byte_memset"],
}
ROUTINES = {
    **{op: LIBRARY[op] for op in ("f64_mul", "f64_div", "f64_compare", "popcount", "memset")},
    "f64_add": ["__adddf3"],
    "f64_sub": ["__subdf3"],
    "f64_widen": ["__extendsfdf2"],
    "f64_narrow": ["__truncdfsf2"],
    "library_sin": ["sinf", "_sinf"],
    "library_cos": ["cosf", "_cosf"],
    "library_atan2": ["atan2f"],
}
OPERATION_OF = {symbol: op for op, symbols in LIBRARY.items() for symbol in symbols}

# Instructions of the trace and operations of the counts that are set against each other.
CLASSES = [
    ("load", ["load", "float_load"], ["load_stream", "load_indexed", "load_l2"]),
    ("store", ["store", "float_store"], ["store_stream", "store_indexed", "store_l2"]),
    ("branch", ["branch"], ["branch_taken", "branch_not_taken", "loop_iteration"]),
    ("branch taken", ["branch_taken"], ["branch_taken", "loop_iteration"]),
    ("jump, call, return", ["jump", "call", "return", "indirect_jump"], ["call", "call"]),
    ("integer alu", ["alu", "move"], ["int_alu", "int_add_shift", "int_min_max", "int_mac", "loop_iteration"]),
    ("integer mul", ["mul", "mul_high"], ["int_mul", "int_mac"]),
    ("integer div", ["div"], ["int_div"]),
    ("float add, mul, fma", ["f32_add", "f32_mul", "f32_fma"], ["f32_add", "f32_mul", "f32_fma"]),
    ("float div, sqrt", ["f32_div", "f32_sqrt"], ["f32_div", "f32_sqrt"]),
    ("float compare, convert", ["f32_compare", "f32_convert"], ["f32_compare", "f32_convert"]),
    ("float sign", ["f32_sign"], ["f32_sign"]),
    ("float move", ["f32_move"], []),
    ("double calls", ["f64"], ["f64_add", "f64_mul", "f64_div", "f64_compare", "f64_convert"]),
    ("popcount calls", ["popcount"], ["popcount"]),
]
NO_INSTRUCTION = {"visits", "branch_taken", "branch_back", "load_use", "load_use_xpulp", "host", "inclusive",
                  "more_loaded", "more_stored", "more_restored", "more_saved", "spared_move",
                  "spared_index", "spared_sum", "spared_shift", "loop_counter"}
SCENE = "scene: "
ROTATIONS = SCENE + "rotations"  # of library_main.cpp
GENERATED = "made by tools/rv32/measure.sh (GCC 12.2 -O3, traced under QEMU); not edited by hand"


class InstructionSet:
    """What code of an instruction set is compared with: the slots that operations issue, and the
    slots that executed instructions issue."""

    def __init__(self, title, prices, price_file, slots, in_hardware=(), load_use="load_use"):
        """@param slots  beyond 1, of kinds of instructions; of accounts that are no kinds, in all
        @param in_hardware  accounts of what repeats loops, where hardware may do that
        @param load_use  account of loads whose value the next instruction needs"""
        self.title, self.prices, self.price_file, self.slots = title, prices, price_file, slots
        self.in_hardware, self.load_use = in_hardware, load_use

    def executed(self, kinds):
        return instructions(kinds) + sum(n * kinds.get(kind, 0) for kind, n in self.slots.items())


# A word that an instruction moves beyond the first takes a slot, as its load or store was counted.
WORDS = {"more_loaded": 1, "more_stored": 1}


def rv32imfc(root):
    prices = read_costs(root / "tools/rv32/rv32imfc_costs.csv")
    # A population count is one instruction, as it was compiled; emulated arithmetic is nobody's own.
    own = {op: 0.0 if op.startswith("f64") else 1.0 if op == "popcount" else cost
           for op, cost in prices.items()}
    return InstructionSet("RV32IMFC", own, "tools/rv32/rv32imfc_costs.csv", {})


def rv32imfc_xpulp(root):
    """What Xpulp spares is no slot (xpulp.h). What repeats a loop is told apart from all else, so it
    has the price of RV32IMFC here; hardware loops take it on a chip, where they hold the loop."""
    name = "platform_models/isa/rv32imfc_xpulp.yaml"
    base = read_issue(root / "platform_models/isa/rv32imfc.yaml")
    loops = {"loop_iteration": base["loop_iteration"], "loop_jump": 0.0}
    prices = {**base, **read_issue(root / name), **loops}
    spared = ("spared_move", "spared_index", "spared_sum", "spared_shift")
    return InstructionSet("RV32IMFC with Xpulp", prices, name, {kind: -1 for kind in spared},
                          ("branch_back", "loop_counter"), "load_use_xpulp")


def thumb2(root):
    """Registers that a push saves are stalls of `call` in the prices."""
    name = "platform_models/isa/thumb2_fp.yaml"
    return InstructionSet("Thumb-2 with single precision", read_issue(root / name), name, WORDS)


def armv6(root):
    """Prices have the words of push and pop in `call`, two and three slots of multiplications, and
    half a slot of a branch that repeats a loop, since it is often folded away."""
    name = "platform_models/isa/armv6_vfp.yaml"
    slots = {**WORDS, "more_restored": 1, "more_saved": 1, "mul": 1, "mul_high": 2, "branch_back": -0.5}
    return InstructionSet("ARMv6 with VFP", read_issue(root / name), name, slots)


INSTRUCTION_SETS = {"rv32imfc": rv32imfc, "rv32imfc_xpulp": rv32imfc_xpulp, "thumb2": thumb2, "armv6": armv6}


class Trace:
    """What the trace plugin wrote."""

    def __init__(self, path):
        self.pieces = []  # (function, after, visits, lines, refetches)
        self.kinds = collections.defaultdict(collections.Counter)  # by (scene, function)
        self.library = collections.defaultdict(list)  # by symbol: rows of numbers
        self.rotations = {}  # those of the scene of Jacobi rotations
        self.calls = collections.defaultdict(collections.Counter)  # by (scene, function)
        self.function_lines, self.scene_lines = {}, {}
        for line in open(path):
            kind, *row = line.rstrip("\n").split("\t")
            if kind == "piece":
                self.pieces.append((row[0], row[1], *map(int, row[2:5])))
            elif kind == "account":
                self.kinds[row[0], row[1]][row[2]] += int(row[3])
            elif kind == "library":
                symbol = "digit_by_digit_sqrtf" if "digit_by_digit" in row[2] else row[2]
                numbers = list(map(int, row[3:]))
                if numbers[0] > 0:
                    if row[0] == ROTATIONS:
                        self.rotations[symbol] = numbers
                    else:
                        self.library[symbol].append(numbers)
                    self.calls[row[0], row[1]][symbol, "calls"] += numbers[0]
                    self.calls[row[0], row[1]][symbol, "instructions"] += numbers[1]
            elif kind == "spared":
                self.calls[row[0], row[1]][row[2], "spared"] += int(row[3])
            elif kind == "function":
                self.function_lines[row[0]] = int(row[1])
            elif kind == "scene":
                self.scene_lines[row[0]] = int(row[1])

    @staticmethod
    def of_layouts(paths):
        """The trace of the first path, with the lines of code as they are in the mean of all. The
        programs execute the same instructions at other places."""
        traces = [Trace(path) for path in paths]
        first = traces[0]
        mean = lambda numbers: sum(numbers) / len(traces)
        for symbol, row in first.rotations.items():
            first.rotations[symbol] = row[:-1] + [mean([t.rotations[symbol][-1] for t in traces])]
        for symbol, rows in first.library.items():
            lines = [mean(of_call) for of_call in
                     zip(*([row[-1] for row in trace.library[symbol]] for trace in traces), strict=True)]
            first.library[symbol] = [row[:-1] + [n] for row, n in zip(rows, lines)]
        pieces = []
        for same in zip(*(trace.pieces for trace in traces), strict=True):
            function, after, visits = same[0][:3]
            if any(piece[:3] != (function, after, visits) for piece in same):
                raise SystemExit(f"{function} after \"{after}\": the layouts differ in what they execute")
            pieces.append((function, after, visits, mean([p[3] for p in same]), mean([p[4] for p in same])))
        first.pieces = pieces
        for kind in ("function_lines", "scene_lines"):
            setattr(first, kind, {name: round(mean([getattr(trace, kind)[name] for trace in traces]))
                                  for name in getattr(first, kind)})
        return first

    def routine(self, symbol):
        """(calls, mean, least, most of instructions, the same of stalls, mean lines)"""
        rows = self.library[symbol]
        n = sum(r[0] for r in rows)
        mean = lambda i: sum(r[i] for r in rows) / n
        return (n, mean(1), min(r[2] for r in rows), max(r[3] for r in rows),
                mean(4), min(r[5] for r in rows), max(r[6] for r in rows), mean(7))

    def lines_of(self, routine):
        """Of the calls in Jacobi rotations, or else of all."""
        rows = [self.rotations[s] for s in ROUTINES[routine] if s in self.rotations]
        rows = rows or [r for s in ROUTINES[routine] for r in self.library.get(s, [])]
        n = sum(r[0] for r in rows)
        return (sum(r[7] for r in rows) / n, n) if n else (0, 0)


def read_counts(path, kind="counted"):
    """@param kind  "counted" of the function itself, "inclusive" with what it called"""
    counts = collections.defaultdict(collections.Counter)
    for line in open(path):
        of, scene, function, what, n = line.rstrip("\n").split("\t")
        if of == kind:
            counts[scene, function][what] += int(n)
    return counts


def read_costs(path):
    lines = [line for line in open(path) if not line.startswith("#")]
    return {row["op"]: float(row["issue"]) for row in csv.DictReader(lines)}


def read_issue(path):
    """Slots that operations issue, from an instruction set of the platforms. Routines of the library
    are nobody's own: they have accounts of their own in the trace."""
    text = re.sub(r"(^|\s)#.*", r"\1", path.read_text(), flags=re.MULTILINE)
    prices = collections.defaultdict(float)
    for op, price in re.findall(r"^    (\w+): \{([^}]*)\}", text, re.MULTILINE):
        prices[op] = 0.0 if "routine: true" in price else float(re.search(r"\bissue: ([0-9.]+)", price)[1])
    # What reaching a second memory costs is a property of the chip; the instruction is the same.
    return {"load_l2": prices["load_stream"], "store_l2": prices["store_stream"], **prices}


def by_scene(accounts):
    total = collections.defaultdict(collections.Counter)
    for (scene, _), account in accounts.items():
        total[scene].update(account)
    return total


# ---- footprints ----

FOOTPRINT_HEADER = """\
Compiled code of the workload's named functions on %s,
%s.
A row is a piece of a function: from its entry (`after` empty), or from the return of the named
function `after`, to its next call of a named function or its end.
lines      distinct 16-byte lines fetched per visit, mean
visits     how often the piece was executed
refetches  lines per visit that a 512-byte cache (fully associative, LRU, empty at the begin)
           loses and fetches again, mean: large where a loop of the piece does not fit
executed   instructions per visit of the whole function, with copying and clearing by the library,
           without emulated arithmetic, on the way through the program that was counted; rows with an
           empty `after` only, as what follows
priced     operations counted in a visit, at the prices of %s
loads, used_at_once   loads per visit; those of which the next instruction needs the value
executed_loops, priced_loops   of executed and priced, what repeats loops: a counter and a branch each
Rows f64_*, popcount, memset are routines of the library; calls of these do not end a piece.
Rows library_* are routines of a public C library, called by the names that they have here.
"""

STAGE_HEADER = """\
Code of the stages that belongs to no named function, on RV32IMFC: columns as in
platform_models/code/rv32imfc.csv, with the scene (scenes.h) in the place of the function;
%s.
""" % GENERATED

STATIC_HEADER = """\
Distinct 16-byte lines that were ever executed: of named functions (all copies that the compiler
made) and of whole stages, library routines included;
%s.
""" % GENERATED


def write_csv(path, header, columns, rows):
    with open(path, "w") as file:
        for line in header.splitlines():
            file.write(f"# {line}\n")
        file.write(",".join(columns) + "\n")
        for row in rows:
            file.write(",".join(f"{x:.2f}" if isinstance(x, float) else str(x) for x in row) + "\n")


def piece_rows(trace, scenes):
    return [(f.removeprefix(SCENE), after, lines / visits, visits, refetches / visits)
            for f, after, visits, lines, refetches in trace.pieces if f.startswith(SCENE) == scenes]


def by_function(accounts):
    total = collections.defaultdict(collections.Counter)
    for (_, function), account in accounts.items():
        total[function].update(account)
    return total


def instructions(kinds):
    return sum(n for kind, n in kinds.items() if kind not in NO_INSTRUCTION)


def in_counted_flow(contracted, uncontracted):
    """What the contracted code would execute on the way of the uncontracted one, which is the way
    that was counted. Contraction changes bits, so the programs part where a comparison turns out
    otherwise, and would be compared over different work. A function takes the same branches for the
    same work, so its instructions are taken per branch, scene by scene. They are no more than the
    uncontracted code takes: contraction only takes instructions away."""
    kinds = {}
    for key, counted in uncontracted.kinds.items():
        executed = contracted.kinds.get(key)
        if not executed:
            continue
        per = "branch" if counted["branch"] and executed["branch"] else "visits"
        share = counted[per] / executed[per]
        if share * instructions(executed) > instructions(counted):
            share = instructions(counted) / instructions(executed)
        kinds[key] = {kind: n * share for kind, n in executed.items()}
        kinds[key]["visits"] = counted["visits"]
    return kinds


def copied_and_cleared(trace, isa):
    """Instructions of memcpy and its kin by scene and function. A compiler calls them in the place
    of loops that were counted."""
    sign = {"instructions": 1, "spared": -1 if isa.in_hardware else 0}
    return {key: sum(sign.get(what, 0) * n for (symbol, what), n in calls.items()
                     if symbol in ("memcpy", "memmove", "memset", "byte_memset"))
            for key, calls in trace.calls.items()}


def compiled_work(executed_kinds, memory, counts, isa):
    """(executed, priced, loads, loads used at once, executed and priced of what repeats loops) per
    visit of each function itself. A loop is repeated by a counter and a branch; those of a library
    routine have the share that they have in the price.
    @param executed_kinds  in_counted_flow()
    @param memory          copied_and_cleared()"""
    counted = by_function({key: n for key, n in counts.items() if key in executed_kinds})
    by_library = collections.Counter()
    for (scene, function), n in memory.items():
        if (scene, function) in executed_kinds:
            by_library[function] += n
    work = {}
    for function, kinds in by_function(executed_kinds).items():
        visits, counted_visits = kinds["visits"], counted[function]["visits"]
        if not visits or not counted_visits:
            continue
        executed = isa.executed(kinds) + by_library[function]
        priced = sum(n * isa.prices.get(op, 0.0) for op, n in counted[function].items() if op != "visits")
        repetition = isa.prices["loop_iteration"]
        priced_loops = counted[function]["loop_iteration"] * repetition
        if isa.in_hardware:  # of libraries, too
            in_library, repeats = 0, sum(kinds.get(kind, 0) for kind in isa.in_hardware)
        else:
            in_library = by_library[function] * priced_loops / priced if priced else 0
            repeats = repetition * kinds["branch_back"]
        # A backward branch may also repeat what was not counted as a loop.
        executed_loops = min(repeats, priced_loops)
        loads = kinds["load"] + kinds["float_load"] + kinds["more_loaded"] + kinds["more_restored"]
        work[function] = (executed / visits, priced / counted_visits, loads / visits,
                          kinds[isa.load_use] / visits, (executed_loops + in_library) / visits,
                          priced_loops / counted_visits)
    return work


def routine_row(routine, trace):
    lines, calls = trace.lines_of(routine)
    return (routine, "", lines, calls, 0.0) if calls else None


def renew_routines(library, code):
    """Puts what was measured of routines alone into a table that is there."""
    table = code.read_text().splitlines()
    for i, line in enumerate(table):
        row = routine_row(line.split(",")[0], library) if line.split(",")[0] in ROUTINES else None
        if row:
            table[i] = ",".join(f"{x:.2f}" if isinstance(x, float) else str(x) for x in row) + "," * 6
    code.write_text("\n".join(table) + "\n")


def write_footprints(trace, library, compiled, isa, code):
    """@param library   trace of the routines alone; None leaves them out
    @param compiled  compiled_work()"""
    columns = ["function", "after", "lines", "visits", "refetches"]
    nothing = ("",) * 6
    rows = [row + (nothing if row[1] else compiled.get(row[0], nothing))
            for row in piece_rows(trace, False) if row[0] not in ROUTINES]
    for routine in ROUTINES if library else ():
        row = routine_row(routine, library) or routine_row(routine, trace)
        if row:
            rows.append(row + nothing)
    write_csv(code, FOOTPRINT_HEADER % (isa.title, GENERATED, isa.price_file),
              columns + ["executed", "priced", "loads", "used_at_once", "executed_loops", "priced_loops"],
              sorted(rows))


def write_stages(trace, here):
    write_csv(here / "stage_code.csv", STAGE_HEADER,
              ["stage", "after", "lines", "visits", "refetches"], sorted(piece_rows(trace, True)))
    static = [("stage", s.removeprefix(SCENE), n) for s, n in trace.scene_lines.items()]
    static += [("function", f, n) for f, n in trace.function_lines.items() if not f.startswith(SCENE)]
    write_csv(here / "static_lines.csv", STATIC_HEADER, ["what", "name", "lines"], sorted(static))


FUNCTIONS_PAGE = """\
# Executed against counted on %s

Per visit of a named function itself, all scenes, without routines of the library. *Executed*: slots that the trace issues
(`slots` in report.py). *Counted*: operations at the prices of `%s`. *At once*: loads whose value the next instruction needs.

| function | visits | counted | executed | ratio | loads | at once |
| --- | ---: | ---: | ---: | ---: | ---: | ---: |
"""


def write_functions_page(compiled, visits, isa, path):
    """@param compiled  compiled_work()
    @param visits    by function"""
    def row(name, n, executed, priced, loads, at_once):
        ratio = f"{executed / priced:.2f}" if priced else "–"
        part = f"{100 * at_once / loads:.0f} %" if loads else "–"
        return f"| {name} | {n:,} | {priced:,.0f} | {executed:,.0f} | {ratio} | {loads:,.0f} | {part} |\n"

    with open(path, "w") as out:
        out.write(f"<!-- {GENERATED} -->\n" + FUNCTIONS_PAGE % (isa.title, isa.price_file))
        total = [sum(visits[f] * work[i] for f, work in compiled.items()) for i in range(4)]
        out.write(row("all, in total", sum(visits[f] for f in compiled), *total))
        for function in sorted(compiled, key=lambda f: -visits[f] * compiled[f][1]):
            if not function.startswith(SCENE):
                out.write(row(f"`{function}`", visits[function], *compiled[function][:4]))


SPARED_PAGE = """
## What Xpulp spares

In per cent of the instructions that all functions execute on RV32IMFC with Zbb ([`xpulp.h`](xpulp.h)).

| instruction | part of | % |
| --- | --- | ---: |
"""
SPARED = [("a pointer that moves besides an access", "the access, with post-increment", ["spared_move"]),
          ("branch and counter of a loop", "a hardware loop, if one holds it", ["branch_back", "loop_counter"]),
          ("a shift of a shifted value or of a sum", "a bit field, `addN`, `addRN`", ["spared_shift"]),
          ("a sum with a product", "`mac`, `msu`", ["spared_sum"]),
          ("the sum of an address", "the access, with two registers", ["spared_index"])]


def write_spared(executed_kinds, path):
    """Appends to the page of functions.
    @param executed_kinds  in_counted_flow()"""
    total = collections.Counter()
    for kinds in executed_kinds.values():
        total.update(kinds)
    with open(path, "a") as out:
        out.write(SPARED_PAGE)
        for what, part, kinds in SPARED:
            share = sum(total[kind] for kind in kinds) / instructions(total)
            out.write(f"| {what} | {part} | {100 * share:.1f} |\n")


# ---- counted against executed ----

def class_totals(kinds, calls):
    """Executed instructions by the names of CLASSES, and the total with and without library."""
    amounts = collections.Counter(kinds)
    library = 0
    for (symbol, what), n in calls.items():
        operation = OPERATION_OF.get(symbol, "memory")
        if what == "spared":
            continue
        if what == "calls":
            amounts["f64" if operation.startswith("f64") else operation] += n
        else:
            library += n
    return amounts, instructions(kinds), library


def check_same_control_flow(trace, counts):
    for key, account in counts.items():
        executed = trace.kinds[key]["visits"]
        if executed != account["visits"]:
            raise SystemExit(f"{key}: executed {executed} times, counted {account['visits']} times")


def write_cross_check(trace, contracted, counts, costs, here):
    counted, kinds, calls = by_scene(counts), by_scene(trace.kinds), by_scene(trace.calls)
    kinds_fused, calls_fused = by_scene(contracted.kinds), by_scene(contracted.calls)
    scenes = list(dict.fromkeys(s for s, _ in counts))
    unfused = dict(costs, f32_fma=2.0)
    library_ops = [op for op in costs if op.startswith("f64") or op == "popcount"]
    price = lambda c, table: sum(n * table[op] for op, n in c.items() if op != "visits")
    price_library = lambda c: sum(c[op] * (costs[op]) for op in library_ops)
    summary, detail = [], []
    for scene in scenes:
        amounts, own, library = class_totals(kinds[scene], calls[scene])
        _, own_fused, library_fused = class_totals(kinds_fused[scene], calls_fused[scene])
        summary.append((scene.removeprefix(SCENE),
                        price(counted[scene], unfused) - price_library(counted[scene]), own,
                        price_library(counted[scene]), library, own_fused + library_fused))
        for name, executed, operations in CLASSES:
            detail.append((scene.removeprefix(SCENE), name,
                           sum(counted[scene][op] for op in operations)
                           + (counted[scene]["f32_fma"] if name == "float add, mul, fma" else 0),
                           sum(amounts[k] for k in executed)))
    functions = []
    for (scene, function), account in counts.items():
        if function.startswith(SCENE):
            continue
        functions.append((function, price(account, unfused),
                          sum(class_totals(trace.kinds[scene, function], trace.calls[scene, function])[1:]),
                          account["visits"]))
    write_csv(here / "cross_check.csv",
              f"Counted operations and executed instructions by class;\n{GENERATED}.",
              ["kernel", "class", "counted", "executed"], detail)
    write_cross_check_page(summary, detail, functions, here / "cross_check.md")


def write_cross_check_page(summary, detail, functions, path):
    with open(path, "w") as out:
        out.write(f"<!-- {GENERATED} -->\n# Counted against executed instructions\n\n")
        out.write("""\
RV32IMFC without Xpulp. *priced*: counted operations times `rv32imfc_costs.csv`; *executed*: the
trace. *Own* code is that of the kernel, *library* that of emulated double precision, popcount and
memset; marks and the simulator's book-keeping are left out. All from code without contraction,
which computes the same bits as the host and so runs the same iterations; a fused multiply-add costs
two there. The last column is the code with contraction, which takes other numbers of iterations
where a loop waits for convergence. README.md explains the large differences.

| kernel | own: priced | executed | ratio | library: priced | executed | all: ratio | with contraction |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
""")
        for name, own_priced, own, library_priced, library, fused in summary:
            out.write(f"| {name} | {own_priced:,.0f} | {own:,} | {own / own_priced:.2f} "
                      f"| {library_priced:,.0f} | {library:,} "
                      f"| {(own + library) / (own_priced + library_priced):.2f} | {fused:,} |\n")
        out.write("\n## By class: executed / counted\n\nIn thousands. A dash: neither.\n\n")
        kernels = [row[0] for row in summary]
        names = [name for name, _, _ in CLASSES]
        table = {(k, c): (a, b) for k, c, a, b in detail}
        out.write("| kernel | " + " | ".join(names) + " |\n")
        out.write("| --- |" + " ---: |" * len(names) + "\n")
        for kernel in kernels:
            cells = []
            for name in names:
                a, b = table[kernel, name]
                cells.append("–" if a == b == 0 else f"{b / 1000:.1f} / {a / 1000:.1f}")
            out.write(f"| {kernel} | " + " | ".join(cells) + " |\n")
        out.write("\n## By named function\n\nSelf, all scenes.\n\n")
        out.write("| function | visits | priced per visit | executed per visit | ratio |\n")
        out.write("| --- | ---: | ---: | ---: | ---: |\n")
        total = collections.defaultdict(lambda: [0, 0, 0])
        for function, priced, executed, visits in functions:
            for i, x in enumerate((priced, executed, visits)):
                total[function][i] += x
        for function in sorted(total, key=lambda f: -total[f][1]):
            priced, executed, visits = total[function]
            out.write(f"| {function} | {visits:,} | {priced / visits:,.0f} | {executed / visits:,.0f} "
                      f"| {executed / priced:.2f} |\n")


# ---- units of the released program's work ----

UNITS_PAGE = """\
# Units of the released program's work

Instructions per unit of `levio`'s work on RV32IMFC beside those of the released program, emulated
arithmetic included. *Released* and *executed* come from the same compiler and options, with
contraction as the vendor's compiler has it; *priced* are counted operations times
`rv32imfc_costs.csv`. *Inner*: how often an inner function runs per unit, which tells how alike the
inputs are. [`units.csv`](units.csv) says what is divided by what, [`RESULTS.md`](RESULTS.md) why
some differ.

| unit | released | executed | ratio | priced | ratio | without contraction | inner | here | released |
| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: |
"""


class Unit:
    """What a unit takes: a row of units.csv, applied to a trace or to counts."""

    def __init__(self, row):
        self.row, self.scene = row, SCENE + row["scene"]
        self.terms = [(f.removeprefix("-"), -1 if f.startswith("-") else 1)
                      for f in row["functions"].split("|")]

    def number(self, trace):
        n = trace.kinds[self.scene, self.row["per"]]["visits"] * int(self.row["units"])
        if n == 0:
            raise SystemExit(f"units.csv: {self.row['per']} is not visited in {self.scene}")
        return n

    def executed(self, trace):
        total = sum(sign * trace.kinds[self.scene, f]["inclusive"] for f, sign in self.terms)
        return total / self.number(trace)

    def executed_itself(self, trace, isa):
        """Without what it calls and without what the instruction set spares."""
        total = sum(sign * isa.executed(trace.kinds[self.scene, f]) for f, sign in self.terms)
        return total / self.number(trace)

    def priced(self, trace, counts, costs):
        total = sum(sign * n * costs[op] for f, sign in self.terms
                    for op, n in counts[self.scene, f].items())
        return total / self.number(trace)

    def inner(self, trace):
        return trace.kinds[self.scene, self.row["inner"]]["visits"] / self.number(trace)


def read_units(here, isa):
    lines = [line for line in open(here / "units.csv") if not line.startswith("#")]
    return [row for row in csv.DictReader(lines) if (row["isa"] or "rv32imfc") == isa]


UNITS_SECTION = """
## Units of the released program's work

Instructions per unit of `levio`'s work beside those of the released program, where they are known with Xpulp.

| unit | released | executed | ratio |
| --- | ---: | ---: | ---: |
"""


def append_units(trace, name, isa, here, page):
    rows = read_units(here, name)
    if not rows:
        return
    with open(page, "a") as out:
        out.write(UNITS_SECTION)
        for row in rows:
            released, executed = float(row["released"]), Unit(row).executed_itself(trace, isa)
            out.write(f"| {row['unit']} | {released:,.0f} | {executed:,.1f} | {executed / released:.2f} |\n")


def write_units(contracted, uncontracted, counts, costs, here):
    """@param counts  inclusive; of as many visits as `uncontracted` has"""
    with open(here / "units.md", "w") as out:
        out.write(f"<!-- {GENERATED} -->\n{UNITS_PAGE}")
        for row in read_units(here, "rv32imfc"):
            unit, released = Unit(row), float(row["released"])
            executed = unit.executed(contracted)
            priced = unit.priced(uncontracted, counts, costs)
            inner = "– | – | –"
            if row["inner"]:
                inner = f"`{row['inner']}` | {unit.inner(contracted):.1f} | {row['inner_released']}"
            out.write(f"| {row['unit']} | {released:,.0f} | {executed:,.0f} | {executed / released:.2f} "
                      f"| {priced:,.0f} | {priced / released:.2f} | {unit.executed(uncontracted):,.0f} "
                      f"| {inner} |\n")


# ---- library routines ----

def write_library(soft, hard, path):
    with open(path, "w") as out:
        out.write(f"<!-- {GENERATED} -->\n# Library routines: emulated arithmetic and trigonometry\n\n")
        for title, trace in (("Core without FPU: libraries for rv32imac", soft),
                             ("Core with single precision: compressed libraries, for rv32imafc", hard)):
            out.write(f"## {title}\n\n| routine | instructions, mean (min–max) | stalls, mean (min–max) "
                      "| lines |\n| --- | ---: | ---: | ---: |\n")
            for symbol in sorted(trace.library, key=lambda s: (OPERATION_OF.get(s, "z"), s)):
                if symbol in ("memset", "memcpy"):
                    continue
                _, mean, least, most, stall, s_least, s_most, lines = trace.routine(symbol)
                if trace is hard and "sqrtf" in symbol:
                    continue
                out.write(f"| `{symbol}` | {mean:.0f} ({least}–{most}) | {stall:.0f} ({s_least}–{s_most}) "
                          f"| {lines:.0f} |\n")
            out.write("\n")


def of_scenes(arguments):
    """What was traced and counted, and what functions execute."""
    work = arguments.work
    contracted = Trace.of_layouts([work / f"scenes_at_{layout}.tsv" for layout in arguments.layouts])
    uncontracted = Trace(work / "scenes_uncontracted.tsv")
    counts = read_counts(arguments.counts)
    check_same_control_flow(uncontracted, counts)
    isa = INSTRUCTION_SETS[arguments.isa](arguments.root)
    executed = in_counted_flow(contracted, uncontracted)
    compiled = compiled_work(executed, copied_and_cleared(uncontracted, isa), counts, isa)
    return contracted, uncontracted, counts, executed, compiled, isa


def write_kernels(arguments):
    contracted, _, _, _, compiled, isa = of_scenes(arguments)
    write_footprints(contracted, None, compiled, isa, arguments.kernels)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--isa", choices=INSTRUCTION_SETS, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder of the raw results")
    parser.add_argument("--counts", type=pathlib.Path, help="counted operations; without, routines of libraries only")
    parser.add_argument("--root", type=pathlib.Path, required=True, help="of the repository, to write to")
    parser.add_argument("--kernels", type=pathlib.Path, help="the only table to write: that of another project's kernels")
    parser.add_argument("--layouts", nargs="+", required=True, help="names of the linked programs")
    arguments = parser.parse_args()
    work, root = arguments.work, arguments.root
    code, here = root / f"platform_models/code/{arguments.isa}.csv", root / "tools/rv32"
    if arguments.kernels:
        write_kernels(arguments)
        return
    hard = Trace.of_layouts([work / f"library_hard_at_{layout}.tsv" for layout in arguments.layouts])
    if arguments.isa == "rv32imfc":
        write_library(Trace(work / "library_soft.tsv"), hard, here / "library.md")
    if arguments.counts is None:
        renew_routines(hard, code)
        return
    contracted, uncontracted, counts, executed, compiled, isa = of_scenes(arguments)
    write_footprints(contracted, hard, compiled, isa, code)
    if arguments.isa != "rv32imfc":
        visits = {function: n["visits"] for function, n in by_function(counts).items()}
        page = here / f"{arguments.isa}.md"
        write_functions_page(compiled, visits, isa, page)
        if isa.in_hardware:
            write_spared(executed, page)
        append_units(contracted, arguments.isa, isa, here, page)
        return
    costs = read_costs(here / "rv32imfc_costs.csv")
    write_stages(contracted, here)
    write_units(contracted, uncontracted, read_counts(arguments.counts, "inclusive"), costs, here)
    write_cross_check(uncontracted, contracted, counts, costs, here)


if __name__ == "__main__":
    main()
