"""A report on a controller as one page that loads no other file: criteria, failures, stops that play, digests."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import Any

from bogie_braking.controllers import page, report_text, table
from bogie_braking.controllers.acceptance import FAILS, PASSES, CaseResult, Finding, extreme
from bogie_braking.controllers.report_text import NO_CLAIM
from bogie_braking.web.frame import filled
from products.machine import Machine
from products.protection.criteria import Criterion

#: Heads of the table of all cases, and whether their columns are numbers or strings; those of `table.cells` between.
BEFORE, AFTER = ("case", "group", "verdict"), ("jerk [m/s3]", "commands", "source of the numbers")
#: Columns of `table.cells` that a report of one controller lacks.
WITHOUT = ("case", "controller", "longer by")


def report_page(
    machine: Machine,
    about: str,
    document: Mapping[str, Any],
    tested: Sequence[CaseResult],
    criteria: Sequence[Criterion],
    found: Sequence[Finding],
) -> str:
    """Return the text of the page, from stops with their histories."""
    scores = [one.score for one in tested]
    failed = [one.case for one in found if one.verdict != PASSES]
    return filled(
        "acceptance.html.jinja",
        title=f"Report on the wheel-slide controller {document['controller']}",
        headline=document["message"],
        result=document["verdict"].replace(" ", "-"),
        claim=NO_CLAIM,
        about=about,
        first=failed[0] if failed else tested[0].case.name,
        criteria=criteria_table(found, criteria),
        failures=(
            heads(report_text.FAILED_HEADS, ("value", "95 %")),
            grouped(report_text.failed_rows(found, criteria)),
        ),
        scores=cases_table(tested, found),
        messages=table.messages(scores),
        inputs=inputs_table(document),
        arguments=shlex.join(document["arguments"]),
        effort="the pressure of its cylinder",
        data=page.data(machine, scores),
    )


def heads(names: Sequence[str], numbers: Sequence[str]) -> list[tuple[str, str]]:
    """Return the heads of a table, each with the kind of its column."""
    return [(name, "number" if name in numbers else "text") for name in names]


def grouped(rows: Sequence[Sequence[str]]) -> list[list[Sequence[str]]]:
    """Return rows as groups of one row each."""
    return [[row] for row in rows]


def criteria_table(found: Sequence[Finding], criteria: Sequence[Criterion]) -> tuple[Any, Any]:
    """Return heads and rows of the criteria, with the measure and the source of each limit."""
    more = [("distance in every draw", "always required"), *((one.measure, one.source) for one in criteria)]
    rows = [(*row, *of) for row, of in zip(report_text.criteria_rows(found, criteria), more, strict=True)]
    return heads((*report_text.HEADS, "measure", "source of the limit"), report_text.NUMBERS), grouped(rows)


def cases_table(tested: Sequence[CaseResult], found: Sequence[Finding]) -> tuple[Any, Any]:
    """Return heads and rows of all cases."""
    kept = [place for place, head in enumerate(table.HEADS) if head not in WITHOUT]
    middle = page.heads([table.HEADS[place] for place in kept], [table.UNITS[place] for place in kept])
    rows = []
    for one in tested:
        cells = table.cells(one.score)
        known = one.score.stop.judged
        worst = [
            f"{extreme(name, one):{form}}" if known else "-" for name, form in (("jerk", ".2f"), ("commands", ".0f"))
        ]
        first = one.case.name, one.case.group or "-", verdict_on(one.case.name, found)
        rows.append((*first, *(cells[place] for place in kept), *worst, one.case.source))
    return [*heads(BEFORE, ()), *middle, *heads(AFTER, AFTER[:2])], grouped(rows)


def verdict_on(case: str, found: Sequence[Finding]) -> str:
    """Return the verdict on a case in words, with the number of its failures."""
    own = [one for one in found if one.case == case]
    failures = sum(one.verdict == FAILS for one in own)
    return f"{FAILS} {failures}" if failures else report_text.of_all(own)


def inputs_table(document: Mapping[str, Any]) -> tuple[Any, Any]:
    """Return heads and rows of the inputs with their digests."""
    rows = [(key, one["file"], one["sha256"]) for key, one in document["inputs"].items()]
    rows.append(("sources", f"bogie-braking {document['versions']['bogie-braking']}", document["sources"]))
    return heads(("input", "file", "SHA-256"), ()), grouped(rows)
