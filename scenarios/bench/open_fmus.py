"""The FMUs that a scenario couples, of the kind that the command line asks for."""

from fmu_src.cosimulation.slave import Slave
from products.building import up_to_date
from scenarios.scenario import Options


def open_bogie(options: Options, **parameters: float) -> Slave:
    """An instance of BogieDynamics of the kind that was chosen."""
    return Slave(up_to_date("bogie", options.kind or "native"), **parameters)


def open_brake(options: Options, **parameters: float) -> Slave:
    """An instance of BrakeCylinder of the kind that was chosen."""
    return Slave(up_to_date("brake", options.kind or "native"), **parameters)
