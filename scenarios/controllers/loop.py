"""The test rig behind a UDP socket, paced by the clock: a controller in another process or machine answers in time.

The page In the loop has the protocol; brake_controller/rig/udp_client.py and .c are its clients.
"""

from __future__ import annotations

import argparse
import gc
import math
import select
import socket
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from tqdm import tqdm

from brake_controller.rig.udp_client import ANSWER, END, HEADER, HELLO, HOST, LARGEST, MAGIC, PORT, question
from brake_controller.wheel_slide import APPLY, VENT
from products.protection.braked_machine import Machine
from products.protection.protected_stop import Settings
from products.protection.rig import PATIENCE, Rig
from products.protection.runs import Run, Stop
from scenarios.reporting.progress import counting
from scenarios.scenario import BadInputError

#: So long is a client waited for, and with pace 0 each of its answers [s].
WAIT, ANSWER_WITHIN = 60.0, 0.4
#: The brake applies after so many missed periods in a row, in the manner of a watchdog; assumed.
WATCHDOG = 20
#: Longest period on the wall: the rig waits for one to begin and to end within its patience with a controller [s].
LONGEST = 0.45 * PATIENCE
#: The last part of a wait is not slept but watched [s], for a sleep ends late; and the bar is drawn so often [s].
WATCHED, DRAWN = 2e-4, 0.5
#: A rig that asks later than this share of a period leaves its client too little of it.
LATE = 0.1
#: So many different sentences on malformed packets are kept.
KEPT = 5


@dataclass
class Counts:
    """What came, by packets, and what did not, by periods; times [s].

    missed: periods without an answer; for_the_rig: those of them in which the rig itself asked late; late: answers to
    a period that had been missed; repeated: answers to one that was answered; malformed: packets that are no answer;
    strangers: packets from others than the client; watchdog: how often it applied the brake.
    """

    periods: int = 0
    missed: int = 0
    for_the_rig: int = 0
    longest_silence: int = 0
    late: int = 0
    repeated: int = 0
    malformed: int = 0
    strangers: int = 0
    watchdog: int = 0
    sentences: list[str] = field(default_factory=list)

    def wrong(self, sentence: str) -> None:
        """Counts a malformed packet and keeps its sentence."""
        self.malformed += 1
        if sentence not in self.sentences and len(self.sentences) < KEPT:
            self.sentences.append(sentence)


def valves_in(packet: bytes, wheelsets: int, asked: int) -> tuple[int, list[int]]:
    """The sequence number of an answer and its valves; `asked`: the last number that was asked.

    Raises ValueError with a sentence for a packet that is none.
    """
    due = HEADER.size + wheelsets
    if len(packet) != due:
        raise ValueError(f"A packet of {len(packet)} bytes came; an answer for {wheelsets} wheelsets has {due}.")
    magic, kind, count, sequence = HEADER.unpack_from(packet)
    if magic != MAGIC:
        raise ValueError(f"A packet began with {magic!r}; begin answers with {MAGIC!r}.")
    if kind != ANSWER or count != wheelsets:
        raise ValueError(
            f"A packet of kind {kind} for {count} wheelsets came; an answer has kind {ANSWER}, for {wheelsets}."
        )
    if sequence > asked:
        raise ValueError(f"An answer had the sequence number {sequence} when {asked} was the last that was asked.")
    valves = list(packet[HEADER.size :])
    for number, valve in enumerate(valves, 1):
        if not APPLY <= valve <= VENT:
            raise ValueError(f"An answer told valve {number} {valve}; tell it 0 (apply), 1 (hold) or 2 (vent).")
    return sequence, valves


