"""A level wheelset on its track over the shift: contacts, radius difference, equivalent conicity (EN 15302)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.geometry import (
    ContactAtShift,
    Sides,
    centred_shift,
    contact_at,
    equivalent_conicity,
    flange_contact_shift,
)

#: Shifts of the tables, to the left, and amplitudes at which annex E of EN 15302 gives the conicity [m].
FILE_SHIFTS = np.linspace(-8.0e-3, 8.0e-3, 161)
FILE_AMPLITUDES = np.linspace(1.0e-3, 7.5e-3, 66)
#: Amplitudes in the printed table [m]; limits are set for 3 mm.
PRINTED = (1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3)
#: Amplitude at which the conicity is compared; the thesis's waves are of a few millimetres [m].
COMPARED = 3.0e-3
WORDS = ("left", "right")


@dataclass(frozen=True)
class Running:
    """Contact of a pair over the shift.

    `centre`: shift of equal rolling radii [m], with the contact `centred`. `flanges`: shifts to the left and to the
    right at flange contact [m]. `series`: contacts over the shift. `conicity`: over the amplitude.
    """

    sides: Sides
    centre: float
    centred: ContactAtShift
    flanges: tuple[float, float]
    series: Recording
    conicity: Recording

    def conicity_at(self, amplitude: float) -> float:
        """Return the equivalent conicity at an amplitude [m]."""
        return float(np.interp(amplitude, self.conicity["amplitude"], self.conicity["equivalent_conicity"]))

    def notes_at(self, amplitude: float) -> list[str]:
        """Return notes on the conicity at an amplitude [m]."""
        return [note for note in (self._flange_within(amplitude), self._unguided_at(amplitude)) if note]

    def _flange_within(self, amplitude: float) -> str:
        """Return a note if a flange touches within an amplitude [m] of the centre, or an empty string."""
        rooms = self.flanges[0] - self.centre, self.flanges[1] + self.centre
        room, word = min(zip(rooms, WORDS, strict=True))
        if room >= amplitude:
            return ""
        return f"with contact of the {word} flange, which begins at an amplitude of {1e3 * room:.3g} mm"

    def _unguided_at(self, amplitude: float) -> str:
        """Return a note if the conicity at an amplitude [m] is not above 0, or an empty string."""
        conicity = self.conicity_at(amplitude)
        if conicity > 0.0:
            return ""
        moves = "drive the wheelset outwards" if conicity < 0.0 else "do not guide the wheelset"
        return f"not above 0, the profiles {moves}; the value is that of annex C of EN 15302, as annex B has none"


def running_of(
    sides: Sides, shifts: NDArray[np.float64] = FILE_SHIFTS, amplitudes: NDArray[np.float64] = FILE_AMPLITUDES
) -> Running:
    """Return the contact of a level wheelset over shifts and amplitudes [m]."""
    centre = centred_shift(sides, rolls=False)
    conicity = Recording({"amplitude": "m"}, [[amplitude] for amplitude in amplitudes])
    conicity.add("equivalent_conicity", "1", equivalent_conicity(sides, amplitudes, rolls=False))
    contacts = [contact_at(sides, shift, rolls=False) for shift in shifts]
    series = Recording({"shift": "m"}, [[shift] for shift in shifts])
    add_contacts(series, contacts)
    series.add("radius_difference", "m", np.array([contact.radius_difference for contact in contacts]))
    for one, word, sign in ((sides.left, "left", 1), (sides.right, "right", -1)):
        beside = one.wheel_half_distance - one.rail_half_distance + sign * shifts
        series.add(f"position_on_rail_{word}", "m", series[f"position_on_wheel_{word}"] + beside)
    flanges = flange_contact_shift(sides, rolls=False), flange_contact_shift(sides.mirrored, rolls=False)
    return Running(sides, centre, contact_at(sides, centre, rolls=False), flanges, series, conicity)


def add_contacts(series: Recording, contacts: Sequence[ContactAtShift]) -> None:
    """Add radii, angles and places of the contacts to a recording, a column for each side."""
    for side, name in enumerate(WORDS):
        series.add(f"rolling_radius_{name}", "m", np.array([c.radius[side] for c in contacts]))
        series.add(f"contact_angle_{name}", "rad", np.array([c.angle[side] for c in contacts]))
        series.add(f"position_on_wheel_{name}", "m", np.array([c.position[side] for c in contacts]))
