"""A vehicle as data: bodies, wheelsets, connections. It holds no symbols; a level of detail interprets it.

x points forward from the vehicle's centre, y to the left, z up from the wheelset axes. All places are those at rest. A
size is a number, the name of a parameter, or a sum of both. Therefore one description suffices for all parameter sets
of its kind.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from itertools import pairwise
from typing import Any, Literal

from fmu_src.system import ParameterRelation, ParameterSet
from rbd_model.contact.creep.kalker import checked_ratio
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.geometry import Pair, Sides, thesis_pair
from rbd_model.contact.hertz import POISSON_RATIO
from rbd_model.vehicle.force_function import ForceFunction, function_fault
from rbd_model.vehicle.force_table import both_sides, damper_fault, spring_fault
from readers.text import shown
from readers.usual import likely_unit

#: Limits of a wheel's radius [m]: scale models on roller rigs; 0.3 m above the wheels of steam locomotives, 1.2 m.
SMALLEST_RADIUS, LARGEST_RADIUS = 0.01, 1.5
#: Largest length of a vehicle [m]. The longest Schnabel cars have 70 m.
LONGEST_VEHICLE = 100.0

DIRECTIONS = ("longitudinal", "lateral", "vertical")
ANGLES = ("roll", "pitch", "yaw")
#: Motions that a body may lack: all directions except the longitudinal one, and all angles.
HOLDABLE = ("lateral", "bounce", *ANGLES)
Motion = Literal["lateral", "bounce", "roll", "pitch", "yaw"]


@dataclass(frozen=True)
class Sum:
    """A constant and parameters by name, each times a factor.

    Parameters
    ----------
    terms : tuple of tuple
        Names and factors.
    constant : float
        The constant, in the unit of the sum.
    """

    terms: tuple[tuple[str, float], ...]
    constant: float = 0.0

    def __add__(self, other: Size) -> Sum:
        other = as_sum(other)
        return Sum(self.terms + other.terms, self.constant + other.constant)

    def __mul__(self, factor: float) -> Sum:
        return Sum(tuple((name, factor * own) for name, own in self.terms), factor * self.constant)

    def __neg__(self) -> Sum:
        return self * -1.0

    def __sub__(self, other: Size) -> Sum:
        return self + -as_sum(other)


Size = float | str | Sum
Place = tuple[Size, Size, Size]


def as_sum(size: Size) -> Sum:
    """Return the same size as a `Sum`."""
    if isinstance(size, Sum):
        return size
    return Sum(((size, 1.0),)) if isinstance(size, str) else Sum((), float(size))


def size_of(size: Size, parameters: Mapping[str, Any]) -> Any:
    """Return a size, computed from the values or symbols of the parameters that it names."""
    if isinstance(size, str):
        return parameters[size]
    if isinstance(size, Sum):
        parts = [parameters[name] if factor == 1.0 else factor * parameters[name] for name, factor in size.terms]
        return sum(parts, size.constant) if size.constant or not parts else sum(parts[1:], parts[0])
    return float(size)


@dataclass(frozen=True)
class RigidBody:
    """A body above the wheelsets.

    Parameters
    ----------
    name, text : str
        Name of the body in variables, and in descriptions.
    mass : Size
        Mass [kg].
    inertia : tuple of Size
        Moments of inertia about its own x, y, z [kg.m2].
    along, height : Size
        Place of its centre [m].
    held : frozenset of str
        Motions that are kept at rest without work, as the pitch of a frame in section 4.2.
    plain : tuple of str
        Motions whose variables do not begin with the body's name.
    """

    name: str
    text: str
    mass: Size
    inertia: tuple[Size, Size, Size]
    along: Size = 0.0
    height: Size = 0.0
    held: frozenset[Motion] = frozenset()
    plain: tuple[str, ...] = ()

    def variable(self, motion: str) -> str:
        """Return the name of a motion's variable.

        Parameters
        ----------
        motion : str
            One of "longitudinal", "lateral", "bounce", "roll", "pitch", "yaw".

        Returns
        -------
        str
            The name, with that of the body unless the motion is in `plain`.
        """
        return motion if motion in self.plain else f"{self.name}_{motion}"


@dataclass(frozen=True)
class Wheelset:
    """A wheelset. The vehicle numbers its wheelsets from 1, the leading one.

    Parameters
    ----------
    along : Size
        Place of its axle along the vehicle [m].
    reacts_on : str
        The body in which its brake and motor are mounted.
    mass : Size
        Mass [kg].
    inertia : tuple of Size
        Moments of inertia about x, y, z [kg.m2].
    radius : tuple of Size
        Nominal rolling radii of the left and of the right wheel [m].
    pair : Sides
        Wheel and rail on both sides.
    """

    along: Size
    reacts_on: str
    mass: Size = "wheelset_mass"
    inertia: tuple[Size, Size, Size] = ("wheelset_roll_inertia", "wheelset_pitch_inertia", "wheelset_yaw_inertia")
    radius: tuple[Size, Size] = ("wheel_radius", "wheel_radius")
    pair: Sides = field(default_factory=thesis_pair, repr=False)

    @property
    def mean_radius(self) -> Size:
        """Nominal rolling radius, the mean of both wheels [m]."""
        left, right = self.radius
        return left if left == right else (as_sum(left) + right) * 0.5

    @property
    def equal_sides(self) -> Pair:
        """The pair of wheel and rail of both sides.

        Raises
        ------
        ValueError
            If `pair` is not a `Pair`, which has the same profiles on both sides.
        """
        if not isinstance(self.pair, Pair):
            raise ValueError(
                "At contact model 1 both wheels of a wheelset have one profile, and so have both rails; give a Pair, "
                "or take contact model 2 or 3, where each side has its own."
            )
        return self.pair


def wheelset_name(number: int) -> str:
    """Return the name of a wheelset in connections."""
    return f"wheelset_{number}"


@dataclass(frozen=True)
class SuspensionElement:
    """An element between a point of one body and a point of another. At rest both points are at one place.

    Parameters
    ----------
    name : str
        Name of the element.
    upper, lower : str
        Names of its ends: bodies, or wheelset_1, wheelset_2 ... `upper` rests on `lower`.
    place : tuple of Size
        Place at rest (x, y, z) [m].
    both_sides : bool
        True for one element at y and one at -y.
    """

    name: str
    upper: str
    lower: str
    place: Place
    both_sides: bool

    def sides(self) -> Iterator[tuple[str, Place]]:
        """Yield the name and the place of each single element."""
        x, y, z = self.place
        if not self.both_sides:
            yield self.name, self.place
        else:
            yield f"{self.name}_left", (x, y, z)
            yield f"{self.name}_right", (x, -as_sum(y), z)


@dataclass(frozen=True)
class Springs(SuspensionElement):
    """Linear springs and dampers, each along one direction of the track, or of axes that are inclined to it.

    An element with a vertical stiffness carries its share of the weight that rests on it, and is not inclined.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    stiffness : tuple of Size
        Stiffness along x, y, z [N/m].
    damping : tuple of Size
        Damping along x, y, z [N.s/m].
    inclination : Size
        Pitch of these axes, positive nose down [rad]: a guiding arm that rises backwards has one above 0.
    """

    stiffness: tuple[Size, Size, Size] = (0.0, 0.0, 0.0)
    damping: tuple[Size, Size, Size] = (0.0, 0.0, 0.0)
    inclination: Size = 0.0

    @property
    def carries(self) -> bool:
        """True if it has a preload."""
        return self.stiffness[2] != 0.0

    @property
    def share(self) -> Size:
        """Stiffness by which it shares a weight with other springs [N/m]."""
        return self.stiffness[2]


@dataclass(frozen=True)
class Torsion(SuspensionElement):
    """A torsion spring and damper about one axis, such as an anti-roll bar.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    angle : str
        "roll", "pitch" or "yaw".
    stiffness : Size
        Stiffness [N.m/rad].
    damping : Size
        Damping [N.m.s/rad].
    """

    angle: str = "roll"
    stiffness: Size = 0.0
    damping: Size = 0.0


@dataclass(frozen=True)
class TableSpring(SuspensionElement):
    """A force over the travel along one direction: straight lines through points, such as a progressive spring.

    The travel is that of the upper end less the lower one: compression of a vertical spring is below 0. Points from 0
    on apply to both senses, with opposite signs of travel and force. Beyond the ends the last slopes continue. A
    vertical spring without clearance carries its share of the weight that rests on it, and rests at this point of its
    table. Springs share by the mean slopes of their tables under compression.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    direction : str
        "longitudinal", "lateral" or "vertical".
    travel : tuple of float
        Increasing travels [m]. If the first is above 0, it is the clearance.
    force : tuple of float
        Forces [N] there, which do not fall: 0 at the travel 0, or at the clearance.
    """

    direction: str = "vertical"
    travel: tuple[float, ...] = ()
    force: tuple[float, ...] = ()

    @property
    def carries(self) -> bool:
        """True if it has a preload: it is vertical, and pushes as soon as it is compressed."""
        below = self.under_load[1]
        return self.direction == "vertical" and len(below) > 1 and below[-2] < 0.0

    @property
    def under_load(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Its points at compression, from the largest one to 0: travels [m] and forces [N]."""
        pairs = [pair for pair in zip(*both_sides(self.travel, self.force), strict=True) if pair[0] < 0.0]
        return (*(float(x) for x, _ in pairs), 0.0), (*(float(f) for _, f in pairs), 0.0)

    @property
    def share(self) -> Size:
        """Stiffness by which it shares a weight with other springs [N/m]."""
        travel, force = self.under_load
        return force[0] / travel[0]


