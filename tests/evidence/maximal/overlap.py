"""Compute how a wheel bears on its rail from the overlap of both bodies: one stored energy for a contact of any shape.

Each place on the wheel's profile has a gap, its least distance from the rail. Ridges separate contacts. In each contact
the gap g is replaced by a parabola B x^2 with the same overlap. With a plane at the level c above the rail,

    F(c) = integral of (c - g)^2 over g < c,    effective depth d_e = 2.5 F / F',    B = (16 d_e^2.5 / (15 F))^2,

Hertz' force on the parabolas of DEPTHS is integrated over the level. At d_e = LIGHT and at d_e = USUAL the contact has
the parabola whose energy U and force N are those of this course: it is 2.5 U / N deep. Both energies, blended by the
approach of the first one, are differentiated by displacements of the wheelset.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from tests.evidence.maximal.hertz import load_of
from tests.evidence.maximal.motion import Moving
from tests.evidence.maximal.rails import Rails, Surface
from tests.evidence.maximal.touch import (
    DIFFERENCE,
    MARGIN,
    NEAR,
    PITCH,
    REACH,
    STENCIL,
    TURN_PITCH,
    Wheel,
    axle_axes,
    gradient,
    paraboloid,
)

#: Effective depths at which the parabola is found [m], and least height of a ridge between two contacts [m].
LIGHT, USUAL, RIDGE = 15e-6, 60e-6, 30e-6
#: Effective depths over which the force is integrated [m].
DEPTHS = 5e-6, 10e-6, LIGHT, 25e-6, 40e-6, USUAL
#: Half range of the angles about the axle of the parabola that gives the least distance [rad], and rounds of it.
SPREAD, ROUNDS = 5e-3, 3
#: Half breadth about the lowest place that is searched, and height above it up to which places are searched [m].
WIDEST, DEEPEST = 15e-3, 0.3e-3
#: Gap of places beyond the larger depth that are kept, as displacements may bring them into contact [m].
SPARE = 20e-6
#: Pitch of the grid to which the paraboloid is fitted that gives the curvature along the rail [m].
BEND_PITCH = 0.025e-3
#: Displacements by which energy and distances are differentiated [m], [rad]. At a fifth of it forces change by 2e-5 of
#: the largest load, at twice of it by 5e-5.
STEP = 5e-7


@dataclass(frozen=True)
class Parabola:
    """The parabola of a contact: distance of its lowest point from the rail [m], half of its second derivative [1/m].

    `level` [m]: of the plane above the lowest place. `lean`, `press`: share of each place in the overlap and in its
    square, which sum up to 1. `deep` [m], `stored` [J]: depth and energy at this level, if they are integrated.
    """

    distance: float
    curvature: float
    level: float
    lean: np.ndarray
    press: np.ndarray
    deep: float = 0.0
    stored: float = 0.0


def parabola(gap: np.ndarray, width: np.ndarray, depth: float) -> Parabola:
    """Return the parabola that has the overlap of a gap [m] at an effective depth [m]; width [m]: between places."""

    def missing(level: float) -> float:
        area, energy = overlap(level - gap, width)
        return 1.25 * energy / area - depth

    low = float(np.min(gap))
    high = low + depth
    while missing(high) < 0.0:
        high += depth
    level = float(brentq(missing, low + depth / 2, high, xtol=1e-15, rtol=1e-14))
    bend = (16 / 15 * depth**2.5 / overlap(level - gap, width)[1]) ** 2
    above, breadth = np.maximum(level - gap, 0.0), np.convolve(width, [0.5, 0.5])
    lean, press = above * breadth, above**2 * breadth
    return Parabola(level - depth, bend, level - low, lean / np.sum(lean), press / np.sum(press))


def overlap(above: np.ndarray, width: np.ndarray) -> tuple[float, float]:
    """Return the integrals of a depth that is linear between places, and of its square, where it is positive."""
    one, other = above[:-1], above[1:]
    high, low = np.maximum(one, other), np.minimum(one, other)
    steep = np.maximum(high - low, 1e-30)
    cut, inside = (high > 0.0) & (low <= 0.0), low > 0.0
    area = np.where(inside, (one + other) / 2, np.where(cut, high**2 / steep / 2, 0.0))
    square = np.where(inside, (one**2 + one * other + other**2) / 3, np.where(cut, high**3 / steep / 3, 0.0))
    return float(area @ width), float(square @ width)


@dataclass(frozen=True)
class Paths:
    """Paths on a wheel along the rail: coordinate on the profile [m], angle about the axle [rad], and `lead` [m/rad].

    A path is a contour of the wheel seen along the rail. There the coordinate changes by `lead` with the angle.
    """

    across: np.ndarray
    turned: np.ndarray
    lead: np.ndarray

    def least(self, body: Moving, wheel: Wheel, surface: Surface, spread: float = SPREAD) -> tuple[np.ndarray, Paths]:
        """Return the least distance from the rail on each path [m], and the paths from these places.

        The least distance is that of a parabola through three angles, `spread` [rad] apart.
        """
        axle = axle_axes(body, surface.along(body.position))
        turns = spread * np.array([-1.0, 0.0, 1.0])
        across, turned = self.across[:, None] + self.lead[:, None] * turns, self.turned[:, None] + turns
        across = np.clip(across, *wheel.profile.limits)
        gap = surface.distance(body.position + wheel.points(across, turned, axle))
        first, second = (gap[:, 2] - gap[:, 0]) / 2, gap[:, 2] - 2 * gap[:, 1] + gap[:, 0]
        turn = -spread * first / second
        return gap[:, 1] - first**2 / (2 * second), replace(
            self, across=self.across + self.lead * turn, turned=self.turned + turn
        )

    def from_centre(self, body: Moving, wheel: Wheel, surface: Surface) -> np.ndarray:
        """Return the places, from the wheelset's centre [m]."""
        return wheel.points(self.across, self.turned, axle_axes(body, surface.along(body.position)))

    def part(self, kept: slice | np.ndarray) -> Paths:
        """Return some of the paths."""
        return Paths(self.across[kept], self.turned[kept], self.lead[kept])


