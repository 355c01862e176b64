"""When people want to see that something happens, and when not."""

from functools import partialmethod

from tqdm import tqdm

#: A progress bar appears when a run takes longer than this [s].
PATIENCE = 2.0


def hide_bars() -> None:
    """No bars from now on, wherever they are made."""
    tqdm.__init__ = partialmethod(tqdm.__init__, disable=True)