@dataclass(frozen=True)
class BumpStop(TableSpring):
    """A `TableSpring` with a clearance, the same in both senses. It carries no weight.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    direction : str
        "longitudinal", "lateral" or "vertical".
    travel : tuple of float
        Increasing travels [m]. The first is the clearance, where the force is 0.
    force : tuple of float
        Forces [N] there. The last slope is continued beyond the end.
    """

    direction: str = "lateral"


@dataclass(frozen=True)
class TableDamper(SuspensionElement):
    """A force over the rate along one direction: straight lines through points, such as a yaw damper that saturates.

    The rate is that of the upper end less that of the lower one. Points from 0 on apply to both senses, with opposite
    signs of rate and force. Beyond the ends the last slopes continue: two last points with the same force are a limit.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    direction : str
        "longitudinal", "lateral" or "vertical".
    rate : tuple of float
        Increasing rates [m/s]. They begin at 0, or include both senses.
    force : tuple of float
        Forces [N] there, with the sign of the rate; 0 at the rate 0. The last ones do not fall.
    """

    direction: str = "longitudinal"
    rate: tuple[float, ...] = ()
    force: tuple[float, ...] = ()


@dataclass(frozen=True)
class ForceLaw(SuspensionElement):
    """A force as a function of travel and rate along one direction, such as a damper that saturates smoothly.

    Travel and rate are those of the upper end less the lower one, from rest. It carries no weight. Its part by the
    travel alone stores energy; the rest must take power, as it is checked at values of its own parameters.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    direction : str
        "longitudinal", "lateral" or "vertical".
    force : callable
        Function of travel [m], rate [m/s] and the sizes, which are CasADi symbols. It returns the force [N], with the
        sign of the travel for a spring and of the rate for a damper; 0 at rest, without jumps.
    sizes : tuple of Size
        Further arguments of the function.

    Raises
    ------
    ValueError
        If the function does not return one CasADi expression.
    """

    direction: str = "longitudinal"
    force: Callable[..., Any] | None = None
    sizes: tuple[Size, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.force, ForceFunction):
            if not callable(self.force):
                raise ValueError(f"{self.name}: force must be a function of travel and rate; got {shown(self.force)}.")
            object.__setattr__(self, "force", ForceFunction.of(self.force, len(self.sizes)))


