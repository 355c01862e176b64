"""The code here against that of another revision: both built, and measured in turns by separate processes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmu_src.compile import library_suffix
from products.building import KINDS
from products.coach import AS_PUBLISHED, brakes
from products.registry import FMUS
from products.sources import ROOT
from rbd_model.track.line import Line, arc, clothoid, line_of, straight
from scenarios.measuring.timing import LEVELS
from scenarios.reporting.progress import counting
from scenarios.reporting.report import Row
from scenarios.scenario import BadInputError

OLD, NEW = "old", "new"
#: Files that a revision needs to be measured.
NEEDED = (
    "fmu_src/compile.py",
    "fmu_src/kernel.py",
    "products/registry.py",
    "scenarios/bench/asymmetric_shoes.py",
    "build_fmu.py",
)
#: Copies of each library, as two copies of one differ by 7 % by their load addresses; rounds over all, least taken.
COPIES, ROUNDS = 4, 5
#: Rounds of the jobs that take seconds: the cases of chapter 9.
LONG_ROUNDS = 2
#: Length of the stop [s] and of a communication step [s]; calls of each job.
STOP, HOST_STEP = 22.9, 1e-3
CALLS = {"right-hand side": 3000, "Jacobian": 1000, "host step": 1500, "stop": 1}
#: Torque capacity on each wheelset by vehicle [N.m].
TORQUE = {"bogie": 20e3, "vehicle": 8e3}
NAMES = {"bogie": "bogie", "vehicle": "coach"}
#: Largest allowed ratio of new to old in 3D by vehicle and action; other jobs may not be slower.
BANDS = {
    "bogie": {"right-hand side": 0.5, "Jacobian": 0.55, "host step": 0.6, "stop": 0.5},
    "vehicle": {"right-hand side": 0.55, "Jacobian": 0.55, "host step": 0.6, "stop": 0.55},
}
NOT_SLOWER = 1.0
STRAIGHT = "straight"
#: Largest allowed ratios: a stop on a line over straight track; chapter 9; binaries; and building all FMUs with an
#: empty cache.
ON_LINE, CASES, BINARIES, BUILD = 1.1, 0.5, 1.15, 1.15


@dataclass(frozen=True)
class Job:
    """A timed job: its kernel, values and action; lanes: largest number, 0 for the default."""

    tree: str
    vehicle: str
    action: str
    values: tuple[tuple[str, float | str], ...]
    lanes: int = 0


@dataclass(frozen=True)
class Timed:
    """The least time of one call [s], and the steps of the kernel until then."""

    seconds: float
    steps: int


@dataclass(frozen=True)
class Comparison:
    """The time of one job over that of another, and the largest ratio that is allowed.

    of_a_step: the ratio is that of the time of one step, if the numbers of steps may differ.
    """

    what: str
    above: Job
    below: Job
    most: float
    of_a_step: bool = False


# ---- what is compared ------------------------------------------------------------------------------------------------


def values_of(vehicle: str, level: int, **more: float | str) -> tuple[tuple[str, float | str], ...]:
    """Return the values of a stop from 25 m/s at a level, in 3D with contact model 2."""
    torques = (
        brakes(TORQUE[vehicle])
        if vehicle == "vehicle"
        else {f"brake_torque_{number}": TORQUE[vehicle] for number in (1, 2)}
    )
    return tuple({"level": level, "initial_speed": 25.0, **torques, **more}.items())


def against_old() -> Iterator[Comparison]:
    """Yield the same work by both; and comparisons with two lanes on this processor."""
    for vehicle, levels in (("bogie", (1, 2, 3)), ("vehicle", (2, 3))):
        for level in levels:
            values, name = values_of(vehicle, level), f"{NAMES[vehicle]}, {LEVELS[level]}"
            for action in CALLS:
                most = BANDS[vehicle][action] if level == 3 else NOT_SLOWER
                old, new = (Job(tree, vehicle, action, values) for tree in (OLD, NEW))
                yield Comparison(f"{name}: {action}, new / old", new, old, most)
                if level == 3:
                    two = Job(NEW, vehicle, action, values, 2)
                    yield Comparison(f"{name}: {action} in two lanes, new / old", two, old, NOT_SLOWER)
            if vehicle == "vehicle":
                published = values_of(vehicle, level, **AS_PUBLISHED)
                old, new = (Job(tree, vehicle, "stop", published) for tree in (OLD, NEW))
                yield Comparison(f"{name}, as published: stop, new / old", new, old, most)


def lines() -> dict[str, Line]:
    """Return the lines of stops: straight track, and a curve of 1000 m to either side."""
    left, right = arc(80.0, 1000.0, 0.06), arc(200.0, -1000.0, -0.06)
    before = straight(70.0)
    curved = [before, clothoid(40.0, before, left), left, clothoid(60.0, left, right), right]
    return {STRAIGHT: line_of([straight(450.0)], -50.0), "curved": line_of(curved, -50.0)}


def on_lines(files: dict[str, Path]) -> Iterator[Comparison]:
    """Yield stops of the new code on lines against straight track without one; curves need more steps."""
    for vehicle, name in NAMES.items():
        plain = Job(NEW, vehicle, "stop", values_of(vehicle, 3))
        for words, path in files.items():
            line = Job(NEW, vehicle, "stop", values_of(vehicle, 3, line_file=str(path)))
            stop = f"{name}, spatial: stop on a {words} line file"
            if words == STRAIGHT:
                yield Comparison(f"{stop} / without", line, plain, ON_LINE)
            else:
                yield Comparison(f"{stop}, a step / without", line, plain, ON_LINE, of_a_step=True)


# ---- rows ------------------------------------------------------------------------------------------------------------


def row_of(what: str, above: float, below: float, most: float, words: str = "") -> Row:
    """Return a ratio with its target; as times vary, the row has no limit."""
    ratio = above / below
    verdict = "reached" if ratio <= most else "not reached"
    return Row(what, "1", None, ratio, None, f"measured now; to be at most {most:g}: {verdict}", words)


def rows_of(comparisons: Iterable[Comparison], found: dict[Job, Timed]) -> list[Row]:
    """Return a row for each comparison, with both times and, of stops, the numbers of steps."""
    rows = []
    for one in comparisons:
        above, below = found[one.above], found[one.below]
        words = f"{1e6 * above.seconds:.4g} and {1e6 * below.seconds:.4g} us"
        if one.above.action == "stop":
            words += f", {above.steps} and {below.steps} steps"
        count = (above.steps, below.steps) if one.of_a_step else (1, 1)
        rows.append(row_of(one.what, above.seconds / count[0], below.seconds / count[1], one.most, words))
    return rows


# ---- another revision ------------------------------------------------------------------------------------------------


def git(*words: str) -> str | None:
    """Return the output of git on this checkout; None if git fails or is missing."""
    try:
        done = subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True)
    except FileNotFoundError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def commit_of(revision: str) -> str:
    """Return the commit of a revision that can be measured."""
    top = git("rev-parse", "--show-toplevel")
    if top is None or Path(top).resolve() != ROOT:
        raise BadInputError("--against needs git and a checkout of the repository: run speed in one.")
    commit = git("rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}")
    if commit is None:
        known = "give --against a commit, a branch or a tag that git knows here"
        raise BadInputError(f"There is no revision {revision}; {known}.")
    there = (git("ls-tree", "--name-only", commit, *NEEDED) or "").split()
    for name in NEEDED:
        if name not in there:
            raise BadInputError(f"Revision {revision} is too old, it has no {name}; give --against one that has.")
    return commit


def unpack(commit: str, folder: Path) -> Path:
    """Unpack the files of a commit into a new folder."""
    archive = folder.with_suffix(".tar")
    if git("archive", "--format=tar", f"--output={archive}", commit) is None:
        raise BadInputError(f"git cannot unpack {commit}; look whether {folder.parent} has room.")
    with tarfile.open(archive) as files:
        files.extractall(folder, filter="data")
    return folder


class Tree:
    """A folder with a revision, and a process with its code that runs jobs. Raises BadInputError if it fails."""

    def __init__(self, name: str, folder: Path, work: Path) -> None:
        self.name, self.folder, self._work = name, folder, work
        self._errors = (work / f"{name}.log").open("w+", encoding="utf-8")
        text = (Path(__file__).parent / "answering.py").read_text(encoding="utf-8")
        self._process = subprocess.Popen(
            [sys.executable, "-c", text],
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(folder)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
        )

    def ask(self, job: str, **values: Any) -> dict[str, Any]:
        """Return the result of one job."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            print(json.dumps({"job": job, **values}), file=self._process.stdin, flush=True)
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer.endswith("\n"):  # the process ended early
            self._process.wait()
            self._errors.seek(0)
            last = (self._errors.read().strip() or "it said nothing").splitlines()[-1]
            raise BadInputError(f"The {self.name} code cannot be measured ({last}); give --against another revision.")
        return dict(json.loads(answer))

    def copy_libraries(self) -> None:
        """Copy compiled kernels under the names that `measure` opens."""
        for vehicle in NAMES:
            self.ask("copy", vehicle=vehicle, copies=[self._copy(vehicle, number) for number in range(COPIES)])

    def _copy(self, vehicle: str, number: int) -> str:
        return str(self._work / f"{self.name}-{vehicle}-{number}{library_suffix()}")

    def measure(self, job: Job, copy: int) -> Timed:
        """Run a job with one of the copies."""
        size = STOP if job.action == "stop" else HOST_STEP
        values = {"values": dict(job.values), "action": job.action, "lanes": job.lanes, "count": CALLS[job.action]}
        return Timed(**self.ask("measure", path=self._copy(job.vehicle, copy), size=size, **values))

    def close(self) -> None:
        """End the process."""
        self._process.communicate()
        self._errors.close()


