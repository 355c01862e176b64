"""Train data of ETCS from a file of either kind, found by its content."""

from __future__ import annotations

from pathlib import Path

from products.etcs_files.osrd import osrd_train_of
from products.etcs_files.train_file import EtcsTrain, train_of
from readers.documents import LARGEST, document
from readers.text import text_of


def etcs_train_in(path: Path) -> EtcsTrain | None:
    """Return the train data in a file."""
    if path.suffix.lower() != ".json":
        return None
    read = document(text_of(path, LARGEST).encode(), str(path))
    if isinstance(read, dict) and "format" in read:
        return train_of(read, str(path))
    train = osrd_train_of(read, str(path))
    return None if train is None else EtcsTrain(train, (), "etcs_brake_params of OSRD")
