"""A controller at the other end of a UDP socket, with the interface of a local one.

All packets, malformed ones and missing ones are counted; none of them ends the run.
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

from bogie_braking.reporting.scenario import BadInputError
from brake_controller.rig.udp_client import ANSWER, END, HEADER, HELLO, LARGEST, MAGIC, question
from brake_controller.wheel_slide import APPLY, VENT

#: Time limit of the wait for a client, and with pace 0 for each of its answers [s].
WAIT, ANSWER_WITHIN = 60.0, 0.4
#: Number of missed periods in a row after which the brake applies, as by a watchdog; assumed.
WATCHDOG = 20
#: Last part of a wait [s], which polls the clock because a sleep ends late; and interval of the progress bar [s].
WATCHED, DRAWN = 2e-4, 0.5
#: Share of a period after which a question of the rig is late, so that the client has too little time.
LATE = 0.1
#: Largest number of different messages on malformed packets.
KEPT = 5


@dataclass
class Counts:
    """Counts of packets, and of periods without an answer; times [s].

    missed: periods without an answer; for_the_rig: those of them in which the rig sent its question late; late: answers
    to a missed period; repeated: answers to an answered period; malformed: packets that are not answers; strangers:
    packets from other senders; watchdog: number of its brake applications.
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
    messages: list[str] = field(default_factory=list)

    def wrong(self, sentence: str) -> None:
        """Count a malformed packet and keep its message."""
        self.malformed += 1
        if sentence not in self.messages and len(self.messages) < KEPT:
            self.messages.append(sentence)


def valves_in(packet: bytes, wheelsets: int, asked: int) -> tuple[int, list[int]]:
    """Return the sequence number of an answer and its valves."""
    due = HEADER.size + wheelsets
    if len(packet) != due:
        raise ValueError(f"An answer for {wheelsets} wheelsets must have {due} bytes; got {len(packet)}.")
    magic, kind, count, sequence = HEADER.unpack_from(packet)
    if magic != MAGIC:
        raise ValueError(f"An answer must begin with {MAGIC!r}; got {magic!r}.")
    if kind != ANSWER or count != wheelsets:
        raise ValueError(
            f"A packet of kind {kind} for {count} wheelsets came; an answer has kind {ANSWER}, for {wheelsets}."
        )
    if sequence > asked:
        raise ValueError(f"The sequence number of an answer must be at most {asked}; got {sequence}.")
    valves = list(packet[HEADER.size :])
    for number, valve in enumerate(valves, 1):
        if not APPLY <= valve <= VENT:
            raise ValueError(f"Valve {number} of an answer must be 0 (apply), 1 (hold) or 2 (vent); got {valve}.")
    return sequence, valves


@dataclass
class Remote:
    """A client behind a socket, with the interface of a local controller.

    period [s]; pace: simulated seconds in a second on the clock, 0: as fast as answers come. late, answered: delay of
    each question, and time until its answer [s].
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
        """Wait for a client and return this object. Raises BadInputError if no client appears."""
        host, port = self.own.getsockname()
        print(f"Waiting for a client at {host}:{port}.", file=sys.stderr, flush=True)
        end = time.monotonic() + WAIT
        while not self.client:
            packet, address = self._next(end - time.monotonic())
            if time.monotonic() >= end:
                wrong = " ".join(self.counts.messages)
                raise BadInputError(f"No client came to {host}:{port} within {WAIT:g} s; start one. {wrong}".strip())
            if packet == HEADER.pack(MAGIC, HELLO, 0, 0):
                self.client = address
            elif packet is not None:
                self.counts.wrong(f"A packet of {len(packet)} bytes from {address[0]} was no hello; see the protocol.")
        return self

    def step(self, time_of_run: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Send a question, and wait for the answer until the period ends; without one the valves stay, or the watchdog
        acts.
        """
        number, wheelsets = self.counts.periods, len(wheel_speeds)
        self._valves = self._valves or [APPLY] * wheelsets
        due = self._due(number)
        self._pause(due)
        sent = time.perf_counter()
        self.late.append(sent - due if self.pace else 0.0)
        with suppress(OSError):  # the client or the network is down: a missed period
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
        """Return the time from which the client has been silent, if the watchdog acts [s]."""
        return (self.counts.periods - self._silent) * self.period if self._silent >= WATCHDOG else None

    def close(self) -> None:
        """Send the end of the run to the client three times, because a packet may be lost."""
        for _ in range(3 if self.client else 0):
            with suppress(OSError):
                self.own.sendto(HEADER.pack(MAGIC, END, 0, self.counts.periods), self.client)

    def _due(self, number: int) -> float:
        """Return the begin of a period on the clock, measured from the first: errors do not accumulate."""
        if number == 0:
            self._begin = self._drawn = time.perf_counter()
        return self._begin + number * self.period / self.pace if self.pace else 0.0

    def _deadline(self, number: int, sent: float) -> float:
        if self.pace:
            return self._due(number + 1)
        return sent if self._silent >= WATCHDOG else sent + ANSWER_WITHIN  # a silent client is no longer waited for

    def _pause(self, due: float) -> None:
        """Sleep until an instant, and poll the clock at the end; the bar is drawn before."""
        if time.perf_counter() - self._drawn > DRAWN:
            self.bar.update(int(self.counts.periods * self.period) - self.bar.n)
            self._drawn = time.perf_counter()
        while (left := due - time.perf_counter()) > 0.0:
            if left > 2 * WATCHED:
                time.sleep(left - WATCHED)

    def _hear(self, number: int, wheelsets: int, deadline: float) -> list[int] | None:
        """Return the valves of the answer to a question; None if none came in time."""
        while True:
            packet, address = self._next(deadline - time.perf_counter())
            if packet is not None and address != self.client:
                self.counts.strangers += 1
            elif packet is not None and packet != HEADER.pack(MAGIC, HELLO, 0, 0):  # a repeated hello is ignored
                valves = self._answer_to(packet, number, wheelsets)
                if valves is not None:
                    return valves
            if time.perf_counter() >= deadline:  # regardless of the number of waiting packets
                return None

    def _answer_to(self, packet: bytes, number: int, wheelsets: int) -> list[int] | None:
        """Return the valves if the packet answers this question; count it otherwise."""
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
        """Return the next packet and its sender; None if none comes in time [s], or the client is gone."""
        ready, _, _ = select.select([self.own], [], [], max(patience, 0.0))
        try:
            return self.own.recvfrom(LARGEST) if ready else (None, None)
        except OSError:  # Windows reports a closed port so
            return None, None

    def _miss(self, number: int) -> None:
        """Count a period without an answer; after too many in a row the brake applies."""
        counts = self.counts
        self._missed.add(number)
        counts.missed += 1
        counts.for_the_rig += self.late[-1] * self.pace > LATE * self.period
        self._silent += 1
        counts.longest_silence = max(counts.longest_silence, self._silent)
        if self._silent == WATCHDOG:
            counts.watchdog += 1
            self._valves = [APPLY] * len(self._valves)
