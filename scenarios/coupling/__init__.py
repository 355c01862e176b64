"""Co-simulation: cost and error of coupled FMUs."""
