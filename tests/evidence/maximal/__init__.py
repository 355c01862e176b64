"""An oracle for level 3 at contact model 2: maximal coordinates in an inertial frame, with NumPy and SciPy only.

It imports only data of the package: the vehicle's description, its parameters, the curves of the profiles. It shares no
equation of motion, connection, contact or creep force. Only `correspondence.py` uses the meaning of the states.
"""
