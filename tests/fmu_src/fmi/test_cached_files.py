"""A stored file is used if it is complete, the user's own and in its place; else it is made again or refused."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from bogie_braking.commands import doctor
from fmu_src import archive, cached_files
from fmu_src import compile as compiling
from fmu_src.compile import CompilerError
from fmu_src.cosimulation.recording import Recording
from products import build_notes, prebuilt
from products.prebuilt import CONTENTS, contents, shipped, write_contents
from readers.storage import PARTIAL, StorageError, is_full
from tests.fmu_src.fmi.limits import files_of_at_most

ANSWER = {"answer.c": '__attribute__((visibility("default"))) int answer(void);\nint answer(void) { return 42; }\n'}
posix = pytest.mark.skipif(os.name != "posix", reason="owners, modes and limits of POSIX")


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the path of an empty cache that does not exist yet."""
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "cache")
    return tmp_path / "cache"


def made() -> Path:
    """Return the path of a library in the cache."""
    return compiling.plain_library(ANSWER)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-1000])


def flipped(path: Path) -> None:
    """Flip one bit and restore the file times."""
    about, data = path.stat(), bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    os.utime(path, ns=(about.st_atime_ns, about.st_mtime_ns))


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def without_checksum(path: Path) -> None:
    """Remove the checksum, as if a process was killed between both files or an older version wrote the library."""
    cached_files.checksum_file(path).unlink()
    cached_files._compared.clear()  # a process compares each file only once


def linked_out(path: Path) -> None:
    """Replace the library with a link to a file elsewhere with the right checksum."""
    shutil.move(path, path.parents[1] / "elsewhere")
    path.symlink_to(path.parents[1] / "elsewhere")


@pytest.mark.study
@pytest.mark.parametrize("damage", [cut, flipped, emptied, without_checksum, linked_out], ids=lambda one: one.__name__)
def test_a_library_that_is_not_whole_is_compiled_again(damage: Callable[[Path], None], cache: Path) -> None:
    before = made().read_bytes()
    damage(made())
    path = made()
    assert path.read_bytes() == before
    assert not path.is_symlink()
    assert compiling.loaded(path).answer() == 42
    assert sorted(one.suffix for one in cache.iterdir()) == [".o", ".sha256", ".sha256", ".so"]


def test_every_object_of_a_library_is_looked_at(cache: Path) -> None:
    before = made().read_bytes()
    for path in (*cache.glob("*.o"), made()):
        cut(path) if path.suffix == ".o" else path.unlink()
    assert made().read_bytes() == before


@pytest.mark.study
def test_a_note_that_is_cut_off_counts_for_nothing(cache: Path) -> None:
    """Regression test: half of a table of variables was read as a complete one."""
    texts = iter(["[1, 2, 3]", "[4]"])
    assert build_notes.noted("numbers", lambda: next(texts)) == "[1, 2, 3]"
    assert build_notes.noted("numbers", lambda: next(texts)) == "[1, 2, 3]"
    [note] = cache.glob("*.made")
    note.write_text("[1, 2")
    assert build_notes.noted("numbers", lambda: next(texts)) == "[4]"


