"""Couplers of a consist file, [[coupler]]: curves of loading and unloading of buffers, draw gear or draft gear.

Buffers press, the draw gear pulls, a draft gear does both. A coupling has one of each at both vehicles, in series, and
two buffers side by side. `compression` and `tension` are curves of the whole coupling.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from fmu_src.suggestion import suggestion
from products.train.consist_columns import LONGEST_NAME, NUMBERS
from rbd_model.train.coupler import COUPLERS, Coupler, Curve
from readers.column_words import with_columns
from readers.quantity import Quantity, by_name
from readers.text import quoted, shown
from readers.toml_files import toml_of

#: Devices: senses in which they act, devices in series and side by side in a coupling.
DEVICES: dict[str, tuple[tuple[str, ...], float, float]] = {
    "buffer": (("compression",), 2.0, 2.0),
    "draw": (("tension",), 2.0, 1.0),
    "gear": (("tension", "compression"), 2.0, 1.0),
    "tension": (("tension",), 1.0, 1.0),
    "compression": (("compression",), 1.0, 1.0),
}
TOML = ".toml"
SENSES = ("tension", "compression")
#: Most points of a table, and its limits: travel [mm], force [kN].
MOST_POINTS, FARTHEST, STRONGEST = 16, 1000.0, 20e3
LISTS = by_name(
    Quantity("travel", "mm", 0.0, FARTHEST),
    Quantity("loading", "kN", 0.0, STRONGEST),
    Quantity("unloading", "kN", 0.0, STRONGEST),
    Quantity("unloading_travel", "mm", 0.0, FARTHEST),
)
#: Numbers of a device, and of a coupling.
OF_DEVICE = by_name(
    Quantity("damping", "1", 0.0, 0.95),
    Quantity("preload", "kN", 0.0, 500.0),
    Quantity("stroke", "mm", 1.0, FARTHEST),
)
OF_COUPLING = {
    "sticking_stiffness": Quantity("sticking_stiffness", "MN/m", 1.0, 1000.0),
    "slack": NUMBERS["coupler_slack"],
    "strength": NUMBERS["coupler_strength"],
}
#: Names of a [[coupler]], in the order in which files are written.
TABLE_NAMES = (
    *("name", *OF_COUPLING),
    *(f"{device}_{name}" for device in DEVICES for name in (*LISTS, *OF_DEVICE)),
)


def couplers_of(tables: Any, source: str) -> dict[str, Coupler]:
    """Return the couplers of a file's [[coupler]] tables by name. Raises ValueError."""
    if not isinstance(tables, list):
        raise ValueError(f"{source}: coupler must be a list of tables. Write each as [[coupler]], with two brackets.")
    found: dict[str, Coupler] = {}
    for number, table in enumerate(tables, 1):
        try:
            one = coupler_of(table)
            if one.name in found:
                raise ValueError(f"name must be that of one coupler; got {quoted(one.name)} again. Rename it.")
        except ValueError as error:
            raise ValueError(f"{source}, coupler {number}: {error}") from None
        found[one.name] = one
    return found


def coupler_named(text: str) -> Coupler:
    """Return a built-in coupler by its name, or one of a file, as "FILE.toml" or "FILE.toml:NAME"."""
    if text in COUPLERS:
        return COUPLERS[text]()
    file, ending, name = text.partition(f"{TOML}:")
    path = f"{file}{TOML}" if ending else text
    if not path.lower().endswith(TOML):
        raise ValueError(
            f"coupler must be one of {', '.join(COUPLERS)}, or FILE.toml:NAME; got {shown(text)}. Choose one."
        )
    found = couplers_of(toml_of(path).get("coupler", []), path)
    able = [name] if name in found else list(found) if not name else []
    if len(able) != 1:
        names = ", ".join(found) or "none"
        raise ValueError(f"{path} must have the coupler that is named, FILE.toml:NAME; got {names}. Name one of them.")
    return found[able[0]]


