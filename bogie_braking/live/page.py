"""Write the live page: one file that brakes a vehicle in a browser, with the kernel of the FMUs as WebAssembly."""

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

from bogie_braking.live.lines import CANTS, rows_of
from bogie_braking.live.machines import MACHINES, YAW_PER_BRAKE_TORQUE, model_of
from bogie_braking.live.presets import DEFAULTS, PERIOD, PRESETS
from bogie_braking.reporting.motion import drawn
from bogie_braking.reporting.progress import counting
from bogie_braking.web.frame import filled, packed
from brake_controller.sensors import GATE, LOWEST_FREQUENCY, TEETH, TIMER
from brake_controller.slide_protection import controlled
from fmu_src import __version__
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import web_module
from products.machine import FULL_PRESSURE
from products.prebuilt import PAGE, prebuilt_page
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import size_of
from readers.storage import write_whole


def write_page(path: Path) -> Path:
    """Write the page, about a megabyte; it needs no network. Raises CompilerError, OSError."""
    return write_made(path, PAGE, page)


def write_made(path: Path, name: str, page: Callable[[], str]) -> Path:
    """Write a page of the release, or the current one. Raises CompilerError, OSError."""
    made = prebuilt_page(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, made.read_bytes() if made else page().encode())
    return path


@lru_cache
def page() -> str:
    """Return its text, with the kernels, which are compiled unless they are in the cache. Raises CompilerError."""
    data = {
        "version": __version__,
        "sensor": {"pulses": TEETH, "gate": GATE, "resolution": TIMER, "lowest_frequency": LOWEST_FREQUENCY},
        "period": PERIOD,
        "defaults": DEFAULTS,
        "presets": [{"title": preset.title, "link": preset.link} for preset in PRESETS.values()],
        "curves": {radius: {"cant": cant, "rows": rows_of(radius)} for radius, cant in CANTS.items()},
        "lineVariable": LINE.variable.name,
        "machines": {name: machine(name) for name in counting(MACHINES, "machines")},
    }
    return filled("live.html.jinja", data=data)


def machine(name: str) -> dict[str, Any]:
    """Return the data of a vehicle: its compiled kernel, variables by their number, sizes and profiles [m]."""
    model, one = model_of(name), MACHINES[name]
    vehicle, pair = one.braked.vehicle, one.pair()
    numbers = vehicle.parameters.values()
    known = {variable.name for variable in model.variables}
    return {
        "title": one.title,
        "guid": guid_of(generate(model)),
        "module": packed(web_module(model, controlled()).read_bytes()),
        "variables": [variable.name for variable in model.variables],
        "mass": {"body": one.mass[0], "variable": one.mass[1], "value": numbers[one.mass[1]]},
        "fullPressure": FULL_PRESSURE,
        "fullTraction": one.full_traction,
        "fullYaw": YAW_PER_BRAKE_TORQUE * one.braked.full_torque,
        "wheelsets": [
            {"along": float(size_of(wheelset.along, numbers)), "radius": float(size_of(wheelset.mean_radius, numbers))}
            for wheelset in vehicle.wheelsets
        ],
        "bodies": [
            {
                "along": float(size_of(body.along, numbers)),
                "height": float(size_of(body.height, numbers)),
                "carries": [
                    number for number, wheelset in enumerate(vehicle.wheelsets) if wheelset.reacts_on == body.name
                ],
                "motions": {
                    motion: body.variable(motion) for motion in ("bounce", "pitch") if body.variable(motion) in known
                },
            }
            for body in vehicle.bodies
        ],
        "wheel": drawn(pair.wheel),
        "rail": drawn(pair.rail),
        "aside": pair.wheel_half_distance - pair.rail_half_distance,
    }
