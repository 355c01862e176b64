"""This project as a program of the benchmark: a module for each question, with `answer(inputs)`."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from fmu_src import __version__

NAME = "bogie-braking"
#: Module of this package by question.
QUESTIONS = {
    "block-braked-bogie": "bogie",
    "coasting": "coasting",
    "impact-of-two-vehicles": "impact",
    "kalker-coefficients": "kalker",
    "shunting-stops": "shunting",
    "stop-by-percentage": "percentage",
    "stop-of-axles": "axles",
    "stop-on-sand": "sand",
    "stop-with-full-brakes": "full_brakes",
    "traction-curve": "traction",
    "train-stop": "train_stop",
    "wheel-on-rail": "wheel_contact",
}


def version() -> str:
    """Return the version of this package."""
    return str(__version__)


def answer(question: str, inputs: Mapping[str, Any]) -> Mapping[str, float] | None:
    """Return the answers in SI units by name, or None to a question without a module."""
    if question not in QUESTIONS:
        return None
    found: Mapping[str, float] | None = import_module(f"{__name__}.{QUESTIONS[question]}").answer(inputs)
    return found