def coupler_of(table: Any) -> Coupler:
    """Return the coupler of a [[coupler]] table, a mapping of TABLE_NAMES."""
    values = _checked(table)
    curves = {device: _curves(device, values) for device in DEVICES if _names(device, values)}
    pairs: dict[str, tuple[Curve, Curve]] = {}
    for sense in SENSES:
        able = [device for device in DEVICES if sense in DEVICES[device][0]]
        stated = [device for device in able if device in curves]
        if len(stated) != 1:
            got = " and ".join(stated) or "none"
            raise ValueError(f"{sense} must be stated once, by {', '.join(able[:-1])} or {able[-1]}; got {got}.")
        pairs[sense] = curves[stated[0]]
    sticking = _sticking(values, pairs, "buffer" in curves)
    plain = Coupler(values["name"], sticking, pairs["tension"], pairs["compression"])
    damped = [name for name in values if name.endswith("_damping") and values[name] > 0.0]
    if damped and not plain.dissipates:
        raise ValueError(
            f"{damped[0]} must come with curves flatter than the sticking stiffness, {1e-6 * sticking:.4g} MN/m. "
            "Increase sticking_stiffness, or leave the damping out."
        )
    slack = 1e-3 * values.get("slack", 0.0)
    if slack:
        touches = "buffer" in curves or plain.compression[0].forces[0] > 0.0
        for sense in SENSES[: 1 if touches else 2]:
            if pairs[sense][0].forces[1] == 0.0:
                raise ValueError(
                    "slack must be left out with curves of loading that begin without a force; got "
                    f"{values['slack']:g} mm. Leave it out."
                )
            loading, unloading = (_shifted(pair, slack, sticking) for pair in pairs[sense])
            pairs[sense] = loading, unloading
    strength = {"strength": 1e3 * values["strength"]} if "strength" in values else {}
    return Coupler(values["name"], sticking, pairs["tension"], pairs["compression"], **strength)


def table_of(coupler: Coupler) -> dict[str, Any]:
    """Return the [[coupler]] table that states a coupler, with curves of the whole coupling."""
    table: dict[str, Any] = {"name": coupler.name, "sticking_stiffness": 1e-6 * coupler.sticking_stiffness}
    if np.isfinite(coupler.strength):
        table["strength"] = 1e-3 * coupler.strength
    for sense, (loading, unloading) in zip(SENSES, (coupler.tension, coupler.compression), strict=True):
        for name, curve in (("", loading), ("unloading_", unloading)):
            table[f"{sense}_{name}travel"] = [1e3 * way for way in curve.ways]
        table[f"{sense}_loading"] = [1e-3 * force for force in loading.forces]
        table[f"{sense}_unloading"] = [1e-3 * force for force in unloading.forces]
    return table


def _names(device: str, values: Iterable[str]) -> list[str]:
    """Return the names of a device that are given."""
    return [f"{device}_{name}" for name in (*LISTS, *OF_DEVICE) if f"{device}_{name}" in values]


