"""Writes the live page: one file that brakes a vehicle in a browser, with the kernel of the FMUs as WebAssembly."""

import base64
import json
import zlib
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

from tqdm import tqdm

from brake_controller.sensors import Encoder
from brake_controller.wheel_slide import common_protection
from fmu_src import __version__
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import web_module
from products.braked_vehicle import FULL_PRESSURE
from products.prebuilt import prebuilt_page
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import size_of
from readers.storage import write_whole
from scenarios import reporting
from scenarios.live.lines import CANTS, rows_of
from scenarios.live.machines import MACHINES, YAW_PER_BRAKE_TORQUE, model_of
from scenarios.live.presets import DEFAULTS, PERIOD, PRESETS
from scenarios.reporting.motion import drawn
from scenarios.reporting.progress import PATIENCE

WEB = Path(__file__).parent / "web"
#: Of all pages with canvases.
CANVAS = Path(reporting.__file__).parent / "page" / "canvas.js"
#: In the order in which they use each other.
SCRIPTS = (
    *("packed.js", "one_file.js", "kernel.js", "protection.js", "stop.js", "simulation.js", "link.js"),
    *("desk.js", "look.js", "charts.js", "side_view.js", "section_view.js", "page.js"),
)

#: What the page knows of the sensors of the wheels.
SENSOR = ("pulses", "gate", "resolution", "lowest_frequency")


def write_page(path: Path) -> Path:
    """Writes the page, about a megabyte; it needs no network. Raises CompilerError, OSError."""
    made = prebuilt_page()
    text = made.read_text(encoding="utf-8") if made else page()
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, text.encode())
    return path


@lru_cache
def page() -> str:
    """Its text, with the kernels, which are compiled unless the cache has them. Raises CompilerError."""
    script = "\n".join(path.read_text(encoding="utf-8") for path in (CANVAS, *(WEB / name for name in SCRIPTS)))
    data = {
        "version": __version__,
        "protection": {
            "thresholds": asdict(common_protection()),
            "sensor": {name: getattr(Encoder(), name) for name in SENSOR},
        },
        "period": PERIOD,
        "defaults": DEFAULTS,
        "presets": [{"title": one.title, "link": one.link} for one in PRESETS.values()],
        "curves": {radius: {"cant": cant, "rows": rows_of(radius)} for radius, cant in CANTS.items()},
        "lineVariable": LINE.variable.name,
        "machines": {name: machine(name) for name in tqdm(MACHINES, "machines", delay=PATIENCE, leave=False)},
    }
    parts = {
        "@STYLE@": (WEB / "page.css").read_text(encoding="utf-8"),
        "@DATA@": json.dumps(data, separators=(",", ":")).replace("</", "<\\/"),
        "@SCRIPT@": script,
    }
    whole = (WEB / "page.html").read_text(encoding="utf-8")
    for mark, text in parts.items():
        whole = whole.replace(mark, text)
    return whole


def machine(name: str) -> dict[str, Any]:
    """What the page knows of a machine: its compiled kernel, variables by their number, sizes and profiles [m]."""
    model, one = model_of(name), MACHINES[name]
    vehicle, pair = one.vehicle(), one.pair()
    numbers = vehicle.parameters.values()
    known = {variable.name for variable in model.variables}
    return {
        "title": one.title,
        "guid": guid_of(generate(model)),
        "module": base64.b64encode(zlib.compress(web_module(model).read_bytes(), 9)).decode(),
        "variables": [variable.name for variable in model.variables],
        "fullPressure": FULL_PRESSURE,
        "fullTraction": one.full_traction,
        "fullYaw": YAW_PER_BRAKE_TORQUE * one.full_torque,
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
