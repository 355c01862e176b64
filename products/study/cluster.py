"""Evaluates points of a sweep on a Dask cluster."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING, Any

from products.sources import sources
from products.study.points import (
    AHEAD,
    Evaluate,
    Evaluator,
    Outcome,
    Outcomes,
    Point,
    SweepError,
    outcomes_from,
)
from readers.extras import named_extras
from readers.text import BadInputError

if TYPE_CHECKING:
    from distributed import Client

#: Time in which a scheduler answers and has a worker [s].
PATIENCE = 5.0


@contextmanager
def cluster(address: str) -> Iterator[Evaluator]:
    """Yield a function that gives outcomes of points from the workers of a scheduler.

    Raises BadInputError before any run: without Dask, a scheduler, workers, or workers with the sources of this
    checkout.
    """
    with named_extras():
        from distributed import Client
    check_form(address)
    for name in ("distributed", "distributed.client"):  # a lost scheduler gets our sentence, not its stack
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except OSError:
        raise BadInputError(
            f"No Dask scheduler answers at {address} within {PATIENCE:g} s; start one with 'dask scheduler', or leave "
            "out --scheduler."
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except (TimeoutError, asyncio.TimeoutError):  # two classes up to Python 3.10
            raise BadInputError(
                f"The Dask scheduler at {address} has no workers; start some with 'dask worker {address}'."
            ) from None
        check_sources(client)
        yield partial(on_cluster, client)


def check_form(address: str) -> None:
    """Raise BadInputError if it is not an address; a client would retry it."""
    from distributed.comm.addressing import parse_address, parse_host_port
    from distributed.comm.registry import get_backend

    try:
        scheme, place = parse_address(address)
        get_backend(scheme)
        parse_host_port(place)
    except ValueError:
        raise BadInputError(
            f"{address} is not an address of a Dask scheduler; write it as tcp://127.0.0.1:8786."
        ) from None


def check_sources(client: Client) -> None:
    """Raise BadInputError if workers have other equations."""
    answers: dict[str, Any] = client.run(sources, on_error="return")
    own = sources()
    for worker, answer in answers.items():
        if answer != own:
            raise BadInputError(
                f"The Dask worker {worker} has other sources ({answer}) than this checkout ({own}); start it from here."
            )


def on_cluster(client: Client, evaluate_point: Evaluate, points: Mapping[int, Point]) -> Outcomes:
    """Yield outcomes as they arrive; a point has failed if it ends as many workers as Dask allows."""
    from distributed.scheduler import KilledWorker

    executor = client.get_executor()
    try:
        for number, future in outcomes_from(executor, evaluate_point, points, AHEAD * sum(client.nthreads().values())):
            try:
                outcome = future.result()
            except KilledWorker:
                died = "The workers of the cluster died of this point, one after the other."
                outcome = Outcome(failure=died, point=points[number])
            yield {number: outcome}
    except CancelledError:
        raise SweepError("The Dask scheduler went away; the same command goes on when it is back.") from None
    finally:
        executor.shutdown(wait=False)
