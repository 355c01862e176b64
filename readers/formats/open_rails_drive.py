"""Motors and dynamic brakes of Open Rails and MSTS locomotives as columns of a consist.

Names, units and defaults as the manual of Open Rails states them. Forces are in N, and powers in W. A curve has m/s
and N where no unit is written, and belongs to a position of the controller.
"""

from __future__ import annotations

from readers.formats.drive_tables import STRONGEST, drive_table
from readers.formats.open_rails_fields import Fields
from readers.formats.open_rails_text import Block
from readers.formats.open_rails_units import measured, units_of
from readers.formats.vehicle_rows import rounded
from readers.import_account import Notes, Row
from readers.text import FileError, quoted

#: Names of a curve, the one that is valid first.
TRACTION_CURVES = ("ORTSMaxTractiveForceCurves", "MaxTractiveForceCurves")
BRAKE_CURVES = ("ORTSDynamicBrakeForceCurves", "DynamicBrakeForceCurves")
#: Largest power of a vehicle of a consist [W].
MOST_POWER = 30e6
#: Fields that are read.
DRIVE = (*TRACTION_CURVES, *BRAKE_CURVES, "MaxForce", "MaxPower")


def drive_of(engines: list[Block], notes: Notes) -> Row:
    """Return the columns of the motors and of the dynamic brake in the blocks Engine of a vehicle."""
    fields = Fields([block for one in engines for block in one.blocks], notes)
    return _traction(fields, notes) | _dynamic(fields, notes)


def _curve(fields: Fields, names: tuple[str, ...], column: str, notes: Notes) -> Row:
    """Return the table of the highest position of a controller; empty without a curve that can be read."""
    name = next((one for one in names if fields.has(one)), "")
    if not name:
        return {}
    positions = {}
    for block in fields.blocks[name.lower()].blocks:
        share = measured(block.name, "1")
        values = [_value(block, name, at) for at in range(len(block.words))]
        if share is None or len(values) % 2:
            notes.left(f"{name}: it is not positions with pairs of a speed and a force.")
            return {}
        positions[share[0]] = list(zip(values[::2], values[1::2], strict=True))
    if len(positions) > 1:
        notes.left(f"{name}: curves of lower positions; a share of the highest one is taken instead.")
    return drive_table(column, positions[max(positions)], name, notes) if positions else {}


def _value(block: Block, name: str, at: int) -> float:
    """Return a speed [km/h] or a force [N] of a curve by its place. Raises FileError if it cannot be read."""
    quantity = ("km/h curve", "N")[at % 2]
    found = measured(block.words[at], quantity)
    if found is None:
        raise FileError(
            f"{block.source}, row {block.row}: {name} must be numbers in {' or '.join(units_of(quantity))}; got "
            f"{quoted(block.words[at])}. Correct it."
        )
    return found[0]


def _traction(fields: Fields, notes: Notes) -> Row:
    """Return the motors: a curve; or MaxForce up to MaxPower, as Open Rails takes them without a curve."""
    row = _curve(fields, TRACTION_CURVES, "traction_table", notes)
    force, power = fields.number("MaxForce", "N"), fields.number("MaxPower", "W")
    told = [name for name in ("MaxForce", "MaxPower") if fields.has(name)]
    if row:
        if told:
            notes.left(f"{', '.join(told)}: the curve of forces is read instead.")
        return row
    if force and power and 100.0 <= force <= 1e3 * STRONGEST and 1e3 <= power <= MOST_POWER:
        notes.taken("MaxForce, MaxPower -> traction_force [kN], traction_power [kW]; the input traction applies them")
        return {"traction_force": rounded(1e-3 * force), "traction_power": rounded(1e-3 * power)}
    if told:
        notes.left(f"{', '.join(told)}: motors need both, up to {STRONGEST:g} kN and {1e-6 * MOST_POWER:g} MW.")
    return {}


def _dynamic(fields: Fields, notes: Notes) -> Row:
    """Return the dynamic brake: a curve; or its largest force, the speed below which it fades and its power.

    Open Rails has no force below MinUsableSpeed, all of it from FadingSpeed to MaximumEffectiveSpeed, and less above.
    """
    row = _curve(fields, BRAKE_CURVES, "dynamic_table", notes)
    force = fields.number("DynamicBrakesMaximumForce", "N")
    if row:
        if force:
            notes.left("DynamicBrakesMaximumForce and its speeds: the curve of forces is read instead.")
        return row
    if not force or force < 0.0:
        return {}
    notes.taken("DynamicBrakesMaximumForce -> dynamic_force [kN]; the input dynamic_brake of the train applies it")
    row = {"dynamic_force": rounded(1e-3 * force)}
    least, fades = (fields.number(name, "km/h") for name in ("DynamicBrakesMinUsableSpeed", "DynamicBrakesFadingSpeed"))
    if fades is not None and fades >= 0.0:
        row["dynamic_fade"] = rounded(fades)
        notes.converted("DynamicBrakesFadingSpeed -> dynamic_fade [km/h]")
        if least:
            notes.left(
                f"DynamicBrakesMinUsableSpeed: the force fades to 0 at standstill, in Open Rails at {least:.3g} km/h."
            )
    rate = fields.number("ORTSDynamicBrakeForceRampUpRate", "N/s")
    if rate and rate > 0.0:
        row["dynamic_rise"] = rounded(force / rate)
        notes.converted("DynamicBrakesMaximumForce / ORTSDynamicBrakeForceRampUpRate -> dynamic_rise [s]")
    effective = fields.number("DynamicBrakesMaximumEffectiveSpeed", "km/h")
    if effective and effective > 0.0:
        row["dynamic_power"] = rounded(1e-3 * force * effective / 3.6)
        notes.converted("DynamicBrakesMaximumForce x DynamicBrakesMaximumEffectiveSpeed -> dynamic_power [kW]")
        if fields.has("DynamicBrakesMaximumSpeedForFadeOut"):
            notes.left(
                "DynamicBrakesMaximumSpeedForFadeOut: above the effective speed the force falls as P / v, in Open "
                "Rails linearly."
            )
    return row
