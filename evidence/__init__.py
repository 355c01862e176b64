"""Evidence that the models are right: oracles, other methods and programs, measurements. No wheel contains it."""
