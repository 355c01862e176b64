"""Vehicles of Open Rails and MSTS (.eng, .wag) as rows of a consist.

The coupler behind a vehicle is the first Coupling of its file, and the second one if the vehicle is flipped. A third
and a fourth replace these two: files that are included have them. The simple coupler of Open Rails has a slack, and
beyond it one stiffness in both senses. This stiffness is 7 times the sum of both values of Stiffness if r0 begins with
0, else 20 MN/m (its source, MSTSWagon.cs: GetSimpleCouplerStiffnessNpM, SetSimpleR0, and TrainCar.cs).

Names, units and defaults as the manual of Open Rails states them. Forces are in N, and powers in W. A curve has m/s
and N where no unit is written, and belongs to a position of the controller.
"""

from __future__ import annotations

from pathlib import Path

from readers.formats.open_rails_brake import brake_of, branch_of, hand_brake_of
from readers.formats.open_rails_fields import Fields, measured, units_of
from readers.formats.open_rails_text import Block, Reader
from readers.formats.vehicle_rows import STRONGEST, drive_table, printable, rounded
from readers.import_account import Notes, Row
from readers.text import FileError, quoted, shown

#: Fields by reason.
_LEFT = {
    "a vehicle of a train has its mass on braked wheels, without axles of their own": (
        "WheelRadius NumWheels ORTSNumberAxles ORTSNumberDriveAxles ORTSDriveWheelWeight"
    ),
    "Open Rails uses it only without ORTSDavis": "ORTSBearingType",
    "Open Rails ignores it, except from the program FCalc; give ORTSDavis_A, B and C": "Friction",
    "breakaway resistance has no column": "ORTSStandstillFriction ORTSMergeSpeed",
    "wind has no column": "ORTSDavisDragConstant ORTSWagonFrontalArea",
    "an emergency reservoir has no column": "EmergencyResChargingRate EmergencyBrakeResMaxPressure",
    "the choke that charges the reservoir is fixed": "MaxAuxilaryChargingRate MaxAuxiliaryChargingRate",
    "dead volume of a cylinder has no column": "ORTSBrakeCylinderPipingVolume",
    "a vacuum cylinder has no column": "ORTSBrakeCylinderSize",
    "a vacuum reservoir has no column": "ORTSAuxilaryResCapacity",
    "a vacuum brake has no column": "ORTSDirectAdmissionValve",
    "a return force has a column with cylinder data alone": "ORTSCylinderSpringPressure",
    "insensitivity is that of UIC 540": "ORTSBrakeInsensitivity",
    "the first stage is that of UIC 540": "ORTSInitialApplicationThreshold",
    "the distributor has its own emergency and quick-service parts": (
        "ORTSEmergencyValveActuationRate ORTSEmergencyDumpValveRate ORTSEmergencyDumpValveTimer "
        "ORTSQuickServiceLimit ORTSQuickServiceApplicationRate ORTSQuickServiceVentRate "
        "ORTSAcceleratedApplicationFactor ORTSAcceleratedApplicationMaxVentRate"
    ),
    "uniform charging has no column": "ORTSUniformChargingThreshold ORTSUniformChargingRatio",
    "uniform release has no column": "ORTSUniformReleaseThreshold ORTSUniformReleaseRatio",
    "a relay valve has no column; the force is that of the stated load": (
        "ORTSBrakeRelayValveRatio ORTSBrakeRelayValveInshot"
    ),
    "a limit of service pressure has no column": "ORTSMaxTripleValveCylinderPressure ORTSMaxServiceCylinderPressure",
    "a rate of service braking alone has no column": "ORTSMaxServiceApplicationRate",
    "two stages of pressure over speed (R brake) have no column; full_pressure applies at all speeds": (
        "ORTSTwoStageLowPressure ORTSHighSpeedReducingPressure"
    ),
    "valves of both kinds together have no column": "ORTSEPBrakeInhibitsTripleValve",
    "a main pipe has no column": "ORTSMainResPipeAuxResCharging",
    "the input parking_brake of the train is a share, without steps": "NumberOfHandbrakeLeverSteps",
    "set adhesion = curtius-kniffler, with its usual numbers, yourself": "ORTSCurtius_Kniffler",
    "Open Rails ignores it": "Adheasion",
    "slide protection of a train is an input": (
        "ORTSWheelBrakeSlideProtection ORTSWheelBrakesSlideProtectionLimitDisable ORTSEmergencyBrakingDisablesWSP"
    ),
    "of the motors, the largest force or its curve and the power alone are read": "MaxContinuousForce",
    "motors have no limit of speed; the last force of a table may be 0": "MaxVelocity",
    "set traction_rise yourself": "RunUpTimeToMaxForce",
    "a dead time has a column with brake = ep-direct alone": "DynamicBrakesDelayTimeBeforeEngaging",
    "of the dynamic brake, the largest force and its speeds alone are read": "DynamicBrakesEffectAtMaximumFadeOut",
    "blending of dynamic and air brakes has no column, other than brake = ep-direct": (
        "DynamicBrakeHasAutoBailOff ORTSDynamicBrakesHasPartialBailOff ORTSDynamicBlendingMinimumSpeed "
        "ORTSDynamicBlendingRetainedPressure ORTSTrainDynamicBlendingTable"
    ),
    "the driver's valve is that of UIC 541-03": (
        "ORTSBrakePipeChargingRate ORTSBrakeServiceTimeFactor ORTSBrakeEmergencyTimeFactor ORTSMainResChargingRate"
    ),
    "the pipe is simulated with flow of air; a factor of time adds nothing": "ORTSBrakePipeTimeFactor",
    "a leak has a column as the diameter of a hole: set leak [mm] yourself": "TrainPipeLeakRate",
}
#: Reasons by field.
LEFT = {name: reason for reason, names in _LEFT.items() for name in names.split()}


