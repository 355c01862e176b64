"""Old names: every face refuses them with the present one."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.batch import Ends
from fmu_src.kernel import Kernel
from readers.renamed import RENAMED, present_name


@pytest.mark.parametrize(
    ("old", "known", "new"),
    [
        ("contact_depth", ["contact_model"], "contact_model"),
        ("contact-depth", ["contact-model"], "contact-model"),
        ("--teeth", ["--pulses"], "--pulses"),
        ("--strength", ["--brake-ratio"], "--brake-ratio"),
        ("--depth", ["--brake-model"], "--brake-model"),
        ("train-depths", ["train-brake-models"], "train-brake-models"),
        ("--teeth", ["pulses"], None),
        ("teeth", [], None),
        ("pulses", ["pulses"], None),
    ],
)
def test_an_old_name_leads_to_the_present_one_as_it_is_spelled(old: str, known: list[str], new: str | None) -> None:
    assert present_name(old, known) == new


def test_no_present_name_is_an_old_one() -> None:
    assert not set(RENAMED) & set(RENAMED.values())


def recording() -> bb.Recording:
    """Return the recording of one row with one message."""
    return bb.Recording({"time": "s"}, [[0.0]], ["It stood."])


def test_a_result_names_the_present_attribute() -> None:
    ends = Ends({}, np.zeros(1), np.zeros(1, bool), {})
    for one, old in ((recording(), "sentences"), (ends, "said")):
        kind = type(one).__name__
        with pytest.raises(AttributeError, match=rf"^{kind} has no attribute {old}; its name is messages now\.$"):
            getattr(one, old)
        with pytest.raises(AttributeError, match=rf"^{kind} has no attribute together\.$"):
            _ = one.together  # type: ignore[attr-defined]
        assert not hasattr(one, "nothing")


def test_results_are_copied_and_pickled() -> None:
    one = recording()
    for again in (copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert (again.messages, again.names) == (["It stood."], ["time"])


def test_a_kernel_names_the_present_attribute() -> None:
    """`fmu_src/kernel.py` travels inside FMUs without the table of old names."""
    with pytest.raises(
        AttributeError, match=rf"^Kernel has no attribute journal; its name is {RENAMED['journal']} now"
    ):
        _ = Kernel.__new__(Kernel).journal
