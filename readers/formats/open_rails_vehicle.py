"""Vehicles of Open Rails and MSTS (.eng, .wag) as rows of a consist.

Names, units and defaults as the manual of Open Rails states them.
"""

from __future__ import annotations

from pathlib import Path

from readers.formats.open_rails_brake import brake_of, branch_of, hand_brake_of
from readers.formats.open_rails_drive import DRIVE, drive_of
from readers.formats.open_rails_fields import Fields
from readers.formats.open_rails_left import LEFT
from readers.formats.open_rails_text import Block, Reader
from readers.formats.vehicle_rows import rounded
from readers.import_account import Notes, Row
from readers.text import FileError, quoted, shown

#: Kinds by the word of Wagon(Type.
KINDS = {
    "engine": "locomotive",
    "carriage": "coach",
    "passenger": "coach",
    "freight": "wagon",
    "tender": "wagon",
    "eot": "wagon",
}
#: Share of its drag that a locomotive has that does not lead the train (MSTSWagon.cs, TrailLocoResistanceFactor).
TRAILING = 0.2083
#: Fields that are taken.
TAKEN = (
    *("ORTSTrailLocomotiveResistanceFactor", "Type", "Mass", "Size", "Name", "ORTSDavis_A", "ORTSDavis_B"),
    *("ORTSDavis_C", "MaxBrakeForce", "ORTSMaxBrakeShoeForce", "ORTSNumberCarBrakeShoes", "ORTSBrakeShoeType"),
    *("ORTSBrakeShoeFriction", "BrakeSystemType", "BrakeEquipmentType"),
    *("BrakeCylinderPressureForMaxBrakeBrakeForce", "ORTSBrakeForceReferencePressure", "MaxApplicationRate"),
    *("MaxReleaseRate", "BrakeDistributorApplicationRate", "BrakeDistributorReleaseRate"),
    *("ORTSAuxiliaryResCapacity", "ORTSBrakeCylinderVolume", "TripleValveRatio", "EmergencyResCapacity"),
    *("EmergencyResVolumeMultiplier", "BrakePipeVolume", "ORTSBrakeCylinderDiameter"),
    *("ORTSBrakeCylinderPistonTravel", "ORTSNumberBrakeCylinders", "Coupling", "ORTSFreightAnims"),
    *("ORTSEPBrakeControlsBrakePipe", "ORTSEmergencyResQuickRelease", "MaxHandbrakeForce"),
)


def vehicle_of(path: Path, notes: Notes) -> tuple[Row, list[Block], float]:
    """Return a vehicle as a row without coupler, its couplings in the order of the file, and its share of drag.

    The share is that of the drag of a locomotive that does not lead the train.
    """
    reader = Reader()
    root = reader.read(path)
    own, notes.vehicle = notes.vehicle, ""
    for remark in reader.remarks:
        notes.assumed(remark)
    notes.vehicle = own
    wagons = root.all("wagon")
    if not wagons:
        raise FileError(f"{path} must have a block Wagon ( ); got none. Give an .eng or .wag file.")
    blocks = [block for wagon in wagons for block in wagon.blocks]
    fields = Fields(blocks, notes)
    loads = _loads(fields, notes)
    row: Row = {"kind": _kind(fields, path, notes)}
    name = " ".join(fields.words("Name")) or path.stem
    row["name"] = "".join(one if one.isprintable() else " " for one in name)[:60].strip() or "vehicle"
    row["mass"] = _mass(fields, loads, path, notes)
    row["length"] = _length(fields, path, notes)
    row |= _resistance(fields, notes)
    row |= brake_of(fields, notes) | hand_brake_of(fields, notes) | drive_of(_engines(root), notes)
    row |= branch_of(fields, row["length"], notes)
    _tell_left(fields, root, notes)
    share = fields.number("ORTSTrailLocomotiveResistanceFactor", "1") or TRAILING
    return row, [block for block in blocks if block.name == "coupling"], share


def _kind(fields: Fields, path: Path, notes: Notes) -> str:
    word = fields.word("Type")
    if word in KINDS:
        notes.taken("Type -> kind")
        return KINDS[word]
    kind = "locomotive" if path.suffix.lower() == ".eng" else "wagon"
    notes.assumed(f"Type: {quoted(word) if word else 'missing'}; taken as {kind} by the name of the file.")
    return kind


