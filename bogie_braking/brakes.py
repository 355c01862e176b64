"""Brake cylinders as models and as parts of systems, their parameters, and friction tables of shoes."""

from brake_controller.cylinder import brake_cylinder, timed_brake
from brake_controller.parameters import BrakeParameters, qr30, uic
from brake_controller.shoe_friction import FrictionTable

__all__ = ["BrakeParameters", "FrictionTable", "brake_cylinder", "qr30", "timed_brake", "uic"]
