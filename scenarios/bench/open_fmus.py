"""The FMUs of a coupled scenario, of the kind given on the command line."""

from bogie_braking.reporting.scenario import Options
from fmu_src.cosimulation.slave import FmuInstance
from products.building import up_to_date


def open_bogie(options: Options, **parameters: float) -> FmuInstance:
    """Return an instance of BogieDynamics of the chosen kind."""
    return FmuInstance(up_to_date("bogie", options.kind or "native"), **parameters)


def open_brake(options: Options, **parameters: float) -> FmuInstance:
    """Return an instance of BrakeCylinder of the chosen kind."""
    return FmuInstance(up_to_date("brake", options.kind or "native"), **parameters)