@dataclass(frozen=True)
class Places:
    """Places of a wheel about a contact, each the nearest one of its path along the rail.

    `steep`: change of each distance per displacement along the contact's normal. `width` [m]: between places, across.
    """

    wheel: Wheel
    rails: Rails
    paths: Paths
    steep: np.ndarray
    width: np.ndarray

    def gap(self, body: Moving) -> np.ndarray:
        """Return the distance of each place from the rail along the contact's normal [m]."""
        return self.paths.least(body, self.wheel, self.rails(body.position))[0] / self.steep

    def parabolas(self, body: Moving, modulus: float, flatter: float) -> tuple[Parabola, Parabola]:
        """Return the parabolas at LIGHT and USUAL with the energies of their course.

        modulus [Pa]: shear modulus; flatter: factor on the curvature along the rail. The force is a power of the level
        between two depths.
        """
        gap, found = self.gap(body), []
        energy, before, press = 0.0, 0.0, 0.0
        for depth in DEPTHS:
            one = parabola(gap, self.width, depth)
            cosine, radius = self.leaning(one)
            force = load_of(depth, flatter * cosine / (2 * radius), one.curvature, modulus)
            power = math.log(force / press) / math.log(one.level / before) if energy else 1.5
            energy += (force * one.level - press * before) / (power + 1)
            before, press = one.level, force
            if depth in (LIGHT, USUAL):
                deep = 2.5 * energy / force
                found.append(replace(one, distance=one.distance + depth - deep, deep=deep, stored=energy))
        return found[0], found[1]

    def leaning(self, one: Parabola) -> tuple[float, float]:
        """Return the cosine of the wheel's mean angle, weighted with the overlap, and the mean radius [m]."""
        height, slope = (self.wheel.profile.height(self.paths.across, n) for n in (0, 1))
        upright = 1 / np.hypot(1.0, slope)
        aside, up = one.lean @ np.column_stack([slope * upright, upright])
        return float(up / np.hypot(aside, up)), float(self.wheel.radius - one.press @ height)


