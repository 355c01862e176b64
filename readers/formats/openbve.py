"""Trains of OpenBVE (train.dat): motor cars and trailers of one length, with one brake.

Sections begin with #. Each line of a section is one number, by its position; text behind ; is a remark. Versions of the
file differ in #ACCELERATION, in lists of delays by notch (from 1534 on), in #DELAY of the electric brake (from 18230
on), and in #HANDLE. Of these, only the delay of the brake has a column. #PERFORMANCE was #DECELERATION, and #CAB was
#COCKPIT. Units, defaults and positions are those of OpenBVE's manual. The places of motor cars, areas and drag are
those of its source (TrainDatParser.cs, BVEAxle.cs, and Atmosphere.cs with air of 20 degC).
"""

from __future__ import annotations

import math
import re
from pathlib import Path

from readers.formats.vehicle_rows import GRAVITY, MOST, checked, fitting, rounded, whole_train
from readers.import_account import Imported, Notes, Row
from readers.text import FileError, lines_of, quoted, shown, text_of
from readers.units import quantity_of

#: Largest file [bytes].
LARGEST = 8_000_000
#: A number, and a remark behind it; a decimal comma is not one.
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)([^\d.,].*)?", re.ASCII)
#: Names of a version in the first line.
VERSION = re.compile(r"(bve(1200000|1210000|1220000|2000000|2060000)|openbve\s*\d*)", re.IGNORECASE)
#: Sections by all their names, in small letters.
SECTIONS = {
    "#performance": "performance",
    "#deceleration": "performance",
    "#delay": "delay",
    "#move": "move",
    "#brake": "brake",
    "#pressure": "pressure",
    "#car": "car",
    "#acceleration": "acceleration",
    "#handle": "handle",
    "#cab": "cab",
    "#cockpit": "cab",
    "#device": "device",
    "#motor_p1": "motor",
    "#motor_p2": "motor",
    "#motor_b1": "motor",
    "#motor_b2": "motor",
}
#: Numbers that are read: section, position, name, default, least, most, and unit (OpenBVE's manual).
NUMBERS: dict[str, tuple[str, int, float, float, float, str]] = {
    "Deceleration": ("performance", 0, 1.0, 0.04, 10.8, "km/h/s"),
    "CoefficientOfRollingResistance": ("performance", 3, 0.0025, 0.0, 0.1, ""),
    "AerodynamicDragCoefficient": ("performance", 4, 1.1, 0.0, 50.0, ""),
    "DelayBrakeUp": ("delay", 2, 0.0, 0.0, 60.0, "s"),
    "BrakeCylinderUp": ("move", 4, 300.0, 1.0, 1e5, "kPa/s"),
    "BrakeCylinderDown": ("move", 5, 200.0, 1.0, 1e5, "kPa/s"),
    "BrakeType": ("brake", 0, 0, 0, 2, ""),
    "BrakeControlSystem": ("brake", 1, 0, 0, 2, ""),
    "BrakeControlSpeed": ("brake", 2, 0.0, 0.0, 500.0, "km/h"),
    "BrakeCylinderServiceMaximumPressure": ("pressure", 0, 440.0, 50.0, 2000.0, "kPa"),
    "BrakeCylinderEmergencyMaximumPressure": ("pressure", 1, 440.0, 50.0, 2000.0, "kPa"),
    "MotorCarMass": ("car", 0, 1.0, 0.1, 1000.0, "t"),
    "NumberOfMotorCars": ("car", 1, 1, 1, MOST, ""),
    "TrailerCarMass": ("car", 2, 1.0, 0.0, 1000.0, "t"),
    "NumberOfTrailerCars": ("car", 3, 0, 0, MOST, ""),
    "LengthOfACar": ("car", 4, 20.0, 1.0, 1000.0, "m"),
    "FrontCarIsAMotorCar": ("car", 5, 1, -1e9, 1e9, ""),
    "WidthOfACar": ("car", 6, 2.6, 0.1, 10.0, "m"),
    "HeightOfACar": ("car", 7, 3.6, 0.1, 10.0, "m"),
}
#: Share of the rate of filling that a brake without a brake pipe has in service.
SERVICE = 0.3
#: Share of a pressure at which a cylinder counts as full, and pressure at which it counts as empty [kPa] (UIC 540).
FULL, EMPTY = 0.95, 40.0
#: Frontal area over width x height of the first car, without width and height in the file, and of those behind it.
FIRST_AREA, BARE_AREA, NEXT_AREA = 0.65, 0.6, 0.2
#: Density of air at 101325 Pa and 293.15 K [kg/m3], which a route may change.
AIR = 101325 * 0.0289644 / (8.31447 * 293.15)
BRAKES = ("electromagnetic straight air brake", "electric command brake", "automatic air brake")


