"""The thesis: its experiment and its simulations, chapters 4 to 9."""
