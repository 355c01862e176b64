"""Wheel-rail contact: geometry, load and creep forces of the contact models against exact theory."""
