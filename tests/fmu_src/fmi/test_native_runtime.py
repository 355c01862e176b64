"""Compilation of the C runtime: shared objects, repeated compilation, and builds without a C compiler on PATH."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import generate
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, Variable, model_of


def decay() -> System:
    system = System("decay", "x' = -x")
    x = system.state("x", "1", 1.0, 1.0)
    system.derivative(x, -x)
    system.output(Variable("x", "output", "1", "x"), x)
    return system


@pytest.fixture
def compiled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the list of C files that the compiler receives; the cache is empty."""
    files: list[str] = []
    run_compiler = compiling.run

    def count(command: Sequence[str], target: str | None, folder: Path) -> None:
        files.extend(word for word in command if word.endswith(".c"))
        run_compiler(command, target, folder)

    monkeypatch.setattr(compiling, "run", count)
    monkeypatch.setattr(compiling, "CACHE", tmp_path)
    return files


@pytest.mark.study
def test_what_two_want_is_compiled_once_for_the_fmu_and_for_studies(compiled: list[str]) -> None:
    """Both libraries contain the same objects.

    All models share the objects of the runtime. Models with other numbers, here another tolerance, share the objects of
    the equations. Two threads represent two processes that begin together: one waits for the result of the other.
    """
    sources = generate(model_of(decay(), 1e-9))
    with ThreadPoolExecutor(2) as both:
        first, second = both.map(compiling.library_of, [sources, sources])
    assert first == second
    assert len(compiled) == len(set(compiled)) > 0
    assert compiling.library_of(sources, fmu=True) != first
    assert compiled.count(f"equations_{decay().name}.c") == 1
    compiled.clear()
    compiling.library_of(generate(model_of(decay(), 1e-8)))
    assert compiled == ["model.c"]


@pytest.mark.study
def test_machine_without_a_c_compiler_builds_with_zig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    assert compiling.compiler()[:3] == [sys.executable, "-m", "ziglang"]
    target = tmp_path / f"decay{compiling.library_suffix()}"
    compiling.compile_library(generate(model_of(decay(), 1e-9)), target)
    kernel = Kernel(Library(target))
    kernel.advance(1.0)
    assert kernel["x"] == pytest.approx(0.36787944, abs=1e-7)


@pytest.mark.parametrize(
    ("cc", "target", "sentence"),
    [
        ("", None, "There is no C compiler on this machine: install gcc or clang"),
        ("", "aarch64-linux-gnu", "To compile for aarch64-linux-gnu takes zig, which is not installed"),
        ("", compiling.WEB_TARGET, "A live page needs zig, which is not installed: run `make live`"),
        ("no-such-compiler -m32", None, r"The C compiler no-such-compiler of \$CC is not on this machine"),
    ],
)
def test_where_nothing_compiles_a_sentence_says_what_to_install(
    cc: str, target: str | None, sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("CC", cc)
    monkeypatch.setattr(compiling, "has", lambda _: False)
    with pytest.raises(compiling.CompilerError, match=rf"{sentence}.*pip install 'bogie-braking\[compiler\]'"):
        compiling.run(["-c", "nothing.c"], target, tmp_path)


def test_refused_c_source_names_the_compiler_and_its_words(tmp_path: Path) -> None:
    with pytest.raises(compiling.CompilerError, match=r"failed:\n.*error"):
        compiling.compile_library({"model.c": "int broken("}, tmp_path / "x")
    assert list(tmp_path.iterdir()) == []


def test_cache_that_cannot_be_made_gets_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from bogie_braking.__main__ import main

    (tmp_path / "taken").write_text("")
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "taken" / "cache")
    assert main(["run", "qr30-130kpa", "--out", str(tmp_path)]) == 3
    shown = capsys.readouterr().err
    assert f"Cannot write {tmp_path / 'taken' / 'cache'}" in shown
    assert "Name another folder in the environment, BOGIE_BRAKING_CACHE" in shown
    assert shown.count("\n") == 1
