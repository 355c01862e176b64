"""An explicit step above its stability limit changes the results and is reported; below it they are accurate."""

from __future__ import annotations

import numpy as np
import pytest

from evidence.numerics.thesis_step import GRID, RUNS, PrintedRun, thesis_reading

#: Below the limit: RK4 at 0.4 ms and RODAS5P at its default tolerance of 1e-6 agree to 1e-7 on the largest shift.
BELOW_BAND = 1e-6
#: Classical Runge-Kutta is of order 4; tolerance of the slope of three errors over a factor of 5.
ORDER, ORDER_BAND = 4.0, 0.1


def run_of(words: str) -> PrintedRun:
    """Return the run with a published number of this name."""
    return next(run for run in RUNS if any(words in printed.quantity for printed in run.printed))


LATERAL = run_of("lateral wave, 15 m/s: spectral peak")


@pytest.mark.study
def test_step_above_the_limit_moves_the_spectral_peak_to_the_printed_one_and_the_log_says_so() -> None:
    accurate, coarse = LATERAL.found(None), LATERAL.found(1e-3)
    assert LATERAL.limit() < 1e-3
    assert coarse.warned
    assert not accurate.warned
    printed = LATERAL.printed[0].thesis
    assert abs(coarse.values[0] - printed) < GRID
    assert abs(accurate.values[0] - printed) > 5 * GRID
    assert abs(coarse.values[1] / accurate.values[1] - 1.0) > 100 * BELOW_BAND  # far above BELOW_BAND


def test_step_below_the_limit_is_silent_and_gives_the_accurate_numbers() -> None:
    accurate, fine = LATERAL.found(None), LATERAL.found(4e-4)
    assert LATERAL.limit() > 4e-4
    assert not fine.warned
    assert fine.values == pytest.approx(accurate.values, rel=BELOW_BAND)


@pytest.mark.study
def test_error_below_the_limit_falls_with_the_fourth_power_of_the_step() -> None:
    run, steps = run_of("wheelset, 25 m/s: frequency"), (8e-4, 1e-3, 1.2e-3)
    assert max(steps) < run.limit()
    exact = run.measure(thesis_reading() | {"tolerance": 1e-12})[1][0]
    errors = [abs(run.found(step).values[0] - exact) for step in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(ORDER, abs=ORDER_BAND)