@dataclass(frozen=True)
class SeriesDamper(SuspensionElement):
    """A spring and a damper in series, along one direction.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    direction : str
        "longitudinal", "lateral" or "vertical".
    stiffness : Size
        Stiffness [N/m].
    damping : Size
        Damping [N.s/m], above 0.
    """

    direction: str = "lateral"
    stiffness: Size = 0.0
    damping: Size = 0.0


@dataclass(frozen=True)
class FrictionSlider(SuspensionElement):
    """Dry friction along one direction, with a true stuck state: a slider in series with a spring.

    A stuck element is only this spring. A damper is parallel to the spring. A friction wedge whose own spring is
    compressed along with the suspension has a capacity that grows with the vertical compression from rest: its friction
    times the stiffness of that spring is `capacity_slope`. A capacity is never below 0.

    Parameters
    ----------
    name, upper, lower, place, both_sides
        As in `SuspensionElement`.
    direction : str
        "longitudinal", "lateral" or "vertical".
    stiffness : Size
        Stiffness of the spring [N/m].
    damping : Size
        Damping of the damper [N.s/m].
    capacity : Size
        Friction force at rest [N], such as that of a prestressed friction wedge.
    slider_mass : Size
        Mass of the slider [kg], above 0.
    capacity_slope : Size
        Increase of the friction force over the vertical compression [N/m].
    """

    direction: str = "vertical"
    stiffness: Size = 0.0
    damping: Size = 0.0
    capacity: Size = 0.0
    slider_mass: Size = 0.0
    capacity_slope: Size = 0.0


