"""Test randomly damaged files of users: each is read, or refused with one message that names it."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bogie_braking.controllers.replay import read_log
from products.protection.criteria import read_criteria
from products.protection.programme import read_programme
from products.train.consist_file import read_consist
from rbd_model.contact.creep.tabulated import CreepTable, axes, read_creep_table, write_table
from rbd_model.track.line import Line, read_line
from readers import text as text_files
from scenarios.bench.torque_history import read_torque_history
from tests.readers.mutations import (
    CONSISTS,
    CONSISTS_IN_TOML,
    CRITERIA,
    LINES,
    LOGS,
    PROGRAMMES,
    TORQUES,
    mutated,
)

COUNT = 2000
LONGEST_SENTENCE = 700
#: Reader of each kind of file: name of the file, valid files, reader.
KINDS: dict[str, tuple[str, Sequence[str], Callable[[Path], Any]]] = {
    "line": ("line.csv", LINES, read_line),
    "consist": ("consist.csv", CONSISTS, read_consist),
    "consist in TOML": ("consist.toml", CONSISTS_IN_TOML, read_consist),
    "log": ("log.csv", LOGS, read_log),
    "torque": ("torque.csv", TORQUES, read_torque_history),
    "programme": ("programme.toml", PROGRAMMES, read_programme),
    "criteria": ("criteria.toml", CRITERIA, read_criteria),
}


def refusal(read: Callable[[Path], Any], path: Path) -> str:
    """Return the message of a refusal, or an empty string if the file is read."""
    try:
        found = read(path)
    except ValueError as error:
        return str(error)
    if isinstance(found, Line):
        assert all(np.all(np.isfinite(values)) for values in found.rows.values())
    return ""


def check_sentence(said: str, path: Path) -> None:
    assert str(path) in said
    assert said.isprintable(), said
    assert len(said) < LONGEST_SENTENCE
    assert said.endswith((".", "?"))


@pytest.mark.study
@pytest.mark.parametrize("kind", KINDS)
def test_a_spoilt_file_is_read_or_refused_in_one_sentence(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The reader receives the bytes directly, because writing 2000 files takes seconds."""
    name, good, read = KINDS[kind]
    path = tmp_path / name
    for text in good:
        path.write_text(text, encoding="utf-8")
        assert refusal(read, path) == ""
    taken = 0
    for data in mutated(good, COUNT, seed=47):
        monkeypatch.setattr(text_files, "first_bytes", lambda path, count, largest, data=data: data)
        said = refusal(read, path)
        taken += not said
        if said:
            check_sentence(said, path)
    assert COUNT / 10 < taken < COUNT


def test_a_spoilt_creep_table_is_read_or_refused_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only a few rows of the table and its head are changed and read, because the whole is too large to be read 2000
    times.
    """
    path = tmp_path / "table.csv"
    write_table(CreepTable(np.zeros((*(place.size for place in axes()), 2))), path)
    assert refusal(read_creep_table, path) == ""
    whole = path.read_text(encoding="utf-8").splitlines()
    chance, good = random.Random(47), "\n".join(whole[:4]) + "\n"
    for data in mutated([good], COUNT, seed=48):
        monkeypatch.setattr(text_files, "first_bytes", lambda path, count, largest, data=data: data)
        check_sentence(refusal(read_creep_table, path), path)  # most values are missing
    monkeypatch.undo()
    twice = [*whole[:-1], whole[chance.randrange(1, 100)]]
    path.write_text("\n".join(twice), encoding="utf-8")
    assert "it is there twice" in refusal(read_creep_table, path)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("place", ["folder", "missing", "pipe"])
def test_what_is_no_file_is_refused(kind: str, place: str, tmp_path: Path) -> None:
    name, _, read = KINDS[kind]
    path = tmp_path / name
    if place == "folder":
        path.mkdir()
    if place == "pipe":
        os = pytest.importorskip("os")
        if not hasattr(os, "mkfifo"):
            pytest.skip("this system has no pipes with names")
        os.mkfifo(path)
    check_sentence(refusal(read, path), path)


def test_depth_and_digits_of_toml_have_limits(tmp_path: Path) -> None:
    path = tmp_path / "consist.toml"
    for value in (
        "[" * 3000,
        "{a=" * 3000,
        "[" * 100 + "]" * 100,
        "9" * 400,
        "9" * 5000,
        "inf",
        "nan",
        "true",
        "1e400",
    ):
        path.write_text(f"[[vehicle]]\nkind = 'locomotive'\nload = {value}\n")
        check_sentence(refusal(read_consist, path), path)
    path.write_text("vehicle" + ".a" * 3000 + " = 1\n")
    check_sentence(refusal(read_consist, path), path)
