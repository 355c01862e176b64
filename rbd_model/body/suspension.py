"""All connections of a vehicle; springs that hold a wheelset are a part, called side by side for all wheelsets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import casadi as ca

from fmu_src.chain import Chain, Part, digest_of
from rbd_model.body.bodies import MovingBody
from rbd_model.body.connections import Load, along, connect, connect_linear, sum_of
from rbd_model.body.kinematics import Body, turned_about_axes
from rbd_model.body.loads import Loads
from rbd_model.body.relation import End
from rbd_model.track.frame import HERE, Pose
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import RigidBody, Size, Springs, Torsion, Wheelset, wheelset_name


@dataclass
class Taken:
    """What a part takes while its equations are written, values at its place with their symbols in the part.

    given: by which it is differentiated; fixed: sizes of the vehicle among them. What is a number stays one.
    """

    assembly: Assembly
    chain: Chain = field(default_factory=Chain)
    given: list[tuple[ca.SX, ca.SX]] = field(default_factory=list)
    fixed: list[tuple[ca.SX, ca.SX]] = field(default_factory=list)

    def arguments(self, values: ca.SX) -> ca.SX:
        """Symbols of values by which the part is differentiated."""
        return ca.vertcat(*[one if one.is_constant() else _added(one, self.given) for one in entries(values)])

    def constants(self, values: ca.SX) -> ca.SX:
        """Symbols of values by which it is not, or not at once: see `follow`."""
        return ca.vertcat(*[one if one.is_constant() else _added(one, self.fixed) for one in entries(values)])

    def follow(self, symbols: ca.SX, given: ca.SX, slope: ca.SX) -> None:
        """Says how constants follow arguments, slope: shape (symbols, given); numbers stay what they are."""
        changing = [n for n, one in enumerate(entries(symbols)) if not one.is_constant()]
        self.chain.follow(symbols[changing], given, ca.densify(slope[changing, :]))

    def value(self, size: Size) -> ca.SX:
        """A size of the vehicle's description."""
        return self.constants(ca.SX(self.assembly.value(size)))

    def preload(self, side: str) -> ca.SX:
        """Static vertical force of a single spring [N]."""
        return self.constants(self.assembly.preload(side))

    def both(self, which: int) -> tuple[ca.SX, ca.SX]:
        """All that is given and all that is fixed: the values (0) or their symbols (1)."""
        given, fixed = (ca.vertcat(*[pair[which] for pair in pairs]) for pairs in (self.given, self.fixed))
        return given, fixed

    def turned(self, angles: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Roll, pitch and yaw as arguments, and the axes that they turn; sines and cosines are computed once."""
        own, turns = self.arguments(angles), []
        for value, symbol in zip(entries(angles), entries(own), strict=True):
            turn = self.constants(ca.vertcat(ca.cos(value), ca.sin(value)))
            if not symbol.is_constant():
                self.chain.follow(turn, symbol, ca.vertcat(-turn[1], turn[0]))
            turns.append(turn)
        return own, turned_about_axes(*turns)


def entries(values: ca.SX) -> list[ca.SX]:
    """The numbers of a vector or matrix, column by column."""
    return ca.vertsplit(ca.vec(ca.densify(values)))


#: How deep two expressions are compared: sizes are sums of a few parameters.
DEPTH = 4


def _added(value: ca.SX, known: list[tuple[ca.SX, ca.SX]]) -> ca.SX:
    for other, symbol in known:
        if ca.is_equal(other, value, DEPTH):
            return symbol
    known.append((value, ca.SX.sym(f"taken_{len(known)}")))
    return known[-1][1]


def hold(loads: Loads, assembly: Assembly, seat: str, wheelset: str, connections: Sequence[Springs | Torsion]) -> None:
    """Adds what springs between a body and a wheelset do, (3.35), (3.36), by a part that all alike share."""
    taken, pose = Taken(assembly), loads.pose(seat, wheelset)
    inside = Loads(taken.chain, ends_in_part(taken, loads, seat, wheelset), poses_in_part(taken, loads, seat, wheelset))
    relation = inside.relation(seat, wheelset)
    effect = sum_of([connect_linear(taken, one, relation) for one in connections])
    inside.push(seat, wheelset, relation, effect)
    (on_seat,), (on_wheelset,) = inside.of[seat], inside.of[wheelset]
    own = [on_seat.force, on_seat.moment, on_wheelset.moment, inside.box(seat, wheelset).axle]
    own += [] if pose is HERE else [on_wheelset.force]
    results = ca.densify(ca.vertcat(*own))
    varying = [n for n, one in enumerate(entries(results)) if not one.is_constant()]
    values, symbols = taken.both(0), taken.both(1)
    part = part_of(assembly.system, taken.chain, symbols, results[varying])
    results[varying] = assembly.system.call(part, *values)
    force, moment, moment_there, axle, *force_there = ca.vertsplit(results, 3)
    loads.of[seat].append(Load(force, moment))
    loads.of[wheelset].append(Load(force_there[0] if force_there else -force, moment_there))
    loads.axles[seat, wheelset] = axle
    energies = [taken.chain.without_waists(one) for one in (inside.stored, inside.lost)]
    stored, lost = ca.Function("energies", symbols, energies)(*values)
    loads.stored, loads.lost = loads.stored + stored, loads.lost + lost


def is_held(upper: End, lower: End) -> bool:
    """Whether a body rests on a wheelset in space (section 5.2); in the plane there is little to compute."""
    return lower.boxed and not upper.boxed and not lower.body.angles.is_constant()


def part_of(system: Chain, chain: Chain, symbols: tuple[ca.SX, ca.SX], results: ca.SX) -> Part:
    """The part under a name that its equations give it; that of the system where it calls one like it."""
    part = Part("suspension", *symbols, results, chain)
    part = replace(part, name=f"suspension_{digest_of(part.function)}")
    return next((call.part for call in system.calls if call.part.name == part.name), part)


def ends_in_part(taken: Taken, loads: Loads, seat: str, wheelset: str) -> dict[str, End]:
    """Body and wheelset in the symbols of their part, eq. (3.1); where one track has both, by differences of places."""
    body, wheels = loads.ends[seat].body, loads.ends[wheelset].body
    places = [ca.vertcat(body.place, body.velocity), ca.vertcat(wheels.place, wheels.velocity)]
    if loads.pose(seat, wheelset) is HERE:
        places = [ca.vertcat(body.position - wheels.position, body.velocity - wheels.velocity), ca.SX(6, 1)]
    # Boxes do not turn about the axle.
    rates = [body.own_rate, ca.vertcat(wheels.own_rate[0], 0, wheels.own_rate[2])]
    ends = {}
    for name, place, rate in zip((seat, wheelset), places, rates, strict=True):
        end = loads.ends[name]
        position, velocity = ca.vertsplit(taken.arguments(place), 3)
        angles, axes = taken.turned(end.body.angles)
        own = Body(position, velocity, axes, taken.arguments(rate), angles)
        ends[name] = replace(end, body=own, centre=taken.constants(end.centre))
    return ends


def poses_in_part(taken: Taken, loads: Loads, seat: str, wheelset: str) -> dict[tuple[str, str], Pose]:
    """How they see each other's track in the symbols of their part, which follow both places on the line, (3.12)."""
    pose = loads.pose(seat, wheelset)
    if pose is HERE:
        return {(seat, wheelset): HERE, (wheelset, seat): HERE}
    tracks = [loads.ends[name].body.track for name in (seat, wheelset)]
    own = Pose.of(taken.constants(pose.vector))
    distances = taken.arguments(ca.vertcat(*[track.plan.distance for track in tracks if track.plan]))
    turning = [taken.constants(track.turning) for track in tracks]
    taken.follow(own.vector, distances, own.slope(*turning))
    return {(seat, wheelset): own, (wheelset, seat): own.back}


def end_of(assembly: Assembly, name: str, data: RigidBody | Wheelset, body: Body) -> End:
    """A body or wheelset as an end of connections, with the place of its centre at rest, eq. (3.1)."""
    height = assembly.value(data.height) if isinstance(data, RigidBody) else 0
    return End(name, body, ca.vertcat(assembly.value(data.along), 0, height), isinstance(data, Wheelset))


def loads_of(assembly: Assembly, bodies: Sequence[MovingBody], axles: Mapping[int, Body]) -> Loads:
    """Loads of all connections and of the forces from outside; axles: the wheelsets by number, eqs (3.35), (3.36)."""
    vehicle = assembly.vehicle
    ends = {moving.data.name: end_of(assembly, moving.data.name, moving.data, moving.body) for moving in bodies}
    for number, wheelset in vehicle.numbered:
        name = wheelset_name(number)
        ends[name] = end_of(assembly, name, wheelset, axles[number])
    loads = Loads(assembly.system, ends)
    for upper, lower in dict.fromkeys((one.upper, one.lower) for one in vehicle.connections):
        between = [one for one in vehicle.connections if (one.upper, one.lower) == (upper, lower)]
        linear = [one for one in between if isinstance(one, Springs | Torsion)]
        if is_held(ends[upper], ends[lower]) and linear == between:
            hold(loads, assembly, upper, lower, linear)
        else:
            relation = loads.relation(upper, lower)
            loads.push(upper, lower, relation, sum_of([connect(assembly, one, relation) for one in between]))
    for pull in vehicle.pulls:
        end = ends[pull.body]
        place = ca.vertcat(*[ca.SX(assembly.value(size)) for size in pull.place])
        force = along(pull.direction, assembly.input[pull.name])
        moment = ca.cross(place - end.centre, end.body.axes.T @ force)
        loads.of[pull.body].append(Load(force, moment))
    return loads
