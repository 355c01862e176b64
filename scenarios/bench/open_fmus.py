"""The FMUs that a scenario couples, of the kind that the command line asks for."""

from fmu_src.cosimulation.slave import FmuInstance
from products.building import up_to_date
from scenarios.scenario import Options


def open_bogie(options: Options, **parameters: float) -> FmuInstance:
    """An instance of BogieDynamics of the kind that was chosen."""
    return FmuInstance(up_to_date("bogie", options.kind or "native"), **parameters)


def open_brake(options: Options, **parameters: float) -> FmuInstance:
    """An instance of BrakeCylinder of the kind that was chosen."""
    return FmuInstance(up_to_date("brake", options.kind or "native"), **parameters)
