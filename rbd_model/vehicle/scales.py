"""Scales of the error control: a tolerance is a share of them."""

#: Scales of the error control: with tolerance 1e-7, a local error of 1 um/s in speed.
NOMINAL_SPEED = 10.0
NOMINAL_DISTANCE = 10.0
NOMINAL_ANGULAR_VELOCITY = 25.0
NOMINAL_ROTATION = 25.0
#: Motions in the suspension: with tolerance 1e-7, 1 nm and 0.1 um/s.
NOMINAL_TRAVEL = 0.01
NOMINAL_TRAVEL_SPEED = 1.0
#: Travel [m] and rate [m/s] of the suspension that no vehicle reaches: tables continue to there, functions are checked.
BEYOND, BEYOND_RATE = 1.0, 10.0