@dataclass
class Remote:
    """A client behind a socket, which the rig asks as it asks a controller of its own.

    period [s]; pace: seconds of the run in a second on the clock, 0: as fast as answers come. late, answered: how late
    each question was sent, and after how long its answer came [s].
    """

    own: socket.socket
    period: float
    pace: float
    bar: tqdm
    counts: Counts = field(default_factory=Counts)
    late: list[float] = field(default_factory=list)
    answered: list[float] = field(default_factory=list)
    client: Any = None
    _valves: list[int] = field(default_factory=list)
    _silent: int = 0
    _missed: set[int] = field(default_factory=set)
    _begin: float = 0.0
    _drawn: float = 0.0

    def found(self) -> Remote:
        """This, once a client has shown itself. Raises BadInputError where none does."""
        host, port = self.own.getsockname()
        print(f"Waiting for a client at {host}:{port}.", file=sys.stderr, flush=True)
        end = time.monotonic() + WAIT
        while not self.client:
            packet, address = self._next(end - time.monotonic())
            if packet is None and time.monotonic() >= end:
                wrong = " ".join(self.counts.sentences)
                raise BadInputError(f"No client came to {host}:{port} within {WAIT:g} s; start one. {wrong}".strip())
            if packet == HEADER.pack(MAGIC, HELLO, 0, 0):
                self.client = address
            elif packet is not None:
                self.counts.wrong(f"A packet of {len(packet)} bytes from {address[0]} was no hello; see the protocol.")
        return self

    def step(self, time_of_run: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Asks, and waits for the answer until the period ends; without one the valves stay, or the watchdog acts."""
        number, wheelsets = self.counts.periods, len(wheel_speeds)
        self._valves = self._valves or [APPLY] * wheelsets
        due = self._due(number)
        self._pause(due)
        sent = time.perf_counter()
        self.late.append(sent - due if self.pace else 0.0)
        with suppress(OSError):  # a client that is gone, a network that is down: a missed period
            self.own.sendto(question(number, time_of_run, self.period, wheel_speeds), self.client)
        self.counts.periods += 1
        valves = self._hear(number, wheelsets, self._deadline(number, sent))
        if valves is None:
            self._miss(number)
        else:
            self.answered.append(time.perf_counter() - sent)
            self._valves, self._silent = valves, 0
        return self._valves

    @property
    def silent_from(self) -> float | None:
        """Since when the client has been silent, if it is so for so long that the watchdog acts [s]."""
        return (self.counts.periods - self._silent) * self.period if self._silent >= WATCHDOG else None

    def close(self) -> None:
        """Tells the client that the run is over, three times, for a packet may be lost."""
        for _ in range(3 if self.client else 0):
            with suppress(OSError):
                self.own.sendto(HEADER.pack(MAGIC, END, 0, self.counts.periods), self.client)

    def _due(self, number: int) -> float:
        """When a period begins on the clock, counted from the first: nothing adds up."""
        if number == 0:
            self._begin = self._drawn = time.perf_counter()
        return self._begin + number * self.period / self.pace if self.pace else 0.0

    def _deadline(self, number: int, sent: float) -> float:
        if self.pace:
            return self._due(number + 1)
        return sent if self._silent >= WATCHDOG else sent + ANSWER_WITHIN  # who is silent is no longer waited for

    def _pause(self, due: float) -> None:
        """Sleeps until an instant, and watches the clock at the end; the bar is drawn before."""
        if time.perf_counter() - self._drawn > DRAWN:
            self.bar.update(self.counts.periods * self.period - self.bar.n)
            self._drawn = time.perf_counter()
        while (left := due - time.perf_counter()) > 0.0:
            if left > 2 * WATCHED:
                time.sleep(left - WATCHED)

    def _hear(self, number: int, wheelsets: int, deadline: float) -> list[int] | None:
        """The valves of the answer to a question; None where none came in time."""
        while True:
            packet, address = self._next(deadline - time.perf_counter())
            if packet is None:
                if time.perf_counter() >= deadline:
                    return None
                continue
            if address != self.client:
                self.counts.strangers += 1
            elif packet != HEADER.pack(MAGIC, HELLO, 0, 0):  # that of the beginning, once more
                valves = self._answer_to(packet, number, wheelsets)
                if valves is not None:
                    return valves

    def _answer_to(self, packet: bytes, number: int, wheelsets: int) -> list[int] | None:
        """The valves, if the packet answers this question; what else it is is counted."""
        try:
            sequence, valves = valves_in(packet, wheelsets, number)
        except ValueError as error:
            self.counts.wrong(str(error))
            return None
        if sequence == number:
            return valves
        if sequence in self._missed:
            self._missed.remove(sequence)
            self.counts.late += 1
        else:
            self.counts.repeated += 1
        return None

    def _next(self, patience: float) -> tuple[bytes | None, Any]:
        """The next packet and where it came from; None where none comes in time [s], or the client is gone."""
        ready, _, _ = select.select([self.own], [], [], max(patience, 0.0))
        try:
            return self.own.recvfrom(LARGEST) if ready else (None, None)
        except OSError:  # Windows tells so that nobody listens any more
            return None, None

    def _miss(self, number: int) -> None:
        """Counts a period without an answer; after too many in a row the brake applies."""
        counts = self.counts
        self._missed.add(number)
        counts.missed += 1
        counts.for_the_rig += self.late[-1] * self.pace > LATE * self.period
        self._silent += 1
        counts.longest_silence = max(counts.longest_silence, self._silent)
        if self._silent == WATCHDOG:
            counts.watchdog += 1
            self._valves = [APPLY] * len(self._valves)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the loop alone."""
    parser.add_argument("--host", default=HOST, help=f"where the rig listens (default: {HOST}, this machine alone)")
    parser.add_argument("--port", type=int, default=PORT, help=f"its UDP port; 0: any that is free (default: {PORT})")
    text = "seconds of the run in a second on the clock; 0: as fast as answers come (default: 1)"
    parser.add_argument("--pace", type=float, default=1.0, help=text)


@contextmanager
def socket_at(host: str, port: int) -> Iterator[socket.socket]:
    """A UDP socket that is bound. Raises BadInputError."""
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
    """Python looks for no garbage within, which takes milliseconds."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


@dataclass(frozen=True)
class Looped:
    """A stop of a client in the loop; silent_from: since when the watchdog has stood in for it, if it has [s]."""

    stop: Stop
    counts: Counts
    pace: float
    period: float
    late: np.ndarray
    answered: np.ndarray
    silent_from: float | None

    @property
    def holds(self) -> bool:
        """Whether the client stopped the machine and answered in every period."""
        return self.stop.distance is not None and not self.counts.missed


def run_in_loop(machine: Machine, run: Run, settings: Settings, own: socket.socket, pace: float) -> Looped:
    """One stop under a client at the other end of a socket. Raises BadInputError for a pace that cannot be."""
    if not (math.isfinite(pace) and pace >= 0.0) or (pace and settings.period / pace > LONGEST):
        least = settings.period / LONGEST
        raise BadInputError(f"Set --pace to 0, or to at least {least:.2g} with this period: it was {pace:g}.")
    with counting(text="in the loop", unit="s") as bar, without_collections():
        remote = Remote(own, settings.period, pace, bar)
        try:
            [stop] = Rig(machine, remote.found, settings, by_flow=True).runs([run])
        finally:
            remote.close()
    silent = remote.silent_from
    if silent is not None:
        said = f"No answer came from {silent:g} s on, and the watchdog applied the brake: no stop of this controller."
        stop = replace(stop, distance=None, said=said)
    late, answered = np.array(remote.late), np.array(remote.answered)
    return Looped(stop, remote.counts, pace, settings.period, late, answered, silent)


def sentences(found: Looped) -> Iterator[str]:
    """What came and what did not."""
    c, period = found.counts, found.period
    paced = f"at {found.pace:g} times the clock's pace" if found.pace else "as fast as answers came"
    yield f"In the loop: {c.periods} periods of {1e3 * period:g} ms, {paced}."
    row = f", at most {c.longest_silence} in a row" if c.missed else ""
    rig = f", {c.for_the_rig} of them where the rig asked late" if c.for_the_rig else ""
    yield f"Missed: {c.missed} periods{row}{rig}. The watchdog applied the brake {c.watchdog} times."
    rest = f"{c.malformed} malformed, {c.strangers} from others"
    yield f"Thrown away: {c.late} late answers, {c.repeated} repeated, {rest}."
    yield from c.sentences
    if found.answered.size:
        yield f"An answer took {times(found.answered)}."
    if found.pace:
        yield f"The rig asked late by {times(found.late)}."


def times(of: np.ndarray) -> str:
    """Median, 99 % and largest of times [s], in words."""
    middle, most = (1e3 * float(np.percentile(of, share)) for share in (50, 99))
    return f"{middle:.2f} ms in the median, {most:.2f} ms at 99 %, {1e3 * float(of.max()):.2f} ms at most"


def document(found: Looped) -> dict[str, object]:
    """For programs; times in s."""
    shares = {"median": 50, "99 %": 99, "longest": 100}
    series = {"answered": found.answered, "asked_late": found.late}
    told = {
        name: {key: float(np.percentile(of, share)) for key, share in shares.items()}
        for name, of in series.items()
        if of.size
    }
    whole = {"pace": found.pace, "holds": found.holds, "silent_from": found.silent_from}
    return whole | asdict(found.counts) | told
