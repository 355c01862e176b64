"""Units that people write, and their conversion. One table for all readers, those in C among them."""

from __future__ import annotations

import math
from types import MappingProxyType

#: Spellings by quantity: numerator and denominator of the factor to SI, exact but for pi, so that a conversion rounds
#: once.
_SPELLINGS: dict[str, dict[str, tuple[float, float]]] = {
    "ratio": {
        "1": (1, 1),
        "-": (1, 1),
        "m/m": (1, 1),
        "rad": (1, 1),
        "%": (1, 100),
        "percent": (1, 100),
        "\u2030": (1, 1000),
        "permille": (1, 1000),
        "per mille": (1, 1000),
        "promille": (1, 1000),
        "mm/m": (1, 1000),
        "m/km": (1, 1000),
        "mrad": (1, 1000),
    },
    "length": {
        "m": (1, 1),
        "km": (1000, 1),
        "cm": (1, 100),
        "mm": (1, 1000),
        "um": (1, 1_000_000),
        "\u00b5m": (1, 1_000_000),
        "ft": (3048, 10_000),
        "in": (254, 10_000),
    },
    "per length": {"1/m": (1, 1), "rad/m": (1, 1), "m-1": (1, 1), "1/km": (1, 1000), "rad/km": (1, 1000)},
    "time": {
        "s": (1, 1),
        **dict.fromkeys(("sec", "sec.", "sek", "sek.", "Sek", "Sek."), (1, 1)),
        "ms": (1, 1000),
        "us": (1, 1_000_000),
        "\u00b5s": (1, 1_000_000),
        "\u03bcs": (1, 1_000_000),
        "min": (60, 1),
        "h": (3600, 1),
    },
    "speed": {
        "m/s": (1, 1),
        "mps": (1, 1),
        "km/h": (10, 36),
        "kmh": (10, 36),
        "kph": (10, 36),
        "km/hr": (10, 36),
        "kmph": (10, 36),
        "mm/s": (1, 1000),
        "mph": (44704, 100_000),
    },
    "acceleration": {
        "m/s2": (1, 1),
        "m/s^2": (1, 1),
        "m/s\u00b2": (1, 1),
        "cm/s2": (1, 100),
        "km/h/s": (10, 36),
        "mph/s": (44704, 100_000),
    },
    "frequency": {"Hz": (1, 1), "1/s": (1, 1), "kHz": (1000, 1)},
    "angular velocity": {
        "rad/s": (1, 1),
        "rpm": (math.pi, 30),
        "1/min": (math.pi, 30),
        "min-1": (math.pi, 30),
        "r/min": (math.pi, 30),
        "U/min": (math.pi, 30),
    },
    "force": {
        "N": (1, 1),
        "daN": (10, 1),
        "kN": (1000, 1),
        "MN": (1_000_000, 1),
        "kgf": (980_665, 100_000),
        "lbf": (44_482_216_152_605, 10_000_000_000_000),
        **dict.fromkeys(("kip", "kips", "klbf"), (44_482_216_152_605, 10_000_000_000)),
    },
    "force per speed": {
        "N/(m/s)": (1, 1),
        "N.s/m": (1, 1),
        "kN/(m/s)": (1000, 1),
        "kN.s/m": (1000, 1),
        "Ns/m": (1, 1),
        "kNs/m": (1000, 1),
        "N/(km/h)": (36, 10),
        "daN/(km/h)": (36, 1),
        "kN/(km/h)": (3600, 1),
        "lbf/mph": (44_482_216_152_605, 4_470_400_000_000),
    },
    "force per speed squared": {
        "N/(m/s)^2": (1, 1),
        "N/(m/s)2": (1, 1),
        "N.s2/m2": (1, 1),
        "kN/(m/s)^2": (1000, 1),
        "N/(km/h)^2": (1296, 100),
        "N/(km/h)2": (1296, 100),
        "daN/(km/h)^2": (1296, 10),
        "kN/(km/h)^2": (12_960, 1),
        "lbf/mph^2": (44_482_216_152_605, 1_998_447_616_000),
    },
    "stiffness": {
        "N/m": (1, 1),
        "N/mm": (1000, 1),
        "kN/m": (1000, 1),
        "kN/mm": (1_000_000, 1),
        "MN/m": (1_000_000, 1),
    },
    "torsional stiffness": {
        "N.m/rad": (1, 1),
        "Nm/rad": (1, 1),
        "kN.m/rad": (1000, 1),
        "kNm/rad": (1000, 1),
        "MN.m/rad": (1_000_000, 1),
        "MNm/rad": (1_000_000, 1),
    },
    "torsional damping": {"N.m.s/rad": (1, 1), "Nms/rad": (1, 1), "kN.m.s/rad": (1000, 1), "kNms/rad": (1000, 1)},
    "inertia": {"kg.m2": (1, 1), "kgm2": (1, 1), "kg.m^2": (1, 1), "t.m2": (1000, 1)},
    "torque": {
        "N.m": (1, 1),
        "Nm": (1, 1),
        "N m": (1, 1),
        "N*m": (1, 1),
        "N\u00b7m": (1, 1),
        "kN.m": (1000, 1),
        "kNm": (1000, 1),
        "kN m": (1000, 1),
        "kN*m": (1000, 1),
        "kN\u00b7m": (1000, 1),
    },
    "pressure": {
        "Pa": (1, 1),
        "hPa": (100, 1),
        "kPa": (1000, 1),
        "MPa": (1_000_000, 1),
        "mbar": (100, 1),
        "bar": (100_000, 1),
        "psi": (6_894_757_293_168, 1_000_000_000),
        "inHg": (3_386_389, 1000),
        "mmHg": (133_322_387, 1_000_000),
        "cmHg": (133_322_387, 100_000),
    },
    "mass": {
        "kg": (1, 1),
        "t": (1000, 1),
        "g": (1, 1000),
        **dict.fromkeys(("tonne", "tonnes", "Tonne", "Tonnen", "to"), (1000, 1)),
        **dict.fromkeys(("lb", "lbs"), (45_359_237, 100_000_000)),
        "klb": (45_359_237, 100_000),
        **dict.fromkeys(("t-us", "short ton", "short tons"), (90_718_474, 100_000)),
        **dict.fromkeys(("t-uk", "long ton", "long tons"), (10_160_469_088, 10_000_000)),
    },
    "pressure over time": {
        "Pa/s": (1, 1),
        "kPa/s": (1000, 1),
        "bar/s": (100_000, 1),
        "psi/s": (6_894_757_293_168, 1_000_000_000),
    },
    "volume": {"m3": (1, 1), "m\u00b3": (1, 1), "l": (1, 1000), "L": (1, 1000), "in3": (16_387_064, 1_000_000_000_000)},
    "volume flow": {
        "m3/s": (1, 1),
        "l/s": (1, 1000),
        "m3/min": (1, 60),
        "m3/h": (1, 3600),
        "l/min": (1, 60_000),
        "ft3/min": (28_316_847, 60_000_000_000),
    },
    "power": {"W": (1, 1), "kW": (1000, 1), "MW": (1_000_000, 1), "hp": (74_569_987_158_227, 100_000_000_000)},
    "energy": {"J": (1, 1), "kJ": (1000, 1), "MJ": (1_000_000, 1)},
    "temperature": {"K": (1, 1)},
    "celsius": {"degC": (1, 1), "\u00b0C": (1, 1)},
}
SPELLINGS = MappingProxyType(_SPELLINGS)
#: Words for several units, in small letters, each with its remedy.
AMBIGUOUS = dict.fromkeys(("ton", "tons"), "Write t, or t-us (907 kg), or t-uk (1016 kg).")
_ALL = [one for units in _SPELLINGS.values() for one in units]
#: Spellings by small letters, where that is unique.
_BY_SMALL = {one.casefold(): one for one in _ALL if sum(one.casefold() == other.casefold() for other in _ALL) == 1}
#: Two characters that look alike and mean micro.
_GREEK_MU, _MICRO = "\u03bc", "\u00b5"


