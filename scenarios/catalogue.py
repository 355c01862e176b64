"""All scenarios. A new one is a file and one entry here."""

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from bogie_braking.reporting.scenario import BadInputError, Scenario
from fmu_src.suggestion import suggestion
from readers.extras import need

#: Files of scenarios by folder, in the order in which they are listed.
FILES = (
    ("brakes", "demo"),
    ("thesis", "qr30 lock_boundary"),
    ("brakes", "brake_timing brake_surface block_friction sanding etcs_low_adhesion"),
    ("thesis", "traction_braking heavy_braking contact_geometry creep_forces"),
    ("contact", "contact_manchester flange_climb"),
    ("thesis", "wheelset_constant_speed wheelset_torque wheelset_variable_speed wheelset_skid critical_speed"),
    ("thesis", "bogie_irregularities bogie_pitch bogie_lateral_under_torque bogie_skid asymmetric_braking"),
    ("brakes", "anti_skid controller_prototype uneven_brakes"),
    ("vehicles", "vehicle_modes vehicle_hunting vehicle_braking vehicle_anti_skid vehicle_composed vehicle_or_bogie"),
    ("vehicles", "drive_torsion"),
    ("trains", "braking_distance"),
    ("lines", "curve_steering line_from_file flexible_track transition gradient curve_braking"),
    ("trains", "train_braking train_brakes train_release train_build_up train_brake_models train_coupling"),
    ("trains", "train_descent train_low_adhesion train_parts train_standing train_timetable train_track_brakes"),
    ("trains", "train_one_vehicle_in_detail"),
    ("coupling", "coupling_step"),
)
#: Scenarios of evidence/ with their folders, which a checkout has and a wheel has not (hatch_build.py).
EVIDENCE = {
    **{"train-brake-evidence": "trains", "train-energy": "trains", "contact-model": "contact", "creep-laws": "contact"},
    **{"sensitivity": "numerics", "oracle": "numerics", "levels": "numerics", "levels-in-curves": "numerics"},
    **{"speed": "numerics", "stability-atlas": "numerics", "thesis-step": "numerics"},
    **{"speed-accuracy": "comparisons", "throughput": "comparisons", "train-methods": "comparisons"},
}
need("fmpy", "matplotlib")  # which most scenarios import
MODULES: list[ModuleType] = [
    import_module(f"{__package__}.{folder}.{name}") for folder, names in FILES for name in names.split()
]
if __package__ == "scenarios" and find_spec("evidence"):
    MODULES += [import_module(f"evidence.{folder}.{name.replace('-', '_')}") for name, folder in EVIDENCE.items()]


def scenarios_of(module: ModuleType) -> list[Scenario]:
    """Return the scenarios of a file."""
    return getattr(module, "SCENARIOS", None) or [module.SCENARIO]


SCENARIOS = [scenario for module in MODULES for scenario in scenarios_of(module)]


def find(name: str) -> Scenario:
    """Return the scenario of this name."""
    by_name = {scenario.name: scenario for scenario in SCENARIOS}
    if name in by_name:
        return by_name[name]
    if name in EVIDENCE:
        raise BadInputError(f"{name} needs a checkout of the repository: no wheel has its references.")
    shown = "'python -m bogie_braking list' shows what there is."
    raise BadInputError(f"There is no scenario {name}; {suggestion(name, by_name, shown)}")
