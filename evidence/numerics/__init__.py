"""Methods and levels of detail: cost, limits and agreement."""
