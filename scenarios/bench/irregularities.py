"""The bogie of chapter 5 over irregularities of the track at constant speed: the cases of section 5.3."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.kernel_runs import bogie, play, spectrum
from rbd_model.track.irregularity import section_5_3
from rbd_model.vehicle.parameters import AS_PRINTED

SPEEDS = (15.0, 25.0)
DURATION, INTERVAL = 12.0, 2e-3
#: Results of the thesis and of VAMPIRE. Largest shift of the leading wheelset at 15 m/s [mm]. Spectral peak of
#: the hunting [Hz] and largest wheel load of the leading wheelset [kN], both by speed [m/s].
LATERAL_PEAK = (9.5, 10.0)
HUNTING_PEAK = {15.0: (0.774, 0.879), 25.0: (1.45, 1.46)}
WHEEL_LOAD = {15.0: (188.0, 169.0), 25.0: (243.0, 224.0)}


@dataclass(frozen=True)
class Irregularity:
    """One of the three irregularities: parameter and amplitude [m], recorded variables, and drawn variables."""

    name: str
    summary: str
    amplitude: float
    shown: tuple[str, ...]
    title: str


LATERAL = Irregularity(
    "lateral_irregularity",
    "A lateral wave of 25 mm at 15 and 25 m/s (section 5.3.1)",
    0.025,
    ("lateral_1", "lateral_2", "frame_yaw"),
    "Lateral wave of the track (Figs 5.3-5.11)",
)
VERTICAL = Irregularity(
    "vertical_irregularity",
    "A vertical wave of 30 mm at 15 and 25 m/s (section 5.3.2)",
    0.03,
    ("bounce", "axle_load_1", "axle_load_2"),
    "Vertical wave of the track (Figs 5.12-5.17)",
)
CROSS_LEVEL = Irregularity(
    "cross_level",
    "A plateau of 20 mm cross level at 15 and 25 m/s (section 5.3.3)",
    0.02,
    ("frame_roll", "wheel_load_1_left", "wheel_load_1_right"),
    "Plateau of cross level (Figs 5.18-5.23)",
)


def travel(
    kind: Irregularity, speed: float, record: Sequence[str] = (), /, **values: float
) -> tuple[Kernel, Recording]:
    """Run over one irregularity at a constant speed, in the thesis's interpretation unless `values` change it.

    Takes speed [m/s].
    """
    read = record or ("distance", *kind.shown)
    scene = AS_PRINTED | {"constant_speed": 1, kind.name: kind.amplitude} | values
    kernel = bogie((), read, initial_speed=speed, **scene)
    return kernel, play("bogie", kernel, DURATION, INTERVAL, read, {})


def kinematic_peak(series: Recording) -> float:
    """Return the frequency of the highest spectral peak of the leading wheelset above the forced one [Hz]."""
    frequency, density = spectrum(series["time"], series["lateral_1"])
    speed = float(np.diff(series["distance"]).mean() / INTERVAL)
    forced = speed * section_5_3().lateral_wave_number / 2
    chosen = frequency > 1.4 * forced
    return float(frequency[chosen][np.argmax(density[chosen])])


def largest_wheel_load(series: Recording) -> float:
    """Return the largest load of both wheels of the leading wheelset [kN]."""
    return max(float(series[f"wheel_load_1_{side}"].max()) for side in ("left", "right")) / 1e3
