"""From equations to a running FMU. Knows FMI and numerics, nothing about railways."""

__version__ = "0.1.0"
