"""A report on a controller as a document for programs, with digests of its inputs; and its comparison with another."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from bogie_braking.controllers.acceptance import CaseResult, Finding, verdict_of
from bogie_braking.controllers.report_text import NO_CLAIM, headline
from bogie_braking.controllers.table import runs_document
from bogie_braking.reporting.scenario import BadInputError
from products.module_files import digest_of
from products.protection.criteria import Criterion
from products.sources import versions
from readers.documents import finite, integer_in, list_in, mapping_in, read_document, text_in
from readers.text import FileError, shown

#: Number of the layout of a report.
FORMAT = 1
#: Modules whose sources affect the numbers of a report.
MODULES = ("bogie_braking.controllers.acceptance",)
#: Largest relative difference of two equal values [1]: round-off of another compiler.
EQUAL = 1e-6
#: Parts of a report that are compared; files and sources are compared by their digests, versions are not.
COMPARED = ("format", "claim", "verdict", "message", "controller", "criteria", "findings", "cases")
#: Most differences that a message names.
MOST_NAMED = 5


def inputs_of(files: Mapping[str, Path]) -> dict[str, dict[str, str]]:
    """Return the name and the SHA-256 digest of each file. Raises BadInputError if one cannot be read."""
    try:
        digests = {key: hashlib.sha256(path.read_bytes()).hexdigest() for key, path in files.items()}
    except OSError as error:
        raise BadInputError(f"{error.filename} cannot be read ({error.strerror}); give a file.") from None
    return {key: {"file": path.name, "sha256": digests[key]} for key, path in files.items()}


def report_document(
    name: str,
    arguments: Sequence[str],
    inputs: Mapping[str, Any],
    tested: Sequence[CaseResult],
    criteria: Sequence[Criterion],
    found: Sequence[Finding],
) -> dict[str, Any]:
    """Return a report as a JSON object."""
    runs = runs_document([one.score for one in tested])
    cases = [
        asdict(replace(one.case, line=None, line_file=None)) | {"dry": one.dry.distance, "stops": run}
        for one, run in zip(tested, runs, strict=True)
    ]
    document = {
        "format": FORMAT,
        "claim": NO_CLAIM,
        "verdict": verdict_of(found),
        "message": headline(name, found, criteria),
        "controller": name,
        "arguments": arguments,
        "inputs": inputs,
        "versions": versions(),
        "sources": digest_of(*MODULES),
        "criteria": [asdict(one) | {"unit": one.unit} for one in criteria],
        "findings": [asdict(one) for one in found],
        "cases": cases,
    }
    whole: dict[str, Any] = finite(document)
    return whole


def read_report(path: Path) -> dict[str, Any]:
    """Return a report of a file."""
    try:
        found = read_document(path)
        what = str(path)
        integer_in(found, "format", what, FORMAT, FORMAT)
        for name in ("verdict", "sources"):
            text_in(found, name, what)
        for key, one in mapping_in(found, "inputs", what).items():
            text_in(one, "sha256", f"{what}, {key}")
        for one in list_in(found, "findings", what):
            for name in ("criterion", "case", "verdict"):
                text_in(one, name, f"{what}, findings")
        mapping_in(found, "versions", what)
        for one in list_in(found, "arguments", what):
            if not isinstance(one, str):
                raise FileError(f"{what}: arguments must be strings; got {shown(one)}.")
    except OSError as error:
        raise BadInputError(f"{path} cannot be read ({error.strerror}); give a report.") from None
    except FileError as error:
        raise BadInputError(str(error)) from None
    return dict(found)


def input_differences(report: Mapping[str, Any], inputs: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Return the files that are not those of a report, and whether the sources that affect results are others."""
    wanted = report["inputs"]
    found = [
        f"{key}: {of['file']} has another SHA-256"
        for key, of in inputs.items()
        if wanted.get(key, {}).get("sha256") != of["sha256"]
    ]
    found += [f"{key}: the report has one" for key in wanted if key not in inputs]
    if report["sources"] != digest_of(*MODULES):
        found.append(f"sources of bogie-braking: the report is of version {report['versions'].get('bogie-braking')}")
    return found


def differences(report: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    """Return the differences of two reports in words: verdict, findings, and all else but files and versions."""
    found = []
    if report["verdict"] != other["verdict"]:
        found.append(f"verdict: {report['verdict']} in the report, {other['verdict']} now")
    ours = {(one["criterion"], one["case"]): one for one in other["findings"]}
    for one in report["findings"]:
        place = one["criterion"], one["case"]
        mine = ours.pop(place, None)
        if mine is None or one["verdict"] != mine["verdict"] or not same(one.get("value"), mine["value"]):
            now = "is not there now" if mine is None else f"{mine['verdict']} with {mine['value']} now"
            found.append(f"{place[0]}, {place[1]}: {one['verdict']} with {one.get('value')} in the report, {now}")
    found += [f"{name}, {case}: not in the report" for name, case in ours]
    return found or changed(compared(report), json.loads(json.dumps(compared(other))), "")


def compared(report: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parts of a report that another must have, too."""
    return {key: report.get(key) for key in COMPARED}


def changed(one: object, other: object, place: str) -> list[str]:
    """Return the places at which two JSON values differ, with both values."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return [
            text
            for key in dict.fromkeys([*one, *other])
            for text in changed(one.get(key), other.get(key), f"{place}, {key}" if place else key)
        ]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = enumerate(zip(one, other, strict=True), 1)
        return [text for number, (a, b) in pairs for text in changed(a, b, f"{place} {number}")]
    equal = one == other or (not isinstance(one, bool) and not isinstance(other, bool) and same(one, other))
    return [] if equal else [f"{place}: {shown(one)} in the report, {shown(other)} now"]


def same(one: object, other: object) -> bool:
    """Return whether two values are equal, or differ by round-off."""
    if isinstance(one, int | float) and isinstance(other, int | float):
        return math.isclose(one, other, rel_tol=EQUAL, abs_tol=EQUAL)
    return one is None and other is None


def check_message(path: Path, found: Sequence[str], count: int) -> str:
    """Return the result of a check; count: number of findings."""
    if not found:
        return f"{path} is reproduced: files, sources, verdict, {count} findings and all stops are equal."
    more = f"; and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    return f"{path} is not reproduced. {'; '.join(found[:MOST_NAMED])}{more}."
