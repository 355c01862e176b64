"""Test JSON documents: read as they are meant, or refused with one message."""

from __future__ import annotations

import errno
import json
import math
import os
import random
import sys
from contextlib import nullcontext
from pathlib import Path

import pytest

from fmu_src.cosimulation.recording import Recording
from products.study.points import judge
from readers.documents import DEEPEST, LARGEST_INTEGER, document, document_text, is_number, read_document
from readers.storage import StorageError, sync_folder, write_whole
from readers.text import FileError, shown

REFUSED = {
    b"": "must be JSON; got a fault in line 1, column 1",
    b'{"a": 1,\n "b" 2}': "must be JSON; got a fault in line 2, column 6",
    b"{} {}": "must be JSON; got a fault in line 1, column 4",
    b'"a\tb"': "must be JSON",
    b"[NaN]": "must have finite numbers; got NaN.",
    b"-Infinity": "must have finite numbers; got -Infinity.",
    b"1e999": "must have finite numbers; got 1e999.",
    b"9" * 5000: "must have integers up to 2^53",
    b"-9007199254740993": "must have integers up to 2^53",
    b'{"a": 1, "b": 2, "a": 1}': "must name each value once; got a again.",
    b"[" * (DEEPEST + 1) + b"]" * (DEEPEST + 1): "must nest brackets at most 64 deep",
    b"[" * 100_000: "must nest brackets at most 64 deep",
    b'{"a":' * 3000 + b"1" + b"}" * 3000: "must nest brackets at most 64 deep",
    b'["\xe9"]': "must be text in UTF-8; got the byte 0xe9.",
    b'{"\\udc80": 1}': "must hold Unicode text; got \\udc80",
    b"\xff\xfe[\0]\0": "must be text in UTF-8",
}


@pytest.mark.parametrize("text", REFUSED, ids=lambda text: repr(text[:20]))
def test_what_is_no_document_is_refused_with_a_sentence(text: bytes) -> None:
    with pytest.raises(FileError) as refused:
        document(text, "The file")
    assert str(refused.value).startswith(f"The file {REFUSED[text]}")
    assert str(refused.value).count("\n") == 0
    assert len(str(refused.value)) < 200


def test_what_is_a_document_is_read(tmp_path: Path) -> None:
    value = {"a": [1, -2.5e-300, None, True, "\u00e9 \U0001f682"], "b": {"c": LARGEST_INTEGER}}
    path = tmp_path / "one.json"
    write_whole(path, document_text(value).encode())
    assert read_document(path) == value
    assert document(b"\xef\xbb\xbf[1.5]", "with a mark") == [1.5]
    assert document(b"[" * DEEPEST + b"7" + b"]" * DEEPEST, "deep") == json.loads("[" * DEEPEST + "7" + "]" * DEEPEST)


@pytest.mark.parametrize("value", [True, "1", None, math.nan, -math.inf, 10**400, 10**5000, [1]], ids=range(8))
def test_what_is_no_number_is_told_and_shown(value: object) -> None:
    assert not is_number(value)
    assert 0 < len(shown(value)) < 80
    assert judge({"x": value}, ["x"]).failure or value is None


def test_a_value_is_shown_as_files_write_it() -> None:
    circle: dict[object, object] = {(1, 2): 3}
    values = (None, True, [1, "a"], "", "a\nb", 1.5, circle, 50 * "x")
    told = ("null", "true", '[1, "a"]', "''", r"'a\nb'", "1.5", "a dict", f"'{40 * 'x'}'... (50 characters)")
    assert tuple(map(shown, values)) == told


def test_random_documents_come_back_and_cut_ones_are_refused() -> None:
    chance = random.Random(7)

    def value(depth: int) -> object:
        kind = chance.randrange(6 if depth else 4)
        if kind == 4:
            return [value(depth - 1) for _ in range(chance.randrange(4))]
        if kind == 5:
            return {f"name {n}": value(depth - 1) for n in range(chance.randrange(4))}
        return (chance.uniform(-1e9, 1e9), chance.randrange(-(2**53), 2**53), chance.choice([None, True]), "\u00fc")[
            kind
        ]

    for _ in range(300):
        written = {"value": value(5)}
        text = json.dumps(written, ensure_ascii=chance.random() < 0.5).encode()
        assert document(text, "") == written
        with pytest.raises(FileError):
            document(text[: chance.randrange(len(text))], "")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes among its files")
def test_a_folder_and_a_pipe_are_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path, tmp_path / "pipe"):
        with pytest.raises(FileError, match="must be a file; got a folder or a device"):
            read_document(path)


def test_a_file_that_cannot_be_written_is_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "table.csv"
    write_whole(path, b"old")

    def full(place: int) -> None:
        raise OSError("No space left on device")

    monkeypatch.setattr("readers.storage.os.fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_whole(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(StorageError, match=r"nowhere/table\.csv: No such file or directory\. Choose another folder\.$"):
        write_whole(tmp_path / "nowhere" / "table.csv", b"new")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows syncs no folders")
@pytest.mark.parametrize(("number", "told"), [(errno.EINVAL, False), (errno.ENOSPC, True), (errno.EIO, True)])
def test_a_file_system_need_not_sync_folders(
    number: int, told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(place: int) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("readers.storage.os.fsync", refused)
    with pytest.raises(OSError, match=os.strerror(number)) if told else nullcontext():
        sync_folder(tmp_path)


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_recording_is_written_whole_or_stays_as_it_was(
    ending: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyarrow.parquet")
    path = tmp_path / f"run.{ending}"
    table = Recording({"time": "s", "speed": "m/s"}, [[0.0, 1.0], [1.0, 2.0]])
    before = table.write(path).read_bytes()

    def full(place: int) -> None:
        raise OSError("No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("readers.storage.os.fsync", full)
        with pytest.raises(OSError, match="No space left"):
            Recording({"time": "s"}, [[3.0]]).write(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(StorageError, match="nowhere"):
        table.write(tmp_path / "nowhere" / path.name)
