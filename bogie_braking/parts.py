"""Data of a vehicle: bodies, wheelsets and the elements that connect them (docs/vehicles.md)."""

from rbd_model.vehicle.description import BumpStop as BumpStop
from rbd_model.vehicle.description import ForceLaw as ForceLaw
from rbd_model.vehicle.description import FrictionSlider as FrictionSlider
from rbd_model.vehicle.description import Pull as Pull
from rbd_model.vehicle.description import RigidBody as RigidBody
from rbd_model.vehicle.description import SeriesDamper as SeriesDamper
from rbd_model.vehicle.description import Springs as Springs
from rbd_model.vehicle.description import Sum as Sum
from rbd_model.vehicle.description import TableDamper as TableDamper
from rbd_model.vehicle.description import TableSpring as TableSpring
from rbd_model.vehicle.description import Torsion as Torsion
from rbd_model.vehicle.description import Vehicle as Vehicle
from rbd_model.vehicle.description import Wheelset as Wheelset
