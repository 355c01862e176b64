"""FMUs of unknown origin: any fault in an archive gives one error message and leaves no files behind."""

from __future__ import annotations

import os
import re
import struct
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest

import build_fmu
from bogie_braking.controllers.controller_loader import fmu_names
from bogie_braking.reporting.scenario import BadInputError
from fmu_src import archive
from fmu_src.compile import library_suffix
from fmu_src.cosimulation import slave as slave_module
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.protection.in_fmu import InFmu
from readers.storage import StorageError
from tests.fmu_src.fmi.limits import files_of_at_most
from tests.fmu_src.fmi.objects import COUNTS

BINARY = f"binaries/{fmpy.platform}/counts{library_suffix()}"
ABOUT = "modelDescription.xml"
Contents = dict[str, bytes]
FMI1 = b"""<fmiModelDescription fmiVersion="1.0" modelName="a" modelIdentifier="a" guid="b" numberOfContinuousStates="0"
 numberOfEventIndicators="0"><ModelVariables/></fmiModelDescription>"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the path of a small FMU."""
    folder = tmp_path_factory.mktemp("counts")
    (folder / "counts.c").write_text(COUNTS)
    assert build_fmu.main(["--controller", str(folder / "counts.c"), "--out", str(folder)]) == 0
    return folder / "native" / "counts.fmu"


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty folder for temporary files."""
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    return tmp_path / "temporary"


def contents_of(path: Path) -> Contents:
    with zipfile.ZipFile(path) as packed:
        return {name: packed.read(name) for name in packed.namelist()}


def packed(path: Path, contents: Contents, method: int = zipfile.ZIP_DEFLATED) -> Path:
    with zipfile.ZipFile(path, "w", method) as made:
        for name, data in contents.items():
            made.writestr(name, data)
    return path


def described(old: str, new: str) -> Callable[[Contents], Contents]:
    """Return a change of the description by a regular expression."""

    def changed(files: Contents) -> Contents:
        text = re.sub(old, new, files[ABOUT].decode(), flags=re.DOTALL)
        assert text != files[ABOUT].decode()
        return files | {ABOUT: text.encode()}

    return changed


def without(name: str) -> Callable[[Contents], Contents]:
    return lambda files: {key: data for key, data in files.items() if key != name}


def elsewhere(files: Contents) -> Contents:
    """Keep only a binary for another platform."""
    return {key.replace(f"/{fmpy.platform}/", "/plan9/"): data for key, data in files.items()}


def exchanged(files: Contents) -> Contents:
    """Replace co-simulation by model exchange."""
    text = re.sub("<CoSimulation.*</CoSimulation>", "<CoSimulation/>", files[ABOUT].decode(), flags=re.DOTALL)
    return files | {ABOUT: re.sub("<CoSimulation.*?/>", '<ModelExchange modelIdentifier="a"/>', text).encode()}


def holding(name: str, data: bytes = b"x") -> Callable[[Contents], Contents]:
    return lambda files: files | {name: data}


WRONG = {
    "another GUID": (
        described(r'guid="\{....', 'guid="{none'),
        "counts: The identifier of modelDescription.xml",
    ),
    "no description": (without(ABOUT), f"it has no {ABOUT}"),
    "a description that ends early": (lambda files: files | {ABOUT: files[ABOUT][:300]}, "cannot be read"),
    "a description of nothing": (holding(ABOUT, b""), "cannot be read"),
    "entities": (holding(ABOUT, b'<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'), "declares a document type"),
    "entities in UTF-16": (
        holding(ABOUT, '<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'.encode("utf-16")),
        "declares a document type",
    ),
    "a version that is none": (described('fmiVersion="2.0"', 'fmiVersion="2.5"'), "Unsupported FMI version: 2.5"),
    "model exchange only": (exchanged, "is for model exchange only; export it for co-simulation"),
    "FMI 1": (holding(ABOUT, FMI1), r"is of FMI 1\.0; this master knows 2\.0 and 3\.0"),
    "a name that leaves the folder": (
        described('modelIdentifier="counts"', 'modelIdentifier="../a"'),
        "is not a name in C",
    ),
    "no binary": (without(BINARY), f"has no binary for {fmpy.platform}, but for no platform"),
    "another platform": (elsewhere, f"has no binary for {fmpy.platform}, but for plan9"),
    "a text as a binary": (holding(BINARY, b"no library"), "is not a shared library of this system"),
    "an empty binary": (holding(BINARY, b""), "is not a shared library of this system"),
    "a step up": (holding("../out"), r"\.\./out is not a valid name of an entry"),
    "a place of the system": (holding("/out"), "/out is not a valid name of an entry"),
    "a drive": (holding("c:out"), "a backslash or a colon"),
    "a name that is too long": (holding(f"resources/{'a' * 300}"), "too long"),
    "a file and a folder": (lambda files: files | {"r": b"", "r/a": b""}, "r is a file and a folder"),
}


@pytest.mark.study
@pytest.mark.parametrize("damage", WRONG)
def test_what_is_wrong_is_one_sentence_and_leaves_nothing(
    damage: str, whole: Path, temporary: Path, tmp_path: Path
) -> None:
    change, words = WRONG[damage]
    path, here = packed(tmp_path / "a.fmu", change(contents_of(whole))), os.getcwd()
    with pytest.raises(CosimulationError, match=words) as caught:
        FmuInstance(path)
    assert "\n" not in str(caught.value)
    assert os.getcwd() == here
    assert list(temporary.iterdir()) == []


def entry_with(place: int, form: str, value: int) -> Callable[[bytes], bytes]:
    """Return a change of one number in the first entry of the central directory."""

    def changed(data: bytes) -> bytes:
        found = bytearray(data)
        struct.pack_into(form, found, data.index(b"PK\x01\x02") + place, value)
        return bytes(found)

    return changed


#: Offsets in an entry of the central directory: APPNOTE.TXT, section 4.3.12.
RAW = {
    "2 GB": (entry_with(24, "<I", 2_000_000_000), r"unpacks to 2000 MB; at most 1074 MB are read"),
    "more than it has": (entry_with(24, "<I", 60_000_000), "ends at [0-9]+ of 60000000 bytes"),
    "a checksum of something else": (entry_with(16, "<I", 1), "Bad CRC-32"),
    "encrypted": (entry_with(8, "<H", 1), "is encrypted"),
    "another method": (entry_with(10, "<H", 14), "is compressed with method 14; FMI allows deflate"),
    "a link": (entry_with(38, "<I", 0o120777 << 16), "is a link"),
    "cut off": (lambda data: data[: len(data) // 2], "is not a valid FMU: File is not a zip file"),
    "nothing": (lambda _: b"", "is not a valid FMU: File is not a zip file"),
}


@pytest.mark.parametrize("damage", RAW)
def test_an_archive_that_lies_is_one_sentence(damage: str, whole: Path, temporary: Path, tmp_path: Path) -> None:
    change, words = RAW[damage]
    path = tmp_path / "a.fmu"
    path.write_bytes(change(whole.read_bytes()))
    with pytest.raises(CosimulationError, match=words):
        FmuInstance(path)
    assert list(temporary.iterdir()) == []


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_an_entry_that_is_there_twice_is_refused(whole: Path, tmp_path: Path) -> None:
    path = packed(tmp_path / "a.fmu", contents_of(whole))
    with zipfile.ZipFile(path, "a") as made:
        made.writestr(ABOUT, b"another")
    with pytest.raises(CosimulationError, match=f"it has {ABOUT} twice"):
        FmuInstance(path)


@pytest.mark.parametrize(
    ("limit", "value", "words"),
    [
        ("LARGE", 1000, "zeros unpacks to more than 200 times its packed size"),
        ("LARGEST_ENTRY", 199_000, "zeros unpacks to 0 MB; at most 0 MB"),
        ("LARGEST_TOTAL", 200_000, r"it unpacks to \d MB; at most 0 MB"),
        ("MOST_ENTRIES", 3, r"it has \d+ entries; at most 3 are read"),
    ],
)
def test_what_an_archive_unpacks_to_is_bounded(
    limit: str, value: int, words: str, whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limits are lowered so that a small archive exceeds them."""
    monkeypatch.setattr(archive, limit, value)
    path = packed(tmp_path / "a.fmu", contents_of(whole) | {"resources/zeros": bytes(200_000)})
    with pytest.raises(CosimulationError, match=words):
        FmuInstance(path)


