"""The systems of sections 4.2 and 5.2, and the complete vehicle that chapter 10 recommends, in numbers.

They are bodies above the wheelsets, and the suspension elements between them and down to the wheelsets. The formulation
of chapter 3 needs no other data of a vehicle. This file is independent of `rbd_model/vehicle/ready.py`, because the
reference shares no equation and no description with the fast model.
"""

from dataclasses import dataclass

import numpy as np

from rbd_model.vehicle.parameters import BogieParameters, VehicleParameters

ANGLES = ("roll", "pitch", "yaw")
DIRECTIONS = ("longitudinal", "lateral", "vertical")


@dataclass(frozen=True)
class Upper:
    """A body above the wheelsets: mass [kg], inertia (3,) [kg.m2], its centre along and above the axles [m]."""

    mass: float
    inertia: np.ndarray
    along: float
    height: float

    @property
    def centre(self) -> np.ndarray:
        """Place of the centre at rest, shape (3,) [m], from which places are measured (3.1)."""
        return np.array([self.along, 0.0, self.height])


@dataclass(frozen=True)
class Element:
    """A suspension element of (3.33), (3.34) from an upper body to another or, `on_wheelset`, to a wheelset, by number.

    place (3,) [m]: of both ends at rest; stiffness, damping (3,); load [N]: its load at rest.
    """

    upper: int
    lower: int
    on_wheelset: bool
    place: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    load: float


@dataclass(frozen=True)
class Layout:
    """Places of the wheelsets along the vehicle [m], the bodies above them, the first of which is driven, elements.

    level: the first body's longitudinal axis is held level, as in section 4.2.
    """

    wheelsets: tuple[float, ...]
    upper: tuple[Upper, ...]
    elements: tuple[Element, ...]
    level: bool


def bogie_layout(p: BogieParameters, wheelsets: int) -> Layout:
    """One wheelset under a frame (section 4.2), or the two-axle bogie (section 5.2)."""
    places = (0.0,) if wheelsets == 1 else (0.5 * p.wheel_base, -0.5 * p.wheel_base)
    frame = Upper(p.frame_mass, inertia(p, "frame"), 0.0, p.frame_height)
    load = p.frame_mass * p.gravity / (2 * wheelsets)
    elements = axle_boxes(p, places, [0] * wheelsets, load)
    return Layout(places, (frame,), tuple(elements), level=wheelsets == 1)


def vehicle_layout(p: VehicleParameters) -> Layout:
    """A car body on two bogies (chapter 10), its suspension without bump stops, anti-roll bars and bending."""
    pivots = (0.5 * p.pivot_distance, -0.5 * p.pivot_distance)
    places = tuple(pivot + side * 0.5 * p.wheel_base for pivot in pivots for side in (1, -1))
    frames = [Upper(p.frame_mass, inertia(p, "frame"), pivot, p.frame_height) for pivot in pivots]
    body = Upper(p.body_mass, inertia(p, "body"), 0.0, p.body_height)
    elements = axle_boxes(p, places, [1, 1, 2, 2], (p.frame_mass + p.body_mass / 2) * p.gravity / 4)
    stiffness, damping = law(p, "secondary_", "stiffness"), law(p, "secondary_", "damping")
    for number, pivot in enumerate(pivots, 1):
        for across in (p.secondary_half_spacing, -p.secondary_half_spacing):
            place = np.array([pivot, across, p.secondary_height])
            elements.append(Element(0, number, False, place, stiffness, damping, p.body_mass * p.gravity / 4))
    return Layout(places, (body, *frames), tuple(elements), level=False)


def axle_boxes(p: BogieParameters, places: tuple[float, ...], frames: list[int], load: float) -> list[Element]:
    """The elements of Tables 4.1 and 5.1 under frames, of each wheelset right and left; load [N]: of each."""
    stiffness, damping = law(p, "", "stiffness"), law(p, "", "damping")
    return [
        Element(frame, number, True, np.array([along, across, 0.0]), stiffness, damping, load)
        for number, (along, frame) in enumerate(zip(places, frames, strict=True))
        for across in (-p.vertical_half_spacing, p.vertical_half_spacing)
    ]


def inertia(p: BogieParameters, body: str) -> np.ndarray:
    """Moments of inertia about a body's own axes [kg.m2], shape (3,), of Tables 4.2 and 5.2."""
    return np.array([getattr(p, f"{body}_{angle}_inertia") for angle in ANGLES])


def law(p: BogieParameters, suspension: str, kind: str) -> np.ndarray:
    """Stiffness or damping in the three directions, shape (3,), of Tables 4.1 and 5.1."""
    return np.array([getattr(p, f"{suspension}{direction}_{kind}") for direction in DIRECTIONS])
