"""The brake: pressure -> shoe force -> torque. This package depends neither on FMI nor on the bogie.

Equation, table and page numbers are those of Handoko (2006), *Investigation of the dynamics of railway bogies
subjected to traction / braking torque*, unless another source is named.
"""