def test_an_interrupted_start_leaves_nothing(whole: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(path: Path, folder: Path) -> None:
        (folder / "half").write_text("")
        raise KeyboardInterrupt

    monkeypatch.setattr(slave_module, "unpacked", interrupted)
    with pytest.raises(KeyboardInterrupt):
        FmuInstance(whole)
    assert list(temporary.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="limits of a process are those of POSIX")
def test_no_room_for_temporary_files_is_told(whole: Path, temporary: Path) -> None:
    with files_of_at_most(1000), pytest.raises(StorageError, match=r"Free space on its disk, or name .* TMPDIR\."):
        FmuInstance(whole)
    assert list(temporary.iterdir()) == []


def test_readers_of_controllers_say_the_same(whole: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.fmu"
    path.write_bytes(whole.read_bytes()[:1000])
    words = f"{path} is not a valid FMU: File is not a zip file."
    with pytest.raises(BadInputError, match=re.escape(words)):
        fmu_names(path, 2)
    with pytest.raises(archive.ArchiveError, match=re.escape(words)):
        InFmu(path, fmu_names(whole, 2), 2, 5e-3)


@pytest.mark.skipif(sys.platform != "linux", reason="headers of ELF")
def test_a_header_with_places_beyond_what_a_machine_addresses_is_one_sentence(whole: Path, tmp_path: Path) -> None:
    """Flip bit 63 of e_phoff, the offset of the program headers (ELF-64, table 2)."""
    files = contents_of(whole)
    binary = bytearray(files[BINARY])
    binary[32 + 7] ^= 0x80
    path = packed(tmp_path / "a.fmu", files | {BINARY: bytes(binary)})
    with pytest.raises(CosimulationError, match="is cut off at"):
        FmuInstance(path)


#: Damaged binaries have crashed the process, so this runs in a separate one: random changes, and binaries cut short.
MUTATIONS = """
import random, sys, tempfile, time, zipfile
from pathlib import Path
from fmu_src.archive import archive_bytes, contents_of
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
whole, binary, folder = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
tempfile.tempdir = str(folder / "temporary")
data, files, draw = whole.read_bytes(), contents_of(whole), random.Random(47)
directory, path, longest, counts = data.index(b"PK\\1\\2"), folder / "a.fmu", 0.0, {True: 0, False: 0}

def flipped():
    made = bytearray(data)
    for _ in range(draw.choice((1, 4, 64))):
        made[draw.randrange(len(made))] ^= 1 << draw.randrange(8)
    return bytes(made)

def cut():
    first, last = sorted(draw.sample(range(len(data)), 2))
    return data[:first] + draw.choice((b"", data[last:]))

def extended():
    place = draw.randrange(len(data) + 1)
    return data[:place] + draw.randbytes(draw.randrange(1, 3000)) + data[place:]

def renamed():
    name = draw.choice(list(files)).encode()
    return data.replace(name, bytes(draw.choice(b"./\\\\\\0:a") if draw.random() < 0.3 else one for one in name))

def misdirected():
    made = bytearray(data)
    made[draw.randrange(directory, len(data))] = draw.randrange(256)
    return bytes(made)

def shortened():
    return archive_bytes(files | {binary: files[binary][: draw.randrange(len(files[binary]))]})

for number in range(1000):
    path.write_bytes(draw.choice((flipped, cut, extended, renamed, misdirected) if number % 20 else (shortened,))())
    begin = time.process_time()
    try:
        with FmuInstance(path) as slave:
            slave.start()
            slave.step(0.0, 0.005)
        counts[True] += 1
    except CosimulationError:
        counts[False] += 1
    longest = max(longest, time.process_time() - begin)
left_open = FmuInstance(whole)
print(sum(counts.values()), counts[False] > counts[True], longest < 5.0)
"""


@pytest.mark.study
def test_a_thousand_damaged_archives_end_no_process_and_leave_nothing(whole: Path, tmp_path: Path) -> None:
    """An instance that is still open when Python ends is cleaned up, too."""
    (tmp_path / "temporary").mkdir()
    call = [sys.executable, "-c", MUTATIONS, str(whole), BINARY, str(tmp_path)]
    done = subprocess.run(call, capture_output=True, text=True, cwd=Path(__file__).parents[3])
    assert (done.returncode, done.stdout.strip()) == (0, "1000 True True"), done.stderr
    assert list((tmp_path / "temporary").iterdir()) == []