@dataclass(frozen=True)
class Contact:
    """One contact of a wheel, in inertial axes.

    `arm` [m]: from the wheelset's centre to the mean place, weighted with the squared overlap, at the angle about the
    axle where the wheel has the normal of the contact. `normal`: into the wheel. `along`: the rail's direction.
    `approach` [m]: of both parabolas. `curvatures` [1/m]: A along, B across, halves of those of the gap. `across` [m]:
    coordinate on the wheel's profile. `slope`: of the profile there. `stored` [J]: energy. `load` [N]: elastic normal
    force. `push`: elastic force [N] and moment about the wheelset's centre [N.m]. `parting`: change of the distance
    along the normal by displacements of the wheelset.
    """

    arm: np.ndarray
    normal: np.ndarray
    along: np.ndarray
    approach: float
    curvatures: tuple[float, float]
    across: float
    slope: float
    stored: float
    load: float
    push: np.ndarray
    parting: np.ndarray

    @property
    def on_line(self) -> np.ndarray:
        """Point on the line of action of the elastic force that is nearest to `arm` [m]."""
        force, moment = self.push[:3], self.push[3:] - np.cross(self.arm, self.push[:3])
        return self.arm + np.cross(force, moment) / (force @ force) if self.load > 0.0 else self.arm


def contacts(
    body: Moving, wheel: Wheel, rails: Rails, grid: float, modulus: float, square: bool = False, step: float = STEP
) -> list[Contact]:
    """Return the loaded contacts of a wheel, from the field side on.

    grid [m]: pitch of the places across. modulus [Pa]: shear modulus. square: use the curvature along the rail of a
    wheel that is square to it.
    """
    parts = basins(body, wheel, rails)
    found = [bear(body, places_of(body, wheel, rails, grid, *part), modulus, square, step) for part in parts]
    return [one for one in found if one.load > 0.0]


def part_of(
    body: Moving, wheel: Wheel, rails: Rails, grid: float, modulus: float, part: tuple[float, float]
) -> Contact:
    """Return the contact of a part between two places on the profile [m], loaded or not."""
    across = np.arange(*part, PITCH)
    gap, _ = Paths(across, 0 * across, 0 * across).least(body, wheel, rails(body.position), REACH / 2)
    places = places_of(body, wheel, rails, grid, float(across[np.argmin(gap)]), *part)
    return bear(body, places, modulus, square=True, step=STEP)


def basins(body: Moving, wheel: Wheel, rails: Rails) -> Iterator[tuple[float, float, float]]:
    """Yield lowest place and ends of each part of a profile that ridges separate and that may bear [m].

    A ridge is measured above the mean of the lowest gaps on both of its sides: this is its height where a shift makes
    both gaps equal.
    """
    low, high = wheel.profile.limits
    across, turned = np.arange(low + MARGIN, high - MARGIN, PITCH), np.arange(-REACH, REACH, TURN_PITCH)
    surface = rails(body.position)
    axle = axle_axes(body, surface.along(body.position))
    grid = np.meshgrid(across, turned, indexing="ij")
    rough = surface.distance(body.position + wheel.points(*grid, axle))
    gap, _ = Paths(across, turned[np.argmin(rough, axis=1)], 0 * across).least(body, wheel, surface, TURN_PITCH)
    inner = np.arange(1, across.size - 1)
    lowest = inner[(gap[inner] < gap[inner - 1]) & (gap[inner] <= gap[inner + 1]) & (np.abs(gap[inner]) < NEAR)]
    groups: list[tuple[int, int]] = []  # lowest place, and where the part begins
    for one in lowest[::-1]:
        if not groups:
            groups.append((one, across.size - 1))
            continue
        before, begins = groups[-1]
        top = one + int(np.argmax(gap[one:before]))
        if gap[top] - (gap[one] + gap[before]) / 2 >= RIDGE:
            groups.append((one, top))
        elif gap[one] < gap[before]:
            groups[-1] = one, begins
    ends = [*(begins for _, begins in groups[1:]), 0]
    for (one, begins), end in zip(groups, ends, strict=False):
        if gap[one] < USUAL:
            yield float(across[one]), float(across[end]), float(across[begins])


