"""Fills the templates of pages. A page is a single file, which asks for no other and for no network."""

import base64
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

#: Where templates, styles and scripts stand: those of all pages, then those of each.
PLACES = [Path(__file__).parents[1] / room for room in ("web", "live/web", "controllers/web", "reporting/page")]


def filled(template: str, filters: dict[str, Callable[..., Any]] | None = None, **parts: Any) -> str:
    """Return the text of a page; its parts are escaped, but for those that the template calls safe.

    Parameters
    ----------
    template
        Name of a file in PLACES that extends `frame.html.jinja`.
    filters
        Functions that it calls behind a bar, by name.
    parts
        What it shows by name; the scripts are given `data` as DATA, if it is there.
    """
    from jinja2 import Environment, FileSystemLoader  # not for commands without pages

    environment = Environment(loader=FileSystemLoader(PLACES), autoescape=True, trim_blocks=True)
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters |= filters or {}
    environment.globals["files"] = files
    return environment.get_template(template).render(parts)


class AsItIs(str):
    """A text that templates do not escape."""

    def __html__(self) -> str:
        """As Jinja asks for it."""
        return self


def files(*names: str) -> AsItIs:
    """Return styles or scripts one after the other, as they are."""
    found = (next(place / name for place in PLACES if (place / name).exists()) for name in names)
    return AsItIs("\n".join(path.read_text(encoding="utf-8") for path in found))


def packed(data: bytes) -> str:
    """Return bytes as a text that `unpacked` of canvas.js unpacks."""
    return base64.b64encode(zlib.compress(data, 9)).decode()
