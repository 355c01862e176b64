"""What is compared: integrators of SciPy, SUNDIALS and FMPy, and the code of other revisions."""
