"""Fill the templates of pages. A page is a single file that loads no other file and needs no network."""

import base64
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

#: Folders of templates, styles and scripts: those of all pages, then those of each.
PLACES = [Path(__file__).parents[1] / room for room in ("web", "live/web", "controllers/web", "reporting/page")]


def filled(template: str, filters: dict[str, Callable[..., Any]] | None = None, **parts: Any) -> str:
    """Return the text of a page; its parts are escaped, except those that the template marks as safe."""
    from jinja2 import Environment, FileSystemLoader  # not for commands without pages

    environment = Environment(loader=FileSystemLoader(PLACES), autoescape=True, trim_blocks=True)
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":")}
    environment.filters |= filters or {}
    environment.globals["files"] = files
    return environment.get_template(template).render(parts)


class AsItIs(str):
    """A string that templates do not escape."""

    def __html__(self) -> str:
        """Return the string; Jinja calls this method."""
        return self


def files(*names: str) -> AsItIs:
    """Return the concatenated styles or scripts, unchanged."""
    found = (next(place / name for place in PLACES if (place / name).exists()) for name in names)
    return AsItIs("\n".join(path.read_text(encoding="utf-8") for path in found))


def packed(data: bytes) -> str:
    """Return bytes as a string that `unpacked` of canvas.js unpacks."""
    return base64.b64encode(zlib.compress(data, 9)).decode()