def quantity_of(unit: str) -> str | None:
    """Return the quantity that a unit measures, or None if the unit is unknown."""
    tidy = unit.strip(" ").replace(_GREEK_MU, _MICRO)
    return next((quantity for quantity, units in SPELLINGS.items() if tidy in units), None)


def si_of(unit: str) -> str:
    """Return the SI unit of the quantity that a unit measures; an unknown unit stays."""
    spellings = SPELLINGS.get(quantity_of(unit) or "", {})
    return next((spelling for spelling, both in spellings.items() if both == (1, 1)), unit)


def unit_like(text: str) -> str:
    """Return the known spelling of a unit, whose case may differ if this is unique, or ""."""
    bare = text.strip().strip("[]()")
    return bare if quantity_of(bare) else _BY_SMALL.get(bare.casefold(), "")


def factor(unit: str, target: str) -> tuple[float, float] | None:
    """Return the factor from one unit to another as numerator and denominator, or None if it does not exist.

    A value is multiplied by the first and divided by the second, in this order, in every language.
    """
    quantity = quantity_of(unit)
    if unit.strip(" ") == target:
        return 1.0, 1.0
    if quantity is None or quantity != quantity_of(target):
        return None
    up, down = SPELLINGS[quantity][unit.strip(" ").replace(_GREEK_MU, _MICRO)]
    of_target = SPELLINGS[quantity][target]
    numerator, denominator = up * of_target[1], down * of_target[0]
    shared = _common(numerator, denominator)
    return float(numerator / shared), float(denominator / shared)


def _common(one: float, other: float) -> float:
    while other:
        one, other = other, one % other
    return one


def twins_of(unit: str) -> tuple[str, ...]:
    """Return a unit and, if micro is in it, its form with the Greek letter."""
    return (unit, unit.replace(_MICRO, _GREEK_MU)) if _MICRO in unit else (unit,)


def spellings_for(target: str) -> dict[str, tuple[float, float]]:
    """Return every spelling that converts to a unit, with its factor as `factor` returns it."""
    quantity = quantity_of(target)
    found = {} if quantity is None else {spelling: factor(spelling, target) for spelling in SPELLINGS[quantity]}
    return {target: (1.0, 1.0)} | {one: both for one, both in found.items() if both is not None}


def different_units(target: str) -> list[str]:
    """Return units that convert to a unit, one spelling of each, for messages."""
    found: dict[tuple[float, float], str] = {}
    for one, both in spellings_for(target).items():
        if one.isascii() and " " not in one:
            found.setdefault(both, one)
    return list(found.values())
