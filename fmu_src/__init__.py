"""Code generation, kernel and FMI: builds running FMUs from equations. Independent of railways."""

__version__ = "0.1.0"
