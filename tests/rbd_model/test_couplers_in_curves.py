"""Test couplers that act along the track: compressed in a curve they push a vehicle outwards."""

from __future__ import annotations

import pytest

from scenarios.bench.pushed_in_a_curve import on_paper, pushed

#: Tolerance of the closed form, whose next term is (a / R)^2 / 2; coupler force [N].
BAND, FORCE = 2e-3, 100e3


@pytest.mark.study
def test_rails_hold_what_compressed_couplers_push_outwards() -> None:
    """2 F a / R: to the left in a curve to the left; in tension to the other side."""
    free = pushed(0.0)
    for compression in (FORCE, -FORCE):
        more = pushed(compression).force - free.force
        assert more == pytest.approx(on_paper(compression), rel=BAND)
    assert pushed(FORCE).quotient > free.quotient
