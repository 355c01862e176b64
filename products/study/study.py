"""One function of named numbers over many points: in memory, or kept in a folder, resumed there, and one table."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fmu_src.progress import counting
from products.sources import sources, versions
from products.study.journal import JOURNAL, Journal, only_writer
from products.study.points import Evaluate, Evaluator, Outcome, Point, SweepError, check_point
from products.study.table import remove_table, write_table
from readers.storage import is_full, sync_folder


@dataclass(frozen=True)
class Study:
    """A function of named numbers, and the points at which it is evaluated.

    name: of its folder and its bar. units: of the varied parameters, then of the results. results: their names. points:
    varied values, by the numbers of the points. head: settings that all points of one table share, in addition to the
    code. provenance: of the table.
    """

    name: str
    units: Mapping[str, str]
    results: Sequence[str]
    points: Sequence[Point]
    evaluate: Evaluate
    head: Mapping[str, Any]
    provenance: Mapping[str, Any] = field(default_factory=dict)


def outcomes_of(study: Study, run_points: Evaluator, journal: Journal | None = None) -> dict[int, Outcome]:
    """Evaluate the points that the log does not have; return the outcomes of all by the numbers of the points.

    Raises SweepError if a worker returns the results of another point, and KeyboardInterrupt with a message.
    """
    found = dict(journal.outcomes) if journal else {}
    left = {number: point for number, point in enumerate(study.points) if number not in found}
    count = len(study.points)
    try:
        with (
            closing(run_points(study.evaluate, left)) as outcomes,
            counting(text=study.name, total=count, unit="point", initial=len(found)) as bar,
        ):
            for some in outcomes:
                for number, outcome in some.items():
                    check_point(study.points[number], outcome)
                if journal:
                    journal.add(some)
                found.update(some)
                bar.update(len(some))
    except KeyboardInterrupt:
        if journal is None:
            raise
        raise KeyboardInterrupt(
            f"{study.name} was interrupted with {len(journal.outcomes)} of {count} points done; the same command goes "
            "on from there."
        ) from None
    return found


def kept_outcomes_of(
    study: Study,
    evaluator: AbstractContextManager[Evaluator],
    folder: Path,
    restart: bool = False,
    tell: Callable[[Journal], None] = lambda journal: None,
) -> tuple[list[Outcome], list[str]]:
    """Run or resume a study in a folder."""
    head = {**study.head, "versions": versions() | {"sources": sources()}}
    with _room_in(folder), ExitStack() as held:
        # The cluster is reached first: if it does not answer, the folder must not appear.
        run_points = None if folder.exists() else held.enter_context(evaluator)
        held.enter_context(only_writer(folder))
        if restart:
            remove_table(folder)
            (folder / JOURNAL).unlink(missing_ok=True)
            sync_folder(folder)
        journal = Journal(folder / JOURNAL, head, study.points, study.results)
        tell(journal)
        if len(journal.outcomes) < len(study.points):
            run_points = run_points or held.enter_context(evaluator)
            with journal:
                remove_table(folder)
                outcomes_of(study, run_points, journal)
        outcomes = [journal.outcomes[number] for number in range(len(study.points))]
        counts = {"points": len(outcomes), "failed": sum(outcome.failure is not None for outcome in outcomes)}
        return outcomes, write_table(folder, study.units, study.points, outcomes, head | counts, study.provenance)


@contextmanager
def _room_in(folder: Path) -> Iterator[None]:
    """Raise SweepError, with the folder and the remedy, if a disk is full."""
    try:
        yield
    except OSError as error:
        if not is_full(error):
            raise
        raise SweepError(
            f"{folder} must have room for the results; got {error.strerror or str(error)!r}. Make room, and the same "
            "command goes on from the points that are done."
        ) from None
