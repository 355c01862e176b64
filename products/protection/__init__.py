"""Wheel-slide protection on trial: a machine with brakes, the rails that it stops on, and a stop of it."""
