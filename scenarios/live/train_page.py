"""Writes the page on which a train brakes: the C of TrainDynamics.fmu as WebAssembly, and a few trains as numbers."""

from __future__ import annotations

import base64
import json
import zlib
from functools import lru_cache
from pathlib import Path

import numpy as np

from fmu_src import __version__
from fmu_src.compile import web_library
from products.prebuilt import prebuilt_page
from products.train.consist import block_train
from products.train.library import sources
from products.train.numbers import Settings, numbers_of
from readers.storage import write_whole
from scenarios.live.page import CANVAS, WEB

#: Trains by the name that the page shows: wagons, position.
TRAINS = {
    "40 wagons, P": (40, "P"),
    "40 wagons, G": (40, "G"),
    "10 wagons, P": (10, "P"),
    "100 wagons, G": (100, "G"),
}
PAGE, TEMPLATE = "live-train.html", "train.html"
#: Beside those of the live page; in the order in which they use each other.
SCRIPTS = ("packed.js", "desk.js", "look.js", "charts.js", "train.js", "train_view.js", "train_page.js")
#: Runs of one click: the links that the page writes, behind #. Steps are those of STEP in train.js.
PRESETS = {
    "Emergency, 40 wagons": "do=50:emergency",
    "Full service, 100 wagons": "train=100 wagons, G&do=50:full service",
    "The train parts": "do=50:part",
}


def packed(data: bytes) -> str:
    """As text that a page unpacks."""
    return base64.b64encode(zlib.compress(data, 9)).decode()


@lru_cache
def train_page() -> str:
    """Its text, a few hundred kilobytes; it needs no network. Raises CompilerError."""
    consists = {name: numbers_of(block_train(n, position=p), Settings(), None) for name, (n, p) in TRAINS.items()}
    data = {
        "version": __version__,
        "module": packed(web_library(sources()).read_bytes()),
        "presets": [{"title": title, "link": link} for title, link in PRESETS.items()],
        "consists": {name: packed(np.asarray(one, "<f8").tobytes()) for name, one in consists.items()},
    }
    parts = {
        "@STYLE@": (WEB / "page.css").read_text(encoding="utf-8"),
        "@DATA@": json.dumps(data, separators=(",", ":")).replace("</", "<\\/"),
        "@SCRIPT@": "\n".join(path.read_text(encoding="utf-8") for path in (CANVAS, *(WEB / name for name in SCRIPTS))),
    }
    whole = (WEB / TEMPLATE).read_text(encoding="utf-8")
    for mark, text in parts.items():
        whole = whole.replace(mark, text)
    return whole


def write_train_page(path: Path) -> Path:
    """Writes it. Raises CompilerError, OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    made = prebuilt_page(PAGE)
    write_whole(path, made.read_bytes() if made else train_page().encode())
    return path
