"""The test bench: machines and drives that several scenarios share."""
