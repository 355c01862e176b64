"""Compared methods: integrators of SciPy, SUNDIALS and FMPy, and the code of other revisions."""
