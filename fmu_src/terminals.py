"""Terminals: groups of variables for the connection to another FMU; FMI 3.0, 2.4.9, adopted by FMI 2.0.4."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fmu_src.archive import xml_file

#: Places in the archive, and default corners of the icon.
FILE, ICON = "terminalsAndIcons/terminalsAndIcons.xml", "terminalsAndIcons/icon.png"
CORNERS = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}


@dataclass(frozen=True)
class Terminal:
    """One terminal: terminals of one kind plug together, member by member.

    signals: variables by the names of their members, equal at both ends. flows: those that add up to 0 there.
    """

    name: str
    kind: str
    description: str
    signals: Mapping[str, str]
    flows: Mapping[str, str] = field(default_factory=dict)


def terminals_and_icons(terminals: Sequence[Terminal]) -> bytes:
    """Return the file of an FMU with these terminals and with the icon at ICON."""
    root = ET.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    drawing = ET.SubElement(root, "GraphicalRepresentation")
    ET.SubElement(drawing, "CoordinateSystem", CORNERS | {"suggestedScalingFactorTo_mm": "0.1"})
    ET.SubElement(drawing, "Icon", CORNERS)
    listed = ET.SubElement(root, "Terminals") if terminals else root
    for terminal in terminals:
        about = {"name": terminal.name, "matchingRule": "plug", "terminalKind": f"_bogie-braking_{terminal.kind}"}
        element = ET.SubElement(listed, "Terminal", about | {"description": terminal.description})
        for kind, members in (("signal", terminal.signals), ("inflow", terminal.flows)):
            for member, variable in members.items():
                names = {"variableName": variable, "memberName": member, "variableKind": kind}
                ET.SubElement(element, "TerminalMemberVariable", names)
    return xml_file(root)
