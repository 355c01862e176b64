"""Couplers pull along the track where they are: in a curve they push a vehicle outwards when they are compressed."""

from __future__ import annotations

import pytest

from scenarios.bench.pushed_in_a_curve import on_paper, pushed

#: Of the closed form, whose next term is (a / R)^2 / 2; and force [N].
BAND, FORCE = 2e-3, 100e3


def test_rails_hold_what_compressed_couplers_push_outwards() -> None:
    """2 F a / R: to the left, as the curve goes to the left; pulled, the other way."""
    free = pushed(0.0)
    for compression in (FORCE, -FORCE):
        more = pushed(compression).force - free.force
        assert more == pytest.approx(on_paper(compression), rel=BAND)
    assert pushed(FORCE).quotient > free.quotient
