"""Shared part of the slave classes of pythonfmu: how they log messages to the host. It is copied into the FMUs."""

from __future__ import annotations

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status


class TellingSlave(Fmi2Slave):
    """A slave whose messages may quote any text: pythonfmu passes them to the host as a format."""

    def log(
        self, msg: str, status: Fmi2Status = Fmi2Status.ok, category: str | None = None, debug: object = None
    ) -> None:
        """Log a message on one line, as a format that prints exactly this; `debug` is pythonfmu's and has no effect."""
        readable = "".join(letter if letter.isprintable() else "?" for letter in msg)
        super().log(readable.replace("%", "%%"), status, category)
