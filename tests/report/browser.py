"""A headless Chromium spoken to over its DevTools pipe, with the standard library alone.

Messages are JSON, each ended by a zero byte, on the descriptors 3 (to the browser) and 4 (from it).
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-extensions", "--hide-scrollbars",
         "--remote-debugging-pipe"]
PATIENCE_S = 90  # without any word: it hangs


class Browser:
    """One page of a browser of its own; ends with the `with` block."""

    def __init__(self, program=None):
        self.profile = tempfile.mkdtemp(prefix="bodesmith-browser-")
        to_read, self.to = os.pipe()
        self.source, from_write = os.pipe()
        # The child finds the pipe's ends at 3 and 4: high copies first, lest one overwrites the other.
        high_in, high_out = os.dup(to_read), os.dup(from_write)
        while high_in < 10 or high_out < 10:
            high_in = high_in if high_in >= 10 else os.dup(high_in)
            high_out = high_out if high_out >= 10 else os.dup(high_out)

        def place():
            os.dup2(high_in, 3)
            os.dup2(high_out, 4)

        self.process = subprocess.Popen([program or shutil.which("chromium")] + FLAGS +
                                        ["--user-data-dir=" + self.profile, "about:blank"],
                                        preexec_fn=place, close_fds=False, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (to_read, from_write, high_in, high_out):
            os.close(end)
        self.buffer, self.number, self.events, self.session = b"", 0, [], None
        target = [t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page"][0]
        self.session = self.call("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.to)
        os.close(self.source)
        self.process.terminate()
        self.process.wait()
        shutil.rmtree(self.profile, ignore_errors=True)

    def receive(self):
        while b"\0" not in self.buffer:
            if not select.select([self.source], [], [], PATIENCE_S)[0]:
                raise RuntimeError("the browser does not answer")
            piece = os.read(self.source, 1 << 20)
            if not piece:
                raise RuntimeError("the browser has gone")
            self.buffer += piece
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)

    def open(self, url, width=1280, height=900, dark=False, scripts=True):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.scheme(dark)
        seen = len(self.events)
        self.call("Page.navigate", url=url)
        while not any(event.get("method") == "Page.loadEventFired" for event in self.events[seen:]):
            self.events.append(self.receive())
        if scripts:
            self.frames()

    def scheme(self, dark, media=""):
        self.call("Emulation.setEmulatedMedia", media=media,
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def frames(self):
        """Waits until what was asked for is drawn."""
        self.js("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))")

    def js(self, expression):
        """The value of an expression in the page; a promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(expression + ": " + json.dumps(answer["exceptionDetails"])[:600])
        return answer["result"].get("value")

    def mouse(self, kind, x, y, button="none", count=0, modifiers=0):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, clickCount=count,
                  buttons=1 if button == "left" else 0, modifiers=modifiers)

    def place(self, expression):
        """Middle and size of an element, scrolled into view."""
        return self.js("(e => { e.scrollIntoView({block: 'center'}); const r = "
                       "e.getBoundingClientRect(); return {x: r.x + r.width / 2, y: r.y + r.height / 2, left: r.x, "
                       f"top: r.y, width: r.width, height: r.height}}; }})({expression})")

    def click(self, expression):
        at = self.place(expression)
        self.mouse("mouseMoved", at["x"], at["y"])
        self.mouse("mousePressed", at["x"], at["y"], "left", 1)
        self.mouse("mouseReleased", at["x"], at["y"], "left", 1)
        self.frames()

    def drag(self, x0, y0, x1, y1):
        self.mouse("mouseMoved", x0, y0)
        self.mouse("mousePressed", x0, y0, "left", 1)
        for part in (0.25, 0.5, 0.75, 1.0):
            self.mouse("mouseMoved", x0 + part * (x1 - x0), y0 + part * (y1 - y0), "left")
        self.mouse("mouseReleased", x1, y1, "left", 1)
        self.frames()

    def key(self, name, text=""):
        self.call("Input.dispatchKeyEvent", type="keyDown", key=name, text=text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=name)
        self.frames()

    def wait(self, expression, seconds=60):
        """Waits for an expression to become true."""
        end = time.monotonic() + seconds
        while not self.js(expression):
            if time.monotonic() > end:
                raise RuntimeError("never came true: " + expression)
            time.sleep(0.02)

    def png(self, path, whole=True):
        size = self.js("({w: document.documentElement.scrollWidth, h: document.documentElement.scrollHeight})")
        clip = {"x": 0, "y": 0, "width": size["w"], "height": size["h"], "scale": 1}
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole,
                         **({"clip": clip} if whole else {}))
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))

    def errors_and_requests(self):
        """What the page's scripts threw, what its Content-Security-Policy stopped, and every address it asked for."""
        self.js("0")
        said, asked = [], []
        for event in self.events:
            what = event.get("params", {})
            if event.get("method") == "Runtime.exceptionThrown":
                said.append(json.dumps(what["exceptionDetails"])[:400])
            if event.get("method") == "Log.entryAdded":
                said.append(what["entry"]["text"])
            if event.get("method") == "Network.requestWillBeSent":
                asked.append(what["request"]["url"])
        return said, asked