def read_openbve(path: Path) -> Imported:
    """Return the train of a train.dat."""
    notes = Notes()
    sections = _sections(path, notes)
    given = {name: _number(name, sections, path, notes) for name in NUMBERS}
    for name in ("NumberOfMotorCars", "NumberOfTrailerCars", "BrakeType", "BrakeControlSystem"):
        given[name] = float(round(given[name]))
    areas = _areas(given, sections, path, notes)
    brake = _brake(given, notes)
    front = given["FrontCarIsAMotorCar"] == 1
    motors = motor_cars(int(given["NumberOfMotorCars"]), int(given["NumberOfTrailerCars"]), front)
    rows: list[Row] = []
    for number, motor in enumerate(motors):
        mass = given["MotorCarMass" if motor else "TrailerCarMass"]
        row: Row = {"kind": "coach", "name": "motor car" if motor else "trailer car", "mass": rounded(mass)}
        row["length"] = rounded(given["LengthOfACar"])
        row |= _resistance(given, 1e3 * mass, areas[min(number, 1)]) | brake
        rows += fitting(row, notes, str(path))
    _tell(given, notes)
    return notes.imported(whole_train(rows, notes, str(path)))


def _sections(path: Path, notes: Notes) -> dict[str, list[tuple[int, str]]]:
    """Return the lines of each section with their rows. Raises FileError if the file is not a train.dat."""
    found: dict[str, list[tuple[int, str]]] = {}
    name, version = "", ""
    for row, line in enumerate(lines_of(text_of(path, LARGEST)), 1):
        text = line.partition(";")[0].strip().rstrip(",").strip()
        if text.startswith("#"):
            name = SECTIONS.get(text.lower(), "unknown")
            if name == "unknown":
                notes.left(f"{text[:40]}: OpenBVE has no such section.")
            found[name] = []
        elif name and name not in ("motor", "unknown"):
            found[name].append((row, text))
        elif text and not name and not version:
            version = text
    if "car" not in found:
        raise FileError(f"{path} must have a section #CAR; got {shown(', '.join(found) or 'none')}. Give a train.dat.")
    if not VERSION.fullmatch(version):
        notes.assumed(f"Version: {quoted(version) if version else 'missing'}; read as OPENBVE, as OpenBVE does.")
    return found


def _number(name: str, sections: dict[str, list[tuple[int, str]]], path: Path, notes: Notes) -> float:
    """Return a number by its section and position, or its default. Raises FileError."""
    section, position, default, least, most, unit = NUMBERS[name]
    lines = sections.get(section, [])
    if position >= len(lines) or not lines[position][1]:
        notes.assumed(f"{name}: missing; OpenBVE's default of {default:g}.")
        return default
    row, text = lines[position]
    if section == "delay":
        text = text.split(",")[-1]
    return _read(text, name, (least, most), f"{path}, row {row}", unit)


def _read(text: str, name: str, limits: tuple[float, float], place: str, unit: str = "") -> float:
    """Return the number at the beginning of a line. Raises FileError, also for another unit behind it."""
    found = NUMBER.fullmatch(text.strip())
    if found is None or len(found[1]) > 40:
        raise FileError(f"{place}: {name} must be a number with a decimal point; got {quoted(text)}. Correct it.")
    behind = (found[2] or "").split()
    if behind and behind[0] != unit and behind[0][0].isalpha() and quantity_of(behind[0].removesuffix("/s")):
        raise FileError(f"{place}: {name} must be in {unit or 'no unit'}; got {quoted(text)}. Convert it.")
    return checked(float(found[1]), name, limits, "", place)


def motor_cars(motors: int, trailers: int, front: bool) -> list[bool]:
    """Return whether each car from the head is a motor car, by OpenBVE's rule."""
    cars = motors + trailers
    if trailers == 0:
        return [True] * cars
    if motors == 1:
        places = [0 if front else cars - 1]
    elif motors == 2 and not front:
        places = [1, 2] if trailers == 1 else [math.ceil(0.25 * (cars - 1)), math.floor(0.75 * (cars - 1))]
    else:
        places = _spread(motors, trailers if front else trailers - 1, 0 if front else 1, cars)
    return [place in places for place in range(cars)]


def _spread(motors: int, trailers: int, first: int, cars: int) -> list[int]:
    """Return the places of motor cars between which the trailers are distributed evenly, from the first place."""
    step, places, rest = 1.0 + trailers / (motors - 1), [first], 0.0
    while True:
        place = places[-1] + step - rest
        rest = math.ceil(place) - place
        if math.ceil(place) >= cars:
            return places
        places.append(math.ceil(place))


