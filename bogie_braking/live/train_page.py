"""Write the page on which a train brakes: the C of TrainDynamics.fmu as WebAssembly, and a few trains as numbers."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from bogie_braking.live.page import write_made
from bogie_braking.web.frame import filled, packed
from fmu_src import __version__
from fmu_src.compile import web_library
from products.train.consist import block_train
from products.train.layout import INPUTS, OUTPUTS
from products.train.library import sources
from products.train.numbers import Settings, numbers_of

#: Trains by the name that the page shows: wagons, position.
TRAINS = {
    "40 wagons, P": (40, "P"),
    "40 wagons, G": (40, "G"),
    "10 wagons, P": (10, "P"),
    "100 wagons, G": (100, "G"),
}
PAGE = "live-train.html"
#: Runs of one click: the links that the page writes, after #. Steps are those of STEP in train.js.
PRESETS = {
    "Emergency, 40 wagons": "do=50:emergency",
    "Full service, 100 wagons": "train=100 wagons, G&do=50:full service",
    "The train parts": "do=50:part",
}


@lru_cache
def train_page() -> str:
    """Return its text, a few hundred kilobytes; it needs no network. Raises CompilerError."""
    consists = {name: numbers_of(block_train(n, position=p), Settings(), None) for name, (n, p) in TRAINS.items()}
    data = {
        "version": __version__,
        "module": packed(web_library(sources()).read_bytes()),
        "inputs": [input_.name for input_ in INPUTS],
        "outputs": [output.name for output in OUTPUTS],
        "presets": [{"title": title, "link": link} for title, link in PRESETS.items()],
        "consists": {name: packed(np.asarray(one, "<f8").tobytes()) for name, one in consists.items()},
    }
    return filled("train.html.jinja", data=data)


def write_train_page(path: Path) -> Path:
    """Write the page. Raises CompilerError, OSError."""
    return write_made(path, PAGE, train_page)
