"""Brakes of Open Rails and MSTS vehicles as columns of a consist.

`MaxBrakeForce` is a force at the rims, behind the friction of the shoes; `ORTSMaxBrakeShoeForce` is the force of all
shoes, before it. A file without a type of shoe has no law of friction: Open Rails then takes MaxBrakeForce at a
friction of 0.20, and multiplies it by (7.6 / (V + 17.5) + 0.07) / 0.20, V in km/h, where this is below 1 (its source,
TrainCar.cs).

A consist has mu = fast + (standing - fast) V2 / (V + V2), the speed dependence of all published laws of blocks and pads
(Karwatzki). It is fitted to the table with the friction at standstill of the table, to which MaxBrakeForce belongs.

In Open Rails a triple valve releases wholly as the pipe rises, and an emergency reservoir acts in emergencies (its
source, AirSinglePipe.cs). Both together are the marks of North American valves, `distributor = aar`. The force of such
a vehicle is stated at a cylinder pressure; that of a full service is what its reservoir and cylinder balance at.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from readers.formats.open_rails_fields import PSI, Fields
from readers.formats.vehicle_rows import rounded
from readers.import_account import Notes, Row
from readers.text import FileError, quoted

#: Words of BrakeEquipmentType that Open Rails and MSTS have; the spelling Auxilary_reservoir is theirs.
EQUIPMENT = (
    *("triple_valve", "graduated_release_triple_valve", "distributor", "distributing_valve"),
    *("auxilary_reservoir", "auxiliary_reservoir", "emergency_brake_reservoir", "retainer_3_position"),
    *("retainer_4_position", "handbrake", "manual_brake", "vacuum_brake", "air_brake", "ep_brake", "ecp_brake"),
    *("supply_reservoir", "emergency_solenoid_valve"),
)
#: Speeds V2 that are tried [km/h], the number of speeds at which a fit is compared, and its least friction.
HALF_SPEEDS, SAMPLES, LEAST_FRICTION = np.geomspace(1.0, 1000.0, 601), 201, 0.001
#: Relative deviation from a table below which its friction is constant.
NEARLY_CONSTANT = 1e-3
#: Relative deviation from which a message calls a table unusual.
FAR = 0.05


def friction_of_table(fields: Fields, notes: Notes, at_rims: bool) -> Row:
    """Return the friction of ORTSBrakeShoeFriction, a row without columns if the file has no such table."""
    table = _table(fields)
    if not table:
        return {}
    speeds, frictions = np.array(table).T
    standing = float(np.interp(0.0, speeds, frictions))
    if float(np.ptp(frictions)) <= NEARLY_CONSTANT * standing:
        notes.converted("ORTSBrakeShoeFriction: one value at all speeds -> friction = constant")
        return {"friction": "constant"} | ({} if at_rims else {"friction_value": rounded(standing)})
    fast, half, deviation = fitted(speeds, frictions)
    notes.converted(
        f"ORTSBrakeShoeFriction -> friction = speed: {standing:.3g} at standstill, fast {fast:.3g}, half of the change "
        f"at {half:.3g} km/h; largest deviation from the table {100 * deviation:.1f} %."
    )
    if deviation > FAR:
        notes.assumed(
            f"ORTSBrakeShoeFriction: friction = speed deviates by {100 * deviation:.0f} % from the table, which does "
            "not fall or rise as that of shoes does. Check it."
        )
    row = {"friction_value": standing, "friction_fast": fast, "friction_speed": half}
    return {"friction": "speed"} | {name: rounded(value) for name, value in row.items()}


def fitted(speeds: np.ndarray, frictions: np.ndarray) -> tuple[float, float, float]:
    """Return friction at a high speed, V2 [km/h] and the largest relative deviation of the fit to a table.

    Takes speeds [km/h], frictions [1], both (rows,).
    """
    at = np.linspace(0.0, speeds[-1], SAMPLES)
    wanted = np.interp(at, speeds, frictions)
    left = HALF_SPEEDS[:, None] / (at + HALF_SPEEDS[:, None])  # share of the friction at standstill
    gains = (1.0 - left) / wanted
    fast = np.sum(gains * (1.0 - left * wanted[0] / wanted), axis=1) / np.sum(gains**2, axis=1)
    fast = np.clip(fast, LEAST_FRICTION, 1.0)
    off = np.max(np.abs((left * wanted[0] + (1.0 - left) * fast[:, None]) / wanted - 1.0), axis=1)
    best = int(np.argmin(off))
    return float(fast[best]), float(HALF_SPEEDS[best]), float(off[best])


def _table(fields: Fields) -> list[tuple[float, float]]:
    """Return speeds [km/h] that grow, and friction, none if the file has no such table. Raises FileError."""
    block = fields.blocks.get("ortsbrakeshoefriction")
    if block is None:
        return []
    numbers = [_number(word) for word in block.words]
    pairs = list(zip(numbers[::2], numbers[1::2], strict=False))
    good = len(pairs) >= 2 and len(numbers) % 2 == 0 and all(a >= 0.0 and 0.01 <= b <= 1.0 for a, b in pairs)
    if good and all(b[0] > a[0] for a, b in pairwise(pairs)):
        return pairs
    raise FileError(
        f"{block.source}, row {block.row}: ORTSBrakeShoeFriction must be pairs of a speed that grows, in km/h, and a "
        f"friction from 0.01 to 1; got {quoted(' '.join(block.words))}. Correct it."
    )


def _number(text: str) -> float:
    """Return the number of a word, NaN if it is not one."""
    try:
        return float(text)
    except ValueError:
        return math.nan


#: Distributors with volumes and pressures of their own.
NORTH_AMERICAN = ("aar", "ecp")
#: Pressure of a charged pipe [bar] (AAR), and ratio of reservoir to cylinder that Open Rails takes by default.
CHARGED, RATIO = 90 * PSI, 2.5
#: Fields of volumes, which those distributors have themselves, and of filling, which the pipe limits in `aar`.
OWN = (
    *("ORTSAuxiliaryResCapacity", "EmergencyResCapacity", "EmergencyResVolumeMultiplier", "ORTSBrakeCylinderVolume"),
    *("ORTSBrakeCylinderDiameter", "ORTSBrakeCylinderPistonTravel", "ORTSNumberBrakeCylinders"),
)
FILLING = ("MaxApplicationRate", "BrakeDistributorApplicationRate")
_RETAINERS = ("retainer_3_position", "retainer_4_position")


def valve_of(system: str, fields: Fields, notes: Notes) -> Row:
    """Return the kind of brake and distributor of a vehicle; `system`: its BrakeSystemType in small letters."""
    words = [one.strip() for one in fields.word("BrakeEquipmentType").split(",")]
    for word in words:
        if word and word not in EQUIPMENT:
            notes.left(f"BrakeEquipmentType: the word {quoted(word)} is unknown, and Open Rails ignores it.")
    row = _system(system, fields, notes)
    if row == {"brake": "pneumatic"} and "triple_valve" in words and not _is_graduated(words):
        row |= _triple_valve(words, notes)
    _tell_equipment(words, row, notes)
    return row | _accelerated(row, fields, notes)


def service_share(fields: Fields, most: float | None, reference: float | None) -> float:
    """Return the pressure of a full service over that of the stated force, of a triple valve.

    Boyle's law in gauge pressures, from a pipe of 90 psi: 90 r / (1 + r), at most the largest pressure.

    Takes most, reference [bar].
    """
    ratio = fields.number("TripleValveRatio", "1")
    ratio = ratio if ratio and ratio > 0.0 else RATIO
    largest = most or reference or 64 * PSI
    return min(CHARGED * ratio / (1.0 + ratio), largest) / (reference or largest)


def tell_own(distributor: str, fields: Fields, notes: Notes) -> None:
    """Report times and volumes of a file that a distributor has itself."""
    own = OWN if distributor == "ecp" else (*OWN, *FILLING)
    if told := [name for name in own if fields.has(name)]:
        what = "volumes" if distributor == "ecp" else "volumes and time of filling"
        notes.left(f"{', '.join(told)}: distributor = {distributor} has its own {what}.")


def _is_graduated(words: list[str]) -> bool:
    return "distributor" in words or "graduated_release_triple_valve" in words


def _system(system: str, fields: Fields, notes: Notes) -> Row:
    """Return the kind of brake by BrakeSystemType."""
    if system.startswith(("vacuum", "straight_vacuum")):
        notes.assumed("BrakeSystemType: a vacuum brake is simulated as a compressed-air brake of equal force.")
    elif system in ("ep", "ecp", "sme"):
        if fields.word("ORTSEPBrakeControlsBrakePipe").startswith("1"):
            notes.converted("ORTSEPBrakeControlsBrakePipe: valves at each vehicle's pipe -> distributor = ep_uic")
            return {"brake": "pneumatic", "distributor": "ep_uic"}
        if system == "ecp":
            notes.taken("BrakeSystemType ECP -> distributor = ecp, with 1.2 times the force in an emergency")
            return {"brake": "pneumatic", "distributor": "ecp"}
        notes.taken(f"BrakeSystemType {system.upper()} -> brake = ep-direct")
        return {"brake": "ep-direct"}
    elif system.startswith("air_twin_pipe"):
        notes.taken("BrakeSystemType Air_twin_pipe -> distributor = twin_pipe")
        return {"brake": "pneumatic", "distributor": "twin_pipe"}
    elif system.startswith("air_single_pipe"):
        notes.taken("BrakeSystemType -> brake = pneumatic")
    else:
        notes.assumed(f"BrakeSystemType: {quoted(system) if system else 'missing'}; taken as pneumatic.")
    return {"brake": "pneumatic"}


def _triple_valve(words: list[str], notes: Notes) -> Row:
    """Return the distributor of a triple valve, whose emergency reservoir shows that it is North American."""
    if "emergency_brake_reservoir" not in words:
        notes.left(
            "BrakeEquipmentType triple_valve without emergency_brake_reservoir: cylinders empty as far as the pipe "
            "rises; distributor = aar releases wholly, but has its own pressures and volumes."
        )
        return {}
    notes.converted("BrakeEquipmentType triple_valve, emergency_brake_reservoir -> distributor = aar")
    notes.assumed(
        "BrakeEquipmentType triple_valve: North American, with 1.2 times the force in an emergency; many European "
        "files have this word too. Set distributor = uic for gradual release."
    )
    return {"distributor": "aar"}


def _tell_equipment(words: list[str], row: Row, notes: Notes) -> None:
    """Report words of BrakeEquipmentType without an effect."""
    kind = row.get("distributor", "")
    for word in _RETAINERS:
        if word in words:
            remedy = (
                "it is in its direct position; set retainer = low or high"
                if kind == "aar"
                else "it has a column with distributor = aar alone"
            )
            notes.left(f"BrakeEquipmentType {word}: {remedy}.")
    if "emergency_brake_reservoir" in words and kind not in NORTH_AMERICAN:
        notes.left("BrakeEquipmentType emergency_brake_reservoir: it acts with distributor = aar or ecp alone.")


def _accelerated(row: Row, fields: Fields, notes: Notes) -> Row:
    """Return whether emergency reservoirs feed the pipe in a release, which Open Rails has off by default."""
    name = "ORTSEmergencyResQuickRelease"
    if row.get("distributor") != "aar":
        if fields.has(name):
            notes.left(f"{name}: it has a column with distributor = aar alone.")
        return {}
    if not fields.has(name):
        notes.assumed(f"{name}: missing; off, as in Open Rails -> accelerated_release = no.")
        return {"accelerated_release": "no"}
    notes.taken(f"{name} -> accelerated_release")
    return {"accelerated_release": "no" if fields.word(name).startswith("0") else "yes"}


#: Cylinder pressure of MaxBrakeForce that Open Rails takes where the file has none [bar], and its default rate [bar/s].
PRESSURE, DEFAULT_RATE = 64 * PSI, 0.9 * PSI
#: Share of a pressure at which a cylinder counts as full, and pressure at which it counts as empty [bar] (UIC 540).
FULL, EMPTY = 0.95, 0.4
#: Inner diameter of a consist's pipe, length of a vehicle's two hoses [m], and largest volume of branches [l].
PIPE, HOSES, MOST_BRANCH = 0.03175, 1.24, 25.0
#: Emergency over auxiliary reservoir that Open Rails takes where the file has no ratio.
EMERGENCY = 1.4
#: Friction over speed of a force at the rims without a type of shoe: 0.20 up to 41 km/h, then 7.6 / (V + 17.5) + 0.07.
#: Lines between these points deviate from it by 0.5 % at most, up to 200 km/h.
CAST_IRON = "40.96:0.2 54.3:0.17505 75.2:0.1513 102.2:0.13309 138.6:0.11828 194.1:0.10543"
COLUMNS = {"ORTSAuxiliaryResCapacity": "auxiliary", "ORTSBrakeCylinderVolume": "cylinder"}
#: Friction laws by the word of ORTSBrakeShoeType.
FRICTIONS = {
    "cast_iron_p6": "cast-iron-p6",
    "cast_iron_p10": "cast-iron-p10",
    "high_friction_composite": "composite",
    "disc_pads": "pads",
}


def brake_of(fields: Fields, notes: Notes) -> Row:
    """Return the columns of a vehicle's brake: its kind, force, friction, pressure and times."""
    system = fields.word("BrakeSystemType").strip()
    if system in ("air_piped", "vacuum_piped", "manual_braking"):
        notes.converted("BrakeSystemType: without a brake that the train applies -> brake = none")
        return {"brake": "none"}
    found = valve_of(system, fields, notes)
    if system.startswith(("vacuum", "straight_vacuum")):
        notes.left("Pressures and rates of a vacuum brake: the default pressure and times of position P apply.")
        return found | _force(fields, 1.0, notes)
    reference = fields.number("ORTSBrakeForceReferencePressure", "bar")
    most = fields.number("BrakeCylinderPressureForMaxBrakeBrakeForce", "bar")
    pressure = most or reference
    if found.get("distributor") in NORTH_AMERICAN:
        return _north_american(found, fields, most, reference, notes)
    found |= _force(fields, _to_largest(most, reference, notes), notes)
    if found["brake"] == "none":
        return {"brake": "none"}
    if pressure and found.keys() - {"brake", "distributor"}:
        notes.taken("BrakeCylinderPressureForMaxBrakeBrakeForce -> full_pressure [bar]")
        found["full_pressure"] = rounded(pressure)
    return found | _times(fields, pressure or PRESSURE, notes) | _volumes(fields, found["brake"], notes)


