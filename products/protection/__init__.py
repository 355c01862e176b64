"""Tests of wheel-slide protection: a vehicle with brakes, its rails, and a stop on them."""
