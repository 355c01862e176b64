"""Table of docs/equations.md: the place of each equation of the thesis in the code, and the tests that cover it.

An equation is cited by its number in parentheses, in a docstring or a comment; "(3.82)-(3.88)" cites all between. The
page names the function or class around a citation and no line, so that it changes only if equations move.
"""

import ast
import io
import re
import tokenize
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from pages import ROOT, table

HOMES, TESTS = ("rbd_model", "brake_controller", "scenarios", "evidence"), "tests"
#: Number of the last equation of each chapter of the thesis.
LAST = {2: 16, 3: 124, 4: 2, 5: 4, 6: 7, 7: 3, 9: 1}
#: Equations that require a place or a reason: sections 2.4 and 2.5, chapters 3, 4 and 5.
EXPECTED = [*((2, n) for n in range(4, 13)), *((c, n) for c in (3, 4, 5) for n in range(1, LAST[c] + 1))]
#: Equations without a home, and why.
REASONS = {
    (2, 9): "an inequality; the simulated wheelset locks when the brake torque exceeds that of the adhesion",
    (2, 11): "an equation of curving; the models take curves from the line instead",
    (2, 12): "an equation of curving; the models take curves from the line instead",
}

Number = tuple[int, int]
_RANGE = re.compile(r"\((\d)\.(\d+)(?:\.?[a-d])?\)(?:\s*(?:-|to)\s*\((\d)\.(\d+)(?:\.?[a-d])?\))?")


def cited(text: str) -> set[Number]:
    """Return the equation numbers in a text."""
    found = set()
    for chapter, first, other, last in _RANGE.findall(text):
        end = int(last) if other == chapter else int(first)
        found |= {(int(chapter), number) for number in range(int(first), end + 1)}
    return found


def scopes(tree: ast.Module) -> list[tuple[int, int, str]]:
    """Return first line, last line and name of each function and class of a file, outer ones first."""
    found: list[tuple[int, int, str]] = []

    def visit(node: ast.AST, outer: str) -> None:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.ClassDef | ast.FunctionDef):
                name = f"{outer}.{child.name}" if outer else child.name
                found.append((child.lineno, child.end_lineno or child.lineno, name))
                visit(child, name)

    visit(tree, "")
    return found


def texts(path: Path) -> Iterator[tuple[str, str]]:
    """Yield each docstring and comment block of a Python file, after the name around it; "" for the file itself."""
    source = path.read_text(encoding="utf-8")
    tree = ast.parse(source)
    known = scopes(tree)
    pieces = [(1, ast.get_docstring(tree) or "")]
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            pieces.append((node.lineno, ast.get_docstring(node) or ""))
    pieces += comments(source)
    for line, text in sorted(pieces):
        yield next((name for first, last, name in reversed(known) if first <= line <= last), ""), text


def comments(source: str) -> list[tuple[int, str]]:
    """Return first line and text of each block of comments."""
    blocks: list[tuple[int, str]] = []
    end = -1
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            line, text = token.start[0], token.string.lstrip("#: ")
            if line == end + 1:
                first, before = blocks.pop()
                blocks.append((first, f"{before} {text}"))
            else:
                blocks.append((line, text))
            end = line
    return blocks


def homes() -> dict[Number, list[str]]:
    """Return places in the code by equation: the file, and the function or class unless it is the whole file."""
    found: dict[Number, list[str]] = defaultdict(list)
    for package in HOMES:
        for path in sorted((ROOT / package).rglob("*.py")):
            for name, text in texts(path):
                for number in sorted(cited(text)):
                    found[number].append(path.relative_to(ROOT).as_posix() + (f": {name}" if name else ""))
    return found


def tests() -> dict[Number, list[str]]:
    """Tests by equation, as file::name."""
    found: dict[Number, list[str]] = defaultdict(list)
    for path in sorted((ROOT / TESTS).rglob("test_*.py")):
        for name, text in texts(path):
            if name.startswith("test_"):
                for number in sorted(cited(text)):
                    found[number].append(f"{path.relative_to(ROOT).as_posix()}::{name}")
    return found


def complaints() -> list[str]:
    """Return messages on numbers that do not exist, equations without place and reason, equations without test."""
    known, covered = homes(), tests()
    wrong = [
        f"({c}.{n}) is cited in {', '.join(places)} and does not exist in the thesis."
        for (c, n), places in sorted((known | covered).items())
        if c in range(2, 10) and n > LAST.get(c, 0)
    ]
    for number in EXPECTED:
        name = f"({number[0]}.{number[1]})"
        if number in known and number in REASONS:
            wrong.append(f"{name} has a home: take it from REASONS in docs/generate/equations.py.")
        elif number not in known and number not in REASONS:
            wrong.append(f"{name} has no home: cite it where it is written, or say in REASONS why it is not.")
        elif number in known and number not in covered:
            wrong.append(f"{name} has no test: cite it in the doc string of the test that covers it.")
    return wrong


def generated() -> str:
    """Return the table."""
    known, covered = homes(), tests()
    rows = []
    for number in EXPECTED:
        if number in REASONS:
            where, by = f"*none: {REASONS[number]}*", ""
        else:
            where, by = "<br>".join(dict.fromkeys(known[number])), "<br>".join(dict.fromkeys(covered[number]))
        rows.append((f"({number[0]}.{number[1]})", where, by))
    return table(("equation", "code", "tests"), rows)
