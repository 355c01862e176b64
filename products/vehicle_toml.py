"""Vehicles as TOML files: the reverse of `vehicle_file.py`."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

from products.vehicle_entries import ENTRIES, HEIGHTS, LIKE, PARAMETER_OF, RESISTANCE, literal, number_of
from products.vehicle_parts import ENTRY, OF_FILE
from products.vehicle_sheet import DataSheet
from rbd_model.vehicle.parameters import VehicleParameters
from readers.storage import write_whole

#: Vehicles from public data, one file each, with the source of each number.
EXAMPLES = Path(__file__).parent / "data_sheets"


def names_of_examples() -> list[str]:
    """Return the names of the vehicles from public data."""
    return sorted(path.stem for path in EXAMPLES.glob("*.toml"))


def export_vehicle(name: str, path: str | Path) -> Path:
    """Write a built-in vehicle, a key of LIKE, or a vehicle from public data as a file. Raises OSError."""
    if name in LIKE:
        return write_vehicle(built_in_sheet(name), path)
    write_whole(Path(path), (EXAMPLES / f"{name}.toml").read_bytes())
    return Path(path)


def built_in_sheet(name: str) -> DataSheet:
    """Return a built-in vehicle as the content of a file, without a brake."""
    parameters = LIKE[name][1]()
    axles = 4 if isinstance(parameters, VehicleParameters) else 2
    return DataSheet(name, name, axles, parameters, {}, None, {})


def toml_of_sheet(sheet: DataSheet) -> str:
    """Return the text of a file with every parameter of a vehicle, its brake, its profiles, bodies and connections.

    Reading it gives the same vehicle. A parameter is written as an entry of the data sheet where this is exact,
    otherwise in [parameters].
    """
    idle = sheet.idle
    values = {name: value for name, value in sheet.parameters.values().items() if name not in idle}
    rows = [f"name = {literal(sheet.name)}", f"like = {literal(sheet.like)}", f"axles = {sheet.axles}"]
    entries = {key: text for key in ENTRIES if key in PARAMETER_OF and (text := _exact(key, values)) is not None}
    rows += [f"{key} = {literal(text)}" for key, text in entries.items()]
    written = {PARAMETER_OF[key] for key in entries}
    rows += [f"{ENTRY} = {literal(OF_FILE)}"] if sheet.parts.are_all else []
    tables = ", ".join(literal(str(path)) for path in sheet.profile_files)
    rows += [f"profile_file = [{tables}]"] if tables else []
    if sheet.resistance:
        rows += ["", "[resistance]"]
        named = {parameter: (key, entry.unit) for key, (parameter, entry) in RESISTANCE.items()}
        rows += [f'{named[one][0]} = "{value!r} {named[one][1]}"' for one, value in sheet.resistance.items()]
    if sheet.brake is not None:
        rows += ["", "[brake]", *(f"{key} = {literal(value)}" for key, value in sheet.brake.entries.items())]
    rows += ["", "[parameters]"]
    for item in fields(sheet.parameters):
        if item.name in values and item.name not in written:
            unit = item.metadata["unit"]
            number = repr(values[item.name])
            rows.append(f"{item.name} = {number}" if unit == "1" else f'{item.name} = "{number} {unit}"')
    rows += sheet.parts.lines()
    return "\n".join([*rows, ""])


def _exact(key: str, values: dict[str, float]) -> str | None:
    """Return the text of an entry that gives a parameter exactly, or None."""
    if PARAMETER_OF[key] not in values:
        return None
    own, above = values[PARAMETER_OF[key]], values["wheel_radius"] if key in HEIGHTS else 0.0
    stated = 2 * own if key == "wheel_diameter" else own + above
    stated = float(f"{stated:.12g}")
    text = f"{stated!r} {ENTRIES[key].unit}"
    back = number_of(ENTRIES[key], text, key)
    again = back / 2 if key == "wheel_diameter" else back - above
    return text if again == own else None


def write_vehicle(sheet: DataSheet, path: str | Path) -> Path:
    """Write a vehicle as a TOML file: parameters, brake, resistance, connections, path of its contact table.

    Reading it gives the same vehicle. Values that were assumed are then stated.
    """
    path = Path(path)
    write_whole(path, toml_of_sheet(sheet).encode())
    return path
