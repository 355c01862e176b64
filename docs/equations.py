"""Writes EQUATIONS.md: where each equation of the thesis lives in the code, and which tests cover it.

  python docs/equations.py            write EQUATIONS.md
  python docs/equations.py --check    exit with 1 if it is not what the code says now

An equation is cited by its number in parentheses, in a doc string or a comment; "(3.82)-(3.88)" cites all between.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "EQUATIONS.md"
HOMES, TESTS = ("rbd_model", "brake_controller", "scenarios"), "tests"
#: Number of the last equation of each chapter of the thesis.
LAST = {2: 16, 3: 124, 4: 2, 5: 4, 6: 7, 7: 3, 9: 1}
#: What must have a home or a reason: sections 2.4 and 2.5, chapters 3, 4 and 5.
EXPECTED = [*((2, n) for n in range(4, 13)), *((c, n) for c in (3, 4, 5) for n in range(1, LAST[c] + 1))]
#: Equations without a home, and why.
REASONS = {
    (2, 9): "an inequality; the simulated wheelset locks by itself when the brake exceeds what the rail can turn",
    (2, 11): "curving: the track here is straight",
    (2, 12): "curving: the track here is straight",
}

Number = tuple[int, int]
_RANGE = re.compile(r"\((\d)\.(\d+)(?:\.?[a-d])?\)(?:\s*(?:-|to)\s*\((\d)\.(\d+)(?:\.?[a-d])?\))?")


def cited(text: str) -> set[Number]:
    """Equation numbers in a text."""
    found = set()
    for chapter, first, other, last in _RANGE.findall(text):
        end = int(last) if other == chapter else int(first)
        found |= {(int(chapter), number) for number in range(int(first), end + 1)}
    return found


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Line and text of each comment block and doc string of a Python file."""
    source = path.read_text(encoding="utf-8")
    block: list[tuple[int, str]] = []
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            if block and token.start[0] != block[-1][0] + 1:
                yield block[0][0], " ".join(text for _, text in block)
                block = []
            block.append((token.start[0], token.string.lstrip("#: ")))
    if block:
        yield block[0][0], " ".join(text for _, text in block)
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node):
            line = 1 if isinstance(node, ast.Module) else node.lineno
            yield line, ast.get_docstring(node) or ""


def named_tests(path: Path) -> Iterator[tuple[str, int, int]]:
    """Name, first and last line of each test of a file."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
            yield node.name, node.lineno, node.end_lineno or node.lineno


def homes() -> dict[Number, list[str]]:
    """Places in the code by equation, as file:line."""
    found: dict[Number, list[str]] = defaultdict(list)
    for package in HOMES:
        for path in sorted((ROOT / package).rglob("*.py")):
            for line, text in sorted(texts(path)):
                for number in sorted(cited(text)):
                    found[number].append(f"{path.relative_to(ROOT).as_posix()}:{line}")
    return found


def tests() -> dict[Number, list[str]]:
    """Tests by equation, as file::name."""
    found: dict[Number, list[str]] = defaultdict(list)
    for path in sorted((ROOT / TESTS).rglob("test_*.py")):
        functions = list(named_tests(path))
        for line, text in sorted(texts(path)):
            for name, first, last in functions:
                if first <= line <= last:
                    for number in sorted(cited(text)):
                        found[number].append(f"{path.relative_to(ROOT).as_posix()}::{name}")
    return found


def complaints() -> list[str]:
    """What is wrong, a sentence each: numbers that do not exist, equations without home and reason, without test."""
    known, covered = homes(), tests()
    wrong = [
        f"({c}.{n}) is cited in {', '.join(places)} and does not exist in the thesis."
        for (c, n), places in sorted((known | covered).items())
        if c in range(2, 10) and n > LAST.get(c, 0)
    ]
    for number in EXPECTED:
        name = f"({number[0]}.{number[1]})"
        if number in known and number in REASONS:
            wrong.append(f"{name} has a home: take it from REASONS in docs/equations.py.")
        elif number not in known and number not in REASONS:
            wrong.append(f"{name} has no home: cite it where it is written, or say in REASONS why it is not.")
        elif number in known and number not in covered:
            wrong.append(f"{name} has no test: cite it in the doc string of the test that covers it.")
    return wrong


def page() -> str:
    """The text of EQUATIONS.md."""
    known, covered = homes(), tests()
    lines = [
        "# Equations",
        "",
        "Where each equation of sections 2.4, 2.5 and of chapters 3, 4, 5 of the thesis lives, and what tests it.",
        "Written by `python docs/equations.py` from the citations in the code. The files of `rbd_model/thesis/` hold",
        "chapter 3 as printed; deviations stand there under *Differs from the thesis*.",
        "",
        "| equation | code | tests |",
        "|---|---|---|",
    ]
    for number in EXPECTED:
        if number in REASONS:
            where, by = f"*none: {REASONS[number]}*", ""
        else:
            where, by = "<br>".join(dict.fromkeys(known[number])), "<br>".join(dict.fromkeys(covered[number]))
        lines.append(f"| ({number[0]}.{number[1]}) | {where} | {by} |")
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> int:
    wrong = complaints()
    for sentence in wrong:
        print(sentence, file=sys.stderr)
    if "--check" in arguments:
        if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != page():
            print("EQUATIONS.md is not what the code says: run python docs/equations.py.", file=sys.stderr)
            return 1
    else:
        PAGE.write_text(page(), encoding="utf-8")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
