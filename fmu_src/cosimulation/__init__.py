"""FMUs through fmpy: instances with named variables, and the master that couples them."""
