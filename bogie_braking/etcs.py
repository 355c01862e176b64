"""Supervision curves of ETCS for a train, SUBSET-026, section 3.13 (docs/etcs.md).

>>> from bogie_braking import etcs
>>> train = etcs.SupervisedTrain.of_percentage(100.0, "passenger P", 200.0)
>>> limits = etcs.supervise(train, place=2000.0, V_est=[10.0, 20.0, 30.0])
>>> limits.P  # places of the front at which the permitted speed is 10, 20 and 30 m/s [m]
"""

from products.supervision import *  # noqa: F403
from products.supervision import __all__ as __all__
