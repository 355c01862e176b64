"""Rigid statics of the complete vehicle of the FMU `vehicle`."""

from rbd_model.vehicle.parameters import VehicleParameters


def rigid_axle_loads(p: VehicleParameters, deceleration: float, torque: float, reaction: float) -> list[float]:
    """Return the axle loads [N] of a vehicle that decelerates without rocking, by statics with all moments about the
    rail.

    The pivots of the bogies transmit no moment. The force that slows the body acts at the height of the secondary
    springs. These springs, the traction rods and the primary springs deflect along axes that pitch with the frames, so
    that the masses above are displaced ahead.

    Takes deceleration [m/s2], torque [N.m].
    """
    pivot, base, radius = p.pivot_distance / 2, p.wheel_base / 2, p.wheel_radius
    spring, body = p.secondary_height + radius, p.body_height + radius
    inertial = p.body_mass * deceleration
    moved = inertial * (body - spring) / (2 * pivot)
    moment = inertial / 2 * spring + p.frame_mass * deceleration * (p.frame_height + radius)
    moment += 2 * p.wheelset_mass * deceleration * radius + 2 * p.wheelset_pitch_inertia * deceleration / radius
    moment -= 2 * (1 - reaction) * torque
    along = 2 * p.secondary_longitudinal_stiffness + p.traction_rod_stiffness
    loads = []
    for sign in (1, -1):
        carried, frame = p.body_mass * p.gravity / 2 + sign * moved, p.frame_mass * p.gravity
        tipping = moment
        for _ in range(4):  # deflections increase the forces that cause them
            pitch = tipping / (p.vertical_stiffness * p.wheel_base**2)
            ahead = (inertial / 2 + carried * pitch) / along
            pushing = inertial / 2 + p.frame_mass * deceleration + (carried + frame) * pitch
            frame_ahead = pushing / (4 * p.longitudinal_stiffness)
            tipping = moment + carried * (ahead + frame_ahead + pitch * p.secondary_height)
            tipping += frame * (frame_ahead + pitch * p.frame_height)
        axle = p.body_mass * p.gravity / 4 + sign * moved / 2 + (p.frame_mass / 2 + p.wheelset_mass) * p.gravity
        loads += [axle + tipping / (2 * base), axle - tipping / (2 * base)]
    return loads
