"""The track below a vehicle: its axes, the line, irregularities, friction along it."""
