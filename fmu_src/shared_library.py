"""Checks of third-party shared libraries: whether a file can be loaded without ending the process."""

from __future__ import annotations

import struct
import sys
from dataclasses import dataclass

#: First bytes of a library of a system; on macOS single and universal ones, of either order of bytes.
MACH_O = (b"\xcf\xfa\xed\xfe", b"\xfe\xed\xfa\xcf", b"\xca\xfe\xba\xbe", b"\xca\xfe\xba\xbf")
BEGINNINGS = {"linux": (b"\x7fELF",), "win32": (b"MZ",), "darwin": MACH_O}
#: ELF: type of a shared object; segments that are loaded, and that of the dynamic section; ELF specification, 1995.
ET_DYN, PT_LOAD, PT_DYNAMIC = 3, 1, 2
#: Entries of a dynamic section: its end; addresses of the tables that a loader reads: hash table, names, symbols,
#: relocations.
DT_NULL, DT_STRTAB, DT_SYMTAB = 0, 5, 6
ADDRESSES = {3, 4, 5, 6, 7, 12, 13, 17, 23, 25, 26, 0x6FFFFEF5, 0x6FFFFFF0, 0x6FFFFFFC, 0x6FFFFFFE}


@dataclass(frozen=True)
class ProgramHeader:
    """One program header: type, place and size in the file, address and size in memory [bytes]."""

    kind: int
    offset: int
    address: int
    in_file: int
    in_memory: int


def fault_of(data: bytes) -> str:
    """Return the reason why this system cannot load a file as a library; empty if no fault was found.

    Linux maps a file that is cut off and ends the process where it reads beyond its end. Windows and macOS refuse it.
    """
    if not data.startswith(BEGINNINGS.get(sys.platform, (b"",))):
        return "is not a shared library of this system"
    if sys.platform != "linux":
        return ""
    try:
        return _fault_of_elf(data)
    except (struct.error, OverflowError):  # places beyond the address range
        return f"is cut off at {len(data)} bytes"


def _fault_of_elf(data: bytes) -> str:
    """Compare the places in headers with the length of the file, and the tables of the loader with its segments."""
    wide, order = data[4:5] == b"\x02", ">" if data[5:6] == b"\x02" else "<"
    if data[4:6] not in (b"\x01\x01", b"\x01\x02", b"\x02\x01", b"\x02\x02"):
        return "has a damaged header"
    kind, _, _, _, programs, sections, _, _, each, count, each_section, section_count, _ = struct.unpack_from(
        f"{order}HHI{'QQQ' if wide else 'III'}IHHHHHH", data, 16
    )
    if kind != ET_DYN:
        return "is not a shared library"
    segments = [_segment(data, programs + number * each, wide, order) for number in range(count)]
    ends = [segment.offset + segment.in_file for segment in segments if segment.in_file]
    end = max([programs + count * each, sections + section_count * each_section if sections else 0, *ends])
    if end > len(data):
        return f"is cut off at {len(data)} of {end} bytes"
    loads = [one for one in segments if one.kind == PT_LOAD]
    if any(load.in_file > load.in_memory for load in loads):
        return "has a damaged segment"
    [*tables] = [one for one in segments if one.kind == PT_DYNAMIC]
    if len(tables) != 1 or not _good_table(data, tables[0], loads, f"{order}{'QQ' if wide else 'II'}"):
        return "has a damaged dynamic section"
    return ""


def _segment(data: bytes, place: int, wide: bool, order: str) -> ProgramHeader:
    if wide:
        kind, _, offset, address, _, in_file, in_memory, _ = struct.unpack_from(f"{order}IIQQQQQQ", data, place)
    else:
        kind, offset, address, _, in_file, in_memory, _, _ = struct.unpack_from(f"{order}IIIIIIII", data, place)
    return ProgramHeader(kind, offset, address, in_file, in_memory)


def _good_table(data: bytes, table: ProgramHeader, loads: list[ProgramHeader], form: str) -> bool:
    """Return whether a dynamic section ends, lies in a segment, and names only addresses inside of the segments."""

    def is_inside(address: int) -> bool:
        return any(load.address <= address < load.address + load.in_memory for load in loads)

    size = struct.calcsize(form)
    found: dict[int, int] = {}
    for place in range(table.offset, table.offset + table.in_file - size + 1, size):
        tag, value = struct.unpack_from(form, data, place)
        if tag == DT_NULL:
            named = [value for tag, value in found.items() if tag in ADDRESSES]
            return {DT_STRTAB, DT_SYMTAB} <= found.keys() and all(map(is_inside, [table.address, *named]))
        found[tag] = value
    return False
