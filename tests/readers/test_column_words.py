"""German and French names: each means one column of a table, and whole files in them are those in English."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from bogie_braking.train_fitting import STOPS
from products.train.consist_columns import IDLE, NAMES, choices
from products.train.consist_file import read_consist
from products.train.coupler_tables import TABLE_NAMES
from products.vehicle_brakes import OF_CONSISTS
from products.vehicle_entries import ENTRIES
from products.vehicle_file import read_vehicle
from products.vehicle_sheet import TABLES
from rbd_model.track.irregularity import COLUMNS as IRREGULAR
from rbd_model.track.irregularity import track_from_file
from rbd_model.track.line import read_line
from rbd_model.track.line_elements import ELEMENTS, PROFILE
from rbd_model.track.line_files import account_of, line_from_file
from rbd_model.track.line_table import LINE
from rbd_model.track.point_files import COLUMNS as POINTS
from rbd_model.track.point_files import HEIGHT
from readers.cell_words import CELL_WORDS
from readers.column_words import COLUMN_WORDS, column_meant, plain, words_of
from readers.columns import Column
from readers.tables import read_table, table_of
from readers.text import FileError

KNOWN: dict[str, list[str]] = {
    "line": [column.name for column in LINE.columns],
    "elements": [column.name for column in ELEMENTS],
    "profile": [column.name for column in PROFILE],
    "points": [column.name for column in POINTS],
    "irregularity": [column.name for column in IRREGULAR],
    "stops": [column.name for column in STOPS],
    "consist": [*NAMES, *IDLE],
    "coupler": list(TABLE_NAMES),
    "vehicle": [*ENTRIES, "name", "like", "profile_file", *TABLES],
    "brake of a vehicle": list(OF_CONSISTS),
}


@pytest.mark.parametrize("table", KNOWN)
def test_each_word_means_one_column_of_a_table_and_none_is_a_column(table: str) -> None:
    known = KNOWN[table]
    for column in known:
        for word in words_of(column):
            assert column_meant(word, known) == column
            both = {word, column}
            assert word == column or word not in known or both <= set(HEIGHT), f"{word} of {column} is a column too"


def test_words_are_those_of_columns_that_exist() -> None:
    everywhere = {name for known in KNOWN.values() for name in known} | {"time", "speed"}
    assert set(COLUMN_WORDS) <= everywhere
    assert {name for name, words in CELL_WORDS.items() if not set(words) <= set(choices(name))} == set()


def test_words_are_compared_as_people_write_them() -> None:
    for name in ("Überhöhung", "ÜBERHÖHUNG", "Ueberhoehung", "U\u0308berho\u0308hung", "überhöhung "):
        assert column_meant(name, KNOWN["line"]) == "cant"
    for name in ("dévers", "Dévers", "devers", "DE\u0301VERS"):
        assert column_meant(name, KNOWN["line"]) == "cant"
    assert plain("Länge über Puffer") == "laenge_ueber_puffer"


@pytest.mark.parametrize(
    ("name", "table"),
    [
        ("Radius", "line"),
        ("Reibwert", "irregularity"),
        ("Reibwert links", "line"),
        ("Tara", "line"),
        ("Bremsgewicht", "stops"),
        ("Reibradius", "consist"),
        ("Gefälle", "line"),
        ("Anzahl Bremsklötze", "brake of a vehicle"),
        ("Reibungsgesetz", "brake of a vehicle"),
    ],
)
def test_a_word_of_another_quantity_is_no_column(name: str, table: str) -> None:
    assert column_meant(name, KNOWN[table]) is None


def test_a_false_friend_and_a_name_of_two_columns_are_refused(tmp_path: Path) -> None:
    with pytest.raises(
        FileError, match=r"'Pente' is unknown. A fall must be a gradient here, which is positive upwards"
    ):
        table_of("distance,Pente\n0,1\n", "line.csv", LINE.columns)
    columns = [Column("distance", "m"), Column("chainage", "m")]
    with pytest.raises(FileError, match=r"row 1: the name 'Abscisse' can be distance or chainage. Write one of these"):
        table_of("Abscisse\n0\n", "line.csv", columns)
    with pytest.raises(FileError, match="the column cant must be there once; it is there twice"):
        table_of("distance,cant,dévers\n0,1,1\n", "line.csv", LINE.columns)
    path = tmp_path / "train.csv"
    path.write_text("Fahrzeugart,Bremsgewicht P,Bremsgewicht G\nwagon,60,50\n")
    with pytest.raises(FileError, match=r"'Bremsgewicht P' is unknown. A vehicle must have one brake weight, that of"):
        read_consist(path)
    for head, said in (
        ("Beladung", "A load must be a mass here: Ladung"),
        ("cars", "Columns are kind, name, count, load, mass, length,"),
    ):
        path.write_text(f"kind,{head}\nwagon,60\n")
        with pytest.raises(FileError, match=f"'{head}' is unknown. {said}"):
            read_consist(path)
    with pytest.raises(FileError, match=r"'Rayon' is unknown. A radius must be a curvature here, 1 / radius, above 0"):
        table_of("distance,Rayon\n0,300\n", "line.csv", LINE.columns)
    path = tmp_path / "train.toml"
    path.write_text('[[vehicle]]\nkind = "wagon"\nlength = 20\nlongueur = 20\n')
    with pytest.raises(ValueError, match="length must be given once; it is there twice, also as 'longueur'"):
        read_consist(path)


def translated(names: str, language: int) -> str:
    """Return a row of names with the first word of each in a language, and the same units."""
    cells = []
    for cell in names.split(","):
        name, unit = re.fullmatch(r"([^\[]*?)( \[.*\])?", cell).groups("")  # type: ignore[union-attr]
        words = COLUMN_WORDS.get(name, ((), ()))[language]
        cells.append((words[0] if words else name) + unit)
    return ",".join(cells)


CONSIST = (
    "kind,name,count,mass [t],length [m],lambda [%],full_pressure [bar],fill_time [s],release_time [s],coupler\n"
    "locomotive,E,1,84,19,120,3.8,5,20,screw\nwagon,W,20,60,15,65,3.8,25,50,screw\n"
)
LINES = (
    "distance,curvature [1/km],cant [mm],gradient [permille],gauge_widening [mm],left_vertical [mm],right_friction\n"
)
LINES += "0,0,0,5,0,0,1\n50,0,0,5,0,1,1\n130,3.3,100,5,5,0,0.5\n400,3.3,100,-2,5,0,0.5\n"


@pytest.mark.parametrize("language", [0, 1])
def test_files_in_one_language_are_those_in_english(language: int, tmp_path: Path) -> None:
    for at, names in enumerate((CONSIST, LINES)):
        head, _, rows = names.partition("\n")
        (tmp_path / f"en{at}.csv").write_text(names, encoding="utf-8")
        own = translated(head, language)
        assert sum(a == b for a, b in zip(own.split(","), head.split(","), strict=True)) <= 1  # kind of the word `name`
        (tmp_path / f"own{at}.csv").write_text(f"{own}\n{rows}", encoding="utf-8")
    assert read_consist(tmp_path / "own0.csv") == read_consist(tmp_path / "en0.csv")
    ours, english = line_from_file(tmp_path / "own1.csv").rows, read_line(tmp_path / "en1.csv").rows
    assert list(ours) == list(english)
    for name, values in english.items():
        np.testing.assert_array_equal(ours[name], values)


def test_tables_in_toml_have_the_words_too(tmp_path: Path) -> None:
    english = """[[vehicle]]\nkind = "locomotive"\n[[vehicle]]\nkind = "wagon"\nload = 20\ncoupler = "own"\ncount = 2
