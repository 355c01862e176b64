"""Evaluate points of a sweep in worker processes or on a Dask cluster; a failed point does not end the sweep.

Every worker process imports this module, so its imports are light.
"""

import multiprocessing
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import islice
from queue import SimpleQueue
from typing import Any, TypeVar

from fmu_src.progress import hide_bars
from readers.documents import is_number
from readers.storage import is_full
from readers.text import shown

#: Points that each worker has before it, so that it need not wait for the next one.
AHEAD = 2
#: Windows cannot wait for more processes than that.
MOST_JOBS = 61 if sys.platform == "win32" else sys.maxsize
#: Longest message on a failure [characters]; longer ones are cut off.
LONGEST_FAILURE = 2000
#: Building a kernel is not thread-safe; a Dask worker may have several threads.
ONE_AT_A_TIME = threading.Lock()

Point = Mapping[str, float]


class SweepError(RuntimeError):
    """The sweep itself cannot continue; the text states the reason and the remedy."""


@dataclass(frozen=True)
class Outcome:
    """Outcome of a point: its results (None: did not happen), or a message with the reason of its failure.

    point: the parameters that the worker received, which must be those of the row. message: in addition to
    results.
    """

    results: Mapping[str, float | None] | None = None
    failure: str | None = None
    point: Point | None = None
    message: str = ""


Evaluate = Callable[[Point], Outcome]
#: Outcomes as they come, by the number of the point: of one point, or of several that were made together.
Outcomes = Generator[dict[int, Outcome], None, None]
Evaluator = Callable[[Evaluate, Mapping[int, Point]], Outcomes]
Task = TypeVar("Task")
Answer = TypeVar("Answer")


def evaluate(run: Callable[..., Mapping[str, float | None]], promised: Sequence[str], point: Point) -> Outcome:
    """Runs one point; an error, or anything but the promised finite results, is its failure.

    Raises OSError or CompilerError where a disk is full.
    """
    try:
        with ONE_AT_A_TIME:
            outcome = judge(run(**point), promised)
    except (Exception, SystemExit) as error:
        if is_full(error):
            raise
        outcome = Outcome(failure=f"{type(error).__name__}: {error}")
    message = None if outcome.failure is None else one_line(outcome.failure)
    return Outcome(outcome.results, message, point)


def one_line(text: str) -> str:
    """Return a message as one line of limited length that UTF-8 can encode."""
    line = " ".join(text.encode("utf-8", "backslashreplace").decode().split())
    return line if len(line) <= LONGEST_FAILURE else f"{line[:LONGEST_FAILURE]}..."


def judge(found: Any, promised: Sequence[str]) -> Outcome:
    """Return the results as plain numbers, or the reason why they are invalid."""
    if not isinstance(found, Mapping):
        return Outcome(failure=f"The point returned a {type(found).__name__}; results by name were promised.")
    if set(found) != set(promised):
        names = ", ".join(map(str, found)) or "nothing"
        return Outcome(failure=f"The point returned {names}; promised were {', '.join(promised)}.")
    results: dict[str, float | None] = {}
    for name in promised:
        value = found[name]
        if not (value is None or is_number(value)):
            got = repr(value) if isinstance(value, str | bool) else shown(value)
            return Outcome(failure=f"The point returned {name} = {got}, which is not a finite number.")
        results[name] = None if value is None else float(value)
    return Outcome(results)


def check_point(point: Point, outcome: Outcome) -> None:
    """Raise SweepError if an outcome is that of another point."""
    if outcome.point is not point and repr(outcome.point) != repr(point):  # repr: NaN is NaN, and 0.0 is not -0.0
        raise SweepError(
            f"A worker must return the results of {shown(dict(point))}; got those of "
            f"{shown(dict(outcome.point or {}))}. Nothing of them is kept; restart the workers, and the same "
            "command goes on."
        )


def outcomes_from(
    executor: Executor, work: Callable[[Task], Answer], tasks: Mapping[int, Task], window: int
) -> Iterator[tuple[int, Future[Answer]]]:
    """Yield tasks as they finish, by their number; at most `window` of them run at once.

    The others are cancelled at the end.
    """
    waiting, done = iter(tasks.items()), SimpleQueue[Future[Answer]]()
    under_way: dict[Future[Answer], int] = {}
    try:
        while True:
            for number, task in islice(waiting, window - len(under_way)):
                future = executor.submit(work, task)
                under_way[future] = number
                future.add_done_callback(done.put)
            if not under_way:
                return
            future = done.get()
            yield under_way.pop(future), future
    finally:
        for future in under_way:
            future.cancel()


def leave_with_parent() -> None:
    """End this process when its parent has ended; otherwise the pool would wait indefinitely after a killed parent."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def prepare_worker() -> None:
    """Prepare a worker: Ctrl-C ends it without output, and it shows no bars. The parent reports."""
    hide_bars()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    threading.Thread(target=leave_with_parent, daemon=True).start()


@contextmanager
def process_pool(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Yield worker processes that start from scratch (spawn), on every system alike."""
    spawn = multiprocessing.get_context("spawn")
    executor = ProcessPoolExecutor(jobs, spawn, prepare_worker)
    try:
        yield executor
    finally:
        executor.shutdown(cancel_futures=True)


def in_processes(jobs: int, evaluate_point: Evaluate, points: Mapping[int, Point]) -> Outcomes:
    """Yield outcomes from worker processes of this computer.

    If a worker dies, the running points are repeated one by one. A point whose worker dies again has failed.
    """
    left = dict(points)
    while left:
        jobs = min(jobs, len(left), MOST_JOBS)
        try:
            with process_pool(jobs) as executor:
                for number, future in outcomes_from(executor, evaluate_point, dict(left), AHEAD * jobs):
                    outcome = future.result()
                    del left[number]
                    yield {number: outcome}
        except BrokenProcessPool:
            # Points go out in order, so those under way are the first that are left.
            for number in list(left)[: AHEAD * jobs]:
                yield {number: alone(evaluate_point, left.pop(number))}


def alone(evaluate_point: Evaluate, point: Point) -> Outcome:
    """Evaluate one point in a separate process."""
    with process_pool(1) as executor:
        try:
            return executor.submit(evaluate_point, point).result()
        except BrokenProcessPool:
            died = "The worker process died, and once more when it had nothing but this point."
            return Outcome(failure=died, point=point)


def point_function(run: Callable[..., Mapping[str, float | None]], promised: Sequence[str]) -> Evaluate:
    """Return the evaluation of one point as a function of its parameters alone, for any worker.

    Raises SweepError if workers could not load it.
    """
    try:
        pickle.dumps(run)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise SweepError(
            f"No worker can load the point function ({error}); it must stand at the top level of a file that workers "
            "can import."
        ) from error
    return partial(evaluate, run, tuple(promised))
