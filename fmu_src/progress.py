"""Progress bars: on terminals alone, and only for runs longer than PATIENCE."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from tqdm import tqdm

#: A progress bar appears when a run takes longer than this [s].
PATIENCE = 2.0


@dataclass
class _Switch:
    """Setting of this process for all bars."""

    hidden: bool = False


_SWITCH = _Switch()


def counting(
    items: Iterable[Any] | None = None,
    text: str | None = None,
    total: float | None = None,
    unit: str = "it",
    **form: Any,
) -> tqdm:
    """Return a progress bar over items, or up to a total that `update` counts.

    The bar disappears at its end. It is disabled if standard error is a file or a pipe, and after `hide_bars`.
    """
    hidden = True if _SWITCH.hidden else None  # tqdm takes None as: only on a terminal
    return tqdm(items, text, total, delay=PATIENCE, leave=False, unit=unit, disable=hidden, **form)


def hide_bars() -> None:
    """Disable all progress bars of this process from now on."""
    _SWITCH.hidden = True


@contextmanager
def without_bars() -> Iterator[None]:
    """Disable all progress bars within the context."""
    before = _SWITCH.hidden
    hide_bars()
    try:
        yield
    finally:
        _SWITCH.hidden = before
