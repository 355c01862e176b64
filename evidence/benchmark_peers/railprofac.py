"""Programs of RailProfAC (R. Pfaff, FH Aachen, MIT): a notebook of EN 14531-1, and a script of shunting stops.

Both are read from a folder with clones of RailProfAC/RailwayBrakeCalculation and RailProfAC/ShuntingBrakingCurves,
whose path is in BOGIE_BRAKING_RAILPROFAC. Cells and functions run as they are, with the numbers of a case.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

NAME = "RailProfAC"
PLACE = "BOGIE_BRAKING_RAILPROFAC"
MEAN_VALUES = "RailwayBrakeCalculation/BrakeCalculationAverageValues.ipynb"
SHUNTING = "ShuntingBrakingCurves/MonteCarloSimulation-multiprocessing.py"
#: Functions of the program: friction of a block, and the distance of one stop.
FRICTION, STOP = "muBr", "ShuntingBrakeCalculation"
#: Stops of a mean, whose standard error is 0.04 m, and the seed of the program's own random numbers.
STOPS, SEED = 500, 42


def version() -> str:
    """Return the first digits of the SHA-256 of both files. Raises ImportError if they, or pandas, are not there."""
    if find_spec("pandas") is None:
        raise ImportError("install what it needs by pip install pandas")
    files = [folder() / name for name in (MEAN_VALUES, SHUNTING)]
    missing = [str(file) for file in files if not file.is_file()]
    if missing:
        raise ImportError(f"{missing[0]} does not exist. Clone the repository, and set {PLACE} to the folder above it.")
    return ", ".join(hashlib.sha256(one.read_bytes()).hexdigest()[:8] for one in files)


def folder() -> Path:
    """Return the folder of the clones. Raises ImportError if it is not set."""
    if not os.environ.get(PLACE):
        raise ImportError(f"set {PLACE} to a folder with clones of RailwayBrakeCalculation and ShuntingBrakingCurves")
    return Path(os.environ[PLACE])


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return distances [m], times [s], forces [N] and shares [1]; None to other questions."""
    served = {"stop-of-axles": mean_values, "shunting-stops": shunting}
    return served[question](inputs) if question in served else None


def cells(name: str) -> Iterator[str]:
    """Yield the code cells of a notebook."""
    for cell in json.loads((folder() / name).read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            yield "".join(cell["source"])


def run(name: str, words: tuple[str, ...], space: dict[str, Any]) -> dict[str, Any]:
    """Run in `space` the cells of a notebook that begin with one of these words, and return it."""
    for text in cells(name):
        if text.startswith(words):
            exec(compile(text, name, "exec"), space)
    return space


def mean_values(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the answers of the notebook of EN 14531-1 to a stop of axles.

    The notebook has pressures in bar and areas in cm2. Its own table of 8 axles has a column of 7 and does not run.
    """
    import numpy as np
    import pandas as pd

    columns = {"pC": "cylinder_pressure", "AC": "piston_area", "etaC": "cylinder_efficiency", "Fs,C": "cylinder_spring"}
    columns |= {"irig": "rigging_ratio", "etarig,dyn": "rigging_efficiency", "Fs,rig": "rigging_spring"}
    columns |= {"mum": "friction", "rS": "friction_radius", "D": "wheel_diameter", "ta": "delay", "tab": "rise"}
    columns |= {"mst": "mass", "mrot": "rotating_mass"}
    axles = inputs["axles"]
    table = pd.DataFrame({short: [inputs[f"{kind}.{name}"] for kind in axles] for short, name in columns.items()})
    table["pC"], table["AC"], table["iC"] = table["pC"] / 1e5, table["AC"] * 1e4, 1.0
    space: dict[str, Any] = {"np": np, "pd": pd, "df": table, "v0": inputs["speed"], "vfin": 0.0}
    run(MEAN_VALUES, ("# Brake cylinder force", "# Equivalent brake", "mdyn ="), space)
    resistance = next(text for text in cells(MEAN_VALUES) if "FRa = " in text)
    space |= dict(zip("ABC", (inputs[f"resistance.{name}"] for name in ("constant", "linear", "square")), strict=True))
    exec("\n".join(line for line in resistance.splitlines() if line.startswith("FRa")), space)
    run(MEAN_VALUES, ("Fext =", "ae =", "s = ", "df['taureq']"), space)
    found = {"distance": space["s"], "mean_value_distance": space["s"], "brake_force": table["FB,i"].sum()}
    found |= {"equivalent_time": space["te"], "equivalent_deceleration": space["ae"]}
    for kind in dict.fromkeys(axles):
        row = table.iloc[list(axles).index(kind)]
        found |= {f"{kind}_force": row["FB,i"], f"{kind}_adhesion": row["taureq"]}
    return {name: float(one) for name, one in found.items()}


def shunting(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return mean and deviation of stops with random brakes [m], and the share beyond the limit, by the program's own
    function of one stop and its random numbers.
    """
    import numpy as np

    text = ast.parse((folder() / SHUNTING).read_text(encoding="utf-8"))
    text.body = [one for one in text.body if isinstance(one, ast.FunctionDef) and one.name in (FRICTION, STOP)]
    space: dict[str, Any] = {"np": np}
    exec(compile(text, SHUNTING, "exec"), space)
    np.random.seed(SEED)
    found = np.array([space[STOP](wagons(inputs)) for _ in range(STOPS)])
    share = float(np.mean(found > inputs["limit"]))
    return {"mean": float(np.mean(found)), "deviation": float(np.std(found)), "share": share}


def wagons(inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of one stop by the program's names, its random numbers drawn in the program's order."""
    import numpy as np

    count, slow = round(inputs["wagons"]), inputs["cylinder.at_once"] > 0.0

    def normal(mean: float, name: str) -> Any:
        return np.random.normal(loc=mean, scale=inputs[f"{name}_deviation"], size=count)

    every = {"m": "wagon.mass", "mrot": "wagon.rotating", "Cdia": "cylinder.diameter", "l": "wagon.length"}
    every |= {"i": "rigging.ratio", "n": "wagon.blocks"}
    names = {"mloco": "mass", "Floco": "brake_force", "lloco": "length"}
    return (
        {"v0": inputs["speed"], "tfloco": inputs["cylinder.filling"], "Gloco": slow, "G": np.full(count, slow)}
        | {short: inputs[f"locomotive.{name}"] for short, name in names.items()}
        | {short: np.full(count, inputs[name]) for short, name in every.items()}
        | {"p": normal(inputs["cylinder.pressure"], "cylinder.pressure")}
        | {"eta": normal(inputs["rigging.efficiency"], "rigging.efficiency")}
        | {"tf": normal(inputs["cylinder.filling"], "cylinder.filling"), "muc": normal(1.0, "friction.factor")}
    )
