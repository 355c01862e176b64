"""Parameters, tables, parts and their connections for equations of your own (docs/writing-a-system.md)."""

from fmu_src.compose import compose, scope
from fmu_src.piecewise import interpolation
from fmu_src.system import ParameterSet, model_of, quantity
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle

__all__ = [
    "ParameterSet",
    "compose",
    "interpolation",
    "model_of",
    "planar_vehicle",
    "point_vehicle",
    "quantity",
    "scope",
]