#: Stiffness where r0 does not begin with 0, both values where a file has none, and factor of their sum [N/m].
STIFFNESS, DEFAULTS, FACTOR = 2e7, (1e7, 2e7), 7.0
#: Slack of a coupler whose r0 does not begin with 0, least and largest slack [m].
SLACK, LEAST_SLACK, MOST_SLACK = 0.012, 0.001, 0.1


def coupler_of(couplings: list[Block], flipped: bool, notes: Notes) -> Row:
    """Return the columns of the coupler behind a vehicle with these blocks Coupling."""
    if not couplings:
        notes.assumed("Coupling: missing; a screw coupler, in Open Rails one of 20 MN/m.")
        return {}
    both = [*couplings[2:4], *couplings[len(couplings[2:4]) : 2]]
    fields = Fields(both[-1 if flipped else 0].blocks, notes)
    kind = fields.word("Type")
    rigid = fields.word("CouplingHasRigidConnection") not in ("", "0", "false") or (
        fields.has("CouplingHasRigidConnection") and not fields.word("CouplingHasRigidConnection")
    )
    if rigid or kind == "bar":
        notes.taken("Coupling: rigid connection or Bar -> coupler = rigid")
        return {"coupler": "rigid"}
    row: Row = {"coupler": "draft-gear" if kind == "automatic" else "screw"}
    notes.taken("Coupling: Automatic -> draft-gear, others -> screw")
    spring = fields.blocks.get("spring")
    if spring is None:
        notes.assumed("Coupling without Spring: the stiffness and slack of its kind, in Open Rails 210 MN/m and 12 mm.")
        return row
    return row | _spring(Fields(spring.blocks, notes), notes)


def _spring(own: Fields, notes: Notes) -> Row:
    """Return stiffness, slack and strength of a coupler."""
    if any(name.startswith("orts") for name in own.blocks):
        notes.left("Coupling, ORTS fields of advanced couplers: Open Rails reads their stiffness as a force.")
        return {}
    pair = own.number("Stiffness", "N/m"), own.number("Stiffness", "N/m", 1)
    stiffness = DEFAULTS if pair[0] is None or pair[0] + (pair[1] or 0.0) < 0.0 else (pair[0], pair[1] or 0.0)
    near, far = own.number("r0", "m") or 0.0, own.number("r0", "m", 1)
    row: Row = {}
    if near != 0.0:
        row["coupler_stiffness"] = rounded(1e-6 * STIFFNESS)
        notes.converted("Coupling r0 that does not begin with 0: 20 MN/m and 12 mm, as in Open Rails, not Stiffness.")
    else:
        row["coupler_stiffness"] = rounded(1e-6 * FACTOR * sum(stiffness))
        notes.converted("Coupling Stiffness: 7 x the sum of both values, as in Open Rails -> coupler_stiffness [MN/m]")
    if own.has("r0"):
        before = list(own.blocks).index("r0") < list(own.blocks).index("stiffness") if own.has("Stiffness") else False
        row["coupler_slack"] = rounded(1e3 * _slack(near, far or 0.0, DEFAULTS if before else stiffness))
        notes.converted(
            "Coupling r0 that begins with 0: half of its second value x the second Stiffness over their sum, 1 to 100 "
            "mm -> coupler_slack [mm]"
        )
    else:
        row["coupler_slack"] = rounded(1e3 * SLACK)
    if strength := own.number("Break", "N"):
        row["coupler_strength"] = rounded(1e-3 * strength)
        notes.taken("Coupling Break, first value -> coupler_strength [kN]")
    if own.has("Damping"):
        notes.left("Coupling Damping: friction of the coupler is that of its kind; Open Rails has none.")
    return row


def _slack(near: float, far: float, stiffness: tuple[float, float]) -> float:
    """Return the slack in each sense [m] of both values of r0 [m], with both values of Stiffness [N/m]."""
    if near != 0.0 or not sum(stiffness):
        return SLACK
    return min(max(far / 2.0 * stiffness[1] / sum(stiffness), LEAST_SLACK), MOST_SLACK)


#: Names of a curve, the one that is valid first.
TRACTION_CURVES = ("ORTSMaxTractiveForceCurves", "MaxTractiveForceCurves")
BRAKE_CURVES = ("ORTSDynamicBrakeForceCurves", "DynamicBrakeForceCurves")
#: Largest power of a vehicle of a consist [W].
MOST_POWER = 30e6
#: Fields that are read.
DRIVE = (*TRACTION_CURVES, *BRAKE_CURVES, "MaxForce", "MaxPower")


def drive_of(engines: list[Block], notes: Notes) -> Row:
    """Return the columns of the motors and of the dynamic brake in the blocks Engine of a vehicle."""
    fields = Fields([block for engine in engines for block in engine.blocks], notes)
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
    row["name"] = printable(" ".join(fields.words("Name")) or path.stem, "vehicle")
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
    names |= {block.name for engine in _engines(root) for block in engine.blocks}
    notes.left_of(LEFT, [name for name in LEFT if name.lower() in names])
    outside = [block.name for block in root.blocks if block.name.lower() in {one.lower() for one in TAKEN}]
    for name in outside:
        notes.left(f"{name}: it stands outside Wagon ( ), and Open Rails ignores it.")
    fields.misspelt([*LEFT, *DRIVE, "Engine", "Inside", "Lights"], TAKEN)