def _north_american(found: Row, fields: Fields, most: float | None, reference: float | None, notes: Notes) -> Row:
    """Return the columns of a brake of the AAR kind, which has its own pressures and volumes."""
    kind = found["distributor"]
    if kind == "aar":
        scale = service_share(fields, most, reference)
        notes.assumed(
            "The force is that of a full service from 90 psi, the pressure 90 psi x r / (1 + r) of the ratio r."
        )
    else:
        scale = _to_largest(most, reference, notes)
    row = found | _force(fields, scale, notes)
    if row["brake"] == "none":
        return {"brake": "none"}
    tell_own(kind, fields, notes)
    pressure = most or reference or PRESSURE
    return row | (_filling(fields, pressure, notes) if kind == "ecp" else {}) | _release(fields, pressure, notes)


def _to_largest(most: float | None, reference: float | None, notes: Notes) -> float:
    """Return the largest cylinder pressure over that of the stated force [bar]."""
    if not most or not reference or abs(most - reference) <= 1e-9 * most:
        return 1.0
    notes.converted("ORTSBrakeForceReferencePressure: the force is scaled to the largest cylinder pressure.")
    return most / reference


def hand_brake_of(fields: Fields, notes: Notes) -> Row:
    """Return the columns of a hand brake, whose force Open Rails takes instead of a smaller one of the air brake."""
    force = fields.number("MaxHandbrakeForce", "N")
    if not force or force < 0.0:
        return {}
    notes.taken("MaxHandbrakeForce -> parking_force [kN]; the input parking_brake of the train applies it")
    notes.converted("MaxHandbrakeForce: Open Rails takes the larger of both brakes -> parking_compounding = larger")
    if fields.has("ORTSMaxBrakeShoeForce"):
        notes.assumed(
            "MaxHandbrakeForce with ORTSMaxBrakeShoeForce: taken at the rims; Open Rails multiplies it by friction."
        )
    return {"parking_force": rounded(1e-3 * force), "parking_compounding": "larger"}