@contextmanager
def both(commit: str) -> Iterator[tuple[Path, dict[str, Tree]]]:
    """Yield a temporary folder, and the trees by name."""
    with tempfile.TemporaryDirectory() as place, ExitStack() as open_trees:
        work = Path(place)
        trees = {}
        for name, folder in ((OLD, unpack(commit, work / "revision")), (NEW, ROOT)):
            trees[name] = Tree(name, folder, work)
            open_trees.callback(trees[name].close)
        yield work, trees


# ---- measuring -------------------------------------------------------------------------------------------------------


def least_of_all(jobs: Sequence[Job], measure: Callable[[Job, int], Timed]) -> dict[Job, Timed]:
    """Return the least time of each job, over rounds and copies of its library, the jobs in turns."""
    found: dict[Job, Timed] = {}
    with counting(total=ROUNDS * COPIES * len(jobs), text="old and new", unit="job") as bar:
        for number in range(ROUNDS * COPIES):
            for job in jobs:
                timed = measure(job, number % COPIES)
                found[job] = min(found.get(job, timed), timed, key=lambda one: one.seconds)
                bar.update()
    return found


def case_rows(trees: dict[str, Tree]) -> list[Row]:
    """Return the rows of all cases of chapter 9, in threads."""
    runs = [(name, tree.ask("cases")) for _ in range(LONG_ROUNDS) for name, tree in trees.items()]
    old, new = (min(run["seconds"] for name, run in runs if name == wanted) for wanted in (OLD, NEW))
    words = f"{runs[-1][1]['cases']} cases, {new:.3g} and {old:.3g} s"
    return [row_of("chapter 9: all cases with recording, new / old", new, old, CASES, words)]


