"""The table of notches on docs/drivers-valve.md, from products/train/drivers_valves.toml."""

from pages import table

from brake_controller.distributors.vacuum import VACUUM
from brake_controller.drivers_valve import POSITIONS, drivers_valve
from brake_controller.vacuum_valve import vacuum_valve
from products.train.notches import Handle, Notch, handles

HEADS = ("`handle`", "notch, and its other names", "`driver_position`", "`driver_step`")


def generated() -> str:
    """Return the notches of all handles, and the source of each."""
    rows = [row for handle in handles().values() for row in rows_of(handle)]
    sources = "\n".join(f"* `{handle.name}`: {handle.source}." for handle in handles().values())
    return f"{table(HEADS, rows)}\n\nSources:\n\n{sources}"


def rows_of(handle: Handle) -> list[tuple[str, str, str, str]]:
    """Return a row for each notch of a handle."""
    return [
        (f"`{handle.name}`" if number == 0 else "", ", ".join(notch.names), *inputs_of(notch, handle.pipe))
        for number, notch in enumerate(handle.notches)
    ]


def inputs_of(notch: Notch, pipe: str) -> tuple[str, str]:
    """Return the inputs of the FMU for a notch, of the valve of the project for air or for 21 inches of mercury."""
    position = f"{POSITIONS[notch.position]} {notch.position}"
    valve = vacuum_valve(VACUUM) if pipe == "vacuum" else drivers_valve()
    if notch.is_service:
        return position, f"{notch.step_of(valve):.3f}"
    return position, "the driver's" if notch.position == "service" else "-"