def _checked(table: Any) -> dict[str, Any]:
    """Return the values of a table, each within its own limits."""
    if not isinstance(table, Mapping):
        raise ValueError(f"a coupler must be names with values; got {shown(table)}. Write name = 'buffers'.")
    table = with_columns(table, TABLE_NAMES)
    name = table.get("name")
    if not isinstance(name, str) or not name.strip() or len(name) > LONGEST_NAME or not name.isprintable():
        raise ValueError(f"name must be printable text of 1 to {LONGEST_NAME} characters; got {shown(name)}. Add it.")
    if name.strip() in COUPLERS:
        raise ValueError(f"name must not be that of a built-in coupler, {', '.join(COUPLERS)}; got {name}. Rename it.")
    limits = {f"{device}_{name}": of for device in DEVICES for name, of in OF_DEVICE.items()} | OF_COUPLING
    lists = {f"{device}_{name}": of for device in DEVICES for name, of in LISTS.items()}
    found: dict[str, Any] = {"name": name.strip()}
    for key, value in table.items():
        if key not in TABLE_NAMES:
            raise ValueError(f"the name {quoted(str(key))} is unknown; {suggestion(str(key), TABLE_NAMES)}")
        if key in limits:
            found[key] = _number(key, value, limits[key])
        elif key in lists:
            if not isinstance(value, list) or not 2 <= len(value) <= MOST_POINTS:
                count = f"{len(value)} of them" if isinstance(value, list) else shown(value)
                raise ValueError(f"{key} must be a list of 2 to {MOST_POINTS} numbers; got {count}. Correct it.")
            found[key] = [_number(f"{key}, number {at},", one, lists[key]) for at, one in enumerate(value, 1)]
    return found


def _number(name: str, value: Any, quantity: Quantity) -> float:
    number = quantity.number(value)
    if not quantity.least <= number <= quantity.most:
        limits = f"a number from {quantity.limits}"
        raise ValueError(f"{name} must be {limits}; got {shown(value)}. Correct it, or its unit.")
    return number


@dataclass(frozen=True)
class _Points:
    """Points of a curve of one device [mm], [kN], with the names of both columns."""

    names: tuple[str, str]
    ways: Sequence[float]
    forces: Sequence[float]

    def __post_init__(self) -> None:
        (way, force), (ways, forces) = self.names, (self.ways, self.forces)
        if len(ways) != len(forces):
            raise ValueError(
                f"{force} must have a number for each of {way}, {len(ways)}; got {len(forces)}. Correct one of them."
            )
        for a, b in pairwise(ways):
            if b <= a:
                raise ValueError(f"{way} must grow; got {b:g} after {a:g} mm. Sort the points.")
        for a, b in pairwise(forces):
            if b < a:
                raise ValueError(f"{force} must never fall; got {b:g} after {a:g} kN. Correct it.")

    def at(self, way: float) -> float:
        """Return the force at a travel; beyond the last point on the last piece."""
        (a, fa), (b, fb) = list(zip(self.ways, self.forces, strict=True))[-2:]
        return float(np.interp(way, self.ways, self.forces)) if way <= b else fb + (fb - fa) / (b - a) * (way - b)


def _curves(device: str, values: Mapping[str, Any]) -> tuple[Curve, Curve]:
    """Return the curves of loading and unloading of a coupling by those of its devices."""
    for name in ("travel", "loading"):
        if f"{device}_{name}" not in values:
            raise ValueError(f"{_names(device, values)[0]} must come with {device}_{name}. Add it.")
    loading = _loading(device, values)
    unloading = _unloading(device, values, loading)
    for way in sorted({*loading.ways, *unloading.ways}):
        above, below = loading.at(way), unloading.at(way)
        if below > above * (1 + 1e-9):
            raise ValueError(
                f"{device}_unloading must be at most {device}_loading, {above:.4g} kN at {way:g} mm; got {below:.4g} "
                "kN. Correct them: a coupler gives back less energy than it takes."
            )
    _, series, parallel = DEVICES[device]
    first, second = (
        Curve(tuple(1e-3 * series * way for way in one.ways), tuple(1e3 * parallel * force for force in one.forces))
        for one in (loading, unloading)
    )
    return first, second