def _force(fields: Fields, scale: float, notes: Notes) -> Row:
    """Return the force of the brake; `scale`: its pressure over that at which the force is stated."""
    law = FRICTIONS.get(fields.word("ORTSBrakeShoeType"))
    shoe_force = fields.number("ORTSMaxBrakeShoeForce", "N")
    rim_force = fields.number("MaxBrakeForce", "N")
    own = fields.word("ORTSBrakeShoeType") == "user_defined"
    if shoe_force and (law or own or not rim_force):
        notes.taken("ORTSMaxBrakeShoeForce, of all shoes, before friction -> shoe_force [kN]")
        return {"shoe_force": rounded(1e-3 * shoe_force * scale)} | _friction(fields, law, notes)
    if rim_force:
        notes.taken("MaxBrakeForce, at the rims, behind friction -> brake_force [kN]")
        return {"brake_force": rounded(1e-3 * rim_force * scale)} | _friction_of_rims(fields, law, notes)
    if rim_force == 0.0:
        notes.converted("MaxBrakeForce 0 -> brake = none")
        return {"brake": "none"}
    notes.assumed("Brake force: the file has no MaxBrakeForce; the brake of the vehicle's kind applies.")
    return {}


def _friction(fields: Fields, law: str | None, notes: Notes) -> Row:
    """Return the friction between shoes of a stated force and the wheels."""
    if law is not None:
        notes.taken("ORTSBrakeShoeType -> friction")
        radius: Row = {}
        if law == "pads":
            notes.converted("ORTSBrakeShoeType Disc_Pads: Open Rails has no radius of discs -> friction_radius = 1")
            radius = {"friction_radius": 1.0}
        return {"friction": law} | radius | _shoes(fields, notes)
    if own := friction_of_table(fields, notes, at_rims=False):
        return own
    notes.assumed("ORTSBrakeShoeType: missing or unknown; friction = cast-iron-p6, because Open Rails takes cast iron.")
    return {"friction": "cast-iron-p6"} | _shoes(fields, notes)


