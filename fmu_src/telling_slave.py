"""What the slave classes of pythonfmu share: how they tell the host a sentence. It travels inside the FMUs."""

from __future__ import annotations

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status


class TellingSlave(Fmi2Slave):
    """A slave whose sentences quote anyone: pythonfmu hands them to the host as a format."""

    def log(
        self, msg: str, status: Fmi2Status = Fmi2Status.ok, category: str | None = None, debug: object = None
    ) -> None:
        """Tells a sentence on one line, as a format that says just this; `debug` is pythonfmu's and has no effect."""
        readable = "".join(letter if letter.isprintable() else "?" for letter in msg)
        super().log(readable.replace("%", "%%"), status, category)
