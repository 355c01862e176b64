"""All connections of a vehicle; those of two bodies are a part, which equal pairs call together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from fmu_src.chain import Chain, Part, digest_of
from fmu_src.symbols import ca
from rbd_model.body.bodies import MovingBody
from rbd_model.body.connections import STATELESS, connect, connect_stateless
from rbd_model.body.effect import Load, along, sum_of
from rbd_model.body.kinematics import Body, turned_about_axes
from rbd_model.body.loads import Loads
from rbd_model.body.relation import End
from rbd_model.track.frame import Pose, TrackFrame, here
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import RigidBody, Size, SuspensionElement, Wheelset, wheelset_name


@dataclass
class Taken:
    """Inputs of a part while its equations are written: values at its place with their symbols in the part.

    given: those by which it is differentiated; fixed: others, such as sizes of the vehicle. Numbers remain numbers.
    """

    assembly: Assembly
    chain: Chain = field(default_factory=Chain)
    given: list[tuple[ca.SX, ca.SX]] = field(default_factory=list)
    fixed: list[tuple[ca.SX, ca.SX]] = field(default_factory=list)

    def arguments(self, values: ca.SX) -> ca.SX:
        """Return symbols of values by which the part is differentiated."""
        return ca.vertcat(*[entry if entry.is_constant() else _added(entry, self.given) for entry in entries(values)])

    def constants(self, values: ca.SX) -> ca.SX:
        """Return symbols of values by which it is not differentiated, or only through `follow`."""
        return ca.vertcat(*[entry if entry.is_constant() else _added(entry, self.fixed) for entry in entries(values)])

    def follow(self, symbols: ca.SX, given: ca.SX, slope: ca.SX) -> None:
        """Declare derivatives of constants by arguments, slope: shape (symbols, given); numbers remain numbers."""
        changing = [n for n, entry in enumerate(entries(symbols)) if not entry.is_constant()]
        self.chain.follow(symbols[changing], given, ca.densify(slope[changing, :]))

    def value(self, size: Size) -> ca.SX:
        """Return a size of the vehicle's description."""
        return self.constants(ca.SX(self.assembly.value(size)))

    def preload(self, side: str) -> ca.SX:
        """Return the static vertical force of a single spring [N]."""
        return self.constants(self.assembly.preload(side))

    def both(self, which: int) -> tuple[ca.SX, ca.SX]:
        """Return all given and all fixed inputs: the values (0) or their symbols (1)."""
        given, fixed = (ca.vertcat(*[pair[which] for pair in pairs]) for pairs in (self.given, self.fixed))
        return given, fixed

    def turned(self, angles: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Return roll, pitch and yaw as arguments, and the axes that they turn; sines and cosines are computed once."""
        own, turns = self.arguments(angles), []
        for value, symbol in zip(entries(angles), entries(own), strict=True):
            turn = self.constants(ca.vertcat(ca.cos(value), ca.sin(value)))
            if not symbol.is_constant():
                self.chain.follow(turn, symbol, ca.vertcat(-turn[1], turn[0]))
            turns.append(turn)
        return own, turned_about_axes(*turns)


def entries(values: ca.SX) -> list[ca.SX]:
    """Return the numbers of a vector or matrix, column by column."""
    return ca.vertsplit(ca.vec(ca.densify(values)))


#: Depth to which two expressions are compared: sizes are sums of a few parameters.
DEPTH = 4


def _added(value: ca.SX, known: list[tuple[ca.SX, ca.SX]]) -> ca.SX:
    for other, symbol in known:
        if ca.is_equal(other, value, DEPTH):
            return symbol
    known.append((value, ca.SX.sym(f"taken_{len(known)}")))
    return known[-1][1]


def hold(loads: Loads, assembly: Assembly, upper: str, lower: str, connections: Sequence[SuspensionElement]) -> None:
    """Add the effect of connections of two bodies, (3.35), (3.36), by a part that all equal pairs share."""
    taken, pose, boxed = Taken(assembly), loads.pose(upper, lower), loads.ends[lower].boxed
    inside = Loads(taken.chain, ends_in_part(taken, loads, upper, lower), poses_in_part(taken, loads, upper, lower))
    relation = inside.relation(upper, lower)
    inside.push(
        upper, lower, relation, sum_of([connect_stateless(taken, connection, relation) for connection in connections])
    )
    (above,), (below,) = inside.of[upper], inside.of[lower]
    results = [above.force, above.moment, below.moment]
    results += [] if pose is here() else [below.force]
    results += [inside.box(upper, lower).axle] if boxed else []
    results, values = call(assembly.system, taken, ca.vertcat(*results)), taken.both(0)
    loads.of[upper].append(Load(results[0], results[1]))
    loads.of[lower].append(Load(-results[0] if pose is here() else results[3], results[2]))
    if boxed:
        loads.axles[upper, lower] = results[-1]
    energies = [taken.chain.expand(one) for one in (inside.stored, inside.lost)]
    stored, lost = ca.Function("energies", taken.both(1), energies)(*values)
    loads.stored, loads.lost = loads.stored + stored, loads.lost + lost


def call(system: Chain, taken: Taken, results: ca.SX) -> list[ca.SX]:
    """Return vectors of three as results of a part, called with the values of its symbols; numbers remain numbers.

    The part's name depends on its equations, so that all equal calls share one.
    """
    found = ca.densify(results)
    varying = [n for n, entry in enumerate(entries(found)) if not entry.is_constant()]
    part = Part("suspension", *taken.both(1), found[varying], taken.chain)
    part = replace(part, name=f"suspension_{digest_of(_all_of_it(taken, part.results))}")
    part = next((one.part for one in system.calls if one.part.name == part.name), part)
    found[varying] = system.call(part, *taken.both(0))
    return ca.vertsplit(found, 3)


def _all_of_it(taken: Taken, results: ca.SX) -> ca.Function:
    """Return a function that determines results and their slopes; to write those out takes ten times as long."""
    following = [each for one in taken.chain.following for each in (one.given, one.symbols, one.slope)]
    return ca.Function(
        "all_of_it", taken.both(1), [ca.densify(taken.chain.expand(one)) for one in (results, *following)]
    )


def in_part(loads: Loads, upper: str, lower: str, connections: Sequence[SuspensionElement]) -> bool:
    """Return true if a pair's connections are a part: at the planar level, section 5.2, a wheelset has few."""
    below = loads.ends[lower]
    simple = below.boxed and below.body.angles.is_constant() and loads.pose(upper, lower) is here()
    return not (loads.ends[upper].boxed or simple) and all(
        isinstance(connection, STATELESS) for connection in connections
    )


def ends_in_part(taken: Taken, loads: Loads, upper: str, lower: str) -> dict[str, End]:
    """Return both ends in the symbols of their part, eq. (3.1).

    On one track frame they follow from the difference of their places.
    """
    bodies = [loads.ends[name].body for name in (upper, lower)]
    places = [ca.vertcat(body.place, body.velocity) for body in bodies]
    if loads.pose(upper, lower) is here():
        places = [places[0] - places[1], ca.SX(6, 1)]
    rates = [body.own_rate for body in bodies]
    if loads.ends[lower].boxed:
        rates[1] = ca.vertcat(rates[1][0], 0, rates[1][2])  # boxes do not turn about the axle
    ends = {}
    for name, place, rate in zip((upper, lower), places, rates, strict=True):
        end = loads.ends[name]
        position, velocity = ca.vertsplit(taken.arguments(place), 3)
        angles, axes = taken.turned(end.body.angles)
        own = Body(position, velocity, axes, taken.arguments(rate), angles)
        ends[name] = replace(end, body=own, centre=taken.constants(end.centre))
    return ends


def poses_in_part(taken: Taken, loads: Loads, upper: str, lower: str) -> dict[tuple[str, str], Pose]:
    """Return relative poses of their track frames in the part's symbols, which follow both places on the line,
    (3.12).
    """
    pose = loads.pose(upper, lower)
    if pose is here():
        return {(upper, lower): here(), (lower, upper): here()}
    tracks = [loads.ends[name].body.track for name in (upper, lower)]
    own = Pose.of(taken.constants(pose.vector))
    distances = taken.arguments(ca.vertcat(*[track.plan.distance for track in tracks if track.plan]))
    turning = [taken.constants(track.turning) for track in tracks]
    taken.follow(own.vector, distances, own.slope(*turning))
    return {(upper, lower): own, (lower, upper): own.back}


def end_of(assembly: Assembly, name: str, data: RigidBody | Wheelset, body: Body) -> End:
    """Return a body or wheelset as an end of connections, with the place of its centre at rest, eq. (3.1)."""
    height = assembly.value(data.height) if isinstance(data, RigidBody) else 0
    return End(name, body, ca.vertcat(assembly.value(data.along), 0, height), isinstance(data, Wheelset))


def loads_of(assembly: Assembly, bodies: Sequence[MovingBody], axles: Mapping[int, Body]) -> Loads:
    """Return loads of all connections and external forces, (3.35), (3.36); axles: the wheelsets by number."""
    vehicle = assembly.vehicle
    ends = {moving.data.name: end_of(assembly, moving.data.name, moving.data, moving.body) for moving in bodies}
    for number, wheelset in vehicle.numbered:
        name = wheelset_name(number)
        ends[name] = end_of(assembly, name, wheelset, axles[number])
    loads = Loads(assembly.system, ends)
    for upper, lower in dict.fromkeys((connection.upper, connection.lower) for connection in vehicle.connections):
        between = [one for one in vehicle.connections if (one.upper, one.lower) == (upper, lower)]
        if in_part(loads, upper, lower, between):
            hold(loads, assembly, upper, lower, between)
        else:
            relation = loads.relation(upper, lower)
            loads.push(upper, lower, relation, sum_of([connect(assembly, one, relation) for one in between]))
    for pull in vehicle.pulls:
        end = ends[pull.body]
        place = ca.vertcat(*[ca.SX(assembly.value(size)) for size in pull.place])
        force = assembly.input[pull.name] * direction_at(place[0] - end.centre[0], pull.direction, end.body.track)
        moment = ca.cross(place - end.centre, end.body.axes.T @ force)
        loads.of[pull.body].append(Load(force, moment))
    return loads


def direction_at(ahead: ca.SX, direction: str, track: TrackFrame) -> ca.SX:
    """Return the track's direction at a distance ahead of a body [m], in the axes at the body, t + s (omega x t),
    (3.12).

    A train's couplers pull along the track where they meet: in a curve, aside.
    """
    here = along(direction, ca.SX(1))
    return here + ahead * ca.cross(track.turning, here)
