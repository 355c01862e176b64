"""The test bench: vehicles and drives that several scenarios share."""