def build(tree: Tree, work: Path, built: Callable[[], object]) -> tuple[float, dict[str, int]]:
    """Build all FMUs of a revision with an empty cache.

    Returns [s].
    """
    out, cache = work / f"{tree.name}-fmus", work / f"{tree.name}-cache"
    environment = os.environ | {"PYTHONPATH": str(tree.folder), "BOGIE_BRAKING_CACHE": str(cache)}
    command, begin = [sys.executable, "build_fmu.py", "--out", str(out)], time.perf_counter()
    with subprocess.Popen(
        command, cwd=tree.folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        for line in process.stdout or ():
            if ".fmu " in line:
                built()
    if process.returncode:
        raise BadInputError(f"The {tree.name} code does not build its FMUs; give --against another revision.")
    return time.perf_counter() - begin, {path.stem: binaries_in(path) for path in (out / "native").glob("*.fmu")}


def binaries_in(fmu: Path) -> int:
    """Return the bytes of the binaries in an FMU."""
    with zipfile.ZipFile(fmu) as archive:
        return sum(one.file_size for one in archive.infolist() if one.filename.startswith("binaries/"))


def build_rows(trees: dict[str, Tree], work: Path) -> list[Row]:
    """Return the size of the binaries, and the cold build, once each."""
    with counting(total=len(trees) * len(FMUS) * len(KINDS), text="building all FMUs", unit="FMU") as bar:
        (old, sizes), (new, now) = (build(trees[name], work, bar.update) for name in (OLD, NEW))
    return rows_of_builds(old, sizes, new, now)


def rows_of_builds(old: float, sizes: dict[str, int], new: float, now: dict[str, int]) -> list[Row]:
    """Return the ratios of the binaries that both have, and of the times."""
    shared = sorted(sizes.keys() & now.keys())
    rows = [
        row_of(
            f"binary of {name}, new / old",
            now[name],
            sizes[name],
            BINARIES,
            f"{now[name] / 1e6:.3g} and {sizes[name] / 1e6:.3g} MB",
        )
        for name in shared
    ]
    words = f"{new:.0f} and {old:.0f} s, once"
    return [*rows, row_of("building all FMUs with an empty cache, new / old", new, old, BUILD, words)]


def rows(commit: str) -> list[Row]:
    """Return all rows; this takes minutes, most of them for the FMUs."""
    with both(commit) as (work, trees):
        for tree in trees.values():
            tree.copy_libraries()
        files = {words: line.write(work / f"{words}.csv") for words, line in lines().items()}
        comparisons = [*against_old(), *on_lines(files)]
        jobs = list(dict.fromkeys(job for one in comparisons for job in (one.below, one.above)))
        found = least_of_all(jobs, lambda job, copy: trees[job.tree].measure(job, copy))
        return [*rows_of(comparisons, found), *case_rows(trees), *build_rows(trees, work)]
