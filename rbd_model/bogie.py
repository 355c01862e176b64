"""The FMUs of this package: BogieDynamics, all levels of detail behind one table of variables, and WheelsetDynamics."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from fmu_src.system import Model, System, Variable, integration_variables, model_of
from rbd_model import variables
from rbd_model.contact_geometry import thesis_pair
from rbd_model.parameters import BogieParameters, tables_4_1_and_4_2, tables_5_1_and_5_2
from rbd_model.planar import planar_bogie
from rbd_model.point import point_bogie
from rbd_model.spatial import spatial_bogie
from rbd_model.track import irregular_track, section_5_3

#: Local error per step in nominal values, chosen from the pictures of `speed-accuracy`: docs/choosing.md.
DEFAULT_TOLERANCE = 1e-6


def levels(defaults: BogieParameters) -> tuple[System, ...]:
    """The systems in the order of the parameter `level`, the least first."""
    spatial = spatial_bogie(defaults, thesis_pair(), irregular_track(section_5_3()))
    return point_bogie(defaults), planar_bogie(defaults), spatial


def bogie_dynamics(defaults: BogieParameters | None = None) -> Model:
    """The bogie as one FMU, that of chapter 5 by default: brake torque capacity in; speed, rotation and slip out."""
    systems = levels(defaults or tables_5_1_and_5_2())
    level = Variable(
        "level",
        "parameter",
        "1",
        "Level of detail: 1 point, 2 planar, 3 spatial",
        2.0,
        1.0,
        float(len(systems)),
        kind="integer",
    )
    parameters = {v.name: v for system in systems for v in system.variables if v.causality == "parameter"}
    table = (
        *variables.inputs().values(),
        *variables.outputs().values(),
        level,
        *parameters.values(),
        *integration_variables(DEFAULT_TOLERANCE),
    )
    text = "Two-axle railway bogie under brake and traction torque, after Handoko (2006)"
    return Model("BogieDynamics", text, table, systems, selector="level", stop_time=25.0)


#: Share of the adhesion that the brakes of the chapter 5 bogie may ask for while static loads give speed, distance and
#: rotation to 0.2 %; from 0.70 on load transfer locks the trailing wheelset (scenario `levels`, friction 0.3).
STATIC_LOADS_UP_TO = 0.6
#: Outputs that the point level has, but that load transfer decides: slip and axle load at any torque, lock and creep
#: force near the adhesion limit.
DECIDED_BY_LOAD_TRANSFER = ("locked", "slip", "slip_ratio", "creep_force", "axle_load")


@dataclass(frozen=True)
class Choice:
    """A level of detail and, in a sentence, why none below it is enough."""

    level: int
    reason: str


def smallest_level(driven: Iterable[str], read: Iterable[str]) -> Choice:
    """The least level that answers a scene: `driven` are the inputs and parameters that it changes, `read` the outputs.

    Raises ValueError for a name that no level has.
    """
    names = names_of_levels()
    needed = [*driven, *read]
    for name in needed:
        if not any(name in own for own in names.values()):
            raise ValueError(f"BogieDynamics has no variable {name}; build_fmu.py --describe lists them.")
    reason = (
        "speed and rotation far from the adhesion limit need no more than static loads "
        f"(up to {STATIC_LOADS_UP_TO} of it for the bogie of chapter 5)."
    )
    level = 1
    for name in needed:
        family = name.removesuffix("_1").removesuffix("_2")
        own = next(number for number, (_, known) in enumerate(names.items(), 1) if name in known)
        own = max(own, 2) if family in DECIDED_BY_LOAD_TRANSFER else own
        if own > level:
            why = {2: "load transfer decides it, or a motion in the plane", 3: "it belongs to motions out of the plane"}
            level, reason = own, f"{name} asks for level {own}, {list(names)[own - 1]}: {why[own]}."
    return Choice(level, reason)


@lru_cache
def names_of_levels() -> dict[str, set[str]]:
    """Names of the variables of each level, the least first; all are integrated with a tolerance."""
    systems = levels(tables_5_1_and_5_2())
    common = {variable.name for variable in integration_variables(DEFAULT_TOLERANCE)}
    return {system.name: common | {variable.name for variable in system.variables} for system in systems}


def wheelset_in_frame(defaults: BogieParameters | None = None) -> System:
    """The single wheelset in a frame of chapter 4, spatial, with the variables of wheelset 1."""
    track = irregular_track(section_5_3())
    system = spatial_bogie(defaults or tables_4_1_and_4_2(), thesis_pair(), track, numbers=(1,))
    system.name = "WheelsetDynamics"
    system.description = "Railway wheelset in a frame under brake and traction torque, after Handoko (2006), chapter 4"
    return system


def wheelset_dynamics() -> Model:
    """The wheelset of chapter 4 as an FMU."""
    return model_of(wheelset_in_frame(), DEFAULT_TOLERANCE)
