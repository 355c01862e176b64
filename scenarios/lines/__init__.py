"""Lines: vehicles on curves, cant and gradients."""
