"""Headers of the FMI standards among the sources of an FMU, as FMPy has them."""

from __future__ import annotations

from fmu_src.compile import fmi_headers

_NAMES = {
    2: ("fmi2FunctionTypes.h", "fmi2TypesPlatform.h", "fmi2Functions.h"),
    3: ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}


def standard_headers(version: int) -> dict[str, bytes]:
    """Return headers by name."""
    found = {name: (fmi_headers() / name).read_bytes() for name in _NAMES[version]}
    return found | ({"fmi2Functions.h": _with_prefix(found["fmi2Functions.h"])} if version == 2 else {})


def _with_prefix(header: bytes) -> bytes:
    """Return fmi2Functions.h with a prefix of names (FMI2_FUNCTION_PREFIX), which FMPy leaves out: as in FMI 3.0."""
    newer = (fmi_headers() / "fmi3Functions.h").read_bytes()
    prefix = newer[newer.index(b"/*\nAllow override of FMI3_FUNCTION_PREFIX") : newer.index(b"/* FMI version */")]
    prefix = prefix.replace(b"FMI3", b"FMI2").replace(b"fmi3", b"fmi2")
    return header[: header.index(b"/*\nExport FMI2")] + prefix + header[header.index(b"/*****") :]
