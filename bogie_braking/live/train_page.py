"""Write the page on which a train brakes: the C of TrainDynamics.fmu as WebAssembly, and trains as numbers."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.live.carried_train import CarriedTrain, layout_mark
from bogie_braking.live.page import write_made
from bogie_braking.live.train_desk import CONTROLS, VALVE_KEYS
from bogie_braking.web.frame import filled, packed
from brake_controller.drivers_valve import drivers_valve
from fmu_src import __version__
from fmu_src.compile import web_library
from products.train.consist import block_train
from products.train.consist_file import consist_of
from products.train.layout import EQUIPMENT, INPUTS, OUTPUTS, Array, layout
from products.train.library import sources
from products.train.notches import notches_shown
from rbd_model.track.line import Line
from readers.storage import write_whole

PAGE = "live-train.html"
#: Block trains by the name that the page shows: wagons, position.
BLOCKS = {"40 wagons, P": (40, "P"), "40 wagons, G": (40, "G"), "10 wagons, P": (10, "P"), "100 wagons, G": (100, "G")}
#: A train with all controls, on a descent: its locomotive, its wagons, gradients [1] by place [m], limits of speed. All
#: assumed.
HILL = "20 wagons on a descent"
LOCOMOTIVE = {"kind": "locomotive", "traction_force": 300, "traction_power": 5600, "dynamic_force": 150}
LOCOMOTIVE |= {"dynamic_power": 2600, "parking_force": 60}
GRADIENTS = {0: 0.0, 1000: 0.0, 1200: -0.015, 4000: -0.015, 4200: 0.004, 8000: 0.004}
LIMITS = ((-1000.0, 1500.0, 80 / 3.6), (1500.0, 4200.0, 60 / 3.6), (4200.0, 9000.0, 100 / 3.6))
#: Runs of one click: the links that the page writes, after #. Steps are those of STEP in train.js.
PRESETS = {
    "Emergency, 40 wagons": "do=50:emergency",
    "Full service, 100 wagons": "train=100 wagons, G&do=50:full service",
    "The train parts": "do=50:part",
    "Drive down a hill": f"train={HILL}&speed=40&place=700&do=50:traction:60,1000:traction:0,1600:dynamic_brake:60,"
    "2200:dynamic_brake:100,3000:first step,4500:full service",
}
#: Around the data of a page (frame.html.jinja).
BEFORE, BEHIND = '<script id="data" type="application/json">', "</script>"


@lru_cache
def trains() -> dict[str, CarriedTrain]:
    """Return the trains of every page by name."""
    places = np.array(list(GRADIENTS), float)
    level = np.zeros(places.size)
    line = Line({"distance": places, "curvature": level, "cant": level, "gradient": np.array([*GRADIENTS.values()])})
    hill = CarriedTrain(HILL, consist_of([LOCOMOTIVE, {"kind": "wagon", "count": 20}]), line, LIMITS)
    blocks = {name: CarriedTrain(name, block_train(count, position=at)) for name, (count, at) in BLOCKS.items()}
    return {**blocks, HILL: hill}


def _about(array: Array) -> dict[str, Any]:
    """Return what the page needs of an input or output."""
    limits = {"least": array.least, "most": array.most} if np.isfinite(array.most) else {}
    about = {"name": array.name, "of": array.of, "whole": array.whole, "text": array.text, "choices": array.choices}
    return about | limits


@lru_cache
def train_page() -> str:
    """Return its text, a few hundred kilobytes; it needs no network. Raises CompilerError."""
    data = {
        "version": __version__,
        "module": packed(web_library(sources()).read_bytes()),
        "inputs": [_about(array) for array in INPUTS],
        "outputs": [output.name for output in OUTPUTS],
        "layout": [[group.name, group.of, [field.name for field in group.fields]] for group in layout()],
        "mark": layout_mark(),
        "equipment": {name: one.above for name, one in EQUIPMENT.items()},
        "notches": notches_shown(drivers_valve()),
        "valveKeys": VALVE_KEYS,
        "controls": {name: asdict(one) for name, one in CONTROLS.items()},
        "presets": [{"title": title, "link": link} for title, link in PRESETS.items()],
        "consists": {name: train.packed() for name, train in trains().items()},
        "own": "",
    }
    return filled("train.html.jinja", data=data)


def with_train(page: str, own: CarriedTrain) -> str:
    """Return a page that also carries a user's train, which it opens with."""
    from jinja2.utils import htmlsafe_json_dumps

    head, _, rest = page.partition(BEFORE)
    text, _, end = rest.partition(BEHIND)
    data = json.loads(text)
    others = {name: consist for name, consist in data["consists"].items() if name != own.name}
    data |= {"own": own.name, "consists": {own.name: own.packed(), **others}}
    return f"{head}{BEFORE}{htmlsafe_json_dumps(data, separators=(',', ':'))}{BEHIND}{end}"


def write_train_page(path: Path, own: CarriedTrain | None = None) -> Path:
    """Write the page, with a user's train if there is one. Raises CompilerError, OSError, ValueError."""
    write_made(path, PAGE, train_page)
    if own:
        write_whole(path, with_train(path.read_text(encoding="utf-8"), own).encode())
    return path
