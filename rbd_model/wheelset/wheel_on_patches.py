"""A wheel on the patches of its profile: arguments of its parts, and the total effect of the patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmu_src.chain import Bundle, rows
from rbd_model.wheelset.pressing_patch import PatchConstants, PatchState, Press, TurningTrack


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
        """Arguments and constants of `patch_of_record`, except for the record."""
        return self._without_nearest, ca.vertcat(self.fixed.cosines, self.fixed.wheel, self.fixed.vector[10:])

    @property
    def _without_nearest(self) -> ca.SX:
        track = [] if self.track is None else [self.track.vector]
        return ca.vertcat(self.state.vector[:-1], *track)
