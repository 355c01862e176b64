"""Chapter 3 of the thesis as printed: the oracle that the fast model is checked against.

Euler parameters, surface parameters and Lagrange multipliers in plain NumPy, one module for each part of the chapter, in
its order: `euler` (3.2.1-3.2.3), `forces` (3.2.4), `surfaces` (3.3.1, 3.3.2), `constraints` (3.2.5, 3.2.6),
`creep` (3.3.4-3.3.7), `mechanism` (4.2, 5.2: what is put together), `partition` (3.4) and `program` (3.5). It shares
parameters, profiles, the track and Kalker's table with the fast model, and no equation of motion, constraint or force.
"""
