"""Brakes: application, wheel-slide protection, uneven brakes."""
