"""Trains of Open Rails and MSTS: a consist (.con) with its vehicles (.eng, .wag), or one vehicle.

A consist names vehicles by file and folder. They are looked for as MSTS keeps them, in TRAINS/TRAINSET/folder beside
TRAINS/CONSISTS, first in a folder OpenRails there, and in the folder of the consist.
"""

from __future__ import annotations

from pathlib import Path

from readers.formats.any_case import in_any_case
from readers.formats.open_rails_text import Block, Reader
from readers.formats.open_rails_vehicle import coupler_of, vehicle_of
from readers.formats.vehicle_rows import MOST, fitting, rounded, whole_train
from readers.import_account import Imported, Notes, Row
from readers.text import FileError

#: Names that a message about missing files lists.
LISTED = 3


def read_open_rails(path: Path) -> Imported:
    """Return the train of a .con file, or the vehicle of an .eng or .wag file."""
    notes = Notes()
    if path.suffix.lower() == ".con":
        entries = _entries(path, notes)
        files = _files(path, entries)
    else:
        entries, files = [Block("wagon")], [path]
    read: dict[Path, tuple[Row, list[Block], float]] = {}
    rows: list[Row] = []
    led = False
    for entry, file in zip(entries, files, strict=True):
        if file not in read:
            notes.begin(file.name)
            read[file] = vehicle_of(file, notes)
        notes.vehicle = file.name
        row, couplings, share = read[file]
        if led and row["kind"] == "locomotive" and "resistance_c" in row:
            row = row | {"resistance_c": rounded(share * row["resistance_c"])}
            notes.converted(f"ORTSDavis_C of a locomotive behind the first one: x {share:g}, as in Open Rails")
        led = led or row["kind"] == "locomotive"
        flipped = entry.last("flip") is not None or "flip" in [word.lower() for word in entry.words]
        rows += fitting(row | coupler_of(couplings, flipped, notes), notes, str(file))
        if flipped:
            notes.taken("Flip: the coupler behind the vehicle is the second one of its file")
    return notes.imported(whole_train(rows, notes, str(path)))


def _entries(path: Path, notes: Notes) -> list[Block]:
    """Return the entries of a consist from its head. Raises FileError."""
    reader = Reader()
    root = reader.read(path)
    for remark in reader.remarks:
        notes.assumed(remark)
    train = root.last("train")
    config = train.last("traincfg") if train else root.last("traincfg")
    if config is None:
        raise FileError(f"{path} must have Train ( TrainCfg ( ) ); got none. Give a .con file.")
    entries = config.all("engine", "wagon")
    if not 1 <= len(entries) <= MOST:
        raise FileError(f"{path} must have 1 to {MOST} vehicles in TrainCfg; got {len(entries)}. Correct the file.")
    outside = len(train.all("engine", "wagon")) if train else 0
    if outside:
        notes.left(f"{outside} vehicles outside TrainCfg: Open Rails ignores them, MSTS adds them.")
    if named := [name for name in ("MaxVelocity", "Durability", "Serial", "NextWagonUID") if config.last(name.lower())]:
        notes.left(f"{', '.join(named)}: they do not affect braking.")
    return entries


def _files(path: Path, entries: list[Block]) -> list[Path]:
    """Return the files of the entries. Raises FileError that names missing ones."""
    found: list[Path] = []
    missing: list[str] = []
    for entry in entries:
        data = entry.last(f"{entry.name}data")
        if data is None or not data.words:
            raise FileError(
                f"{path}, row {entry.row}: {entry.name} must name its file with {entry.name}data ( file folder ); got "
                "none. Add it."
            )
        name = f"{data.words[0]}.{'eng' if entry.name == 'engine' else 'wag'}"
        folder = data.words[1] if len(data.words) > 1 else data.words[0]
        place = _place(path.parent, folder, name)
        if place is None:
            missing.append(f"{folder}/{name}")
        else:
            found.append(place)
    if missing:
        names = list(dict.fromkeys(missing))
        more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
        raise FileError(
            f"{path} must have its vehicles in {path.parent.parent / 'TRAINSET'} or beside it; got no "
            f"{', '.join(names[:LISTED])}{more}. Copy the folders there."
        )
    return found


def _place(folder: Path, own: str, name: str) -> Path | None:
    """Return the file of a vehicle in its folder, with letters of any case, or None."""
    for base in (folder.parent, folder):
        for way in ("TRAINSET/", ""):
            for kind in ("OpenRails/", ""):
                found = in_any_case(base, f"{way}{own}/{kind}{name}")
                if found is not None:
                    return found
    return in_any_case(folder, name)
