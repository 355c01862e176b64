"""transportation-ai999x (PyPI, Apache-2.0): formulas of transport, with the train's braking distance by quadrature.

`transport_train_braking_distance` has a constant brake force without a rise, the running resistance a + b v + c v^2 and
a gradient. Its brake force must be above 0. A coasting train has the constant part of its resistance there.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as version_of
from typing import Any

NAME = "transportation-ai999x"
PACKAGE = "transportation-ai999x"


def version() -> str:
    """Return its version. Raises ImportError if it is not installed."""
    try:
        return version_of(PACKAGE)
    except PackageNotFoundError:
        raise ImportError(f"install it by pip install {PACKAGE}") from None


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return distance [m] and time [s] of a run; None to other questions."""
    if question not in ("coasting", "stop-with-full-brakes"):
        return None
    resistance = tuple(inputs[f"resistance.{name}"] for name in ("constant", "linear", "square"))
    masses, speeds = (inputs["mass"], inputs["rotating_mass"]), (inputs["speed"], inputs.get("end_speed", 0.0))
    distance, time = braking(*masses, resistance, inputs.get("brake_force", 0.0), inputs["gradient"], *speeds)
    return {"distance": distance, "time": time}


def braking(
    mass: float,
    rotating: float,
    resistance: tuple[float, ...],
    force: float,
    gradient: float,
    speed: float,
    last: float,
) -> tuple[float, float]:
    """Return distance [m] and time [s] from `speed` to `last` by the brake force [N], resistance and gradient."""
    import transportation_ai999x as transportation

    constant, linear, square = resistance
    values = {"m": f"{mass!r} kg", "v1": f"{speed!r} m/s", "v2": f"{last!r} m/s", "F_b": f"{force + constant!r} N"}
    values |= {"A": "0 N", "B": f"{linear!r} N*s/m", "C": f"{square!r} N*s^2/m^2"}
    values |= {"G": repr(gradient), "gamma": repr(1.0 + rotating / mass)}
    found = transportation.solve("transport_train_braking_distance", **values)
    if not found.solved:
        raise ValueError(found.message)
    return float(found.values["S"]), float(found.values["t"])