@dataclass(frozen=True)
class Pull:
    """An external force [N] on a body or wheelset, an input.

    Parameters
    ----------
    name, text : str
        Name and description of the input.
    body : str
        Name of a body, or wheelset_1, wheelset_2 ...
    place : tuple of Size
        Place at rest (x, y, z) [m].
    direction : str
        "longitudinal", "lateral" or "vertical".
    """

    name: str
    text: str
    body: str
    place: Place
    direction: str = "longitudinal"


@dataclass(frozen=True)
class Vehicle:
    """Bodies, wheelsets, and the connections between them.

    Parameters
    ----------
    name : str
        Name of the vehicle and of its FMU.
    parameters : ParameterSet
        Values of the parameters that sizes name.
    bodies : tuple of RigidBody
        The distance is measured at the first of them.
    wheelsets : tuple of Wheelset
        The leading one first.
    connections : tuple of SuspensionElement
        Elements between bodies and wheelsets.
    pulls : tuple of Pull
        External forces on bodies or wheelsets.
    creep_law : str
        A key of LAWS, for treads, or "default": Polach's law at levels 1 and 2 and in contact model 1,
        kalker-to-coulomb in contact model 2. Strips (contact model 3) have their own law and accept only "default".
    poisson_ratio : float
        Poisson's ratio of wheels and rails [1], 0 to 0.5: of Kalker's coefficients and of the contact's stiffness.
    contact_outputs : bool
        Whether creepages, creep forces, places and wear numbers of each tread and flange are outputs, at level 3 with
        contact model 2.

    Raises
    ------
    ValueError
        If the vehicle cannot be built. Examples: an end of a connection is unknown; a mass is 0; a body is not carried;
        two wheelsets are at one place; the creep law is unknown.
    """

    name: str
    parameters: ParameterSet
    bodies: tuple[RigidBody, ...]
    wheelsets: tuple[Wheelset, ...]
    connections: tuple[SuspensionElement, ...]
    pulls: tuple[Pull, ...] = ()
    creep_law: str = DEFAULT_LAW
    poisson_ratio: float = POISSON_RATIO
    contact_outputs: bool = False

    def __post_init__(self) -> None:
        check(self)

    @property
    def numbered(self) -> list[tuple[int, Wheelset]]:
        """Wheelsets with their numbers, from 1."""
        return list(enumerate(self.wheelsets, 1))

    @property
    def parts(self) -> list[RigidBody | Wheelset]:
        """Bodies and wheelsets: all parts with a mass."""
        return [*self.bodies, *self.wheelsets]

    def number(self, size: Size) -> float:
        """Return a size computed from the values of the vehicle's own parameters.

        Parameters
        ----------
        size : Size
            A number, the name of a parameter, or a sum of these.

        Returns
        -------
        float
            The size, in its unit.
        """
        return float(size_of(size, self.parameters.values()))

    @property
    def gaps(self) -> list[Sum]:
        """Clearances between the wheels of each wheelset and the next one [m].

        They overlap if a clearance is below 0.
        """
        return [
            as_sum(leading.along) - trailing.along - as_sum(leading.mean_radius) - trailing.mean_radius
            for leading, trailing in pairwise(self.wheelsets)
        ]

    @property
    def carrying(self) -> list[Springs | TableSpring]:
        """The connections that have a preload."""
        return [
            connection
            for connection in self.connections
            if isinstance(connection, Springs | TableSpring) and connection.carries
        ]


