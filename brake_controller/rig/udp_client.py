"""Answers the test rig over UDP with a wheel-slide controller in Python; the page In the loop has the protocol.

    from udp_client import answer
    from mine import PI

    answer(PI(), "192.168.0.7", 5005)

This file needs only Python, so that it can be copied to another computer. `udp_client.c` is the same for C.
"""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Callable, Sequence
from typing import Protocol

HOST, PORT = "127.0.0.1", 5005
#: First bytes of each packet; the last character is the version.
MAGIC = b"WSP1"
#: Kinds of packets: a client registers; the rig sends speeds; a client answers; the run is over.
HELLO, SPEEDS, ANSWER, END = 1, 2, 3, 4
#: Magic, kind, wheelsets, sequence number; of SPEEDS then the time of the run and the period [s].
HEADER, TIMES = struct.Struct("<4sHHI"), struct.Struct("<dd")
#: Larger than any packet [bytes].
LARGEST = 2048
#: Interval at which a client registers, and time for which it waits for the next packet [s].
EVERY, SILENCE = 0.2, 10.0


class Controller(Protocol):
    """Interface of a user's controller."""

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        """Return valve commands (0 apply, 1 hold, 2 vent) from circumferential speeds [m/s] at a time of the run
        [s].
        """
        ...


def question(sequence: int, time: float, period: float, speeds: Sequence[float]) -> bytes:
    """Return a packet of the rig with a sample: time and period [s], a speed for each wheelset [m/s]."""
    head = HEADER.pack(MAGIC, SPEEDS, len(speeds), sequence)
    return head + TIMES.pack(time, period) + struct.pack(f"<{len(speeds)}d", *speeds)


def answer_to(packet: bytes, controller: Controller) -> bytes | None:
    """Return the answer to a packet of the rig, or None if the packet has no speeds."""
    if len(packet) < HEADER.size:
        return None
    magic, kind, wheelsets, sequence = HEADER.unpack_from(packet)
    at = HEADER.size + TIMES.size
    if magic != MAGIC or kind != SPEEDS or len(packet) != at + 8 * wheelsets:
        return None
    now, _ = TIMES.unpack_from(packet, HEADER.size)
    valves = controller.step(now, list(struct.unpack_from(f"<{wheelsets}d", packet, at)))
    return HEADER.pack(MAGIC, ANSWER, wheelsets, sequence) + bytes(int(valve) for valve in valves)


def is_end(packet: bytes) -> bool:
    """Return True if the packet reports the end of the run."""
    return len(packet) == HEADER.size and HEADER.unpack(packet)[:2] == (MAGIC, END)


def answer(
    controller: Controller, host: str = HOST, port: int = PORT, report: Callable[[str], object] = lambda text: None
) -> int:
    """Register with the rig, answer its packets until the end of the run, and return the number of answers.

    report: is called with a message when the run begins.
    """
    given, heard = 0, time.monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:
        own.connect((host, port))  # packets from others do not come in
        own.settimeout(EVERY)
        while True:
            try:
                if not given:
                    own.send(HEADER.pack(MAGIC, HELLO, 0, 0))
                packet = own.recv(LARGEST)
                if is_end(packet):
                    return given
                reply = answer_to(packet, controller)
                if reply:
                    own.send(reply)
                    given, heard = given + 1, time.monotonic()
                    if given == 1:
                        report("The rig asks.")
            except TimeoutError:
                pass
            except ConnectionError:  # nobody listens there yet, or any more
                time.sleep(EVERY)
            if given and time.monotonic() - heard > SILENCE:
                raise TimeoutError(f"The rig at {host}:{port} asked nothing for {SILENCE:g} s; {given} answers given.")
