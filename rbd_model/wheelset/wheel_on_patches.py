"""A wheel on the patches of its profile, as one part: their nearest points to the rail, and their total effect."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Bundle, Chain, Part, rows
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.wheelset.pressing_patch import PatchConstants, PatchState, Press, TurningTrack, pressing_patch
from rbd_model.wheelset.touch import Placement, Wheel, follow_cosines
from rbd_model.wheelset.touching_patch import Nearest, PatchTables, find_nearest

#: Largest distance from the rail at which a patch is evaluated [m]: above the error of its nearest point without yaw.
NEAR = 0.5e-3


@dataclass(frozen=True)
class WheelPress(Bundle):
    """Effect of all patches of a wheel on its wheelset, sums of a `Press`."""

    force: ca.SX = rows(3)  # in the axes of the track [N]
    moment: ca.SX = rows(3)  # in the wheelset's own [N.m]
    creep_along: ca.SX = rows(1)  # creep forces along the rail [N]
    creep_power: ca.SX = rows(1)  # what all creep forces take [W]
    damping_power: ca.SX = rows(1)  # what the contacts lose as they are pressed [W]
    stored: ca.SX = rows(1)  # their energy [J]
    flange_force: ca.SX = rows(1)  # of the rail on the flange, to the left [N]

    @classmethod
    def of_patches(cls, patches: Sequence[Press], flanges: Sequence[bool]) -> WheelPress:
        """flanges: true for the patches of the flange."""
        flange = [one.force[1] for one, is_flange in zip(patches, flanges, strict=True) if is_flange]

        def total(name: str) -> ca.SX:
            return sum((getattr(one, name) for one in patches[1:]), getattr(patches[0], name))

        powers = total("creep_along"), total("creep_power"), total("damping_power"), total("stored")
        return cls(total("force"), total("moment"), *powers, flange_force=sum(flange, ca.SX(0)))


@dataclass(frozen=True)
class Feeling:
    """Arguments of a wheel on its rail, and its inputs that are not differentiated; without data of single patches.

    `state` has its nearest point at 0, `fixed` its direction too.
    """

    state: PatchState
    fixed: PatchConstants
    track: TurningTrack | None  # None: straight

    @property
    def given(self) -> tuple[ca.SX, ca.SX]:
        """Arguments and constants of `wheel_on_patches`."""
        return self._without_nearest, ca.vertcat(self.fixed.cosines, self.fixed.wheel, self.fixed.vector[10:])

    @property
    def _without_nearest(self) -> ca.SX:
        track = [] if self.track is None else [self.track.vector]
        return ca.vertcat(self.state.vector[:-1], *track)

    def nearest(self, chain: Chain, patch: PatchTables) -> Nearest:
        """Return the point of a patch that is nearest to the rail."""
        state, wheel = self.state, Wheel(*ca.vertsplit(self.fixed.wheel))
        return find_nearest(
            chain, patch, (Placement(state.yaw, state.roll, self.fixed.cosines, state.offset), wheel, state.height)
        )

    def press(self, chain: Chain, near: Nearest, patch: PatchTables, law: CreepLaw, when: ca.SX | float) -> Press:
        """Return the forces of a patch; when: above 0 if it may touch."""
        terms = near.pieces.wheel.numel(), near.pieces.rail.numel()
        part = pressing_patch(*terms, patch.flange, law, self.track is not None)
        fixed = replace(self.fixed, direction=ca.SX(patch.line.cosine_and_sine))
        track = [] if self.track is None else [self.track.vector]
        given = ca.vertcat(replace(self.state, nearest=near.position).vector, *track)
        return Press.of(chain.call(part, given, ca.vertcat(fixed.vector, near.pieces.vector), when))

    def each(self, chain: Chain, patches: Sequence[PatchTables], laws: Sequence[CreepLaw]) -> list[Press]:
        """Return the forces of each patch. The first, a tread, nearly always touches; the others seldom."""
        pressed = []
        for number, (patch, law) in enumerate(zip(patches, laws, strict=True)):
            near = self.nearest(chain, patch)
            pressed.append(self.press(chain, near, patch, law, near.approach + NEAR if number else 1.0))
        return pressed


@lru_cache
def wheel_on_patches(patches: tuple[PatchTables, ...], laws: tuple[CreepLaw, ...], on_line: bool) -> Part:
    """Return the part for a `WheelPress`, (3.77)-(3.105), from `Feeling.given`; laws: of creep, for each patch."""
    state, fixed, chain = PatchState.symbols("state"), PatchConstants.symbols("constants"), Chain()
    state, fixed = replace(state, nearest=ca.SX(0)), replace(fixed, direction=ca.SX.zeros(2))
    feeling = Feeling(state, fixed, TurningTrack.symbols("track") if on_line else None)
    follow_cosines(chain, fixed.cosines, ca.vertcat(state.yaw, state.roll))
    pressed = WheelPress.of_patches(feeling.each(chain, patches, laws), [patch.flange for patch in patches])
    name = hashlib.sha256(repr([patches, [law.__name__ for law in laws], on_line]).encode()).hexdigest()[:12]
    return Part(f"wheel_{name}", *feeling.given, pressed.vector, chain)