def check(vehicle: Vehicle) -> None:
    """Raise ValueError with a message if the vehicle cannot be built."""
    ends = [*(body.name for body in vehicle.bodies), *(wheelset_name(number) for number, _ in vehicle.numbered)]
    names = Counter([*ends, *(one.name for one in vehicle.connections), *(pull.name for pull in vehicle.pulls)])
    for name, count in names.items():
        if count > 1:
            raise _refused(vehicle, f"{name} is there {count} times; give each part its own name")
    if vehicle.creep_law not in (laws := [DEFAULT_LAW, *LAWS]):
        law, known = vehicle.creep_law, ", ".join(laws)
        raise _refused(vehicle, f"creep_law must be one of {known}; got {shown(law)}. Name one, or add yours to LAWS")
    checked_ratio(vehicle.poisson_ratio)
    if not isinstance(vehicle.contact_outputs, bool):
        raise _refused(vehicle, f"contact_outputs must be True or False; got {shown(vehicle.contact_outputs)}")
    if not vehicle.bodies or not vehicle.wheelsets:
        raise _refused(vehicle, "give it at least one body and one wheelset")
    for user, asked, there in _references(vehicle, ends):
        if asked not in there:
            raise _refused(vehicle, f"{user} names {asked}, which is not there; there are {', '.join(there)}")
    for part, what, size in _sizes(vehicle):
        value = _number(vehicle, part, size)
        if what in POSITIVE_SIZES and not value > 0.0:
            raise _refused(vehicle, f"{part} has a {what} of {value:g}; it must be above 0")
    for connection in vehicle.connections:
        _check_ends(vehicle, connection)
        _check_law(vehicle, connection)
    _check_radii(vehicle)
    _check_places(vehicle)
    _check_supports(vehicle)


#: Names of the mass and of the moments of inertia of a body or wheelset.
INERTIAS = ("mass", *(f"{angle} inertia" for angle in ANGLES))
#: Sizes that must be above 0, because accelerations and rates are divided by them.
POSITIVE_SIZES = (*INERTIAS, "series damping", "slider mass")


def _refused(vehicle: Vehicle, sentence: str) -> ValueError:
    return ValueError(f"Vehicle {vehicle.name}: {sentence}.")


def _number(vehicle: Vehicle, part: str, size: Size) -> float:
    try:
        return vehicle.number(size)
    except KeyError as error:
        raise _refused(vehicle, f"{part} asks for {error.args[0]}, which is no parameter of its set") from None


def _sizes(vehicle: Vehicle) -> Iterator[tuple[str, str, Size]]:
    """Yield all sizes of a description: name of the part, name of the size, and the size."""
    parts: dict[str, RigidBody | Wheelset] = {body.name: body for body in vehicle.bodies}
    parts |= {wheelset_name(number): wheelset for number, wheelset in vehicle.numbered}
    for name, part in parts.items():
        yield from zip([name] * 4, INERTIAS, (part.mass, *part.inertia), strict=True)
        own = (part.height,) if isinstance(part, RigidBody) else part.radius
        yield from ((name, "place", size) for size in (part.along, *own))
    acting: list[SuspensionElement | Pull] = [*vehicle.connections, *vehicle.pulls]
    for one in acting:
        laws = [getattr(one, item.name) for item in fields(one) if "Size" in str(item.type)]
        sizes = [*one.place, *(size for law in laws for size in (law if isinstance(law, tuple) else (law,)))]
        yield from ((one.name, "place or law", size) for size in sizes)
        if isinstance(one, SeriesDamper):
            yield one.name, "series damping", one.damping
        if isinstance(one, FrictionSlider):
            yield one.name, "slider mass", one.slider_mass


