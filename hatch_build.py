"""Wheels: all packages but `evidence` below one name, `bogie_braking`; imports between them are rewritten.

A wheel with the compiled files of `make release` is for one platform; without them it is for all.
"""

import json
import re
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

NAME = "bogie_braking"
#: Packages and the modules next to them in a checkout; in a wheel they are below NAME.
ROOMS = ("readers", "fmu_src", "rbd_model", "brake_controller", "products", "scenarios")
BESIDE = ("build_fmu.py",)
#: At the beginning of a line that imports from a room. Our code has no other form (tests/test_architecture.py).
IMPORTS = re.compile(rf"^(\s*from )((?:{'|'.join([*ROOMS, *(name[:-3] for name in BESIDE)])})\b)", re.MULTILINE)


def below_one_name(text: str) -> str:
    """Return a source file as in a wheel."""
    return IMPORTS.sub(rf"\1{NAME}.\2", text)


class CustomBuildHook(BuildHookInterface):
    """Fills a wheel; its tag names the platform that products/prebuilt/contents.json names."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called before a wheel is written; an editable installation has the checkout on its path instead."""
        if version == "editable":
            return
        root = Path(self.root)
        contents = root / "products" / "prebuilt" / "contents.json"
        if contents.exists():
            build_data["tag"] = f"py3-none-{json.loads(contents.read_text(encoding='utf-8'))['platform']}"
            build_data["pure_python"] = False
        self.copy = tempfile.TemporaryDirectory()
        places = {root / NAME: NAME} | {root / room: f"{NAME}/{room}" for room in ROOMS}
        for place, inside in places.items():
            for path in sorted(place.rglob("*")):
                if path.is_file() and "__pycache__" not in path.parts:
                    self.add(path, f"{inside}/{path.relative_to(place).as_posix()}", build_data)
        for name in BESIDE:
            self.add(root / name, f"{NAME}/{name}", build_data)

    def add(self, path: Path, inside: str, build_data: dict[str, Any]) -> None:
        """Add a file to the wheel, with its imports rewritten if it is Python."""
        if path.suffix == ".py":
            written = Path(self.copy.name) / inside
            written.parent.mkdir(parents=True, exist_ok=True)
            written.write_text(below_one_name(path.read_text(encoding="utf-8")), encoding="utf-8")
            path = written
        build_data["force_include"][str(path)] = inside

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Called after it is written."""
        if version != "editable":
            self.copy.cleanup()
