"""Supervision curves of ETCS for a train, SUBSET-026, section 3.13 (docs/etcs.md).

>>> from bogie_braking import etcs
>>> train = etcs.SupervisedTrain.of_percentage(100.0, "passenger P", 200.0)
>>> limits = etcs.supervise(train, place=2000.0, V_est=[10.0, 20.0, 30.0])
>>> limits.P  # places of the front at which the permitted speed is 10, 20 and 30 m/s [m]
"""

from bogie_braking.supervised import FromRuns, OwnStop, own_stops, supervised_train
from bogie_braking.wet_rails import WET_RAILS, WetFactors, WetRails, wet_factors
from products.braking_curves.train_data import fmu_parameters
from products.etcs_files.national import read_national
from products.etcs_files.osrd import osrd_document, read_osrd_train
from products.etcs_files.train_file import EtcsTrain, read_train, train_document, write_train
from products.supervision import *  # noqa: F403
from products.supervision import __all__ as _of_supervision
from products.tolerance_file import read_tolerances

__all__ = [
    *_of_supervision,
    "WET_RAILS",
    "EtcsTrain",
    "FromRuns",
    "OwnStop",
    "WetFactors",
    "WetRails",
    "fmu_parameters",
    "osrd_document",
    "own_stops",
    "read_national",
    "read_osrd_train",
    "read_tolerances",
    "read_train",
    "supervised_train",
    "train_document",
    "wet_factors",
    "write_train",
]
