"""Consists as people write them: brake sheets in three languages, brake weights, positions, net braking ratios."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

import bogie_braking as bb
from brake_controller.brake_weight import FROM_100, VEHICLE_BUILD_UP
from products.train.consist_columns import NUMBERS
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.summary import brake_force, summary_of
from products.vehicle_file import sheet_of
from readers.text import FileError

POUND, G = 0.45359237, 9.80665
HEAD = {"kind": "locomotive", "brake": "none"}
#: The same train as its sheets are written: separators, marks, units, words, cases.
SHEETS = {
    "plain": "kind,mass,length,brake_weight,position\nlocomotive,84,19.1,80,P\ncoach,46.5,26.4,62,R\n"
    "wagon,80,14.04,58,G\n",
    "German": "\ufeffNr;Art;Gewicht;Bremsgewicht;Bremsart R/P/G;Länge\n1;Lokomotive;84;80;P;19,1\n"
    "2;Reisezugwagen;46,5;62;R;26,4\n3;Wagen;80;58;G;14,04\n",
    "heads as on sheets": "Baureihe;Art;Gewicht;Bremsgewicht;Br-Art P/G/R;Länge\n103;Lok;84;80;P;19,1\n"
    "Bm;Sitzwagen;46,5;62;R;26,4\nEaos;Wagen;80;58;G;14,04\n",
    "units in cells": "Fahrzeug;Achsen;Gewicht;Bremsgewicht;Bremsstellung;LüP\nLOK;4;8,4e1;80000 kg;p;19,1 m\n"
    "reisezugwagen;4;46500 kg;62t;r;2640 cm\nGüterwagen;4;80 T;58 t;g;14,04\n",
    "units behind": "Art;Masse in kg;Bremsgewicht/t;Bremsart (R/P/G);Länge_m;Bemerkung\nLok;84000;80;P;19,1;\n"
    "Personenwagen;46500;62;R;26,4;neu\nWagen;80000;58;G;14,04;\n",
    "French": "n°;type de véhicule;poids (t);masse freinée [t];régime;longueur\n1;loco;84;80;V;19.1\n"
    "2;voiture;46.5;62;R;26.4\n3;wagon;80;58;M;14.04\n",
    "with tare": "kind,tare [lb],load [kg],length,braked weight,lambda,brake position\n"
    f"locomotive,{84000 / POUND!r},0,19.1,80,95 %,P\ncoach,{46000 / POUND!r},500,26.4,62,133,R\n"
    f"wagon,{20000 / POUND!r},60000,14.04,58,,G\n",
}


@pytest.mark.parametrize("name", SHEETS)
def test_a_sheet_reads_as_the_plain_consist(name: str, tmp_path: Path) -> None:
    (tmp_path / "plain.csv").write_text(SHEETS["plain"])
    (tmp_path / "sheet.csv").write_text(SHEETS[name], encoding="utf-8")
    plain, read = read_consist(tmp_path / "plain.csv"), read_consist(tmp_path / "sheet.csv")
    if name == "with tare":
        assert [one.percentage for one in read.vehicles] == pytest.approx([95.0, 133.0, 72.5], rel=1e-9)
        assert [one.mass for one in read.vehicles] == pytest.approx([84e3, 46.5e3, 80e3], rel=1e-12)
    else:
        assert read == plain
    assert bool(read.notes) == (name != "plain")
    for ending in ("csv", "toml"):  # what is written reads as the same train
        write_consist(read, tmp_path / f"again.{ending}")
        again = read_consist(tmp_path / f"again.{ending}")
        assert [one.percentage for one in again.vehicles] == pytest.approx([one.percentage for one in read.vehicles])


def test_rows_with_words_of_people_are_written_with_the_names_of_columns(tmp_path: Path) -> None:
    rows = [{"Art": "Lok", "Gewicht": "84 t", "Bremsgewicht": "80 t", "Achsen": 4}, {"kind": "Wagen", "Gewicht": 80}]
    for ending in ("csv", "toml"):
        path = tmp_path / f"rows.{ending}"
        write_consist(rows, path)
        assert "Gewicht" not in path.read_text()
        assert read_consist(path) == consist_of(rows)
    notes = consist_of(rows).notes
    assert "column 'Bremsgewicht' is read as brake_weight" in notes
    assert "'Lok' is read as kind = locomotive" in notes
    assert any(note.startswith("column axles is left out") for note in notes)
    assert "Read 'Art' as kind, " in "".join(summary_of(consist_of(rows), ()).remarks)


def test_magnets_that_have_the_brake_weight_alone_are_told() -> None:
    coach = {"kind": "coach", "mass": 49.5, "position": "R+Mg", "magnetic_attraction": 160}
    for weight, is_told in ((20, True), (90, False)):
        notes = consist_of([HEAD, coach | {"brake_weight": weight}]).notes
        assert any("wheel brakes have almost none" in note for note in notes) == is_told


def test_brakes_that_some_rows_leave_to_their_kind_are_told() -> None:
    rows = [{"kind": "locomotive"}, {"kind": "coach", "brake_weight": 62}, {"kind": "wagon", "brake_weight": 0}]
    assert "row 1 (locomotive, 85 %). State brake_weight" in consist_of(rows).notes[-1]
    assert not consist_of([rows[0] | {"lambda": 90}, *rows[1:]]).notes
    assert not consist_of([rows[0], {"kind": "coach"}]).notes  # nothing is stated: the train of the defaults


def test_a_ratio_outside_of_the_limits_of_aar_is_told() -> None:
    car = {"kind": "wagon", "distributor": "aar"}
    for mass, ratio, is_told in ((119, 8.5, False), (119, 45, True), (27, 14, True), (27, 38, False)):
        notes = consist_of([HEAD, car | {"mass": mass, "net_braking_ratio": ratio}]).notes
        assert any("is unusual for a car" in note for note in notes) == is_told


def test_a_text_of_thousands_is_told() -> None:
    with pytest.raises(ValueError, match=r"got 84\.000 kg\. The point is read as .* mean 84000 kg"):
        consist_of([{"kind": "locomotive", "mass": "84.000 kg"}])


def test_a_vehicle_is_a_name_beside_its_kind(tmp_path: Path) -> None:
    (tmp_path / "train.csv").write_text("Fahrzeug;Art\nE-Lok 103;Lok\nBm 234;Sitzwagen\n")
    rows = [{"Fahrzeug": "E-Lok 103", "Art": "Lok"}, {"Fahrzeug": "Bm 234", "Art": "Sitzwagen"}]
    for consist in (read_consist(tmp_path / "train.csv"), consist_of(rows)):
        assert [(one.name, one.kind) for one in consist.vehicles] == [("E-Lok 103", "locomotive"), ("Bm 234", "coach")]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("Nr;Art;Gewicht\n1;Lok;84\nSumme;;84\n", "got ''. Write the kind, or remove a row of totals"),
        ("Art;Bremsart;Bremsgewicht\nLok;P+Mg;80\n", r"Magnets have a position of their own: R\+Mg"),
        ("Art;Gewicht\nTriebwagen;40\n", "Write coach, and state its motors and its brake"),
        (
            "Fahrzeug;Gewicht\nE-Lok 103;84\n",
            "'E-Lok 103'. Choose one, or add a column kind: 'Fahrzeug' is then",
        ),
        ("Art;Bremsgewichte\nLok;84\n", "'Bremsgewichte' is unknown. Did you mean Bremsgewicht"),
        ("Bauart;Gewicht\nLok;84\n", "can be that of the vehicle or of its brake: Bezeichnung or Bremsbauart"),
        ("kind,mass [tons]\nlocomotive,90\n", r"the unit 'tons' of mass can be several. Write t, or t-us"),
        ("kind,mass\nlocomotive,90 tons\n", r"column mass: the unit 'tons' of mass can be several"),
        ("kind,mass\nlocomotive,90 bar\n", "the unit 'bar' of mass is of another quantity"),
        (
            "Art;Gewicht\nLok;84.000 kg\n",
            r"got '84.000 kg'. The point is read as a decimal mark. Did you mean 84000 kg",
        ),
        ("Art;Gewicht kg\nLok;84,000\n", r"1 of which is 0.001 t. The comma is read as .* Did you mean 84000\?"),
        ("Art;Gewicht [kg]\nLok;50,2\n", r"1 of which is 0.001 t. Did you mean 50.2 t\?"),
        ("Art;Gewicht\nLok;84000\n", r"Did you mean 84000 kg = 84 t"),
        ("kind,mass,lambda,brake_weight\nlocomotive,84,90,80\n", r"lambda must be brake_weight over mass, 95.24 %"),
        ("kind,mass,brake_weight\nlocomotive,84,300\n", "brake_weight must be 5 to 250 % of the mass of 84 t"),
        ("kind,tare,load,mass\nwagon,20,60,90\n", "mass must be tare and load, 80 t; got 90 t"),
        ("kind,tare\nwagon,20\n", "tare must come with load or mass"),
        ("kind,position\nlocomotive,R\n", "position = R must come with its force"),
        ("kind,position,brake_weight\nlocomotive,R+Mg,80\n", "R.Mg must come with magnetic_attraction, .*160 kN"),
        ("kind,friction,shoe_force\nlocomotive,Grauguss,80\n", "Write cast-iron-p6 or cast-iron-p10"),
        ("kind,Gewicht,Masse\nlocomotive,80,80\n", "it is there twice, as 'Gewicht' and 'Masse'"),
        ("kind,distributor,weighing\nwagon,aar,lever\n", "weighing must be left out with distributor = aar"),
        ("kind,brake_weight,shoe_force\nlocomotive,80,90\n", "a brake must be stated once"),
    ],
)
def test_what_is_ambiguous_or_contradicts_is_refused_with_its_remedy(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "sheet.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises((FileError, ValueError), match=sentence):
        read_consist(path)


@pytest.mark.parametrize("name", ["axle", "gear", "colour"])
def test_a_word_that_is_no_column_is_not_mended_into_another_one(name: str, tmp_path: Path) -> None:
    path = tmp_path / "sheet.csv"
    path.write_text(f"kind,{name}\nlocomotive,4\n")
    with pytest.raises(FileError) as refused:
        read_consist(path)
    assert "valve" not in str(refused.value).partition("Columns are")[0]


def test_a_brake_weight_of_0_is_a_vehicle_without_a_brake() -> None:
    rows = [HEAD, {"kind": "wagon", "brake_weight": 0, "position": "G"}, {"kind": "wagon", "brake": "none"}]
    _, cut_out, piped = consist_of(rows).vehicles
    assert cut_out == piped


def test_r_fills_as_p_and_has_the_force_of_its_brake_weight() -> None:
    r, p = (
        consist_of([HEAD, {"kind": "coach", "position": position, "brake_weight": 70}]).vehicles[1] for position in "RP"
    )
    assert r == p
    assert r.percentage == pytest.approx(100 * 70 / 46, rel=1e-9)


@pytest.mark.parametrize("friction", [{}, {"friction": "cast-iron-p10"}])
def test_a_brake_weight_of_r_mg_is_that_of_wheels_and_magnets(friction: dict[str, str]) -> None:
    """Full wheel brake, lowered magnets and resistance stop in the distance C / (lambda + D) - T v (UIC 544-1)."""
    row = {"kind": "coach", "position": "R+Mg", "brake_weight": 80, "magnetic_attraction": 160, **friction}
    found = consist_of([HEAD, row]).vehicles[1]
    a, b, c = found.resistance

    def per_speed(v: float) -> float:
        magnets = 160e3 * (0.05 + 0.2 * 50.0 / (3.6 * v + 50.0)) if v >= 20 / 3.6 else 0.0
        force = brake_force(found, v) + magnets + a + b * v + c * v**2
        return (1 + found.rotating_share) * found.mass * v / force

    way = quad(per_speed, 0.0, 20 / 3.6)[0] + quad(per_speed, 20 / 3.6, 100 / 3.6)[0]
    stop = VEHICLE_BUILD_UP * 100 / 3.6 + way
    assert FROM_100.constant / stop - FROM_100.offset == pytest.approx(100 * 80 / 46, rel=2e-3)
    alone = consist_of([HEAD, row | {"position": "R"}]).vehicles[1]
    assert alone.percentage == pytest.approx(100 * 80 / 46, rel=1e-9)
    assert found.percentage < alone.percentage - 20


@pytest.mark.parametrize("distributor", ["aar", "ecp"])
@pytest.mark.parametrize(("columns", "ratio"), [({"mass": 130}, 0.11), ({"load": 0}, 0.25), ({"mass": 41}, 0.11)])
def test_an_american_car_without_a_force_has_a_net_braking_ratio(
    distributor: str, columns: dict[str, float], ratio: float
) -> None:
    """Force of all shoes over the weight in full service; mu of eight composite shoes at standstill."""
    row = {"kind": "wagon", "distributor": distributor, **columns}
    consist = consist_of([HEAD, row])
    car = consist.vehicles[1]
    shoes = ratio * car.mass * G
    each = shoes / 8e3
    friction = 0.055 * (each + 200) / (each + 50) * 150 / 75
    assert brake_force(car, 0.0) == pytest.approx(friction * shoes, rel=1e-3)
    assert f"net braking ratio of {100 * ratio:.3g} %" in consist.notes[0]
    stated = consist_of(
        [HEAD, {"kind": "wagon", "distributor": distributor, "net_braking_ratio": 100 * ratio, **columns}]
    )
    assert stated.vehicles == consist.vehicles
    assert not stated.notes


def test_an_empty_load_device_passes_a_share_of_the_force_of_a_loaded_car() -> None:
    cars = {"kind": "wagon", "distributor": "aar"}
    _, loaded, empty = consist_of([HEAD, cars, cars | {"load": 0, "empty_load": 0.4}]).vehicles
    pressed = [one.brake.force_per_pressure * one.distributor.full_pressure for one in (loaded, empty)]
    assert pressed[1] == pytest.approx(0.4 * pressed[0], rel=1e-12)
    assert pressed[1] / (empty.mass * G) == pytest.approx(0.4 * 0.11 * 4, rel=1e-12)


def test_a_net_braking_ratio_is_a_force_of_shoes_on_any_vehicle() -> None:
    row = {"kind": "coach", "friction": "constant", "friction_value": 0.3}
    ratio, force = ({"net_braking_ratio": 60}, {"shoe_force": 0.6 * 46 * G})
    one, other = (consist_of([HEAD, row | stated]).vehicles[1] for stated in (ratio, force))
    values = dataclasses.asdict(one.brake)
    assert values == pytest.approx(dataclasses.asdict(other.brake), rel=1e-12)
    assert np.isfinite(bb.train([HEAD | {"kind": "locomotive"}, row | ratio], speed=10.0).brake_force).all()


def test_a_vehicle_file_states_a_brake_weight_too() -> None:
    brakes = ({"brake_weight": "60 t"}, {"Bremsgewicht": 60e3}, {"percentage": 120})
    found = [sheet_of({"axles": 4, "tare": "42 t", "load": "8 t", "brake": brake}).brake for brake in brakes]
    values = [dict(one.values) for one in found if one is not None]
    assert values[0] == values[1] == pytest.approx(values[2], rel=1e-12)


@pytest.mark.parametrize(
    ("text", "number"),
    [("60,5 t", 60.5), ("60500 kg", 60.5), ("120 KLB", 120e3 * POUND / 1e3), ("60 short tons", 120e3 * POUND / 1e3)],
)
def test_a_number_in_toml_is_read_as_people_write_it(text: str, number: float) -> None:
    assert NUMBERS["mass"].read(text) == pytest.approx(number, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "remedy"),
    [("120,000 lb", "Write 120000 lb without a separator"), ("90 tons", "Write t, or t-us"), ("1,500", "Write 1500")],
)
def test_a_number_that_may_be_several_is_refused(text: str, remedy: str) -> None:
    with pytest.raises(ValueError, match=remedy):
        NUMBERS["mass"].read(text)
