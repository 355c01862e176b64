"""A host for @MODEL@.fmu in Python: sets what is named, makes 100 steps of 10 ms and prints the outputs.

pip install fmpy; python host.py .. NAME=VALUE ...   (.. is the unpacked FMU; its file serves as well)
"""

import sys
from pathlib import Path

from fmpy import simulate_fmu

path, *assignments = sys.argv[1:]
values = dict(assignment.split("=") for assignment in assignments)
fmu = str(Path(path).resolve())
table = simulate_fmu(fmu, stop_time=1.0, step_size=0.01, output_interval=0.01, start_values=values)
for name in table.dtype.names[1:]:
    print(name, float(table[name][-1]))
