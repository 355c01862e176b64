"""Read the exported names of a shared library: ELF, PE or Mach-O, both parts of a universal binary."""

from __future__ import annotations

import struct
from collections.abc import Iterator


def exports(data: bytes) -> set[str]:
    """Return the names that the library defines and exports."""
    if data[:4] == b"\x7fELF":
        return _elf(data)
    if data[:2] == b"MZ":
        return _pe(data)
    if data[:4] == b"\xca\xfe\xba\xbe":
        parts = [struct.unpack_from(">IIIII", data, 8 + 20 * n) for n in range(struct.unpack_from(">I", data, 4)[0])]
        each = [_mach_o(data[offset : offset + size]) for _, _, offset, size, _ in parts]
        assert all(names == each[0] for names in each)
        return each[0]
    return _mach_o(data)


def _text(data: bytes, offset: int) -> str:
    return data[offset : data.index(b"\0", offset)].decode()


def _elf(data: bytes) -> set[str]:
    """Return the global and weak symbols of .dynsym that belong to a section (64-bit ELF)."""
    (table,) = struct.unpack_from("<Q", data, 40)
    size, count = struct.unpack_from("<HH", data, 58)
    sections = [struct.unpack_from("<IIQQQQIIQQ", data, table + size * n) for n in range(count)]
    found = set()
    for _, kind, _, _, offset, length, link, _, _, entry in sections:
        if kind != 11:  # SHT_DYNSYM
            continue
        for place in range(offset, offset + length, entry):
            name, info, _, section = struct.unpack_from("<IBBH", data, place)
            if info >> 4 and section:
                found.add(_text(data, sections[link][4] + name))
    return found


def _pe(data: bytes) -> set[str]:
    """Return the names of the export directory, the first entry after the 64-bit or 32-bit optional header."""
    (start,) = struct.unpack_from("<I", data, 60)
    count, optional = struct.unpack_from("<H12xH", data, start + 6)
    (kind,) = struct.unpack_from("<H", data, start + 24)
    (address,) = struct.unpack_from("<I", data, start + 24 + {0x20B: 112, 0x10B: 96}[kind])
    sections = [struct.unpack_from("<8xIIII", data, start + 24 + optional + 40 * n) for n in range(count)]

    def place(virtual: int) -> int:
        [found] = [raw + virtual - first for size, first, _, raw in sections if first <= virtual < first + size]
        return found

    number, _, names = struct.unpack_from("<III", data, place(address) + 24)
    addresses = struct.unpack_from(f"<{number}I", data, place(names))
    return {_text(data, place(name)) for name in addresses}


def _mach_o(data: bytes) -> set[str]:
    """Return the names of the loader's export trie, without the leading underscore of C names."""
    commands, place = struct.unpack_from("<I", data, 16)[0], 32
    found: set[str] = set()
    for _ in range(commands):
        command, size = struct.unpack_from("<II", data, place)
        where = {0x80000022: 40, 0x80000033: 8}.get(command)  # LC_DYLD_INFO_ONLY, LC_DYLD_EXPORTS_TRIE
        if where:
            offset, length = struct.unpack_from("<II", data, place + where)
            found |= set(_leaves(data[offset : offset + length], 0, "")) if length else set()
        place += size
    return {name.removeprefix("_") for name in found}


def _leaves(trie: bytes, node: int, begin: str) -> Iterator[str]:
    """Yield the names below a node. A node has a byte count, data on the name that ends here, and labelled edges."""
    size, place = _number(trie, node)
    if size:
        yield begin
    place += size
    edges, place = trie[place], place + 1
    for _ in range(edges):
        letters = _text(trie, place)
        child, place = _number(trie, place + len(letters) + 1)
        yield from _leaves(trie, child, begin + letters)


def _number(data: bytes, place: int) -> tuple[int, int]:
    """Return a number in groups of seven bits (the lowest first) and the offset after it."""
    value = shift = 0
    while True:
        byte, place = data[place], place + 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, place
