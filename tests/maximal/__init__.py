"""An oracle for level 3 at contact model 2: maximal coordinates in an inertial frame, NumPy and SciPy alone.

Of the package it reads data only: the vehicle's description, its parameters, the curves of the profiles. No equation of
motion, connection, contact or creep force comes from there; `correspondence.py` alone knows what the states mean.
"""
