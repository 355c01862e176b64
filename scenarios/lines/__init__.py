"""Lines: curves, cant and gradients, and what the vehicle makes of them."""