def _shoes(fields: Fields, notes: Notes) -> Row:
    shoes = fields.number("ORTSNumberCarBrakeShoes", "1")
    if shoes is not None and shoes >= 1:
        notes.taken("ORTSNumberCarBrakeShoes -> shoes")
        return {"shoes": int(shoes)}
    axles = sum(fields.number(name, "1") or 0.0 for name in ("ORTSNumberAxles", "ORTSNumberDriveAxles"))
    shoes = 4 * int(axles)
    notes.assumed(
        f"ORTSNumberCarBrakeShoes: missing; {f'4 for each of {axles:g} axles' if shoes else 'that of the kind'}."
    )
    return {"shoes": shoes} if shoes else {}


def _friction_of_rims(fields: Fields, law: str | None, notes: Notes) -> Row:
    """Return the friction law of a force at the rims, which belongs to standstill; none: constant force."""
    if law is not None:
        notes.assumed("MaxBrakeForce with ORTSBrakeShoeType: the force is that at standstill, and falls by that law.")
        return {"friction": law} | _shoes(fields, notes)
    if own := friction_of_table(fields, notes, at_rims=True):
        return own
    notes.assumed(
        "MaxBrakeForce without a friction: as in Open Rails, which takes it at friction 0.20 and reduces it above 41 "
        "km/h by cast iron, to 67 % at 100 km/h. In MSTS it is constant: set friction = constant."
    )
    return {"friction": "table", "friction_table": CAST_IRON}


