"""The wheelset of chapter 4 hunting at constant speed: the case of section 4.4, and the results of the thesis."""

from collections.abc import Sequence

import numpy as np

from bogie_braking.reporting.report import rounding
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from fmu_src.system import System
from products.kernel_runs import period, play, prepare
from rbd_model.linear import Mode, oscillations
from rbd_model.vehicle.parameters import AS_PRINTED

#: The disturbance: a short lateral wave of the track. The thesis does not report its size.
WAVE = {"lateral_irregularity": 4e-3, "lateral_wave_number": 0.2}
INTERVAL = 5e-3
#: Time window after the disturbance, while the amplitude is still well above its final value [s].
MEASURED = (3.0, 20.0)
#: Results of the thesis and of VAMPIRE, and their rounding: wavelength at 15 m/s [m], frequency at 25 m/s [Hz].
WAVELENGTH, WAVELENGTH_BAND = (13.25, 14.0), rounding("13.25")
FREQUENCY, FREQUENCY_BAND = (1.89, 1.79), rounding("1.89")
#: Search range of the critical speed [m/s].
RANGE = (12.0, 44.0)
#: Time until creepages have settled from the start with pure rolling [s].
SETTLED = 1.0
RECORDED = ("lateral_1", "frame_lateral", "distance")


def hunt(
    speed: float, duration: float, record: Sequence[str] = RECORDED, /, **values: float
) -> tuple[Kernel, Recording]:
    """Run disturbed at a constant speed [m/s], in the thesis's interpretation; return the final kernel and the
    recording.
    """
    kernel = prepare("wheelset", initial_speed=speed, constant_speed=1, **AS_PRINTED | WAVE | values)
    return kernel, play("wheelset", kernel, duration, INTERVAL, record, {})


def hunting_period(series: Recording) -> float | None:
    chosen = (series["time"] > MEASURED[0]) & (series["time"] < MEASURED[1])
    return period(series["time"][chosen], series["lateral_1"][chosen])


def modes_at(system: System, speed: float, half_spacing: float) -> list[Mode]:
    """Return the oscillations of the wheelset about its steady run."""
    springs = {"longitudinal_half_spacing": half_spacing, "vertical_half_spacing": half_spacing}
    kernel = prepare("wheelset", initial_speed=speed, constant_speed=1, **springs)
    kernel.advance(SETTLED)
    return oscillations(system, np.array(kernel.linearise().jacobian))


def growth_by_eigenvalue(system: System, speed: float, half_spacing: float) -> float:
    """Return the growth of the least damped oscillation [1/s]."""
    return max(mode.growth for mode in modes_at(system, speed, half_spacing))
