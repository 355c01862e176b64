"""Test the reader of tables: tables of several countries are read as they are meant, or refused with their place."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest

from readers.columns import Column, TableError
from readers.tables import read_table, table_of
from readers.text import FileError
from readers.units import SPELLINGS, factor

COLUMNS = (
    Column("distance", "m", -1e7, 1e7, required=True),
    Column("curvature", "1/m", -0.02, 0.02, required=True),
    Column("cant", "m", -0.3, 0.3),
    Column("gradient", "1", -0.5, 0.5),
    Column("kind", words=("straight", "curve"), filled=False),
)
#: The same two rows in many forms: distance 0 and 50 m, curvature 0 and 0.002 1/m, cant 0 and 0.1 m.
DISTANCE, CURVATURE, CANT = [0.0, 50.0], [0.0, 0.002], [0.0, 0.1]
FORMS = {
    "commas": "distance,curvature,cant\n0,0,0\n50,0.002,0.1\n",
    "old lines of a Mac": "distance,curvature,cant\r0,0,0\r50,0.002,0.1\r",
    "byte order mark": "\ufeffdistance,curvature,cant\n0,0,0\n50,0.002,0.1\n",
    "tabs": "distance\tcurvature\tcant\r\n0\t0\t0\r\n50\t0.002\t0.1",
    "semicolons, decimal commas": "distance;curvature;cant\n0;0;0\n50;0,002;0,1\n",
    "tabs, decimal commas": "distance\tcurvature\tcant\n0\t0\t0\n50,0\t2,0e-3\t0,1\n",
    "three digits, which decide": "distance;curvature;cant\n0.000;0.000;0.000\n50.000;0.002;0.100\n",
    "three digits, points": "distance,curvature,cant\n0,0,0\n50.000,0.002,0.100\n",
    "quotes": '"distance","curvature","cant"\n"0","0","0"\n"50","0.002","0.1"\n',
    "quotes, decimal commas": 'distance,curvature,cant\n"0,0","0","0"\n"50,0","0,002","0,1"\n',
    "declared": "sep=;\ndistance;curvature;cant\n0;0;0\n50;0.002;0.1\n",
    "spreadsheet's rest": "distance,curvature,cant,,\n\n0,0,0,,\n,,,,\n50,0.002,0.1,,\n,,,,\n\n",
    "remarks": '# a line, "quoted\n% of two rows\ndistance,curvature,cant\n! end\n0,0,0\n// x\n50,0.002,0.1\n',
    "units": "distance [km],curvature (1/km),cant [mm]\n0,0,0\n0.05,2,100\n",
    "capitals": "Distance [m];CURVATURE [rad/m];Cant [cm]\n0;0;0\n50;0,002;10\n",
    "another order": "cant, distance , curvature\n0,0,0\n0.1,50,0.002\n",
    "a typographer's minus": "distance,curvature,cant\n\u22120,0,0\n50,0.002,0.1\n",
}


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_one_table_in_many_forms(name: str, encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "line.csv"
    path.write_bytes(FORMS[name].encode(encoding))
    table = read_table(path, COLUMNS)
    for column, values in (("distance", DISTANCE), ("curvature", CURVATURE), ("cant", CANT)):
        assert table.numbers[column].tolist() == values, column
    assert "gradient" not in table.numbers


BAD = {
    'distance,curvature\n0,0\n"1,000",0\n"2,000",0\n': ("row 3", "distance", "'1,000' can be 1000 or 1", "one reading"),
    "distance;curvature\n0;0\n1.000;0\n25.000;0\n": ("row 3", "distance", "'1.000' can be 1000 or 1", "one reading"),
    "distance\tcurvature\n0\t0\n1,000\t0\n": ("row 3", "one reading", "Write 1000"),
    "distance,curvature,gradiant\n0,0,0\n": ("row 1", "'gradiant'", "Did you mean gradient?"),
    "distance,curvature,Cant,cant\n0,0,0,0\n": ("row 1", "cant", "twice"),
    "curvature\n0\n": ("row 1", "distance is missing", "Add it"),
    "distance curvature\n0 0\n": ("row 1", "unknown"),
    "distance,curvature,cant [furlong]\n0,0,0\n": ("row 1", "'furlong'", "cant", "unknown"),
    "distance,curvature,cant [kPa]\n0,0,0\n": ("row 1", "'kPa'", "another quantity"),
    "\n\ndistance;curvature\n0;0\n\n1;x\n": ("row 6", "column curvature", "'x'"),
    "distance,curvature\n0,0\n1,0.03\n": ("row 3", "column curvature", "from -0.02 to 0.02 1/m", "'0.03'"),
    "distance,curvature [1/km]\n0,0\n1,30\n": ("row 3", "curvature", "from -0.02 to 0.02 1/m", "'30'"),
    "distance;curvature\n0;0\n0,5;0.01\n": ("row 3", "one decimal mark", "'0.01'", "'0,5'"),
    "distance;curvature\n0;0\n1.234,5;0\n": ("row 3", "column distance", "must be a number", "'1.234,5'"),
    "distance,curvature\n0,0\n1,5,0,01\n": ("row 3", "at most 2 values", "semicolons"),
    "distance,curvature\n0,0\n1\n": ("row 3", "column curvature", "the cell is empty"),
    "distance,curvature\n0,0\n1,nan\n": ("row 3", "column curvature", "'nan'"),
    "distance,curvature\n0,0\n1_0,0\n": ("row 3", "column distance", "'1_0'"),
    "distance,curvature\n0,0\ninf,0\n": ("row 3", "column distance", "'inf'"),
    f"distance,curvature\n0,0\n{'9' * 400},0\n": ("row 3", "column distance", "400 characters", "1.8e308"),
    f"distance,curvature\n0,0\n{'x' * 200_000},0\n": ("row 3", "at most 20000 characters", "200002"),
    "distance,curvature,kind\n0,0,hill\n": ("row 2", "column kind", "one of straight, curve", "'hill'"),
    'distance,curvature\n0,"0\n': ("row 2", "quotes must close"),
    "0,0\n1,0\n": ("row 1", "must have names", "'0'", "distance [m]"),
    "distance,curvature\n0,0\n1,\x000\n": ("row 3", "character 0"),
    "# nothing\n\n": ("empty",),
}


@pytest.mark.parametrize("text", BAD, ids=range(len(BAD)))
def test_what_cannot_be_read_is_refused_by_its_place(text: str, tmp_path: Path) -> None:
    path = tmp_path / "line.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileError) as caught:
        read_table(path, COLUMNS)
    said = str(caught.value)
    assert str(path) in said
    for part in BAD[text]:
        assert part in said
    assert len(said) < 600


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("0,1\n2,3\n", [(0, 1), (2, 3)]),
        ("0;1,5\n2;3\n", [(0, 1.5), (2, 3)]),
        ("-36,000;-2,1600\n-35,5;-2\n", [(-36, -2.16), (-35.5, -2)]),
        ("0.5 1.5\n2  3\n", [(0.5, 1.5), (2, 3)]),
        ("0,5 1,5\n2 3\n", [(0.5, 1.5), (2, 3)]),
        ("t;moment [kN.m]\n0;1,5\n2;3\n", [(0, 1500), (2, 3000)]),
        ("torque [N.m],time [ms]\n1,0\n3,2000\n", [(0, 1), (2, 3)]),
    ],
)
def test_columns_by_position(text: str, pairs: list[tuple[float, float]]) -> None:
    columns = (Column("time", "s", required=True), Column("torque", "N.m", required=True))
    table = table_of(text, "torque.csv", columns, by_position=True)
    assert list(zip(table.numbers["time"], table.numbers["torque"], strict=True)) == pairs


def test_a_part_below_an_empty_cell_is_refused() -> None:
    columns = (Column("count", whole=True, filled=False), Column("mass", "kg"))
    assert table_of("count,mass\n,1\n2,1\n", "mine.csv", columns).numbers["count"][1] == 2.0
    with pytest.raises(TableError, match=r"row 3, column count: the value must be an integer; got '2\.5'"):
        table_of("count,mass\n,1\n2.5,1\n", "mine.csv", columns)


@pytest.mark.parametrize("text", ["0,1,2\n1,2,3\n", "0\n1\n", "time,moment [Pa]\n0,1\n", "0,1\n2,3,4\n"])
def test_rows_of_another_width_are_refused(text: str) -> None:
    columns = (Column("time", "s", required=True), Column("torque", "N.m", required=True))
    with pytest.raises(TableError, match=r"torque\.csv, row"):
        table_of(text, "torque.csv", columns, by_position=True)


def test_further_columns_keep_their_units() -> None:
    log = "Time [ms];speed (GPS) [km/h];valve 1\n0;90,0;0\n5;89,5;2\n"
    table = table_of(log, "log.csv", [Column("time", "s", required=True)], others=True)
    assert table.units == {"time": "s", "speed (GPS)": "km/h", "valve 1": "1"}
    assert table.numbers["time"].tolist() == [0.0, 0.005]
    np.testing.assert_allclose(table.converted("speed (GPS)", "m/s"), [25.0, 89.5 / 3.6], rtol=1e-15)
    with pytest.raises(TableError, match="another quantity"):
        table.converted("speed (GPS)", "Pa")


def test_growth_is_refused_by_the_row_of_the_spreadsheet() -> None:
    table = table_of("distance,curvature\n\n0,0\n# x\n0.0005,0\n", "line.csv", COLUMNS)
    table.check_growth("distance")
    with pytest.raises(TableError, match=r"line\.csv, row 5, column distance: .* at least 0\.001 m; got 0\.0005 m"):
        table.check_growth("distance", 1e-3)


@pytest.mark.parametrize("end", ["", "# a remark\n"])
def test_rows_are_counted_against_their_limit(end: str) -> None:
    """Both the fast path for plain numbers and the general one are checked; rows of separators are not counted."""
    text = f"distance,curvature\n{end}0,0\n,\n1,0\n"
    assert table_of(text, "line.csv", COLUMNS, most_rows=2).numbers["distance"].tolist() == [0.0, 1.0]
    with pytest.raises(TableError, match=r"line\.csv must have at most 1 rows"):
        table_of(text, "line.csv", COLUMNS, most_rows=1)


@pytest.mark.parametrize("end", ["", "# a remark\n"])
@pytest.mark.parametrize(("cell", "value"), [("-0", -0.0), ("-0.0", -0.0), ("1e-400", 0.0), (".5e1", 5.0), ("5.", 5.0)])
def test_numbers_are_read_to_their_sign(end: str, cell: str, value: float) -> None:
    table = table_of(f"distance,curvature\n{end}{cell},0\n", "line.csv", COLUMNS)
    assert np.array_equal(table.numbers["distance"], [value])
    assert np.signbit(table.numbers["distance"][0]) == np.signbit(value)


@pytest.mark.parametrize("rows", ["0,5;0\n1.5;0\n", "0;0\n" * 25_000 + "30000,5;0\n30001.5;0\n"])
def test_two_decimal_marks_are_refused_wherever_they_stand(rows: str) -> None:
    with pytest.raises(TableError, match="one decimal mark"):
        table_of(f"distance;curvature\n{rows}", "line.csv", COLUMNS)


@pytest.mark.parametrize("place", ["folder", "missing", "pipe"])
def test_what_is_no_file_is_refused(place: str, tmp_path: Path) -> None:
    path = tmp_path / "line.csv"
    if place == "folder":
        path.mkdir()
    elif place == "pipe":
        os = pytest.importorskip("os")
        if not hasattr(os, "mkfifo"):
            pytest.skip("this system has no pipes with names")
        os.mkfifo(path)
    with pytest.raises(FileError, match=r"line\.csv"):
        read_table(path, COLUMNS)


def test_units_convert_by_the_definitions_of_the_si() -> None:
    """Prefixes by their definition; km/h, mph, foot and inch by theirs (BIPM SI brochure; international yard 1959)."""
    known = {
        ("km/h", "m/s"): 1 / 3.6,
        ("mph", "m/s"): 1609.344 / 3600,
        ("mm", "m"): 1e-3,
        ("km", "mm"): 1e6,
        ("ft", "m"): 0.3048,
        ("in", "mm"): 25.4,
        ("bar", "Pa"): 1e5,
        ("kPa", "bar"): 1e-2,
        ("1/km", "1/m"): 1e-3,
        ("\u2030", "1"): 1e-3,
        ("%", "1"): 1e-2,
        ("kNm", "N.m"): 1e3,
        ("t", "kg"): 1e3,
        ("l", "m3"): 1e-3,
        ("\u03bcm", "m"): 1e-6,
    }
    for (unit, target), expected in known.items():
        both = factor(unit, target)
        assert both is not None
        assert both[0] / both[1] == pytest.approx(expected, rel=1e-15)
    for units in SPELLINGS.values():
        for one in units:
            assert factor(one, one) == (1.0, 1.0)
    assert factor("kPa", "m") is None
    assert factor("furlong", "m") is None


def test_mutated_tables_give_a_result_or_one_message() -> None:
    random_ = random.Random(47)
    texts = list(FORMS.values())
    odd = [
        "\0",
        '"',
        ",",
        ";",
        "\t",
        "[",
        "(",
        "]",
        "e",
        "-",
        "9" * 400,
        "\u2212",
        "\ud7ff",
        "nan",
        "\r",
        "\n",
        "x" * 30,
    ]
    for _ in range(2000):
        text = random_.choice(texts)
        for _ in range(random_.randint(1, 4)):
            at = random_.randrange(len(text) + 1)
            text = text[:at] + random_.choice(odd) + text[at + random_.randint(0, 3) :]
        said = ""
        try:
            table = table_of(text, "line.csv", COLUMNS)
            assert all(np.all(np.isfinite(values)) for values in table.numbers.values())
        except FileError as error:
            said = str(error)
        assert "\n" not in said
        assert len(said) < 700