def _areas(
    given: dict[str, float], sections: dict[str, list[tuple[int, str]]], path: Path, notes: Notes
) -> tuple[float, float]:
    """Return the frontal areas of the first car and of the others [m2]."""
    found, lines = [], sections["car"]
    first = FIRST_AREA if any(text for _, text in lines[6:8]) else BARE_AREA
    for position, name, share in ((9, "ExposedFrontalArea", first), (10, "UnexposedFrontalArea", NEXT_AREA)):
        if position < len(lines) and lines[position][1]:
            row, text = lines[position]
            found.append(_read(text, name, (0.01, 100.0), f"{path}, row {row}"))
        else:
            notes.assumed(f"{name}: missing; OpenBVE's {share:g} x width x height.")
            found.append(share * given["WidthOfACar"] * given["HeightOfACar"])
    return found[0], found[1]


def _resistance(given: dict[str, float], mass: float, area: float) -> Row:
    """Return the running resistance of a car [kg, m2]: coefficient x weight + 0.5 rho coefficient x area v^2."""
    drag = 0.5 * AIR * given["AerodynamicDragCoefficient"] * area
    return {
        "rotating": 0.0,
        "resistance_a": rounded(given["CoefficientOfRollingResistance"] * mass * GRAVITY),
        "resistance_b": 0.0,
        "resistance_c": rounded(drag),
    }


def _brake(given: dict[str, float], notes: Notes) -> Row:
    """Return the brake of every car."""
    kind, pressure = int(given["BrakeType"]), given["BrakeCylinderServiceMaximumPressure"]
    rate = given["BrakeCylinderUp"] * (1.0 if kind == 2 else SERVICE)
    row: Row = {
        "brake": "pneumatic" if kind == 2 else "ep-direct",
        "deceleration": rounded(given["Deceleration"] / 3.6),
    }
    row["full_pressure"] = rounded(0.01 * pressure)
    row["fill_time"] = rounded(FULL * pressure / rate)
    row["release_time"] = rounded((pressure - EMPTY) / given["BrakeCylinderDown"])
    if kind < 2 and given["DelayBrakeUp"]:
        row["dead_time"] = rounded(given["DelayBrakeUp"])
        notes.taken("DelayBrakeUp, of the last notch -> dead_time [s]")
    notes.taken(f"BrakeType {kind}, {BRAKES[kind]} -> brake = {row['brake']}")
    notes.converted("Deceleration [km/h/s] / 3.6 -> deceleration [m/s2], at full service, without running resistance")
    notes.converted("BrakeCylinderServiceMaximumPressure [kPa] -> full_pressure [bar]")
    notes.converted(
        f"BrakeCylinderUp: 0.95 pressure / {'' if kind == 2 else f'{SERVICE:g} '}rate -> fill_time [s] (to 95 %)"
    )
    notes.converted("BrakeCylinderDown: (pressure - 40 kPa) / rate -> release_time [s] (to 0.4 bar, UIC 540)")
    return row


def _tell(given: dict[str, float], notes: Notes) -> None:
    """Tell what is taken, and fields without a column."""
    notes.taken("MotorCarMass, TrailerCarMass -> mass [t]; LengthOfACar -> length [m]; numbers of cars -> count")
    notes.converted("CoefficientOfRollingResistance x weight -> resistance_a [N]")
    notes.converted(f"0.5 x {AIR:.5g} kg/m3 x AerodynamicDragCoefficient x frontal area -> resistance_c")
    notes.converted("Rotating masses: OpenBVE has none -> rotating = 0 %")
    most, service = given["BrakeCylinderEmergencyMaximumPressure"], given["BrakeCylinderServiceMaximumPressure"]
    if most > service:
        notes.left(
            f"BrakeCylinderEmergencyMaximumPressure: {most:g} kPa; a force of emergency braking has no column. It "
            f"is {100 * most / service - 100:.0f} % more than that of full service."
        )
    system = int(given["BrakeControlSystem"])
    if given["BrakeType"] < 2 and system:
        notes.left(
            f"BrakeControlSystem {system}: the share of motors in the deceleration above {given['BrakeControlSpeed']:g}"
            " km/h; the brakes of all cars have the whole deceleration here."
        )
    elif given["BrakeType"] < 2:
        notes.left("BrakeControlSystem 0: motors brake in addition; that deceleration has no column.")
    if given["DelayBrakeUp"] and given["BrakeType"] == 2:
        notes.left(f"DelayBrakeUp: {given['DelayBrakeUp']:g} s; OpenBVE has it with notches, not with a brake pipe.")
    notes.left(
        "Couplers: OpenBVE limits their travel around a gap of 0.3 m, without a force; screw couplers are taken."
    )
    notes.left("Volumes of pipe and reservoirs: OpenBVE counts them by cars, not by metres, so they are not read.")
    notes.left(
        "#ACCELERATION: the meaning of its numbers depends on the version. State traction_table of the motor cars "
        "yourself."
    )
    notes.left("Jerk, #HANDLE, #CAB, #DEVICE, motor sounds: driving, no column.")
    notes.left("CoefficientOfStaticFriction: friction of the rail is an input of the train.")