def _times(fields: Fields, pressure: float, notes: Notes) -> Row:
    """Return filling and release times [s] of rates that change a cylinder between 0 and a pressure [bar]."""
    found = _filling(fields, pressure, notes) | _release(fields, pressure, notes)
    if "fill_time" not in found:
        notes.assumed("MaxApplicationRate: missing; the times of position P apply, not Open Rails' default of 71 s.")
    return found


def _filling(fields: Fields, pressure: float, notes: Notes) -> Row:
    """Return the filling time [s] of a rate that fills a cylinder to a pressure [bar]."""
    found: Row = {}
    fill = fields.number("MaxApplicationRate", "bar/s") or fields.number("BrakeDistributorApplicationRate", "bar/s")
    if fill and fill > 0.0:
        found["fill_time"] = rounded(FULL * pressure / fill)
        notes.converted("MaxApplicationRate: 0.95 pressure / rate -> fill_time [s] (to 95 %, UIC 540)")
        if abs(fill - DEFAULT_RATE) < 1e-6:
            notes.assumed(
                f"MaxApplicationRate 0.9 psi/s is Open Rails' default, {found['fill_time']:.0f} s; UIC 540 has 3 to 5 "
                "s (P) and 18 to 30 s (G). Check it."
            )
    return found


def _release(fields: Fields, pressure: float, notes: Notes) -> Row:
    """Return the release time [s] of a rate that empties a cylinder from a pressure [bar]."""
    release = fields.number("MaxReleaseRate", "bar/s") or fields.number("BrakeDistributorReleaseRate", "bar/s")
    if release and release > 0.0 and pressure > EMPTY:
        notes.converted("MaxReleaseRate: (pressure - 0.4 bar) / rate -> release_time [s] (to 0.4 bar, UIC 540)")
        return {"release_time": rounded((pressure - EMPTY) / release)}
    return {}


