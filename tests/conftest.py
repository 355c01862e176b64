"""Compiled kernels and built FMUs, shared by all tests."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from fmu_src.kernel import Library
from products.building import KINDS, kernel_of, up_to_date
from products.registry import DIFFERENT

#: Files whose fixtures take a minute. They come first, so that no processor waits for them at the end.
SLOW_TO_BEGIN = {"test_installation.py", "test_pages_run.py"}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.path.name not in SLOW_TO_BEGIN)


@pytest.fixture(scope="session")
def bogie() -> Library:
    return Library(kernel_of("bogie"))


@pytest.fixture(scope="session")
def brake() -> Library:
    return Library(kernel_of("brake"))


class Fmus(Mapping[tuple[str, str], Path]):
    """FMUs by (name, kind), for all that differ in their equations; each is built at its first use, if necessary."""

    def __init__(self) -> None:
        self.built: dict[tuple[str, str], Path] = {}

    def __getitem__(self, key: tuple[str, str]) -> Path:
        if key not in self.built:
            self.built[key] = up_to_date(*key)
        return self.built[key]

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return iter((name, kind) for name in DIFFERENT for kind in KINDS)

    def __len__(self) -> int:
        return len(DIFFERENT) * len(KINDS)


@pytest.fixture(scope="session")
def fmus() -> Fmus:
    return Fmus()
