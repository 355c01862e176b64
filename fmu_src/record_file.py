"""C of records: the description of their file for the runtime, and the records with which a model is generated."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import lru_cache, partial

from fmu_src.c_literals import c_array, c_number, c_text
from fmu_src.piecewise import piecewise_in_c
from fmu_src.records import OwnRecord, Record, RecordKind
from fmu_src.unique_names_in_c import with_own_names
from fmu_src.user_files import OfRecord, RecordFile

#: In front of the names that the model's C has at the scope of its file.
PREFIX = "of_records_"
#: Prefix of the names of root records and of their files.
OWN = "records_"


def record_file_source(file: RecordFile, variable: int, roots: int) -> str:
    """Return C of RECORD_FILE, a `record_file_description`."""
    kinds = kinds_of(file.kind)
    places = [f"KIND_{kind.name.upper()}" for kind in kinds]
    names = [f"enum {{ {', '.join(places)} }};"]
    for kind in kinds:
        numbers = [f"NUMBER_{kind.name}_{number.name}".upper() for number in kind.numbers]
        names.append(f"enum {{ {', '.join(numbers)} }};" if numbers else "")
    [given] = with_own_names(["\n".join([*names, file.source])], PREFIX)
    lines = ['#include <stdio.h>\n#include "record_file.h"', given]
    for kind, place in zip(kinds, places, strict=True):
        lines += _arrays_of_kind(kind, place, kinds)
    words = (file.noun, f"/{file.resource}", file.remedy, file.owner, file.kind.name)
    counts = str(file.version), str(roots)
    members = [str(variable), *map(c_text, words), *counts, "KIND_OF_RECORD", f"{PREFIX}check_record"]
    lines.append(c_array("record_kind", "KIND_OF_RECORD", (_kind(kind) for kind in kinds)))
    lines.append(f"static const record_file_description RECORD_FILE = {{{', '.join(members)}}};")
    return "\n".join(line for line in lines if line)


def kinds_of(root: RecordKind) -> list[RecordKind]:
    """Return a kind and those of all records in its lists, each once, the root first."""
    found = [root]
    for kind in found:
        found += [one.kind for one in kind.lists if one.kind not in found]
    return list(dict.fromkeys(found))


def _arrays_of_kind(kind: RecordKind, place: str, kinds: list[RecordKind]) -> Iterable[str]:
    numbers = (
        f"{{{c_text(number.name)}, {c_number(number.minimum)}, {c_number(number.maximum)}}}" for number in kind.numbers
    )
    tables = (
        f"{{{c_text(table.name)}, {2 + table.degree}, {c_number(table.minimum)}, {c_number(table.maximum)}}}"
        for table in kind.tables
    )
    lists = (f"{{{c_text(one.name)}, {kinds.index(one.kind)}, {one.least}, {one.most}}}" for one in kind.lists)
    yield c_array("number_of_record", f"NUMBER_OF_{place}", numbers)
    yield c_array("table_of_record", f"TABLE_OF_{place}", tables)
    yield c_array("list_of_record", f"LIST_OF_{place}", lists)


def _kind(kind: RecordKind) -> str:
    place = f"KIND_{kind.name.upper()}"
    parts = ((kind.numbers, "NUMBER"), (kind.tables, "TABLE"), (kind.lists, "LIST"))
    counts = [str(len(some)) for some, _ in parts]
    return f"{{{', '.join([*counts, *(f'{word}_OF_{place}' if some else '0' for some, word in parts)])}}}"


@lru_cache(maxsize=64)
def own_name(own: OwnRecord) -> str:
    """Return the name of a root record in C."""
    return f"{OWN}{hashlib.sha256(repr(own.record).encode()).hexdigest()[:12]}"


def own_records(records: Iterable[OfRecord]) -> dict[str, Record]:
    """Return the root records of these by their names in C."""
    return {own_name(fromkey): fromkey.record for fromkey in dict.fromkeys(each.own for each in records)}


def record_in_c(name: str, record: Record) -> str:
    """Return C of a root record and of all that is in its lists; equal tables are written once."""
    lines = ['#include "model.h"', '#include "records.h"']
    known: dict[tuple[str, object], str] = {}

    def once(kind: str, content: object, values: Iterable[str]) -> str:
        if (kind, content) not in known:
            known[kind, content] = f"{name}_{len(known)}"
            lines.append(c_array(kind, known[kind, content], values))
        return known[kind, content]

    def entry(one: Record) -> str:
        numbers = once("double", one.numbers, map(c_number, one.numbers)) if one.numbers else "0"
        rows = [piecewise_in_c(table, partial(once, "double", table)) for table in one.tables]
        tables = once("piecewise", one.tables, rows) if rows else "0"
        rows = [once("record", each, [entry(own) for own in each]) if each else "0" for each in one.lists]
        rows = [f"{{{len(each)}, {row}}}" for each, row in zip(one.lists, rows, strict=True)]
        lists = once("record_list", one.lists, rows) if rows else "0"
        return f"{{{numbers}, {tables}, {lists}}}"

    root = entry(record)
    return "\n".join([*lines, f"RUNTIME_LOCAL const record {name} = {root};", ""])
