"""How is a Firefox driven that is as its distribution ships it? It speaks WebDriver BiDi itself, over a socket.

Playwright drives builds of its own only. Here is the little of the protocol (w3.org/TR/webdriver-bidi) that tests need.
"""

import itertools
import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from websockets.sync.client import connect

FIREFOX = shutil.which("firefox-esr") or shutil.which("firefox")
# https://www.w3.org/TR/webdriver/#keyboard-actions
KEYS = {
    "Tab": "\ue004",
    "Shift": "\ue008",
    "End": "\ue010",
    "Home": "\ue011",
    "ArrowLeft": "\ue012",
    "ArrowUp": "\ue013",
    "ArrowRight": "\ue014",
    "ArrowDown": "\ue015",
    "Space": " ",
}

type Send = Callable[..., dict[str, Any]]


class Tab(NamedTuple):
    """What tests do with a page in any browser; names and selectors are those of Playwright."""

    evaluate: Callable[[str], Any]
    press: Callable[[str], object]
    click: Callable[[str], object]


class Firefox(NamedTuple):
    send: Send
    events: list[dict[str, Any]]


@contextmanager
def start_firefox(**preferences: object) -> Iterator[Firefox]:
    """Start one with a profile of its own; events are those of the console and of requests."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in preferences.items()]
        Path(profile, "user.js").write_text("".join(lines))
        command = [FIREFOX, "--headless", "--no-remote", "--profile", profile, "--remote-debugging-port", "0"]
        with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as process:
            try:
                address = next(filter(None, (re.search(r"ws://\S+", line) for line in process.stderr)))[0]
                with connect(f"{address}/session", max_size=None) as socket:
                    events: list[dict[str, Any]] = []
                    send = _sender(socket, events)
                    send("session.new", capabilities={})
                    send("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
                    yield Firefox(send, events)
            finally:
                process.kill()  # nothing of it is kept


def _sender(socket, events: list[dict[str, Any]]) -> Send:
    numbers = itertools.count()

    def send(method: str, **params: object) -> dict[str, Any]:
        number = next(numbers)
        socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while (answer := json.loads(socket.recv(timeout=30))).get("id") != number:
            events.append(answer)
        assert answer["type"] == "success", answer
        return answer["result"]

    return send


def open_tab(send: Send, url: str, width: int, height: int) -> Tab:
    """Open a page in a window of its own, and wait until it is there."""
    context = send("browsingContext.create", type="window")["context"]
    send("browsingContext.setViewport", context=context, viewport={"width": width, "height": height})
    send("browsingContext.navigate", context=context, url=url, wait="complete")

    def evaluate(expression: str) -> Any:
        wanted = f"JSON.stringify(({expression}) ?? null)"  # no promise: without scripts, none is ever kept
        done = send("script.evaluate", expression=wanted, target={"context": context}, awaitPromise=False)
        assert done["type"] == "success", done
        return json.loads(done["result"]["value"])

    def press(keys: str) -> None:
        codes = [KEYS[key] for key in keys.split("+")]
        actions = [{"type": "keyDown", "value": code} for code in codes]
        actions += [{"type": "keyUp", "value": code} for code in reversed(codes)]
        send("input.performActions", context=context, actions=[{"type": "key", "id": "keys", "actions": actions}])

    def click(selector: str) -> None:
        evaluate(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{ block: 'center' }})")
        located = send("browsingContext.locateNodes", context=context, locator={"type": "css", "value": selector})
        element = {"type": "element", "element": {"sharedId": located["nodes"][0]["sharedId"]}}
        actions = [
            {"type": "pointerMove", "x": 0, "y": 0, "origin": element},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerUp", "button": 0},
        ]
        send("input.performActions", context=context, actions=[{"type": "pointer", "id": "mouse", "actions": actions}])

    return Tab(evaluate, press, click)
