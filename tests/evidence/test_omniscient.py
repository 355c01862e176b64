"""A controller that is shown everything: between the ideal stop and the built-in protection."""

from evidence.omniscient import of_all, shortest
from products.machine import bogie, filling_by_flow
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rig import Rig
from products.protection.rig_in_c import slide_protection
from products.protection.runs import Run
from products.protection.settings import Settings
from rbd_model.track.friction import low


def test_it_is_never_below_the_ideal_and_not_above_the_protection():
    """Twice from 8 m/s on the low rail, whose ideal omits the friction of axle boxes and uses one of 28 slips."""
    machine, run = bogie(), Run(low().values(2), 8.0)
    [tried] = of_all(machine, [run], Settings(), by_flow=True)
    best = shortest(tried).distance
    ideal = PeakAdhesion(machine, run.values, filling_by_flow(machine.full_pressure)).stopping_distance(8.0)
    [built_in] = Rig(machine, slide_protection(), Settings(), by_flow=True).runs([run])
    assert 0.995 * ideal < best < 1.005 * built_in.distance
    assert best < 1.05 * ideal
