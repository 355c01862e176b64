"""The bogie: parameters -> equations -> System. This package does not depend on FMI.

Equation, table and page numbers are those of Handoko (2006), *Investigation of the dynamics of railway bogies
subjected to traction / braking torque*, unless another source is named.
"""
