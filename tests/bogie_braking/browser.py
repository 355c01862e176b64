"""A real browser for tests of pages: Chromium without a window, driven by its DevTools protocol through two pipes.

The protocol is https://chromedevtools.github.io/devtools-protocol/; messages are JSON that ends with a zero byte.
"""

from __future__ import annotations

import base64
import json
import os
import select
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.needed import needed

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
#: The processor renders WebGL; test computers have no graphics card.
FLAGS = (
    *("--headless=new", "--no-sandbox", "--no-first-run", "--disable-dev-shm-usage", "--hide-scrollbars"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--remote-debugging-pipe"),
)
#: The browser reads from its file 3 and writes to its file 4; some shells support no file number above 9.
BEGINNING = """
import fcntl, os, sys
both = [fcntl.fcntl(int(end), fcntl.F_DUPFD, 10) for end in sys.argv[1:3]]
for place, end in enumerate(both, 3):
    os.dup2(end, place)
os.execv(sys.argv[3], sys.argv[3:])
"""
#: Longest wait for an answer [s].
PATIENCE = 60.0


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Yield a browser that ends with the test module: opening pages is expensive."""
    found = needed(*NAMES, packages="chromium")
    # Its processes may still write while they end.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        running = Browser(found, profile)
        yield running
        running.close()


class Browser:
    """One Chromium process; `open` returns its pages."""

    def __init__(self, program: str, profile: str) -> None:
        reads, self._out = os.pipe()
        self._in, writes = os.pipe()
        beginning = [sys.executable, "-c", BEGINNING, str(reads), str(writes)]
        self._process = subprocess.Popen(
            [*beginning, program, *FLAGS, f"--user-data-dir={profile}"],
            pass_fds=(reads, writes),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(reads)
        os.close(writes)
        self._number, self._rest = 0, b""
        self._pages: dict[str, Page] = {}

    def call(self, method: str, session: str | None = None, **parameters: Any) -> dict[str, Any]:
        """Return the answer of a method of the protocol; pass events that arrive meanwhile to their page."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        message |= {"sessionId": session} if session else {}
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.next_message()
            if answer.get("id") == self._number:
                assert "error" not in answer, f"{method}: {answer['error']['message']}"
                return dict(answer["result"])

    def next_message(self) -> dict[str, Any]:
        """Return the next answer or event; an event is first passed to its page."""
        end = time.monotonic() + PATIENCE
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._in], [], [], end - time.monotonic())
            assert ready, f"The browser has not answered within {PATIENCE:g} s."
            self._rest += os.read(self._in, 1 << 20)
        text, self._rest = self._rest.split(b"\0", 1)
        message: dict[str, Any] = json.loads(text)
        page = self._pages.get(message.get("sessionId", ""))
        if page and "method" in message:
            page.hear(message["method"], message["params"])
        return message

    def open(self, path: Path, width: int, height: int = 900, link: str = "") -> Page:
        """Open a file in a window of this size [pixels] and return the loaded page; link: is added to its address."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = self._pages[session] = Page(self, session)
        for domain in ("Page", "Runtime", "Log", "Network"):
            page.call(f"{domain}.enable")
        page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        page.call("Page.navigate", url=path.resolve().as_uri() + link)
        while not page.loaded:
            self.next_message()
        return page

    def close(self) -> None:
        os.close(self._out)
        os.close(self._in)
        self._process.terminate()
        self._process.wait(PATIENCE)


class Page:
    """A loaded page: `errors` of its console, and `requests` for anything outside its own file."""

    def __init__(self, browser: Browser, session: str) -> None:
        self._browser, self._session = browser, session
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.loaded = False

    def hear(self, event: str, about: dict[str, Any]) -> None:
        if event == "Page.loadEventFired":
            self.loaded = True
        elif event == "Runtime.exceptionThrown":
            details = about["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif event == "Runtime.consoleAPICalled" and about["type"] in ("error", "assert"):
            self.errors.append(" ".join(str(one.get("value", one.get("description"))) for one in about["args"]))
        elif event == "Log.entryAdded" and about["entry"]["level"] == "error":
            self.errors.append(about["entry"]["text"])
        elif event == "Network.requestWillBeSent":
            address = about["request"]["url"]
            if not address.startswith(("file:", "data:", "blob:")):
                self.requests.append(address)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        return self._browser.call(method, self._session, **parameters)

    def evaluate(self, script: str) -> Any:
        """Return the value of a JavaScript expression; wait for a promise."""
        done = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def drag(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        """Move the mouse with its left button down, in pixels of the window."""
        middle = ((begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2)
        steps = [("mousePressed", begin), ("mouseMoved", middle), ("mouseMoved", end), ("mouseReleased", end)]
        for kind, (x, y) in steps:
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)

    def press(self, key: str) -> None:
        """Press and release a key: " " or "Tab"."""
        code = {" ": 32, "Tab": 9}[key]
        about = {"key": key, "code": key.replace(" ", "Space"), "windowsVirtualKeyCode": code}
        text = {"text": key} if key == " " else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", **about, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **about)

    def prefer(self, scheme: str) -> None:
        """Set the preferred colour scheme of the reader: "light" or "dark"."""
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def close(self) -> None:
        """Close the page, so that it uses no more processor time."""
        self.call("Page.close")

    def screenshot(self, path: Path) -> None:
        """Write the whole page as PNG."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        area = {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}
        shot = self.call("Page.captureScreenshot", captureBeyondViewport=True, clip=area)
        path.write_bytes(base64.b64decode(shot["data"]))