def _loads(fields: Fields, notes: Notes) -> list[float]:
    """Return the loads of a vehicle's freight animations [kg], and use the fields of its state of load."""
    block = fields.blocks.get("ortsfreightanims")
    if block is None:
        return []
    loads, full = [], False
    for one in block.all("freightanimstatic", "freightanimcontinuous"):
        own = Fields(one.blocks, notes)
        load = own.number("FreightWeight" if one.name == "freightanimstatic" else "FreightWeightWhenFull", "kg")
        there = one.name == "freightanimstatic" or own.word("FullAtStart") in ("1", "true")
        if load and there:
            loads.append(load)
            full = True
    state = "full" if full else "empty"
    for one in [block, *block.blocks]:
        for inner in one.blocks:
            if inner.name.startswith(state) and (base := inner.name.removeprefix(state)) in _OF_STATE:
                fields.blocks[base] = inner
                notes.taken(f"ORTSFreightAnims: {state} values in place of the vehicle's own")
    return loads


_OF_STATE = {name.lower() for name in TAKEN} | {"ortsmaxbrakeshoeforce", "maxbrakeforce"}


def _mass(fields: Fields, loads: list[float], path: Path, notes: Notes) -> float:
    """Return the mass [t]. Raises FileError if the file has none."""
    anims = fields.blocks.get("ortsfreightanims")
    empty = Fields(anims.blocks, notes).number("WagonEmptyWeight", "kg") if anims else None
    if empty:
        notes.converted("ORTSFreightAnims: WagonEmptyWeight and the loads that are there at the start -> mass [t]")
        return rounded(1e-3 * (empty + sum(loads)))
    mass = fields.number("Mass", "kg")
    if mass is None or mass <= 0.0:
        raise FileError(f"{path} must have Mass in kg, t or lb; got {shown(fields.word('Mass') or None)}. Add it.")
    notes.taken("Mass -> mass [t]")
    return rounded(1e-3 * mass)


def _length(fields: Fields, path: Path, notes: Notes) -> float:
    """Return the length [m]. Raises FileError if the file has none."""
    length = fields.number("Size", "m", 2)
    if length is None or length <= 0.0:
        words = " ".join(fields.words("Size"))
        raise FileError(f"{path} must have Size ( width height length ); got {shown(words)}. Correct it.")
    notes.taken("Size, third value -> length [m]")
    return rounded(length)


def _resistance(fields: Fields, notes: Notes) -> Row:
    """Return Davis' a + b v + c v^2 [N] as it stands; Open Rails takes it where none of the three is 0."""
    names = {"ORTSDavis_A": "N", "ORTSDavis_B": "N/(m/s)", "ORTSDavis_C": "N/(m/s)^2"}
    found = [fields.number(name, unit) for name, unit in names.items()]
    default = "Open Rails takes its own formula, with 516 N and 6.374 N/t at rest"
    if found[0] is None:
        told = "no ORTSDavis_A" if any(one is not None for one in found) else "no ORTSDavis_A, B, C"
        notes.assumed(f"Running resistance: the file has {told}; that of the vehicle's kind applies, where {default}.")
        return {}
    notes.taken("ORTSDavis_A, _B, _C -> resistance_a, _b, _c [N, N/(m/s), N/(m/s)^2]")
    notes.left("Starting resistance below 5 mph, which Open Rails has instead of ORTSDavis: it has no column.")
    if not all(found):
        notes.assumed(f"ORTSDavis with a coefficient that is 0 or missing: read as it stands, where {default}.")
    return {f"resistance_{letter}": rounded(value or 0.0) for letter, value in zip("abc", found, strict=True)}


def _engines(root: Block) -> list[Block]:
    """Return the blocks Engine of a file, beside Wagon or inside it."""
    return [*root.all("engine"), *(inner for wagon in root.all("wagon") for inner in wagon.all("engine"))]


def _tell_left(fields: Fields, root: Block, notes: Notes) -> None:
    """Tell fields without a column, each with the reason, and misspelt ones."""
    names = {block.name for block in fields.blocks.values()}
    names |= {block.name for one in _engines(root) for block in one.blocks}
    notes.left_of(LEFT, [name for name in LEFT if name.lower() in names])
    outside = [block.name for block in root.blocks if block.name.lower() in {one.lower() for one in TAKEN}]
    for name in outside:
        notes.left(f"{name}: it stands outside Wagon ( ), and Open Rails ignores it.")
    fields.misspelt([*LEFT, *DRIVE, "Engine", "Inside", "Lights"], TAKEN)
