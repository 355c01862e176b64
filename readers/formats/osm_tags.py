"""Tags of OpenStreetMap that a line uses: `railway`, `service`, `maxspeed` [km/h or mph], `incline` [%, permille or °].

Definitions: wiki.openstreetmap.org, Key:maxspeed and Key:incline. Values that state no number are left, and told.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence

from readers.formats.ways import Way
from readers.import_account import Account
from readers.units import factor

#: Values of `railway` that vehicles run on.
RAILS = {"rail", "light_rail", "subway", "tram", "narrow_gauge", "preserved"}
SPEED = re.compile(r"(\d{1,3}(?:\.\d{1,3})?) ?(km/h|mph)?", re.ASCII)
INCLINE = re.compile(r"([+-]?\d{1,3}(?:\.\d{1,4})?) ?(%|\u2030|\u00b0)", re.ASCII)


def rails(ways: Sequence[Way], asked: Sequence[str], account: Account) -> list[Way]:
    """Return the ways that are rails, without sidings and crossovers if none is named; all if no way has the tag."""
    found = [way for way in ways if way.tags.get("railway") in RAILS]
    if not found:
        return list(ways)
    if others := len(ways) - len(found):
        account.left.append(f"ways without railway = {', '.join(sorted(RAILS))}: {others}")
    through = [way for way in found if "service" not in way.tags]
    if asked or not through or len(through) == len(found):
        return found
    account.left.append(f"sidings, yards and crossovers (ways with the tag service): {len(found) - len(through)}")
    return through


def gradient_in(tags: Mapping[str, str], backwards: bool) -> float | None:
    """Return the rise per metre along the line that `incline` states, None if it states no number."""
    text = tags.get("incline", "").strip()
    match = INCLINE.fullmatch(text)
    if not match:
        return 0.0 if text == "0" else None
    number, unit = float(match[1]), match[2]
    rise = math.tan(math.radians(number)) if unit == "\u00b0" else number / (100.0 if unit == "%" else 1000.0)
    return -rise if backwards else rise


def speed_in(tags: Mapping[str, str], backwards: bool) -> float | None:
    """Return the limit of speed that `maxspeed` states in a direction [m/s], None if it states no number."""
    match = SPEED.fullmatch(_limit(tags, backwards))
    up, down = factor((match[2] or "km/h") if match else "km/h", "m/s") or (1.0, 1.0)
    return float(match[1]) * up / down if match and float(match[1]) else None


def _limit(tags: Mapping[str, str], backwards: bool) -> str:
    directed = tags.get("maxspeed:backward" if backwards else "maxspeed:forward")
    return (directed or tags.get("maxspeed", "")).strip()


def unread(tags: Mapping[str, str], backwards: bool) -> list[str]:
    """Return the tags of a way that state no number, as `name = value`."""
    limit, incline = _limit(tags, backwards), tags.get("incline", "")
    found = [f"maxspeed = {limit}"] if limit and speed_in(tags, backwards) is None else []
    return found + ([f"incline = {incline}"] if incline and gradient_in(tags, backwards) is None else [])
