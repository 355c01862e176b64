"""Where a wheelset starts: how far its contacts give way under the static load, at contact models 2 and 3.

One contact of the centred wheelset has a closed form. On a contact table a wheel may bear on several patches, and on
others beside the centre. There the height at which all its patches carry the static load is found by Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

from fmu_src.chain import Chain, Each, Part
from fmu_src.symbols import ca
from rbd_model.body.bodies import at_start
from rbd_model.body.kinematics import direction_cosines
from rbd_model.contact.creep.kalker import smooth_kalker_coefficients
from rbd_model.contact.depth import Contact
from rbd_model.contact.elastic import elastic_force
from rbd_model.contact.hertz import moving_ellipse
from rbd_model.vehicle.assembly import Assembly
from rbd_model.wheelset.in_space import OnTrack
from rbd_model.wheelset.pressing_patch import PatchConstants, PatchState, TurningTrack, WheelPress
from rbd_model.wheelset.profiles_of import ProfilesOf, SideOf
from rbd_model.wheelset.touch import SIDES, Wheel
from rbd_model.wheelset.touching_patch import TouchingPatch, touching_patch
from rbd_model.wheelset.wheel_on_record import FLANGES, TREADS, wheel_on_record

#: Approach at which a contact's stiffness is evaluated [m]; its value does not matter.
UNIT_APPROACH = 1e-3
#: Error of a wheel's load up to which the closed form is kept, and that of the solution [1].
KEPT_ERROR, LOAD_ERROR = 0.005, 1e-6
#: Most rounds of Newton's method for the height of a wheel, largest step down in a round, and largest lift [m]. Loads
#: grow faster than approaches, so that steps up do not pass the solution. A wheel does not rise on its flange.
ROUNDS, LARGEST_FALL, LARGEST_LIFT = 8, 0.1e-3, 0.2e-3
#: Times that both wheels are lifted at the start: a tilt moves their patches sideways, on a slope up or down.
TILTS = 3
#: Rows of a `PatchState`.
STATE = PatchState.length()


def sinking(assembly: Assembly, number: int, profiles: ProfilesOf) -> ca.SX:
    """Return the approach of a centred wheelset and its rails under the static load [m]: Hertz, Johnson (1985)."""
    data, load = assembly.vehicle.wheelsets[number - 1], static_load(assembly, number)
    modulus, nu = assembly.parameter["shear_modulus"], assembly.contact.poisson_ratio
    wheels = zip(profiles.sides, data.radius, strict=True)
    left, right = (sinking_of_wheel(one, assembly.value(radius), load, modulus, nu) for one, radius in wheels)
    sunk = (left + right) / 2
    if profiles.sides[0].record is None:
        return sunk
    place = ca.SX(0), assembly.radius(data) + profiles.lift - sunk, ca.SX(0), profiles.stand(ca.SX(0))[1]
    lifts = [rest_of_wheel(assembly, number, index, side, place) for index, side in enumerate(profiles.sides)]
    return sunk - sum(lifts) / 2


def static_load(assembly: Assembly, number: int) -> ca.SX:
    """Return the load of each wheel of a wheelset at rest on level track [N] (section 4.3), in parameters alone."""
    data, system = assembly.vehicle.wheelsets[number - 1], assembly.system
    carried = assembly.resting_on(number)
    known = ca.vertcat(*system.derived_symbols.values()), ca.vertcat(*system.derived_expressions.values())
    carried = ca.substitute(carried, *known)
    return (carried + assembly.value(data.mass) * assembly.parameter["gravity"]) / 2


def sinking_of_wheel(side_of: SideOf, radius: ca.SX, load: ca.SX, modulus: ca.SX, poisson_ratio: float) -> ca.SX:
    """Return the approach of a wheel in contact where a centred wheelset stands [m], by Hertz, Johnson (1985).

    The load is carried by the normal force and, on a cone, by the lateral creep force of spin (3.99). For a rolling
    wheel the two are proportional.
    """
    depth, slope, curvature = side_of.shape
    secant, rolling = ca.sqrt(1 + slope**2), radius - depth
    shape = 1 / (2 * rolling * secant), ca.SX(curvature)
    logarithm, semi_axis = moving_ellipse(*shape, ca.SX(1.0), modulus, poisson_ratio)
    of_spin = (
        modulus * smooth_kalker_coefficients(logarithm, poisson_ratio).c23 * semi_axis**3 * slope / (secant * rolling)
    )
    normal = load * secant / (1 + of_spin * slope)
    stiffness = elastic_force(ca.SX(UNIT_APPROACH), *shape, modulus, poisson_ratio) / UNIT_APPROACH**1.5
    return secant * (normal / stiffness) ** (2 / 3)


def rest_of_wheel(assembly: Assembly, number: int, index: int, side_of: SideOf, place: Sequence[ca.SX]) -> ca.SX:
    """Return how far the wheel `index` (0: left) must rise to carry its static load [m] where a wheelset is centred.

    Section 4.3. place: lateral displacement, height over the rails [m], yaw and roll.
    """
    data, modulus = assembly.vehicle.wheelsets[number - 1], assembly.parameter["shear_modulus"]
    assert side_of.record is not None
    distances = ca.SX(side_of.wheel_half_distance), ca.SX(side_of.rail_half_distance)
    wheel = Wheel(ca.SX(list(SIDES)[index]), assembly.value(data.radius[index]), *distances)
    given = ca.vertcat(*place, direction_cosines(*place[2:]), wheel.vector, modulus, side_of.record)
    load = static_load(assembly, number)
    return assembly.system.call(lift_of_wheel_at_rest(assembly.contact), ca.SX(0, 1), ca.vertcat(given, load))


@lru_cache
def lift_of_wheel_at_rest(contact: Contact) -> Part:
    """Return the part for the lift of `lift_until_static` from constants of `load_on_patch`, and the load, (3.82)."""
    given, chain = ca.SX.sym("given", 15), Chain()

    def press(lift: ca.SX, when: ca.SX) -> tuple[ca.SX, ca.SX]:
        load = chain.call(load_on_wheel(contact.poisson_ratio), lift, given[:14], when=when)
        return load, chain.calls[-1].slope

    return Part(
        f"lift_at_rest_{_word(contact.poisson_ratio)}", ca.SX(0, 1), given, lift_until_static(given[14], press), chain
    )


@lru_cache
def lift_of_wheel_at_start(contact: Contact, on_line: bool) -> Part:
    """Return the part for the lift of `lift_until_static` from arguments and constants of `wheel_on_record`, and load.

    Equations (3.77)-(3.105). The wheelset rolls on straight rails, without the speeds across them that damp a contact.
    """
    wheel, chain = wheel_on_record(contact, on_line), Chain()
    counts = wheel.arguments.numel(), wheel.constants.numel()
    given = ca.SX.sym("given", sum(counts) + 1)
    own, constants, load = ca.vertsplit(given, [0, counts[0], sum(counts), sum(counts) + 1])
    state, zero = PatchState.of(own[:STATE]), ca.SX(0)
    state = replace(state, sideways=zero, rise=zero, roll_rate=zero, yaw_rate=zero, slopes=ca.SX.zeros(2))
    track = TurningTrack.straight().vector if on_line else ca.SX(0, 1)
    fixed = PatchConstants.of(constants[:-1])
    place = ca.vertcat(state.offset, state.height, state.yaw, state.roll)
    place = ca.vertcat(place, fixed.cosines, fixed.wheel, fixed.shear_modulus, constants[-1])

    def press(lift: ca.SX, when: ca.SX) -> tuple[ca.SX, ca.SX]:
        lifted = replace(state, height=state.height + lift).vector
        pressed = WheelPress.of(chain.call(wheel, ca.vertcat(lifted, track), constants, when=when))
        # The slope needs no creep forces.
        chain.call(load_on_wheel(contact.poisson_ratio), lift, place, when=when)
        return pressed.force[2], chain.calls[-1].slope

    name = f"lift_of_{wheel.name}"
    return Part(name, ca.SX(0, 1), given, lift_until_static(load, press), chain)


def lift_until_static(load: ca.SX, press: Callable[[ca.SX, ca.SX], tuple[ca.SX, ca.SX]]) -> ca.SX:
    """Return the lift at which a wheel carries a load, by Newton's method; 0 if its load is within KEPT_ERROR.

    press: calls for the vertical force on the wheel [N] and its slope by the lift [N/m]; both are 0 without a call if
    its second argument is not above 0.
    """
    lift, wrong = ca.SX(0), ca.SX(1)
    for number in range(ROUNDS):
        found, slope = press(lift, wrong)
        off = ca.fabs(found / load - 1) - (LOAD_ERROR if number else KEPT_ERROR)
        wrong = ca.fmin(wrong, off)
        step = ca.fmax((load - found) / ca.fmin(slope, -load / LARGEST_LIFT), -LARGEST_FALL)
        lift += ca.if_else(wrong > 0, step, 0)
    return ca.fmin(lift, LARGEST_LIFT)


@lru_cache
def load_on_wheel(poisson_ratio: float) -> Part:
    """Return the part for the vertical force on the patches of a wheel that rolls [N] (3.82), as `load_on_patch`."""
    lift, constants, chain = ca.SX.sym("lift"), ca.SX.sym("constants", 14), Chain()
    each = {False: Each(TREADS, always=True), True: Each(FLANGES)}
    found = [
        chain.call(load_on_patch(flange, poisson_ratio), lift, constants, each=one) for flange, one in each.items()
    ]
    return Part(f"load_on_wheel_{_word(poisson_ratio)}", lift, constants, sum(found[1:], found[0]), chain)


@lru_cache
def load_on_patch(flange: bool, poisson_ratio: float) -> Part:
    """Return the part for the vertical force on the patch in a record [N] (3.82)-(3.88), by the lift of its wheel [m].

    Constants: offset, height, yaw, roll, direction cosines, wheel, shear modulus, record. The lateral creep force is
    that of spin (3.99), as in `sinking_of_wheel`.
    """
    lift, constants, chain = ca.SX.sym("lift"), ca.SX.sym("constants", 14), Chain()
    offset, height, yaw, roll = ca.vertsplit(constants[:4])
    modulus, record = constants[12], constants[13]
    fixed = ca.vertcat(constants[4:12], modulus / (1 - poisson_ratio), record)
    given = ca.vertcat(offset, height + lift, yaw, roll)
    patch = TouchingPatch.of(chain.call(touching_patch(flange), given, fixed))
    shape = patch.curvature_along, patch.curvature_across
    slope = patch.across[0] / patch.across[1]
    logarithm, semi_axis = moving_ellipse(*shape, ca.SX(1.0), modulus, poisson_ratio)
    of_angle = smooth_kalker_coefficients(logarithm, poisson_ratio).c23 * 2 * patch.curvature_along * slope
    of_spin = modulus * semi_axis**3 * of_angle
    load = patch.push[1] + patch.load * patch.across[1] * of_spin * slope
    return Part(f"load_on_{'flange' if flange else 'tread'}_{_word(poisson_ratio)}", lift, constants, load, chain)


def _word(poisson_ratio: float) -> str:
    """Return the ratio as a part of a name."""
    return str(round(1e9 * poisson_ratio))


def stand_at_start(
    assembly: Assembly, profiles: ProfilesOf, on: OnTrack
) -> tuple[Callable[[], ca.SX] | ca.SX, Callable[[], ca.SX] | ca.SX]:
    """Return rise [m] and roll [rad] of a wheelset that starts on its treads (section 4.3), or functions for them.

    The rails are those at the start. If one rail is higher, the wheelset leans. Its wheels then move sideways over the
    rails in proportion to their distance below its centre.
    """
    lateral, left, right = ca.vertsplit(at_start(assembly.system, ca.vertcat(on.offset, on.heights)))
    leaning = (left - right) / sum(side.rail_half_distance for side in profiles.sides)
    lateral += profiles.mean_radius * leaning

    def rise() -> ca.SX:
        return profiles.stand(lateral)[0] + (left + right) / 2

    def roll() -> ca.SX:
        return profiles.stand(lateral)[1] + leaning

    if profiles.sides[0].record is None:
        return rise, roll  # the tables of positions take seconds
    return rise(), roll()


def press_at_start(
    assembly: Assembly, number: int, profiles: ProfilesOf, standing: tuple[ca.SX, ca.SX], given: Sequence[ca.SX]
) -> None:
    """Let each wheel of a wheelset rise or sink until its patches carry its static load at the start.

    Section 4.3. standing: states of rise [m] and roll [rad]; given: arguments and constants of `wheel_on_record` for
    the (left, right) wheel.
    """
    system, load = assembly.system, static_load(assembly, number)
    part = lift_of_wheel_at_start(assembly.contact, assembly.on_line)
    apart = sum(side.rail_half_distance for side in profiles.sides)
    for _ in range(TILTS):
        left, right = (system.call(part, ca.SX(0, 1), ca.vertcat(at_start(system, one), load)) for one in given)
        for state, moved in zip(standing, ((left + right) / 2, (left - right) / apart), strict=True):
            system.add_to_start(state, moved)
