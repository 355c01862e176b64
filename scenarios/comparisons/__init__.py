"""Others' methods on the same equations, SciPy's and those of SUNDIALS: in a checkout alone, not in a wheel."""
