"""The test rig at a UDP socket: clients in Python and in C; packets that are lost, late, wrong or repeated."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.controllers import loop, remote
from bogie_braking.controllers.loop import Looped, messages, run_in_loop
from bogie_braking.controllers.remote import WATCHDOG, Remote
from bogie_braking.reporting.progress import counting
from brake_controller.rig.udp_client import ANSWER, HEADER, HELLO, HOST, MAGIC, answer, answer_to, is_end, question
from brake_controller.slide_protection import RIG
from brake_controller.wheel_slide import Watch, within
from evidence.measuring.protected_throughput import SHARE, SOURCE, LetGo
from fmu_src.compile import compiler
from products.machine import bogie
from products.protection.rails import RAILS
from products.protection.rig import Rig
from products.protection.runs import Run
from products.protection.settings import Settings

ROOT = Path(__file__).parents[2]
SHORT = Settings(speed=4.0, period=10e-3)
RUN = Run(RAILS[2].values())
CLASS = """
class LetGo:
    def step(self, time, speeds):
        return [2 if speed < {share} * max(speeds) else 0 for speed in speeds]
"""
#: Largest duration of a paced run over its periods; delays must not add up, which would give 1.16.
OVER = 1.1


@pytest.fixture
def own() -> Iterator[socket.socket]:
    """Yield the rig's socket, at a free port."""
    with loop.socket_at(HOST, 0) as found:
        yield found


@pytest.fixture
def client() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind((HOST, 0))
        yield found


def port_of(own: socket.socket) -> int:
    return int(own.getsockname()[1])


def reply(sequence: int, valves: list[int], magic: bytes = MAGIC, kind: int = ANSWER) -> bytes:
    return HEADER.pack(magic, kind, len(valves), sequence) + bytes(valves)


class Asked:
    """Requests the next period of a client, with packets already waiting for the request."""

    def __init__(self, own: socket.socket, client: socket.socket) -> None:
        self.own, self.client = own, client
        self.remote = Remote(own, 5e-3, 0.0, counting(text="", unit="s"), client=client.getsockname())
        self.counts = self.remote.counts

    def __call__(self, *packets: bytes, by: socket.socket | None = None) -> list[int]:
        for packet in packets:
            (by or self.client).sendto(packet, self.own.getsockname())
        return self.remote.step(5e-3 * self.counts.periods, [20.0, 20.0])


@pytest.fixture
def asked(own: socket.socket, client: socket.socket, monkeypatch: pytest.MonkeyPatch) -> Asked:
    monkeypatch.setattr(remote, "ANSWER_WITHIN", 0.01)
    return Asked(own, client)


# ---- the same stop ---------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def here() -> object:
    """Return the stop of the class in this process."""
    return Rig(bogie(), LetGo, Settings(), by_flow=True).runs([RUN])[0]


def stop_with(client: list[str], own: socket.socket) -> Looped:
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(client, env=environment, stdout=subprocess.DEVNULL) as process:
        try:
            found = run_in_loop(bogie(), RUN, Settings(), own, 0.0)
            assert process.wait(10) == 0
        finally:
            process.kill()
    assert found.holds
    return found


@pytest.mark.study
@pytest.mark.parametrize("share", [0.8, 0.7])
def test_a_client_in_another_process_makes_the_stop_of_the_class_to_the_last_bit(
    share: float, own: socket.socket, here: object, tmp_path: Path
) -> None:
    (tmp_path / "let_go.py").write_text(CLASS.format(share=share))
    words = ["controllers", "answer", str(tmp_path / "let_go.py:LetGo"), "--port", str(port_of(own))]
    stop = stop_with([sys.executable, "-m", "bogie_braking", *words], own).stop
    assert (stop == here) == (share == 0.8)