def _loading(device: str, values: Mapping[str, Any]) -> _Points:
    """Return the curve of loading from travel 0 to the stroke."""
    names = f"{device}_travel", f"{device}_loading"
    ways, forces = (list(values[name]) for name in names)
    preload = values.get(f"{device}_preload")
    _Points(names, ways, forces)
    if (preload is None) is (ways[0] > 0.0):
        needs = "must come with a" if preload is None else "must begin above 0 mm with a"
        raise ValueError(
            f"{device}_travel {needs} {device}_preload, the force at 0 mm; got {ways[0]:g} mm as its first number. "
            + ("Add it." if preload is None else "Leave the preload out.")
        )
    if preload is not None:
        ways, forces = [0.0, *ways], [preload, *forces]
    found = _Points((names[0], f"{device}_preload and {names[1]}"), ways, forces)
    if forces[-1] <= 0.0:
        raise ValueError(f"{names[1]} must end above 0 kN; got 0 kN. Correct it.")
    stroke = values.get(f"{device}_stroke", ways[-1])
    if stroke < ways[-1]:
        raise ValueError(f"{device}_stroke must be at least the last travel, {ways[-1]:g} mm; got {stroke:g} mm.")
    if stroke > ways[-1]:
        found = _Points(found.names, [*ways, stroke], [*forces, found.at(stroke)])
    return found


def _unloading(device: str, values: Mapping[str, Any], loading: _Points) -> _Points:
    """Return the curve of unloading: a table, or a share of that of loading."""
    own, damping, along = f"{device}_unloading", f"{device}_damping", f"{device}_unloading_travel"
    if (own in values) is (damping in values):
        got = "both" if own in values else "neither"
        raise ValueError(f"{device}_loading must come with {own} or {damping}; got {got}. Give one of them.")
    if damping in values:
        if along in values:
            raise ValueError(f"{along} must come with {own}. Add it, or leave {along} out.")
        return _Points((along, own), loading.ways, [(1.0 - values[damping]) * force for force in loading.forces])
    along = along if along in values else f"{device}_travel"
    if values[along][0] > 0.0:
        raise ValueError(
            f"{own} must begin at 0 mm; its first travel is {values[along][0]:g} mm. Give {device}_unloading_travel "
            "from 0 on."
        )
    if values[along][-1] > loading.ways[-1]:
        raise ValueError(
            f"{along} must end within the stroke, {loading.ways[-1]:g} mm; got {values[along][-1]:g} mm. Give "
            f"{device}_stroke, or correct it."
        )
    return _Points((along, own), values[along], values[own])


def _sticking(values: Mapping[str, Any], pairs: Mapping[str, tuple[Curve, Curve]], buffers: bool) -> float:
    """Return the stiffness while friction sticks [N/m]: that of the built-in coupler unless a curve is steeper."""
    slopes = [
        (fb - fa) / (b - a)
        for pair in pairs.values()
        for one in pair
        for (a, fa), (b, fb) in pairwise(zip(one.ways, one.forces, strict=True))
    ]
    steepest, most = max(slopes), OF_COUPLING["sticking_stiffness"].most
    if steepest > 1e6 * most:
        raise ValueError(
            f"curves of the coupling must rise by at most {most:g} MN/m; got {1e-6 * steepest:.4g} MN/m. Correct the "
            "points, or their units."
        )
    built_in = COUPLERS["screw" if buffers else "draft-gear"]().sticking_stiffness
    if "sticking_stiffness" not in values:
        return max(built_in, steepest)
    stated = 1e6 * values["sticking_stiffness"]
    if stated < steepest * (1 - 1e-9):
        raise ValueError(
            f"sticking_stiffness must be at least the steepest slope of the coupling, {1e-6 * steepest:.4g} MN/m; got "
            f"{1e-6 * stated:g} MN/m. Increase it."
        )
    return max(stated, steepest)


def _shifted(curve: Curve, slack: float, sticking: float) -> Curve:
    """Return a curve behind a travel without a force [m]; a preload is reached at the sticking stiffness [N/m]."""
    (_, preload), *rest = zip(curve.ways, curve.forces, strict=True)
    begins = [(slack, 0.0)] + ([(slack + preload / sticking, preload)] if preload > 0.0 else [])
    points = [(0.0, 0.0), *begins, *((slack + way, force) for way, force in rest)]
    return Curve(*zip(*points, strict=True))