def places_of(
    body: Moving, wheel: Wheel, rails: Rails, grid: float, lowest: float, first: float, last: float
) -> Places:
    """Return the places of a part that may touch, at a pitch [m].

    The normal of the contact is the mean one of all places, weighted with their overlap.
    """
    surface = rails(body.position)
    deepest = Paths(np.array([lowest]), np.zeros(1), np.zeros(1))
    for spread in (REACH / 2, *[SPREAD] * ROUNDS):
        _, deepest = deepest.least(body, wheel, surface, spread)
    across = np.arange(first, last, grid)
    across = across[np.abs(across - lowest) < WIDEST]
    # All paths begin at one angle: on a circle about the axle the nearest place of a flange lies elsewhere.
    paths = Paths(across, np.full_like(across, deepest.turned[0]), 0 * across)
    normal = gradient(surface, body.position + deepest.from_centre(body, wheel, surface))[0]
    for _ in range(ROUNDS):
        along = surface.along(body.position + deepest.from_centre(body, wheel, surface)[0])
        tangent = np.cross(normal, along)
        tangent /= np.linalg.norm(tangent)
        paths = replace(paths, lead=lead_of(body, wheel, surface, paths, tangent))
        gap, paths = paths.least(body, wheel, surface)
        kept = gap < np.min(gap) + DEEPEST
        gap, paths = gap[kept], paths.part(kept)
        points = body.position + paths.from_centre(body, wheel, surface)
        steepest, width = gradient(surface, points), np.abs(np.diff(points @ tangent))
        normal = parabola(gap, width, USUAL).lean @ steepest
        normal /= np.linalg.norm(normal)
        steep = steepest @ normal
    gap = gap / steep
    near = np.flatnonzero(gap < parabola(gap, width, USUAL).distance + USUAL + SPARE)
    inner = slice(near[0], near[-1] + 1)
    return Places(wheel, rails, paths.part(inner), steep[inner], width[near[0] : near[-1]])


def lead_of(body: Moving, wheel: Wheel, surface: Surface, paths: Paths, tangent: np.ndarray) -> np.ndarray:
    """Return the change of the coordinate on the profile with the angle [m/rad] that keeps a place along the rail."""

    def moved(across: float, turned: float) -> np.ndarray:
        there = Paths(paths.across + across, paths.turned + turned, paths.lead)
        return np.asarray(there.from_centre(body, wheel, surface) @ tangent)

    by_turn, by_across = (moved(*way) - moved(*(-way)) for way in DIFFERENCE * np.array([[0.0, 1.0], [1.0, 0.0]]))
    return -by_turn / by_across


