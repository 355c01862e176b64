"""A host for @MODEL@.fmu in Python: sets what is named, makes 100 steps of 10 ms and prints the outputs.

pip install fmpy; python host.py .. NAME=VALUE ...   (.. is the unpacked FMU; its file serves as well)
seconds=30 makes 3000 steps.
"""

import sys
from contextlib import redirect_stdout
from pathlib import Path

from fmpy import simulate_fmu
from numpy import ndenumerate

path, *assignments = sys.argv[1:]
for assignment in assignments:
    if assignment.count("=") != 1:
        sys.exit(f"An argument must be NAME=VALUE; got {assignment}. Correct it.")
values = dict(assignment.split("=") for assignment in assignments)
seconds, fmu = float(values.pop("seconds", 1.0)), str(Path(path).resolve())
times = {"stop_time": seconds, "step_size": 0.01, "output_interval": 0.01}
with redirect_stdout(sys.stderr):  # messages of the FMU
    table = simulate_fmu(fmu, **times, start_values=values, debug_logging=True)
for name in table.dtype.names[1:]:
    for place, value in ndenumerate(table[name][-1]):
        print(name + "".join(f"[{number + 1}]" for number in place), float(value))
