"""Libraries of models for files that run them only briefly."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass

import casadi as ca
import numpy as np
import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import generate
from fmu_src.compile import cache
from fmu_src.kernel import Library
from fmu_src.records import OwnRecord
from fmu_src.states import State
from fmu_src.system import Model
from products.build_notes import is_there, noted, place_of
from products.module_files import digest_of

FLAGS = ("-O0", *compiling.FLAGS, "-DLANES_WIDEST=2")


def quick_library(model: Model) -> Library:
    """Return a library that is compiled without optimisation, for at most two lanes: for models that run briefly.

    Compiling takes a quarter of the time. More lanes give bit-identical results (tests/fmu_src/test_lanes.py). The
    cache keeps the library of a model with the same content, so that its equations are not differentiated and written
    again.
    """

    def make() -> str:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(compiling, "OPTIMISE_GENERATED", FLAGS[0])
            return place_of(compiling.library_of(generate(model), FLAGS[1:]))

    what = f"quick library of {content_of(model)}, {' '.join(FLAGS)}"
    return Library(cache() / noted(what, make, is_there, digest_of("fmu_src.compile")))


def content_of(model: Model) -> str:
    """Return a digest of all fields of a model, those of its systems included, and of every expression in them.

    Raises TypeError for a field of another kind: a function, say, whose results cannot be compared.
    """
    content = _Content()
    content.add(model)
    return hashlib.sha256("\n".join([*content.words, content.expressions.encode()]).encode()).hexdigest()


class _Content:
    """Description of an object's content, and its expressions in order, with shared nodes only once."""

    def __init__(self) -> None:
        self.words: list[str] = []
        self.expressions = ca.StringSerializer()
        #: Objects by their `id`, kept alive so that no other one gets it.
        self.seen: dict[int, tuple[int, object]] = {}

    def add(self, one: object) -> None:
        """Add the words of an object and of all that it holds."""
        if one is None or isinstance(one, (str, int, float)):
            self.words.append(repr(one))
        elif isinstance(one, (ca.SX, ca.DM, ca.Function)):
            self.words.append(type(one).__name__)
            self.expressions.pack(one)
        elif isinstance(one, np.ndarray):
            self.words.append(f"{one.dtype} {one.shape} {hashlib.sha256(one.tobytes()).hexdigest()}")
        elif isinstance(one, OwnRecord):
            self.add(one.record)
        elif id(one) in self.seen:
            self.words.append(f"as {self.seen[id(one)][0]}")
        else:
            self.seen[id(one)] = len(self.seen), one
            self._add_parts(one)

    def _add_parts(self, one: object) -> None:
        if is_dataclass(one):
            parts = [(item.name, self._value(one, item.name)) for item in fields(one)]
        elif isinstance(one, dict):
            parts = list(one.items())
        elif isinstance(one, (list, tuple)):
            parts = [("", value) for value in one]
        else:
            raise TypeError(f"A part of a model must be a number, text, expression or dataclass; got {type(one)}.")
        self.words.append(f"{type(one).__qualname__} {len(parts)}")
        for name, value in parts:
            self.words.append(repr(name))
            self.add(value)

    @staticmethod
    def _value(one: object, name: str) -> object:
        """Return the value of a field; for a start value made by a function, the result of that function."""
        return one.start if isinstance(one, State) and name == "starts" else getattr(one, name)
