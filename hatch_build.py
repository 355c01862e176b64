"""Wheels: with what `make release` has compiled inside, a wheel belongs to one platform; without, it serves all."""

import json
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CustomBuildHook(BuildHookInterface):
    """Tags a wheel with the platform that products/prebuilt/contents.json names."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called before the wheel is written."""
        contents = Path(self.root) / "products" / "prebuilt" / "contents.json"
        if contents.exists():
            build_data["tag"] = f"py3-none-{json.loads(contents.read_text(encoding='utf-8'))['platform']}"
            build_data["pure_python"] = False
