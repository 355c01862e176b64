"""Chapter 3 of the thesis as published: the independent reference for the fast model.

It has Euler parameters, surface parameters and Lagrange multipliers in plain NumPy, one module for each part of the
chapter. `euler`: sections 3.2.1-3.2.3. `forces`: 3.2.4. `constraints`: 3.2.5 and 3.2.6. `surfaces`: 3.3.1 and 3.3.2.
`kinematic_analysis`: 3.3.3. `creep`: 3.3.4-3.3.7. `mechanism`: 4.2 and 5.2. `partition`: 3.4. `program`: 3.5. It shares
parameters, profiles, the track and Kalker's table with the fast model, but no equation of motion, constraint or force.
"""
