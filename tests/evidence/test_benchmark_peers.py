"""Peers of the benchmark: each is run where it is installed, and missing with a sentence where it is not."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from types import ModuleType

import pytest

from scenarios.benchmark import elsewhere
from scenarios.benchmark.case_file import CASES, read_case
from scenarios.benchmark.programs import CannotAnswerError, of_adapter, of_module
from scenarios.benchmark.score import processor_time

#: Case, question and allowed relative error of each peer, where it is installed.
SERVED = {
    "altrios": ("en-14531-1-twelve-axles", "distance", 1e-3),
    "exudyn": ("two-vehicle-impact", "force", 1e-5),
    "oxiphysics": ("stop-on-gradients", "distance", 0.05),
    "railprofac": ("en-14531-1-twelve-axles", "brake_force", 1e-6),
    "sumo": ("stop-on-gradients", "distance", 3e-3),
    "transportation_ai999x": ("stop-on-gradients", "distance", 3e-4),
}
ADAPTER = """
NAME = "strange"
def version():
    print("not an answer")
    return "7"
def answer(question, inputs):
    if inputs["mass_1"] > 100e3:
        raise ValueError("too heavy\\nlong story")
    return {"force": sum(number * number for number in range(200_000)) * 0 + 4.0, "unknown": 1.0}
"""


@pytest.mark.parametrize("name", SERVED)
def test_a_peer_answers_where_it_is_installed(name: str) -> None:
    module = importlib.import_module(f"evidence.benchmark_peers.{name}")
    case_name, answer, allowed = SERVED[name]
    case = read_case(CASES / f"{case_name}.toml")
    assert module.answer("no such question", dict(case.points[0].inputs)) is None
    try:
        program = of_module(module)
    except ImportError as error:
        pytest.skip(f"{module.NAME} is not installed here: {error}")
    for number, point in enumerate(case.points):
        if answer in point.published:
            assert program.ask(case, number)[answer] == pytest.approx(point.published[answer], rel=allowed)


def test_an_adapter_runs_in_another_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    adapter = tmp_path / "strange.py"
    adapter.write_text(ADAPTER)
    case = read_case(CASES / "two-vehicle-impact.toml")
    monkeypatch.setenv(elsewhere.PLACE, sys.executable)
    other = elsewhere.other_python()
    assert other is not None
    assert other is elsewhere.other_python()
    module = ModuleType("strange")
    module.NAME, module.__file__ = "strange", str(adapter)  # type: ignore[attr-defined]
    program = of_adapter(module, other)
    assert (program.name, program.version) == ("strange", "7")
    begin = processor_time()
    assert program.ask(case, 0) == {"force": 4.0}
    assert other.seconds > 0.0
    assert processor_time() - begin >= other.seconds / 2
    with pytest.raises(CannotAnswerError, match=r"^ValueError: too heavy$"):
        program.ask(case, 5)


def test_a_python_that_is_not_there_is_told() -> None:
    with pytest.raises(ImportError, match=r"BOGIE_BRAKING_PEERS must be the path of a Python; got /no/python"):
        elsewhere.OtherPython("/no/python")
    other = elsewhere.OtherPython(sys.executable)
    other.process.kill()
    other.process.wait()
    with pytest.raises(RuntimeError, match="ended"):
        other.call("/no/adapter.py", "version")
