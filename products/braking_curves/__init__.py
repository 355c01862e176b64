"""BrakingCurves.fmu: the curves of products/supervision in C, for simulators."""
