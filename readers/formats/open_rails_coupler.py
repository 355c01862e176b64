"""Couplers of Open Rails and MSTS vehicles as columns of a consist.

The coupler behind a vehicle is the first Coupling of its file, and the second one if the vehicle is flipped. A third
and a fourth replace these two: files that are included have them. The simple coupler of Open Rails has a slack, and
beyond it one stiffness in both senses. This stiffness is 7 times the sum of both values of Stiffness if r0 begins with
0, else 20 MN/m (its source, MSTSWagon.cs: GetSimpleCouplerStiffnessNpM, SetSimpleR0, and TrainCar.cs).
"""

from __future__ import annotations

from readers.formats.open_rails_fields import Fields
from readers.formats.open_rails_text import Block
from readers.formats.vehicle_rows import rounded
from readers.import_account import Notes, Row

#: Stiffness where r0 does not begin with 0, both values where a file has none, and factor of their sum [N/m].
STIFFNESS, DEFAULTS, FACTOR = 2e7, (1e7, 2e7), 7.0
#: Slack of a coupler whose r0 does not begin with 0, least and largest slack [m].
SLACK, LEAST_SLACK, MOST_SLACK = 0.012, 0.001, 0.1


def coupler_of(couplings: list[Block], flipped: bool, notes: Notes) -> Row:
    """Return the columns of the coupler behind a vehicle with these blocks Coupling."""
    if not couplings:
        notes.assumed("Coupling: missing; a screw coupler, in Open Rails one of 20 MN/m.")
        return {}
    both = [*couplings[2:4], *couplings[len(couplings[2:4]) : 2]]
    own = Fields(both[-1 if flipped else 0].blocks, notes)
    kind = own.word("Type")
    rigid = own.word("CouplingHasRigidConnection") not in ("", "0", "false") or (
        own.has("CouplingHasRigidConnection") and not own.word("CouplingHasRigidConnection")
    )
    if rigid or kind == "bar":
        notes.taken("Coupling: rigid connection or Bar -> coupler = rigid")
        return {"coupler": "rigid"}
    row: Row = {"coupler": "draft-gear" if kind == "automatic" else "screw"}
    notes.taken("Coupling: Automatic -> draft-gear, others -> screw")
    spring = own.blocks.get("spring")
    if spring is None:
        notes.assumed("Coupling without Spring: the stiffness and slack of its kind, in Open Rails 210 MN/m and 12 mm.")
        return row
    return row | _spring(Fields(spring.blocks, notes), notes)


def _spring(own: Fields, notes: Notes) -> Row:
    """Return stiffness, slack and strength of a coupler."""
    if any(name.startswith("orts") for name in own.blocks):
        notes.left("Coupling, ORTS fields of advanced couplers: Open Rails reads their stiffness as a force.")
        return {}
    pair = own.number("Stiffness", "N/m"), own.number("Stiffness", "N/m", 1)
    stiffness = DEFAULTS if pair[0] is None or pair[0] + (pair[1] or 0.0) < 0.0 else (pair[0], pair[1] or 0.0)
    near, far = own.number("r0", "m") or 0.0, own.number("r0", "m", 1)
    row: Row = {}
    if near != 0.0:
        row["coupler_stiffness"] = rounded(1e-6 * STIFFNESS)
        notes.converted("Coupling r0 that does not begin with 0: 20 MN/m and 12 mm, as in Open Rails, not Stiffness.")
    else:
        row["coupler_stiffness"] = rounded(1e-6 * FACTOR * sum(stiffness))
        notes.converted("Coupling Stiffness: 7 x the sum of both values, as in Open Rails -> coupler_stiffness [MN/m]")
    if own.has("r0"):
        before = list(own.blocks).index("r0") < list(own.blocks).index("stiffness") if own.has("Stiffness") else False
        row["coupler_slack"] = rounded(1e3 * _slack(near, far or 0.0, DEFAULTS if before else stiffness))
        notes.converted(
            "Coupling r0 that begins with 0: half of its second value x the second Stiffness over their sum, 1 to 100 "
            "mm -> coupler_slack [mm]"
        )
    else:
        row["coupler_slack"] = rounded(1e3 * SLACK)
    if strength := own.number("Break", "N"):
        row["coupler_strength"] = rounded(1e-3 * strength)
        notes.taken("Coupling Break, first value -> coupler_strength [kN]")
    if own.has("Damping"):
        notes.left("Coupling Damping: friction of the coupler is that of its kind; Open Rails has none.")
    return row


def _slack(near: float, far: float, stiffness: tuple[float, float]) -> float:
    """Return the slack in each sense [m] of both values of r0 [m], with both values of Stiffness [N/m]."""
    if near != 0.0 or not sum(stiffness):
        return SLACK
    return min(max(far / 2.0 * stiffness[1] / sum(stiffness), LEAST_SLACK), MOST_SLACK)