def parameters_in(vehicle: Vehicle) -> set[str]:
    """Return the names of the parameters that the sizes of a vehicle name."""
    return {name for _, _, size in _sizes(vehicle) for name, _ in as_sum(size).terms}


def _references(vehicle: Vehicle, ends: list[str]) -> Iterator[tuple[str, str, list[str]]]:
    """Yield each reference to a part: its user, the name that it uses, and the possible names."""
    bodies = [body.name for body in vehicle.bodies]
    for connection in vehicle.connections:
        yield f"the connection {connection.name}", connection.upper, ends
        yield f"the connection {connection.name}", connection.lower, ends
    for number, wheelset in vehicle.numbered:
        yield f"{wheelset_name(number)}, which reacts on a body,", wheelset.reacts_on, bodies
    for pull in vehicle.pulls:
        yield f"the force {pull.name}", pull.body, ends
        yield f"the force {pull.name}, which has a direction,", pull.direction, list(DIRECTIONS)


def _check_ends(vehicle: Vehicle, connection: SuspensionElement) -> None:
    """Check connections to axle boxes. Axle boxes pitch with the body at the other end."""
    wheelsets = [end for end in (connection.upper, connection.lower) if end not in {b.name for b in vehicle.bodies}]
    if len(wheelsets) == 2:
        sentence = (
            f"{connection.name} joins {wheelsets[0]} and {wheelsets[1]}, whose axle boxes nothing would hold level; "
            "give it a body at one end"
        )
        raise _refused(vehicle, sentence)
    if wheelsets and isinstance(connection, Torsion) and connection.angle == "pitch":
        sentence = (
            f"{connection.name} twists about the axle of {wheelsets[0]}, whose axle boxes pitch with the other end, so "
            "that it does nothing; leave it out, or give it another angle"
        )
        raise _refused(vehicle, sentence)


def _check_law(vehicle: Vehicle, connection: SuspensionElement) -> None:
    """Check the names of directions and angles, and the points of tables."""
    for word, known in (("direction", DIRECTIONS), ("angle", ANGLES)):
        value = getattr(connection, word, known[0])
        if value not in known:
            raise _refused(vehicle, f"{connection.name} has the {word} {value}; give one of {', '.join(known)}")
    fault = fault_of(connection)
    if isinstance(connection, ForceLaw):
        assert isinstance(connection.force, ForceFunction)
        fault = function_fault(connection.force, tuple(vehicle.number(size) for size in connection.sizes))
    if fault:
        raise _refused(vehicle, f"{connection.name}: {fault.removesuffix('.')}")


def fault_of(connection: SuspensionElement) -> str:
    """Return what is wrong with the values of a connection, or an empty text."""
    fault = ""
    if isinstance(connection, Springs) and connection.carries and connection.inclination != 0.0:
        fault = "inclination must be left out with a vertical stiffness, which carries weight; got both. Take two rows."
    if isinstance(connection, TableSpring):
        fault = spring_fault(connection.travel, connection.force, False)
        fault = fault or spring_fault(connection.travel, connection.force, connection.carries)
    if isinstance(connection, TableDamper):
        fault = damper_fault(connection.rate, connection.force)
    if isinstance(connection, BumpStop) and not fault and not connection.travel[0] > 0.0:
        fault = f"travel must begin with the clearance, above 0; got {connection.travel[0]:g} m. Take a TableSpring."
    return fault


def _check_places(vehicle: Vehicle) -> None:
    places = [_number(vehicle, "a wheelset", wheelset.along) for wheelset in vehicle.wheelsets]
    for number, (leading, trailing) in enumerate(pairwise(places), 1):
        if not leading > trailing:
            sentence = (
                f"wheelset_{number + 1} is at {trailing:g} m, not behind wheelset_{number} at {leading:g} m; number "
                "the wheelsets from the front, each at its own place"
            )
            names = _words(name for name, _ in _joined(vehicle.gaps[number - 1]))
            raise _refused(vehicle, f"{sentence}, or change {names}" if names else sentence)
    for number, gap in enumerate(vehicle.gaps, 1):
        if not vehicle.number(gap) > 0.0:
            raise _refused(vehicle, _overlap(number, gap) % f"{-vehicle.number(gap):.4g}")


