"""Prints the oldest versions that pyproject.toml permits, as constraints for pip; without tools of this checkout."""

import re
from pathlib import Path

import tomllib

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
TOOLS = ("test", "docs", "masters", "charts")
extras = [texts for name, texts in PROJECT["optional-dependencies"].items() if name not in TOOLS]
for text in (text for texts in (PROJECT["dependencies"], *extras) for text in texts):
    if bound := re.match(r"([\w-]+)(?:\[\w+\])?>=([\w.]+)", text):
        print(f"{bound[1]}=={bound[2]}")