@pytest.mark.study
def test_a_compiled_client_in_c_makes_the_stop_of_the_class_to_the_last_bit(
    own: socket.socket, here: object, tmp_path: Path
) -> None:
    (tmp_path / "let_go.c").write_text(f"#define SHARE {SHARE}\n{SOURCE}")
    for name in ("wheel_slide.h", "udp_client.c"):
        (tmp_path / name).write_text((RIG / name).read_text(encoding="utf-8"))
    warnings = ["-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    subprocess.run([*compiler(), *warnings, "-o", "client", "udp_client.c", "let_go.c"], cwd=tmp_path, check=True)
    found = stop_with([str(tmp_path / "client"), HOST, str(port_of(own))], own)
    assert found.stop == here
    assert found.counts.periods > 1000


# ---- packets that are not as they should be --------------------------------------------------------------------------


def test_valves_stay_as_they_were_until_the_watchdog_applies_the_brake(asked: Asked) -> None:
    counts = asked.counts
    assert asked(reply(0, [2, 1])) == [2, 1]
    for _ in range(WATCHDOG - 1):
        assert asked() == [2, 1]
    assert counts.watchdog == 0
    assert asked() == [0, 0]
    assert (counts.missed, counts.longest_silence, counts.watchdog) == (WATCHDOG, WATCHDOG, 1)
    assert asked.remote.silent_from == pytest.approx(5e-3)
    assert asked(reply(WATCHDOG + 1, [1, 2])) == [1, 2]
    assert asked.remote.silent_from is None


def test_late_and_repeated_answers_are_thrown_away_and_told_apart(asked: Asked) -> None:
    counts = asked.counts
    assert asked(reply(0, [0, 0])) == [0, 0]
    assert asked() == [0, 0]
    assert asked(reply(1, [2, 2]), reply(0, [2, 2]), reply(1, [2, 2]), reply(2, [1, 1])) == [1, 1]
    assert (counts.missed, counts.late, counts.repeated, counts.malformed) == (1, 1, 2, 0)


@pytest.mark.parametrize(
    ("packet", "sentence"),
    [
        (b"", "An answer for 2 wheelsets must have 14 bytes; got 0."),
        (reply(0, [2, 2, 2]), "An answer for 2 wheelsets must have 14 bytes; got 15."),
        (reply(0, [2, 2], magic=b"WSP2"), "An answer must begin with b'WSP1'; got b'WSP2'."),
        (
            reply(0, [2, 2], kind=HELLO),
            "A packet of kind 1 for 2 wheelsets came; an answer has kind 3, for 2.",
        ),
        (reply(9, [2, 2]), "The sequence number of an answer must be at most 0; got 9."),
        (reply(0, [2, 3]), "Valve 2 of an answer must be 0 (apply), 1 (hold) or 2 (vent); got 3."),
        (bytes(60000), "An answer for 2 wheelsets must have 14 bytes; got 2048."),
    ],
)
def test_a_malformed_packet_gets_a_sentence_and_no_valve(packet: bytes, sentence: str, asked: Asked) -> None:
    assert asked(packet) == [0, 0]
    counts = asked.counts
    assert (counts.missed, counts.malformed, counts.messages) == (1, 1, [sentence])
    assert asked(packet, reply(1, [1, 1])) == [1, 1]
    assert counts.missed == 1


def test_packets_from_others_move_no_valve(asked: Asked) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        assert asked(reply(0, [2, 2]), by=other) == [0, 0]
    counts = asked.counts
    assert (counts.strangers, counts.malformed, counts.missed) == (1, 0, 1)


def test_a_flood_of_packets_makes_no_period_longer(asked: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another packet is always waiting."""
    monkeypatch.setattr(Remote, "_next", lambda self, patience: (b"flood", ("127.0.0.1", 9)))
    for _ in range(5):
        assert within(Watch(1.0), asked) == [0, 0]
    counts = asked.counts
    assert counts.missed == 5
    assert counts.strangers > 5


def test_a_client_that_dies_leaves_the_brake_to_the_watchdog(
    own: socket.socket, client: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote, "ANSWER_WITHIN", 0.01)
    client.sendto(HEADER.pack(MAGIC, HELLO, 0, 0), own.getsockname())

    def live() -> None:
        for _ in range(150):
            packet = answer_to(client.recv(2048), LetGo())
            assert packet is not None
            client.sendto(packet, own.getsockname())
        client.close()

    thread = threading.Thread(target=live)
    thread.start()
    found = run_in_loop(bogie(), RUN, SHORT, own, 0.0)
    thread.join()
    assert not found.holds
    assert found.stop.message.startswith("No answer came from 1.5 s on, and the watchdog applied the brake")
    assert found.stop.end_speed < 0.02
    assert found.counts.missed == found.counts.periods - 150


# ---- the clock -------------------------------------------------------------------------------------------------------


def test_a_paced_run_takes_as_long_as_its_periods(own: socket.socket) -> None:
    pace = 10.0
    clock, began = time.perf_counter, []
    thread = threading.Thread(target=answer, args=(LetGo(), HOST, port_of(own), lambda _: began.append(clock())))
    thread.start()
    found = run_in_loop(bogie(), RUN, SHORT, own, pace)
    ended = clock()
    thread.join()
    due = (found.counts.periods - 1) * SHORT.period / pace
    assert (found.stop.distance is None) is bool(found.counts.for_the_rig)  # excluded on a busy computer
    assert 0.98 * due < ended - began[0] < OVER * due
    assert any(line.startswith("The rig asked late by") for line in messages(found))


# ---- the command line ------------------------------------------------------------------------------------------------


def test_the_command_prints_what_came(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    with loop.socket_at(HOST, 0) as free:
        port = port_of(free)
    thread = threading.Thread(target=answer, args=(LetGo(), HOST, port))
    thread.start()
    words = ["--rail", "dry", "--speed", "4", "--pace", "0", "--port", str(port), "--out", str(tmp_path)]
    assert main(["controllers", "loop", "--json", *words]) == 0
    thread.join()
    told = json.loads(capsys.readouterr().out)
    assert told["loop"]["missed"] == 0
    assert told["loop"]["periods"] > 500
    assert told["runs"][0]["distance"] == pytest.approx(told["runs"][0]["ideal"], rel=0.1)
    assert json.loads((tmp_path / "controllers" / "loop.json").read_text()) == told


def test_a_port_that_another_program_has_is_refused(own: socket.socket, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["controllers", "loop", "--port", str(port_of(own))]) == 2
    assert f"Port {port_of(own)} of {HOST} cannot be had (" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--pace", "-1"], "--pace must be at least 0; got -1."),
        (["--pace", "0.001"], "--pace must be 0, or at least 0.011 with this period; got 0.001."),
        (["--rail", "slow"], "There is no case slow; give --rail one of dry, wet, low, changing."),
        (["--port", "70000"], "--port must be an integer from 0 to 65535; got 70000."),
        (["--period", "0.001ms"], "--period must be from 1e-05 to 1 s; got 0.001ms."),
        (["--port", "0"], "No client came to 127.0.0.1:"),
    ],
)
def test_a_loop_that_cannot_be_is_refused(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote, "WAIT", 0.05)
    assert main(["controllers", "loop", *words]) == 2
    assert sentence in capsys.readouterr().err


def test_a_client_whose_rig_is_gone_says_so(own: socket.socket, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("brake_controller.rig.udp_client.SILENCE", 0.1)

    def ask_once() -> None:
        _, address = own.recvfrom(2048)
        own.sendto(question(0, 0.0, 5e-3, [20.0, 20.0]), address)

    thread = threading.Thread(target=ask_once)
    thread.start()
    with pytest.raises(TimeoutError, match="; 1 answers given"):
        answer(LetGo(), HOST, port_of(own))
    thread.join()


@pytest.mark.parametrize("packet", [b"", b"WSP1", question(0, 0.0, 5e-3, [1.0])[:-1], bytes(40)])
def test_a_client_answers_nothing_that_is_no_question(packet: bytes) -> None:
    assert answer_to(packet, LetGo()) is None
    assert not is_end(packet)
