"""A real Firefox for the page's tests, driven over WebDriver BiDi: no driver program is needed."""

import base64
import contextlib
import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

FIREFOX = next((path for path in map(shutil.which, ("firefox-esr", "firefox")) if path), None)
QUIET = {
    "remote.active-protocols": 1,
    "datareporting.policy.dataSubmissionEnabled": False,
    "app.update.enabled": False,
    "app.normandy.enabled": False,
    "browser.aboutwelcome.enabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "ui.prefersReducedMotion": 1,
}
WAIT = 60  # s: longer than a busy machine needs for any command
needs_firefox = pytest.mark.skipif(
    FIREFOX is None, reason="no Firefox here: apt-get install firefox-esr"
)


class Tab:
    """One tab of a running Firefox."""

    def __init__(self, socket):
        self.socket, self.last = socket, 0
        self.trouble = []
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded"])
        self.context = self.call("browsingContext.create", type="tab")["context"]

    def call(self, method, **params):
        """A command's result; what the page logs meanwhile is kept."""
        self.last += 1
        self.socket.send(json.dumps({"id": self.last, "method": method, "params": params}))
        while True:
            answer = json.loads(self.socket.recv(timeout=WAIT))
            if answer.get("method") == "log.entryAdded":
                entry = answer["params"]
                if entry["level"] in ("error", "warn"):
                    self.trouble.append(entry["text"])
            elif answer.get("id") == self.last:
                if answer["type"] == "error":
                    raise RuntimeError(f"{method}: {answer['message']}")
                return answer["result"]

    def visit(self, url, width=1280, height=800):
        self.call(
            "browsingContext.setViewport",
            context=self.context,
            viewport={"width": width, "height": height},
        )
        self.call("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def evaluate(self, script):
        """The value of a JavaScript expression, as JSON carries it."""
        answer = self.call(
            "script.evaluate",
            expression=f"Promise.resolve({script}).then((value) => JSON.stringify(value))",
            target={"context": self.context},
            awaitPromise=True,
        )
        if answer["type"] == "exception":
            raise RuntimeError(answer["exceptionDetails"]["text"])
        found = answer["result"]
        return json.loads(found["value"]) if found["type"] == "string" else None

    def press(self, *keys):
        """Press and release keys, one after the other."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call(
            "input.performActions",
            context=self.context,
            actions=[{"type": "key", "id": "keyboard", "actions": actions}],
        )

    def photograph(self):
        answer = self.call("browsingContext.captureScreenshot", context=self.context)
        return base64.b64decode(answer["data"])

    def printed(self):
        answer = self.call("browsingContext.print", context=self.context)
        return base64.b64decode(answer["data"])


@contextlib.contextmanager
def firefox(preferences=()):
    """A tab of a Firefox with a fresh profile and these preferences {name: value}."""
    connect = pytest.importorskip(
        "websockets.sync.client", reason="websockets is missing: pip install -e '.[test]'"
    ).connect
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        wanted = QUIET | dict(preferences)
        lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});" for k, v in wanted.items()]
        Path(profile, "user.js").write_text("\n".join(lines), encoding="utf-8")
        command = [FIREFOX, "--headless", "--no-remote", "--profile", profile]
        process = subprocess.Popen(
            [*command, "--remote-debugging-port", "0"],
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
        )
        try:
            address = next(
                found[0] for line in process.stderr if (found := re.search(r"ws://[\d.:]+", line))
            )
            with connect(f"{address}/session", max_size=None) as socket:
                yield Tab(socket)
        finally:
            process.terminate()
            process.wait(WAIT)
            process.stderr.close()