[[coupler]]\nname = "own"\nslack = 10\nbuffer_travel = [0, 100]\nbuffer_loading = [10, 600]\nbuffer_damping = 0.5
tension_travel = [0, 50]\ntension_loading = [10, 1000]\ntension_damping = 0.4
"""
    german = english
    for name in ("kind", "load", "count", "coupler", "slack", *re.findall(r"\w+_\w+", english), "name"):
        word = COLUMN_WORDS[name][0][0]
        german = re.sub(rf"^{name} =", f'"{word}" =', german, flags=re.MULTILINE)
    assert "slack" not in german
    (tmp_path / "en.toml").write_text(english)
    (tmp_path / "de.toml").write_text(german, encoding="utf-8")
    assert read_consist(tmp_path / "de.toml") == read_consist(tmp_path / "en.toml")
    english = (
        'axles = 4\ntare = "42 t"\nload = "5 t"\nwheel_diameter = "920 mm"\n[brake]\npercentage = 120\nfriction = 0.3\n'
    )
    french = '"nombre d\'essieux" = 4\n"masse à vide" = "42 t"\ncharge = "5 t"\n"diamètre de roue" = "920 mm"\n'
    french += '[brake]\n"pourcentage de freinage" = 120\n"coefficient de frottement" = 0.3\n'
    (tmp_path / "v.toml").write_text(english)
    before = read_vehicle(tmp_path / "v.toml")
    (tmp_path / "v.toml").write_text(french, encoding="utf-8")
    assert read_vehicle(tmp_path / "v.toml") == before


def test_elements_points_and_measured_tracks_have_the_words_too(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("Typ;Länge;Halbmesser;Überhöhung [mm]\nstraight;100;;\ntransition;60;;\narc;200;600;100\n")
    elements = line_from_file(path)
    assert "column 'Halbmesser' is read as radius" in account_of(elements).converted
    path.write_text("type;length;radius;cant [mm]\nstraight;100;;\ntransition;60;;\narc;200;600;100\n")
    for name, values in line_from_file(path).rows.items():
        np.testing.assert_array_equal(elements.rows[name], values)
    angle = np.linspace(0.0, 0.5, 40)
    rows = "".join(f"{600 * np.sin(a):.4f},{600 - 600 * np.cos(a):.4f},0\n" for a in angle)
    path.write_text("Rechtswert,Hochwert,Höhe\n" + rows)
    assert line_from_file(path).rows["distance"].size > 10
    path.write_text("Weg,seitlich [mm],links [mm],rechts [mm],friction\n" + "".join(f"{n},1,2,3,1\n" for n in range(8)))
    assert track_from_file(path) is not None
    assert read_table(path, IRREGULAR, by_position=True).numbers["lateral"].tolist() == [0.001] * 8
