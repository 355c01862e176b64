"""Friction between the wheels of a train's vehicle and the rail over its speed, by choice."""

from __future__ import annotations

from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.variables import Field
from rbd_model.track.adhesion_laws import at_speed

#: Laws by their names in consists: the input at any speed, or its fall by Curtius and Kniffler.
ADHESIONS = {"input": 0, "curtius-kniffler": 1}
#: The law of a vehicle.
ADHESION = (Field("law", "1", 0.0, len(ADHESIONS) - 1.0, "the adhesion law of a vehicle", whole=True),)


def adhering() -> ca.Function:
    """Return the function for friction at a speed [m/s] over that at standstill: 1, or by Curtius and Kniffler (1950).

    Their law is scaled, so that the input is the friction at standstill. The fall over the sliding speed is that of
    `sliding` (vehicle.py). Arguments: speed of the vehicle, law.
    """
    speed, law = ca.SX.sym("speed"), ca.SX.sym("law")
    share = at_speed(ca.fabs(speed)) / at_speed(0.0)
    chosen = ca.if_else(law == ADHESIONS["curtius-kniffler"], share, 1)
    return function_of("adhering", [speed, law], chosen)