def _check_radii(vehicle: Vehicle) -> None:
    for number, wheelset in vehicle.numbered:
        for radius in wheelset.radius:
            value, limits = _number(vehicle, wheelset_name(number), radius), (SMALLEST_RADIUS, LARGEST_RADIUS)
            if not limits[0] <= value <= limits[1]:
                raise ValueError(
                    f"Vehicle {vehicle.name}: {wheelset_name(number)} must have a radius from {limits[0]:g} to "
                    f"{limits[1]:g} m; got {value:g} m.{likely_unit(value, 'm', *limits)}"
                )


def _overlap(number: int, gap: Sum) -> str:
    """Return the message for wheelsets that are too near. %s stands for the overlap [m]."""
    names = _words(name for name, _ in _joined(gap))
    return (
        f"the wheels of {wheelset_name(number)} and {wheelset_name(number + 1)} must not overlap; they do by %s m; "
        f"{f'set {names} so that' if names else 'place them so that'} the axles lie further apart than both radii"
    )


def _words(names: Iterable[str]) -> str:
    """Return names as a list in words, with "and" before the last one."""
    *first, last = [*names] or [""]
    return f"{', '.join(first)} and {last}" if first else last


def _joined(size: Sum) -> tuple[tuple[str, float], ...]:
    """Return the terms of a size, each parameter once."""
    factors: dict[str, float] = {}
    for name, factor in size.terms:
        factors[name] = factors.get(name, 0.0) + factor
    return tuple((name, factor) for name, factor in factors.items() if factor)


def relations_of(vehicle: Vehicle, parameters: Collection[str]) -> tuple[ParameterRelation, ...]:
    """Return the relations between the `parameters` of an FMU by which wheels do not overlap."""
    found = []
    for number, gap in enumerate(vehicle.gaps, 1):
        terms = _joined(gap)
        free = tuple((name, factor) for name, factor in terms if name in parameters)
        fixed = Sum(tuple(term for term in terms if term not in free), gap.constant)
        if free:
            sentence = f"Vehicle {vehicle.name}: {_overlap(number, Sum(free))}."
            found.append(ParameterRelation(free, vehicle.number(fixed), sentence))
    return tuple(dict.fromkeys(found))


def _check_supports(vehicle: Vehicle) -> None:
    """Check that each body rests on a wheelset, directly or through others, on springs that do not let it tip over."""
    resting = {wheelset_name(number) for number, _ in vehicle.numbered}
    waiting = [body for body in vehicle.bodies if "bounce" not in body.held]
    resting |= {body.name for body in vehicle.bodies if body not in waiting}
    while waiting:
        carried = [b for b in waiting if any(c.upper == b.name and c.lower in resting for c in vehicle.carrying)]
        if not carried:
            hung = [body for body in waiting if all(c.upper != body.name for c in vehicle.carrying)]
            sentence = (
                f"nothing carries {(hung or waiting)[0].name}; give it a connection with a vertical stiffness whose "
                "upper end it is, and whose lower end rests on a wheelset"
            )
            raise _refused(vehicle, sentence)
        for body in carried:
            _check_footing(vehicle, body)
        resting |= {body.name for body in carried}
        waiting = [body for body in waiting if body not in carried]


def _check_footing(vehicle: Vehicle, body: RigidBody) -> None:
    """Check that the springs of a body are not on one line, over which the body would tip."""
    places = [p for c in vehicle.carrying if c.upper == body.name for _, p in c.sides()]
    for angle, across, axis in (("roll", 1, "side to side"), ("pitch", 0, "front to back")):
        values = {_number(vehicle, body.name, place[across]) for place in places}
        if angle not in body.held and len(values) < 2:
            raise _refused(
                vehicle, f"the springs under {body.name} have no distance from {axis}; spread them, or hold its {angle}"
            )
