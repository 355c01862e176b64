"""All scenarios. A new one is a file and one entry here."""

from importlib import import_module
from importlib.util import find_spec

from bogie_braking.reporting.scenario import BadInputError, Scenario
from fmu_src.suggestion import suggestion
from scenarios.brakes import (
    anti_skid,
    block_friction,
    brake_surface,
    brake_timing,
    controller_prototype,
    demo,
    etcs_low_adhesion,
    sanding,
    uneven_brakes,
)
from scenarios.contact import contact_manchester, flange_climb
from scenarios.coupling import coupling_step
from scenarios.lines import curve_braking, curve_steering, flexible_track, gradient, line_from_file, transition
from scenarios.thesis import (
    asymmetric_braking,
    bogie_irregularities,
    bogie_lateral_under_torque,
    bogie_pitch,
    bogie_skid,
    contact_geometry,
    creep_forces,
    critical_speed,
    heavy_braking,
    lock_boundary,
    qr30,
    traction_braking,
    wheelset_constant_speed,
    wheelset_skid,
    wheelset_torque,
    wheelset_variable_speed,
)
from scenarios.trains import (
    braking_distance,
    train_brake_models,
    train_brakes,
    train_braking,
    train_build_up,
    train_coupling,
    train_descent,
    train_low_adhesion,
    train_one_vehicle_in_detail,
    train_parts,
    train_release,
    train_standing,
    train_timetable,
    train_track_brakes,
)
from scenarios.vehicles import (
    drive_torsion,
    vehicle_anti_skid,
    vehicle_braking,
    vehicle_composed,
    vehicle_hunting,
    vehicle_modes,
    vehicle_or_bogie,
)

SCENARIOS: list[Scenario] = [
    demo.SCENARIO,
    *qr30.SCENARIOS,
    lock_boundary.SCENARIO,
    brake_timing.SCENARIO,
    brake_surface.SCENARIO,
    block_friction.SCENARIO,
    sanding.SCENARIO,
    etcs_low_adhesion.SCENARIO,
    traction_braking.SCENARIO,
    heavy_braking.SCENARIO,
    contact_geometry.SCENARIO,
    creep_forces.SCENARIO,
    contact_manchester.SCENARIO,
    flange_climb.SCENARIO,
    wheelset_constant_speed.SCENARIO,
    wheelset_torque.SCENARIO,
    wheelset_variable_speed.SCENARIO,
    wheelset_skid.SCENARIO,
    critical_speed.SCENARIO,
    *bogie_irregularities.SCENARIOS,
    bogie_pitch.SCENARIO,
    bogie_lateral_under_torque.SCENARIO,
    bogie_skid.SCENARIO,
    asymmetric_braking.SCENARIO,
    anti_skid.SCENARIO,
    controller_prototype.SCENARIO,
    uneven_brakes.SCENARIO,
    vehicle_modes.SCENARIO,
    vehicle_hunting.SCENARIO,
    vehicle_braking.SCENARIO,
    vehicle_anti_skid.SCENARIO,
    vehicle_composed.SCENARIO,
    vehicle_or_bogie.SCENARIO,
    drive_torsion.SCENARIO,
    braking_distance.SCENARIO,
    curve_steering.SCENARIO,
    line_from_file.SCENARIO,
    flexible_track.SCENARIO,
    transition.SCENARIO,
    gradient.SCENARIO,
    curve_braking.SCENARIO,
    train_braking.SCENARIO,
    train_brakes.SCENARIO,
    train_release.SCENARIO,
    train_build_up.SCENARIO,
    train_brake_models.SCENARIO,
    train_coupling.SCENARIO,
    train_descent.SCENARIO,
    train_low_adhesion.SCENARIO,
    train_parts.SCENARIO,
    train_standing.SCENARIO,
    train_timetable.SCENARIO,
    train_track_brakes.SCENARIO,
    train_one_vehicle_in_detail.SCENARIO,
    coupling_step.SCENARIO,
]
#: Scenarios of evidence/, which a checkout has and a wheel has not (hatch_build.py).
EVIDENCE = (
    *("contact-model", "creep-laws", "sensitivity", "oracle", "levels", "levels-in-curves", "speed", "stability-atlas"),
    *("thesis-step", "train-brake-evidence", "speed-accuracy", "throughput", "train-methods"),
)
if __package__ == "scenarios" and find_spec("evidence"):
    SCENARIOS += import_module("evidence.catalogue").SCENARIOS


def find(name: str) -> Scenario:
    """Return the scenario of this name."""
    by_name = {scenario.name: scenario for scenario in SCENARIOS}
    if name in by_name:
        return by_name[name]
    if name in EVIDENCE:
        raise BadInputError(f"{name} needs a checkout of the repository: no wheel has its references.")
    shown = "'python -m bogie_braking list' shows what there is."
    raise BadInputError(f"There is no scenario {name}; {suggestion(name, by_name, shown)}")
