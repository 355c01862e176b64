"""C of a system over several instances, for runs in lanes: batch.h in the runtime."""

from __future__ import annotations

from fmu_src.elimination import elimination, elimination_in_lanes
from fmu_src.equations import functions, table_ranks
from fmu_src.equations_in_c import HEAD, functions_in_lanes
from fmu_src.system import Model, System

#: Functions of a system in the order of `batch_functions` in batch.h.
FUNCTIONS = ("ode", "jacobian", "output", "drive", "capacity", "condition_margin", "largest_change")


def batch_source(model: Model, system: System) -> dict[str, str]:
    """Return the C file, by its name, of a system of a model in BATCH_LANES lanes."""
    every, name = functions(system), system.name
    ranks = [f"table_argument_{rank}" for rank in range(table_ranks(system))]
    made = {one: every[one] for one in (*FUNCTIONS, *ranks) if one in every}
    given, texts = functions_in_lanes(name, made)
    texts += elimination_in_lanes(name, elimination(system))
    in_lanes = [f"LANES_NAME({name}_{every[one].function.name()})" if one in every else "0" for one in FUNCTIONS]
    arguments = [f"LANES_NAME({name}_{every[one].function.name()})" for one in ranks]
    tables = f"static const lanes_function ARGUMENT[] = {{{', '.join(arguments)}}};" if ranks else ""
    solving = [f"LANES_NAME({name}_factorise)", f"LANES_NAME({name}_substitute)"]
    fields = ["LANES", str(model.systems.index(system)), *in_lanes, "ARGUMENT" if ranks else "0", *solving]
    described = [tables, f"const batch_functions BATCH = {{{', '.join(fields)}}};"]
    lanes = ["#define LANES BATCH_LANES", '#include "lanes.h"', *texts, *described, '#include "lanes_end.h"', ""]
    return {f"batch_{name}.c": "\n".join([*HEAD, '#include "batch_lanes.h"', *given, *lanes])}
