"""A controller at the other end of a UDP socket, which the test rig asks as it asks one of its own.

Whatever comes through the socket, or does not come, is counted; nothing of it ends the run.
"""

from __future__ import annotations

import select
import socket
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from tqdm import tqdm

from brake_controller.rig.udp_client import ANSWER, END, HEADER, HELLO, LARGEST, MAGIC, question
from brake_controller.wheel_slide import APPLY, VENT
from scenarios.scenario import BadInputError

#: So long is a client waited for, and with pace 0 each of its answers [s].
WAIT, ANSWER_WITHIN = 60.0, 0.4
#: The brake applies after so many missed periods in a row, in the manner of a watchdog; assumed.
WATCHDOG = 20
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
            if time.monotonic() >= end:
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
            self.bar.update(int(self.counts.periods * self.period) - self.bar.n)
            self._drawn = time.perf_counter()
        while (left := due - time.perf_counter()) > 0.0:
            if left > 2 * WATCHED:
                time.sleep(left - WATCHED)

    def _hear(self, number: int, wheelsets: int, deadline: float) -> list[int] | None:
        """The valves of the answer to a question; None where none came in time."""
        while True:
            packet, address = self._next(deadline - time.perf_counter())
            if packet is not None and address != self.client:
                self.counts.strangers += 1
            elif packet is not None and packet != HEADER.pack(MAGIC, HELLO, 0, 0):  # one hello more is nothing
                valves = self._answer_to(packet, number, wheelsets)
                if valves is not None:
                    return valves
            if time.perf_counter() >= deadline:  # however many packets wait
                return None

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