def test_a_copied_cache_serves_its_own_files(cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Regression test: notes contained paths in the folder that was copied."""
    assert build_notes.noted_path("answer", made).is_relative_to(cache)
    shutil.copytree(cache, tmp_path / "copy")
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "copy")
    found = build_notes.noted_path("answer", lambda: pytest.fail("it is there"))
    assert found.is_relative_to(tmp_path / "copy")
    found.unlink()
    assert build_notes.noted_path("answer", made).is_relative_to(tmp_path / "copy")


@pytest.mark.parametrize("text", ["", "../outside", "/etc/hostname"])
def test_a_note_leads_nowhere_else(text: str, cache: Path) -> None:
    compiling.cache()
    cached_files.keep(b"x", cache.parent / "outside")
    assert compiling.path_from(text) is None


@posix
def test_a_new_cache_is_for_its_owner_alone_whatever_the_umask(cache: Path) -> None:
    before = os.umask(0)
    try:
        path = made()
    finally:
        os.umask(before)
    assert cache.stat().st_mode & 0o777 == 0o700
    assert path.stat().st_mode & 0o022 == 0


@posix
@pytest.mark.parametrize("mode", [0o777, 0o775, 0o702])
def test_a_cache_that_others_can_write_is_refused_with_what_to_do(mode: int, cache: Path) -> None:
    cache.mkdir()
    cache.chmod(mode)
    words = f"{cache} must be yours alone; others can write to it (mode 0{mode:o}). Run chmod -R go-w {cache}, or name"
    with pytest.raises(CompilerError, match=re.escape(words)):
        made()
    found = doctor.cache(compiles=False)
    assert found.verdict == doctor.MISSING
    assert "others can write" in found.text


@posix
def test_files_and_folders_of_another_user_are_not_ours() -> None:
    for user, ours in ((os.geteuid(), True), (0, True), (os.geteuid() + 1, False)):
        words = cached_files.of_others(SimpleNamespace(st_uid=user, st_mode=0o100644))  # type: ignore[arg-type]
        assert (words == "") == ours
    assert f"it belongs to user {os.geteuid() + 1}" in words


@posix
def test_a_file_that_others_can_write_is_compiled_again(cache: Path) -> None:
    made().chmod(0o666)
    assert not cached_files.whole(next(cache.glob("*.so")))
    assert cached_files.whole(made())


@posix
def test_a_full_disk_is_one_sentence_with_the_folder_and_what_to_do(cache: Path, tmp_path: Path) -> None:
    compiling.cache()
    words = r"Free space on its disk, or name .* TMPDIR\.$"
    with files_of_at_most(100), pytest.raises(CompilerError, match=words) as caught:
        made()
    assert is_full(caught.value)  # a sweep stops at this error, whereas other errors fail one point
    made()
    next(cache.glob("*.so")).unlink()
    with files_of_at_most(100), pytest.raises(CompilerError, match=r"Cannot write .*Free space on its disk, or name"):
        made()
    with (
        files_of_at_most(100),
        pytest.raises(CompilerError, match=rf"Cannot write {cache}.* or name .*BOGIE_BRAKING_CACHE\.$"),
    ):
        build_notes.noted("numbers", lambda: "1" * 1000)
    with files_of_at_most(100):
        assert "Free space" in doctor.cache(compiles=False).advice
    assert not list(cache.glob(f"*{PARTIAL}"))


@posix
def test_results_that_do_not_fit_leave_those_of_before(tmp_path: Path) -> None:
    recording = Recording({"time": "s"}, [[float(row)] for row in range(1000)])
    tasks: dict[str, Callable[[Path], object]] = {
        "table.csv": recording.write,
        "made.fmu": lambda path: archive.write_archive(path, {"noise": os.urandom(1000)}),
    }
    for name, write in tasks.items():
        path = tmp_path / name
        path.write_text("before")
        words = f"Cannot write {path}: File too large. Free space on its disk, or choose another folder."
        with files_of_at_most(100), pytest.raises(StorageError, match=re.escape(words)) as caught:
            write(path)
        assert is_full(caught.value)
        assert path.read_text() == "before"
    assert sorted(one.name for one in tmp_path.iterdir()) == sorted(tasks)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device of Linux")
def test_a_device_is_written_to_and_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "full.csv").symlink_to("/dev/full")
    with pytest.raises(StorageError, match=r"No space left on device\. Free space on its disk"):
        Recording({"time": "s"}, [[0.0]]).write(tmp_path / "full.csv")
    assert Path("/dev/full").is_char_device()


def test_a_place_that_cannot_be_written_is_one_sentence(cache: Path) -> None:
    """In a read-only cache, existing files are used and a missing file raises an error."""
    path = made()
    path.unlink()
    path.with_name(path.name + cached_files.LOCK).mkdir()
    with pytest.raises(CompilerError, match=rf"Cannot write {cache}.*Name another folder in the environment"):
        made()
    path.with_name(path.name + cached_files.LOCK).rmdir()
    made()
    path.with_name(path.name + cached_files.LOCK).mkdir()
    assert made() == path


#: Program that kills itself after writing a file, before the rename.
KILLED = """
import os, signal, sys
from pathlib import Path
from fmu_src import compile as compiling
compiling.CACHE = Path(sys.argv[1])
Path.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
compiling.noted("text.made", lambda: "1")
"""


@posix
def test_a_process_that_was_killed_while_it_wrote_holds_nobody_up(cache: Path) -> None:
    ended = subprocess.run([sys.executable, "-c", KILLED, str(cache)], cwd=Path(__file__).parents[3])
    assert ended.returncode == -signal.SIGKILL
    [partial] = cache.glob(f".*{PARTIAL}")
    assert compiling.noted("text.made", lambda: "2") == "2"
    old = time.time() - 2 * cached_files.STALE
    os.utime(partial, (old, old))
    fresh = cache / f".fresh{PARTIAL}"
    fresh.write_text("")
    made()
    assert not partial.exists()
    assert fresh.exists()
    assert not list(cache.glob(f"*{cached_files.LOCK}"))


def test_doctor_names_what_is_not_whole(cache: Path) -> None:
    path = made()
    assert doctor.cache(compiles=True).verdict == doctor.OK
    cut(path)
    found = doctor.cache(compiles=True)
    assert found.verdict == doctor.WITHOUT
    assert found.advice == "Nothing to do: each is made again when it is next needed."
    assert f"not whole: {path.name}" in found.text


def test_doctor_says_where_libraries_cannot_be_loaded(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some disks are mounted without permission to execute."""

    def refused(_: str) -> None:
        raise OSError("failed to map segment from shared object")

    monkeypatch.setattr(compiling.ctypes, "CDLL", refused)
    found = doctor.cache(compiles=True)
    assert found.verdict == doctor.MISSING
    assert "failed to map segment" in found.text
    assert found.advice == (
        "Name another folder in the environment, BOGIE_BRAKING_CACHE, on a disk from which programs may run."
    )


def test_what_a_release_brought_serves_while_it_is_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prebuilt, "PREBUILT", tmp_path)
    (tmp_path / "kernel").mkdir()
    (tmp_path / "kernel" / "a.so").write_bytes(bytes(2000))
    write_contents(tmp_path, "here", [])
    assert shipped("kernel/a.so") == tmp_path / "kernel" / "a.so"
    cut(tmp_path / "kernel" / "a.so")
    assert shipped("kernel/a.so") is None
    assert "damaged: kernel/a.so" in doctor.prebuilt().text
    for damaged in ('{"platform": "here", "con', "[" * 3000):
        (tmp_path / CONTENTS).write_text(damaged)
        assert contents() == {}
        assert doctor.prebuilt().text == f"prebuilt FMUs: damaged: {CONTENTS}"


def test_files_of_an_installation_are_compared_with_what_pip_noted(tmp_path: Path) -> None:
    (tmp_path / "abc").write_bytes(b"abc")
    # FIPS 180-4, the example of one block, in base64.
    noted = "ungWv48Bz-pBQUDeXa4iI7ADYaOWF3qctBD_YfIAFa0"
    assert doctor.unchanged(tmp_path / "abc", noted)
    cut(tmp_path / "abc")
    assert not doctor.unchanged(tmp_path / "abc", noted)
    assert not doctor.unchanged(tmp_path / "gone", noted)