def bear(body: Moving, places: Places, modulus: float, square: bool, step: float) -> Contact:
    """Return the contact at these places."""
    wheel, surface = places.wheel, places.rails(body.position)
    axle, ways = axle_axes(body, surface.along(body.position)), step * np.eye(6)
    press = parabola(places.gap(body), places.width, USUAL).press
    around = float(press @ places.paths.across), float(press @ places.paths.turned)
    flatter = 1.0 if square else flattening(body, wheel, surface, axle, *around)
    both = places.parabolas(body, modulus, flatter)
    ends = [tuple(places.parabolas(body.displaced(sign * way), modulus, flatter) for sign in (1, -1)) for way in ways]
    by_place = np.array(
        [[(ahead.distance - behind.distance) / (2 * step) for ahead, behind in zip(*end, strict=True)] for end in ends]
    )
    shares = blend(-both[0].distance)
    press = shares @ [one.press for one in both]
    middle, across = press @ places.paths.from_centre(body, wheel, surface), float(press @ places.paths.across)
    # The contact has the angle of its parabola, by which the distance changes.
    upright = np.hypot(*(axle[:, [0, 2]].T @ by_place[:3])) / np.linalg.norm(by_place[:3], axis=0)
    factors = [flatter * one / places.leaning(each)[0] for one, each in zip(upright, both, strict=True)]

    def curvatures(found: tuple[Parabola, ...]) -> list[float]:
        """Return the curvatures along the rail of both parabolas [1/m]."""
        pairs = [(factor, *places.leaning(one)) for factor, one in zip(factors, found, strict=True)]
        return [factor * cosine / (2 * radius) for factor, cosine, radius in pairs]

    def energy(found: tuple[Parabola, ...]) -> float:
        stored = [one.stored * (max(-one.distance, 0.0) / one.deep) ** 2.5 for one in found]
        return float(blend(-found[0].distance) @ stored)

    push = np.array([energy(behind) - energy(ahead) for ahead, behind in ends]) / (2 * step)
    parting = by_place @ shares
    along = surface.along(body.position + middle)
    normal = parting[:3] - along * (along @ parting[:3])
    normal /= np.linalg.norm(normal)
    along = along - normal * (normal @ along)
    # The mean place lies where the wheel has this normal.
    (ahead, aside, up), lean = middle @ axle, normal @ axle
    outwards = math.hypot(ahead, up) / math.hypot(lean[0], lean[2])
    arm = axle @ [-outwards * lean[0], aside, -outwards * lean[2]]
    return Contact(
        arm,
        normal,
        along / np.linalg.norm(along),
        -float(shares @ [one.distance for one in both]),
        (float(shares @ curvatures(both)), float(shares @ [one.curvature for one in both])),
        across,
        float(wheel.profile.height(np.array(across), 1)),
        energy(both),
        float(push[:3] @ normal),
        push,
        parting,
    )


def blend(approach: float) -> np.ndarray:
    """Return the shares of both parabolas by the approach of the light one [m]."""
    share = min(max((approach - LIGHT) / (USUAL - LIGHT), 0.0), 1.0)
    usual = share**2 * (3 - 2 * share)
    return np.array([1 - usual, usual])


def flattening(body: Moving, wheel: Wheel, surface: Surface, axle: np.ndarray, across: float, turned: float) -> float:
    """Return the curvature of the gap along the rail at a place, over that of a wheel that is square to its rail."""
    one = BEND_PITCH * np.arange(-STENCIL, STENCIL + 1)
    steps = np.stack(np.meshgrid(one, one, indexing="ij"), axis=-1).reshape(-1, 2)
    points = body.position + wheel.points(across + steps[:, 0], turned + steps[:, 1] / wheel.radius, axle)
    middle = body.position + wheel.points(np.array(across), np.array(turned), axle)
    normal = gradient(surface, middle[None])[0]
    steep = float(np.linalg.norm(normal))
    normal, along = normal / steep, surface.along(middle)
    along = along - normal * (normal @ along)
    along /= np.linalg.norm(along)
    # Curvatures are those of bodies that just touch.
    apart = float(surface.distance(middle[None])[0]) / steep
    on_plane = (points - middle) @ np.column_stack([along, np.cross(normal, along)])
    bend = paraboloid(on_plane, surface.distance(points - apart * normal))[2] / steep
    height, slope = (float(wheel.profile.height(np.array(across), n)) for n in (0, 1))
    return float(bend[0, 0]) * (wheel.radius - height) * math.hypot(1.0, slope)