def _volumes(fields: Fields, brake: str, notes: Notes) -> Row:
    """Return the volumes of reservoir and cylinders [l]; a direct brake has none."""
    auxiliary, cylinder = fields.number("ORTSAuxiliaryResCapacity", "l"), fields.number("ORTSBrakeCylinderVolume", "l")
    if brake != "pneumatic":
        for name, volume in (("ORTSAuxiliaryResCapacity", auxiliary), ("ORTSBrakeCylinderVolume", cylinder)):
            if volume:
                notes.left(f"{name}: a direct brake has a rate, no volumes.")
        return {}
    for name, volume in (("ORTSAuxiliaryResCapacity", auxiliary), ("ORTSBrakeCylinderVolume", cylinder)):
        if volume:
            notes.taken(f"{name} -> {COLUMNS[name]} [l]")
    auxiliary = auxiliary or _of_emergency(fields, notes)
    cylinder = cylinder or _of_pistons(fields, notes)
    ratio = fields.number("TripleValveRatio", "1")
    if ratio and ratio > 0.0 and bool(auxiliary) is not bool(cylinder):
        notes.converted("TripleValveRatio, reservoir over cylinder -> the volume of these that is missing [l]")
        auxiliary, cylinder = auxiliary or ratio * (cylinder or 0.0), cylinder or (auxiliary or 0.0) / ratio
    elif ratio:
        notes.left(f"TripleValveRatio: {'both volumes are there' if auxiliary else 'a ratio without a volume'}.")
    found = {"auxiliary": auxiliary, "cylinder": cylinder}
    return {name: rounded(volume) for name, volume in found.items() if volume}


def _of_emergency(fields: Fields, notes: Notes) -> float | None:
    """Return the volume of the auxiliary reservoir by that of the emergency reservoir [l]."""
    emergency = fields.number("EmergencyResCapacity", "l")
    if not emergency:
        return None
    ratio = fields.number("EmergencyResVolumeMultiplier", "1")
    notes.converted("EmergencyResCapacity / EmergencyResVolumeMultiplier -> auxiliary [l]; no emergency reservoir acts")
    if not ratio or ratio <= 0.0:
        notes.assumed(f"EmergencyResVolumeMultiplier: missing; {EMERGENCY}, as in Open Rails.")
        ratio = EMERGENCY
    return emergency / ratio


def _of_pistons(fields: Fields, notes: Notes) -> float | None:
    """Return the volume of the cylinders by number, diameter and travel [l]."""
    diameter = fields.number("ORTSBrakeCylinderDiameter", "m")
    travel = fields.number("ORTSBrakeCylinderPistonTravel", "m")
    if not diameter or not travel:
        return None
    count = fields.number("ORTSNumberBrakeCylinders", "1")
    notes.converted("ORTSBrakeCylinderDiameter, PistonTravel, ORTSNumberBrakeCylinders -> cylinder [l]")
    if not count:
        notes.assumed("ORTSNumberBrakeCylinders: missing; 1.")
    return 1e3 * (count or 1.0) * math.pi / 4 * diameter**2 * travel


def branch_of(fields: Fields, length: float, notes: Notes) -> Row:
    """Return the volume of the pipe beyond that of a vehicle's own pipe, as branches [l]; length of the vehicle [m]."""
    volume = fields.number("BrakePipeVolume", "l")
    if not volume:
        return {}
    own = 1e3 * math.pi / 4 * PIPE**2 * (length + HOSES)
    branch = rounded(volume - own)
    if not 0.0 <= branch <= MOST_BRANCH:
        notes.left(
            f"BrakePipeVolume: {volume:.3g} l, but the pipe of {1e3 * PIPE:g} mm has {own:.3g} l, and branches have 0 "
            f"to {MOST_BRANCH:g} l; set pipe_diameter yourself."
        )
        return {}
    notes.converted(f"BrakePipeVolume less the pipe of {1e3 * PIPE:g} mm with its hoses -> branch [l]")
    return {"branch": branch} if branch > 0.0 else {}
