"""Control valves of Open Rails and MSTS vehicles as columns of a consist: BrakeSystemType and BrakeEquipmentType.

In Open Rails a triple valve releases wholly as the pipe rises, and an emergency reservoir acts in emergencies (its
source, AirSinglePipe.cs). Both together are the marks of North American valves, `distributor = aar`. The force of such
a vehicle is stated at a cylinder pressure; that of a full service is what its reservoir and cylinder balance at.
"""

from __future__ import annotations

from readers.formats.open_rails_fields import Fields
from readers.formats.open_rails_left import EQUIPMENT
from readers.formats.open_rails_units import PSI
from readers.import_account import Notes, Row
from readers.text import quoted

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
    return row | _release(row, fields, notes)


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


def _release(row: Row, fields: Fields, notes: Notes) -> Row:
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
