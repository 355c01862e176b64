"""The test rig behind a UDP socket, paced by the clock: a controller in another process or machine answers in time.

  bogie-braking controllers loop --rail low                    one stop on the low rail, at 127.0.0.1:5005
  bogie-braking controllers loop --programme full --rail low   a case of a programme
  bogie-braking controllers loop --host 0.0.0.0 --pace 0.5     a client on another computer, at half the pace
  bogie-braking controllers answer mine.py:PI                  the client, in another terminal

The page In the loop has the protocol; 'controllers client c' and 'controllers client python' print its clients.

Exit status: 0 the client stopped the vehicle and missed no period; 1 it did not; 2 bad input; 3 the simulation failed;
130 interrupted.
"""

from __future__ import annotations

import argparse
import gc
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace

import numpy as np

from bogie_braking.controllers.options import add_case, rigged
from bogie_braking.controllers.remote import Counts, Remote
from bogie_braking.controllers.scoring import ScoredController, ideal_distance, runs_of
from bogie_braking.controllers.table import document, lines, show, write_document
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.scenario import BadInputError
from brake_controller.rig.udp_client import HOST, PORT
from brake_controller.wheel_slide import PATIENCE
from products.machine import Machine
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from readers.command_line import quantity, whole

#: Longest period on the clock [s]: the rig polls the clock for its start and end within the processor time of an
#: answer.
LONGEST = 0.45 * PATIENCE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("--host", default=HOST, help=f"where the rig listens (default: {HOST}, this machine alone)")
    parser.add_argument(
        "--port",
        type=whole("--port", 0, 65535),
        default=PORT,
        help=f"its UDP port; 0: any that is free (default: {PORT})",
    )
    text = "seconds of the run in a second on the clock; 0: as fast as answers come (default: 1)"
    parser.add_argument("--pace", type=quantity("--pace", least=0.0), default=1.0, help=text)
    add_case(parser)


def run(chosen: argparse.Namespace) -> bool:
    """Run one stop of a client in the loop; return whether it stopped without a missed period."""
    machine, settings, known = rigged(chosen)
    cases = {case.name: case for case in known}
    if chosen.rail not in cases:
        raise BadInputError(f"There is no case {chosen.rail}; give --rail one of {', '.join(cases)}.")
    [run] = runs_of(machine, [cases[chosen.rail]])
    with socket_at(chosen.host, chosen.port) as own:
        found = run_in_loop(machine, run, settings, own, chosen.pace)
    ideal = ideal_distance(machine, run, settings)
    score = ScoredController(
        chosen.rail, "client", found.stop, machine.parameters.wheel_radius, ideal, None, run.driven
    )
    about = document(machine.title, settings, [score]) | {"loop": loop_document(found)}
    text = write_document(chosen.out / "controllers" / "loop.json", about)
    show(chosen, text, [*lines(machine.title, settings, [score]), "", *messages(found)])
    return found.holds


@contextmanager
def socket_at(host: str, port: int) -> Iterator[socket.socket]:
    """Yield a bound UDP socket."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:
        try:
            own.bind((host, port))
        except (OSError, OverflowError) as error:
            raise BadInputError(
                f"Port {port} of {host} cannot be had ({error}); give another --host or --port."
            ) from None
        yield own


@contextmanager
def without_collections() -> Iterator[None]:
    """Disable Python's garbage collection, which takes milliseconds, within this context."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


@dataclass(frozen=True)
class Looped:
    """A stop of a client in the loop; silent_from: time from which the watchdog replaced it, if it did [s]."""

    stop: Stop
    counts: Counts
    pace: float
    period: float
    late: np.ndarray
    answered: np.ndarray
    silent_from: float | None

    @property
    def holds(self) -> bool:
        """Return whether the client stopped the vehicle and answered in every period."""
        return self.stop.distance is not None and not self.counts.missed


def run_in_loop(machine: Machine, run: Run, settings: Settings, own: socket.socket, pace: float) -> Looped:
    """Run one stop under a client at the other end of a socket."""
    if pace and settings.period / pace > LONGEST:
        least = settings.period / LONGEST
        raise BadInputError(f"--pace must be 0, or at least {least:.2g} with this period; got {pace:g}.")
    with counting(text="in the loop", unit="s") as bar, without_collections():
        remote = Remote(own, settings.period, pace, bar)
        try:
            [stop] = Rig(machine, remote.found, settings, by_flow=True).runs([run])
        finally:
            remote.close()
    silent = remote.silent_from
    if silent is not None:
        message = (
            f"No answer came from {silent:g} s on, and the watchdog applied the brake: no stop of this controller."
        )
        stop = replace(stop, distance=None, message=message)
    elif remote.counts.for_the_rig:
        message = (
            f"The rig itself asked late in {remote.counts.for_the_rig} of the periods that were missed: not judged. "
        )
        stop = replace(
            stop, distance=None, judged=False, message=message + "Lower --pace, or lower the load of this machine."
        )
    late, answered = np.array(remote.late), np.array(remote.answered)
    return Looped(stop, remote.counts, pace, settings.period, late, answered, silent)


def messages(found: Looped) -> Iterator[str]:
    """Yield messages on the received answers and the missing ones."""
    c, period = found.counts, found.period
    paced = f"at {found.pace:g} times the clock's pace" if found.pace else "as fast as answers came"
    yield f"In the loop: {c.periods} periods of {1e3 * period:g} ms, {paced}."
    row = f", at most {c.longest_silence} in a row" if c.missed else ""
    rig = f", {c.for_the_rig} of them where the rig asked late" if c.for_the_rig else ""
    yield f"Missed: {c.missed} periods{row}{rig}. The watchdog applied the brake {c.watchdog} times."
    rest = f"{c.malformed} malformed, {c.strangers} from others"
    yield f"Thrown away: {c.late} late answers, {c.repeated} repeated, {rest}."
    yield from c.messages
    if found.answered.size:
        yield f"An answer took {times(found.answered)}."
    if found.pace:
        yield f"The rig asked late by {times(found.late)}."


def times(of: np.ndarray) -> str:
    """Return median, 99 % and largest of times [s], in words."""
    middle, most = (1e3 * float(np.percentile(of, share)) for share in (50, 99))
    return f"{middle:.2f} ms in the median, {most:.2f} ms at 99 %, {1e3 * float(of.max()):.2f} ms at most"


def loop_document(found: Looped) -> dict[str, object]:
    """Return the results for programs; times in s."""
    shares = {"median": 50, "99 %": 99, "longest": 100}
    series = {"answered": found.answered, "asked_late": found.late}
    told = {
        name: {key: float(np.percentile(of, share)) for key, share in shares.items()}
        for name, of in series.items()
        if of.size
    }
    whole = {"pace": found.pace, "holds": found.holds, "silent_from": found.silent_from}
    return whole | asdict(found.counts) | told
