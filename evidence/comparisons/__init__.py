"""Third-party methods on the same equations, those of SciPy and SUNDIALS: only in a checkout, not in a wheel."""
