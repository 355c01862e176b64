"""From equations to a running FMU. Knows FMI and numerics, nothing about railways."""
