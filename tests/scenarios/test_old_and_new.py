"""New against old: ratios and their limits, and messages about revisions that cannot be measured."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from products.sources import ROOT
from scenarios.bench.drive import prepare
from scenarios.comparisons.peers import old_and_new
from scenarios.comparisons.peers.old_and_new import NEW, OLD, Comparison, Job, Timed, Tree
from scenarios.scenario import BadInputError

STOPS = {tree: Job(tree, "bogie", "stop", (("level", 1),)) for tree in (OLD, NEW)}


def test_a_ratio_is_new_over_old_beside_what_is_wanted_and_judges_nothing() -> None:
    found = {STOPS[OLD]: Timed(4e-3, 400), STOPS[NEW]: Timed(3e-3, 200)}
    wanted = [Comparison("stop", STOPS[NEW], STOPS[OLD], most) for most in (0.75, 0.7)]
    each = Comparison("a step", STOPS[NEW], STOPS[OLD], 2.0, of_a_step=True)
    good, bad, step = old_and_new.rows_of([*wanted, each], found)
    assert good.simulated == bad.simulated == pytest.approx(0.75)
    assert step.simulated == pytest.approx(1.5)
    assert good.source == "measured now; to be at most 0.75: reached"
    assert bad.source == "measured now; to be at most 0.7: not reached"
    assert good.assumption == "3000 and 4000 us, 200 and 400 steps"
    assert {good.holds, bad.holds, step.holds} == {None}


def test_the_least_of_all_copies_and_rounds_counts_and_jobs_take_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(old_and_new, "ROUNDS", 2)
    asked = []

    def measure(job: Job, copy: int) -> Timed:
        asked.append((job.tree, copy))
        return Timed(1.0 + abs(len(asked) - 5), len(asked))

    found = old_and_new.least_of_all(list(STOPS.values()), measure)
    assert asked == [(tree, copy) for copy in (0, 1, 2, 3, 0, 1, 2, 3) for tree in (OLD, NEW)]
    assert found == {STOPS[OLD]: Timed(1.0, 5), STOPS[NEW]: Timed(2.0, 4)}


def test_in_space_less_time_is_wanted_and_elsewhere_no_more() -> None:
    wanted = {one.what: one.most for one in old_and_new.against_old()}
    assert wanted["bogie, spatial: stop, new / old"] == 0.5
    assert wanted["coach, spatial, as published: stop, new / old"] == 0.55
    assert wanted["bogie, spatial: stop in two lanes, new / old"] == 1.0
    assert {most for what, most in wanted.items() if "spatial" not in what} == {1.0}
    assert all((one.above.tree, one.below.tree, one.below.lanes) == (NEW, OLD, 0) for one in old_and_new.against_old())


def test_stops_on_lines_are_those_of_the_new_code_without_a_line_but_for_it() -> None:
    files = {words: Path(f"{words}.csv") for words in old_and_new.lines()}
    for one in old_and_new.on_lines(files):
        assert (one.above.tree, one.below.tree, one.most) == (NEW, NEW, 1.1)
        [(name, file)] = set(one.above.values) - set(one.below.values)
        assert name == "line_file"
        assert one.of_a_step == (file == "curved.csv")


def test_binaries_are_compared_where_both_have_them(tmp_path: Path) -> None:
    path = tmp_path / "a.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("binaries/linux64/a.so", b"0" * 300)
        archive.writestr("modelDescription.xml", b"0" * 1000)
    size = old_and_new.binaries_in(path)
    assert size == 300
    binary, build = old_and_new.rows_of_builds(10.0, {"a": 200, "gone": 1}, 11.0, {"a": size, "new": 1})
    assert (binary.quantity, binary.simulated) == ("binary of a, new / old", 1.5)
    assert (build.simulated, build.source) == (1.1, "measured now; to be at most 1.15: reached")


def answers(monkeypatch: pytest.MonkeyPatch, **known: str) -> None:
    """Replace git by fixed answers."""
    monkeypatch.setattr(old_and_new, "git", lambda *words: known.get(words[0].replace("-", "_")))


def test_a_checkout_is_needed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for told in ({}, {"rev_parse": str(tmp_path)}):
        answers(monkeypatch, **told)
        assert main(["run", "speed", "--against", "HEAD", "--out", str(tmp_path / "out")]) == 2
        assert capsys.readouterr().err.startswith("--against needs git and a checkout")


def test_a_revision_that_is_not_there_or_too_old_is_refused_with_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    told = {"--show-toplevel": str(ROOT)}
    monkeypatch.setattr(old_and_new, "git", lambda *words: told.get(words[1]))
    with pytest.raises(BadInputError, match="There is no revision newest; give --against a commit"):
        old_and_new.commit_of("newest")
    told |= {"--verify": "c0ffee", "--name-only": "build_fmu.py\nfmu_src/compile.py"}
    with pytest.raises(BadInputError, match="Revision v0 is too old, it has no fmu_src/kernel"):
        old_and_new.commit_of("v0")
    told["--name-only"] = "\n".join(old_and_new.NEEDED)
    assert old_and_new.commit_of("v1") == "c0ffee"


@pytest.mark.long
def test_the_code_of_another_folder_answers_and_what_it_cannot_do_is_told(tmp_path: Path) -> None:
    tree = Tree(NEW, ROOT, tmp_path)
    tree.copy_libraries()
    values = old_and_new.values_of("bogie", 1)
    found = tree.measure(Job(NEW, "bogie", "stop", values), 3)
    kernel = prepare("bogie", **dict(values))
    kernel.advance(old_and_new.STOP)
    assert found.steps == kernel.counts["steps"]
    assert found.seconds > 0.0
    with pytest.raises(BadInputError, match=r"The new code cannot be measured \(.*no variable mas.*\); give --against"):
        tree.measure(Job(NEW, "bogie", "stop", (("mas", 1.0),)), 0)
    tree.close()


def test_code_that_cannot_be_imported_is_told(tmp_path: Path) -> None:
    (tmp_path / "fmu_src").mkdir()
    (tmp_path / "fmu_src" / "__init__.py").write_text("raise ImportError('of another time')")
    tree = Tree(OLD, tmp_path, tmp_path)
    with pytest.raises(BadInputError, match=r"The old code cannot be measured \(ImportError: of another time\)"):
        tree.copy_libraries()
    tree.close()


def test_all_fmus_are_built_with_an_empty_cache_and_each_is_counted(tmp_path: Path) -> None:
    script = """
import os, sys, zipfile
from pathlib import Path
assert not Path(os.environ["BOGIE_BRAKING_CACHE"]).exists()
out = Path(sys.argv[2]) / "native"
out.mkdir(parents=True)
for name in "ab":
    with zipfile.ZipFile(out / f"{name}.fmu", "w") as archive:
        archive.writestr("binaries/a.so", b"0" * 7)
    print(f"{out / name}.fmu  7 kB  valid")
"""
    (tmp_path / "build_fmu.py").write_text(script)
    tree = Tree(OLD, tmp_path, tmp_path)
    counted: list[int] = []
    seconds, sizes = old_and_new.build(tree, tmp_path, lambda: counted.append(1))
    assert (sizes, len(counted)) == ({"a": 7, "b": 7}, 2)
    assert seconds > 0.0
    (tmp_path / "build_fmu.py").write_text("raise SystemExit(1)")
    with pytest.raises(BadInputError, match="The old code does not build its FMUs"):
        old_and_new.build(tree, tmp_path, lambda: None)
    tree.close()
