#!/usr/bin/env python3
"""Finds reads and writes of kernels that go round the work counters, so that no chip would be charged for them.

usage: check_counting.py [-p BUILD] FILE... [-- FLAGS]
       check_counting.py src/main.cpp -- -std=c++20 -I/usr/include/leviosim

Looks at sources as Clang reads them, at templates as they are instantiated for counting, in the files and in the headers
that they include. BUILD is a folder with compile_commands.json; without it, FLAGS are those of the compiler. Prints
FILE:LINE: what, and how it is counted. A line with the comment `uncounted: REASON` is passed over, and so is what only the
host computes: the second argument of host_value(), and functions whose names end in _on_host.

Needs the program clang-query (Debian: apt-get install clang-tools). Exit status 0: nothing found, 1: something, 2: bad
input. Left out: values that were assigned to a variable after its declaration, or returned by a function."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

DEFINITIONS = """
set output diag
set bind-root false
set print-matcher false
let view cxxRecordDecl(hasAnyName("::leviosim::work::CountedSpan", "::leviosim::work::CountedArray"))
let counting refersToType(hasDeclaration(cxxRecordDecl(hasName("::leviosim::work::Counting"))))
let kernel functionDecl(anyOf(hasAnyTemplateArgument(counting), cxxMethodDecl(ofClass(classTemplateSpecializationDecl(hasAnyTemplateArgument(counting))))))
let toView cxxConstructExpr(hasDeclaration(cxxMethodDecl(ofClass(view))))
let raw expr(anyOf(cxxMemberCallExpr(callee(cxxMethodDecl(hasName("data"), ofClass(view)))), memberExpr(member(fieldDecl(hasName("data_"), hasParent(view))))))
let onHost anyOf(hasAncestor(callExpr(callee(functionDecl(hasName("host_value"))), hasArgument(1, expr(hasDescendant(expr(equalsBoundNode("at"))))))), hasAncestor(functionDecl(matchesName("_on_host"))))
let here unless(anyOf(isExpansionInSystemHeader(), isExpansionInFileMatching("sim/work/")))
let value callExpr(callee(functionDecl(hasName("::leviosim::work::value"))))
let hasValue expr(anyOf(value, hasDescendant(value)))
let valueVariable declRefExpr(to(varDecl(hasInitializer(hasValue))))
let fromValue expr(anyOf(hasValue, valueVariable, hasDescendant(valueVariable)))
let computed binaryOperator(hasAnyOperatorName("%", "/", "&", "|", "^", ">>", "<<"))
let hasComputed expr(anyOf(computed, hasDescendant(computed)))
let computedVariable declRefExpr(to(varDecl(hasInitializer(hasComputed))))
let fromComputed expr(anyOf(hasComputed, computedVariable, hasDescendant(computedVariable)))
let ofLoop varDecl(hasParent(declStmt(hasParent(forStmt()))))
let constant varDecl(anyOf(isConstexpr(), allOf(hasType(isConstQualified()), hasInitializer(integerLiteral()))))
let sized cxxRecordDecl(hasAnyName("::std::array", "::leviosim::work::CountedArray"))
let known callExpr(anyOf(cxxMemberCallExpr(thisPointerType(sized)), allOf(callee(functionDecl(isConstexpr())), unless(cxxMemberCallExpr()))))
let variable expr(anyOf(declRefExpr(hasType(isInteger()), to(varDecl(unless(ofLoop), unless(constant)))), memberExpr(hasType(isInteger()), member(fieldDecl())), callExpr(unless(known))))
let atRunTime binaryOperator(hasAnyOperatorName("<", "<=", ">", ">=", "!=", "=="), hasEitherOperand(expr(anyOf(variable, hasDescendant(variable)))))
let inTable hasAncestor(functionDecl(isConstexpr(), unless(cxxMethodDecl(ofClass(cxxRecordDecl(isLambda()))))))
let ends expr(anyOf(atRunTime, hasDescendant(atRunTime)))
let begins declStmt(hasDescendant(varDecl(hasInitializer(expr(anyOf(variable, hasDescendant(variable)))))))
let plainIndex cxxOperatorCallExpr(hasOverloadedOperatorName("[]"), callee(cxxMethodDecl(ofClass(view), hasParameter(0, hasType(isInteger())))))
"""

RULES = {
    "a view's memory without its counters: .data()":
        ('expr(raw, here, unless(hasAncestor(toView)), '
         'unless(hasAncestor(typeAliasDecl())), unless(hasAncestor(unaryExprOrTypeTraitExpr())))',
         "read and write elements of the view, or make a view of it"),
    "an element of a plain pointer":
        ('arraySubscriptExpr(here, hasAncestor(kernel), unless(hasBase(ignoringParenImpCasts(hasType(hasCanonicalType(arrayType()))))), '
         'anyOf(hasType(isInteger()), hasType(realFloatingPointType()), hasType(enumDecl()), '
         'hasType(qualType(hasUnqualifiedDesugaredType(enumType())))))',
         "make a P::Span or P::L2Span of it"),
    "an array that counts no load, at an index that is data":
        ('expr(anyOf(arraySubscriptExpr(hasBase(ignoringParenImpCasts(hasType(hasCanonicalType(arrayType())))), hasIndex(fromValue)), '
         'cxxOperatorCallExpr(hasOverloadedOperatorName("[]"), unless(callee(cxxMethodDecl(ofClass(view)))), '
         'hasArgument(1, fromValue))), here, hasAncestor(kernel))',
         "make a P::Array or a view of it; plain arrays stand for registers"),
    "work::value() in an index, which passes for one of a loop":
        ('cxxOperatorCallExpr(plainIndex, here, hasArgument(1, fromValue))', "let the index be a P::I32"),
    "index arithmetic on plain integers that no loop's stream replaces":
        ('cxxOperatorCallExpr(plainIndex, here, unless(hasArgument(1, fromValue)), hasArgument(1, fromComputed))',
         "compute the index in P::I32"),
    "a loop on plain numbers that ends where data say":
        ('stmt(anyOf(forStmt(hasCondition(ends)), forStmt(hasLoopInit(begins), hasCondition(expr(hasDescendant(declRefExpr(to(ofLoop)))))), whileStmt(hasCondition(ends)), doStmt(hasCondition(ends))), here, hasAncestor(kernel), unless(inTable))',
         "iterate over P::range"),
}

PLACE = re.compile(r'^(.*?):(\d+):\d+: note: "at" binds here$')
MARK = "uncounted:"


class Refused(Exception):
    pass


def query():
    """@returns the program. The one of the newest version, if none has the plain name"""
    found = shutil.which("clang-query")
    for folder in os.environ.get("PATH", "").split(os.pathsep):
        if found is None and os.path.isdir(folder):
            found = next((str(p) for p in sorted(pathlib.Path(folder).glob("clang-query-*"), reverse=True)), None)
    if found is None:
        raise Refused("the program clang-query is missing; apt-get install clang-tools")
    return found


def script():
    lines = DEFINITIONS.strip().splitlines()
    for matcher, _ in RULES.values():
        lines.append(f'match stmt({matcher}, stmt().bind("at"), unless(onHost))')
    return lines


def is_marked(file, line):
    try:
        lines = pathlib.Path(file).read_text(errors="replace").splitlines()
    except OSError:
        return False
    return any(MARK in lines[at] for at in (line - 1, line - 2) if 0 <= at < len(lines) and "//" in lines[at])


def findings_in(source, build, flags):
    """@returns places (file, line) with the rules that they break"""
    if not pathlib.Path(source).is_file():
        raise Refused(f"{source}: no such file")
    words = [query(), *(part for line in script() for part in ("-c", line))]
    words += ["-p", build, source] if build else [source, "--", *flags]
    done = subprocess.run(words, capture_output=True, text=True)
    text = done.stdout + done.stderr
    fault = re.search(r"^.*?:\d+:\d+: (?:fatal )?error: .*$|^.*error.*while.*$", text, re.MULTILINE)
    if fault or done.returncode != 0:
        line = fault.group(0) if fault else (text.strip().splitlines() or ["clang-query failed"])[-1]
        raise Refused(f"{source}: Clang cannot read it: {line}")
    found, rules = set(), iter(RULES)
    rule = next(rules)
    for line in text.splitlines():
        place = PLACE.match(line)
        if place:
            found.add((os.path.relpath(place.group(1)), int(place.group(2)), rule))
        elif re.match(r"^\d+ match(es)?\.$", line):
            rule = next(rules, None)
    if rule is not None:
        raise Refused(f"{source}: clang-query did not understand its matchers: {text.strip().splitlines()[-1]}")
    return found


def check(words):
    flags = []
    if "--" in words:
        words, flags = words[: words.index("--")], words[words.index("--") + 1 :]
    build = None
    if words[:1] == ["-p"] and len(words) > 1:
        build, words = words[1], words[2:]
    if not words or words[0].startswith("-"):
        raise Refused("expected [-p BUILD] FILE... [-- FLAGS]; --help says more")
    if build and not (pathlib.Path(build) / "compile_commands.json").is_file():
        raise Refused(f"{build}: holds no compile_commands.json; cmake -DCMAKE_EXPORT_COMPILE_COMMANDS=ON writes it")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = set().union(*pool.map(lambda source: findings_in(source, build, flags), words))
    left = sorted(place for place in found if not is_marked(place[0], place[1]))
    for file, line, rule in left:
        print(f"{file}:{line}: {rule}; {RULES[rule][1]}")
    print(f"check_counting.py: {len(words)} file{'s' if len(words) > 1 else ''}, {len(left)} found")
    return 1 if left else 0


def main():
    if sys.argv[1:2] in (["--help"], ["-h"]):
        print(__doc__)
        return 0
    try:
        return check(sys.argv[1:])
    except Refused as refusal:
        print(f"check_counting.py: {refusal}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
