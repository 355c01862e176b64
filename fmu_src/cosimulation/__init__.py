"""FMUs through fmpy: instances with named variables, and the master that couples them."""


class CosimulationError(RuntimeError):
    """An FMU cannot be loaded, or a call to it failed; the text is the FMU's own message if it has one."""
