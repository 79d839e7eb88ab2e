#!/usr/bin/env python3
"""Tests the viewer of moving gears of report pages in headless Chromium.

    python3 .ci/moving_gears.py PAGE.html [...]          exit code 0: all checks hold, 1: one fails
    python3 .ci/moving_gears.py --pictures DIR PAGE.html   also stores pictures of the viewer

Without Chromium it says so and ends with code 0; GEARBENCH_CHROMIUM names another program. The browser is driven over its
debugging pipe: file descriptors 3 and 4 have JSON messages that end with a zero byte.
"""

import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time


class Browser:
    """A headless browser with one page."""

    def __init__(self, program):
        self.profile = tempfile.mkdtemp(prefix="gearbench-browser-")
        to_child, self.to = os.pipe()
        self.back, from_child = os.pipe()

        def descriptors():
            # First out of the way of 3 and 4, which may be the ends of the pipes themselves.
            a, b = os.dup(to_child), os.dup(from_child)
            a, b = [os.dup2(f, n, inheritable=True) for f, n in ((a, 100), (b, 101))]
            os.dup2(a, 3, inheritable=True)
            os.dup2(b, 4, inheritable=True)

        flags = ["--headless", "--no-sandbox", "--remote-debugging-pipe", "--hide-scrollbars", "--no-first-run",
                 "--enable-unsafe-swiftshader", f"--user-data-dir={self.profile}", "--window-size=1300,900", "about:blank"]
        self.process = subprocess.Popen([program, *flags], preexec_fn=descriptors, close_fds=False,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_child)
        os.close(from_child)
        self.number = 0
        self.rest = b""
        self.events = []
        self.session = None
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(f"{domain}.enable")

    def receive(self):
        while b"\0" not in self.rest:
            got = os.read(self.back, 1 << 20)
            if not got:
                raise RuntimeError("the browser has ended")
            self.rest += got
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def send(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            found = self.receive()
            if found.get("id") == self.number:
                if "error" in found:
                    raise RuntimeError(f"{method}: {found['error']['message']}")
                return found["result"]
            self.events.append(found)

    def evaluate(self, expression):
        found = self.send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in found:
            raise RuntimeError(found["exceptionDetails"].get("exception", {}).get("description", "exception"))
        return found["result"].get("value")

    def open(self, path):
        self.events.clear()
        self.send("Page.navigate", url=path.resolve().as_uri())
        while self.evaluate("document.readyState") != "complete":
            time.sleep(0.05)
        self.settle()

    def settle(self):
        """Waits until the page has drawn twice."""
        self.evaluate("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(0))))")

    def key(self, key, code=None, text=None):
        common = {"key": key, "code": code or key, "windowsVirtualKeyCode": {" ": 32, "Tab": 9, "ArrowRight": 39}.get(key, 0)}
        self.send("Input.dispatchKeyEvent", type="keyDown", **common, **({"text": text} if text else {}))
        self.send("Input.dispatchKeyEvent", type="keyUp", **common)

    def messages(self):
        """Messages of the console, exceptions and requests other than of the page itself."""
        found = []
        for event in self.events:
            method, p = event.get("method"), event.get("params", {})
            if method == "Runtime.consoleAPICalled":
                found.append("console: " + " ".join(str(a.get("value")) for a in p["args"]))
            elif method == "Runtime.exceptionThrown":
                found.append("exception: " + p["exceptionDetails"].get("exception", {}).get("description", "?"))
            elif method == "Log.entryAdded" and "ReadPixels" not in p["entry"]["text"]:
                # Reading pixels is what this test does.
                found.append("log: " + p["entry"]["text"])
            elif method == "Network.requestWillBeSent":
                url = p["request"]["url"]
                if p.get("type") != "Document" and not url.startswith(("data:", "blob:")):
                    found.append("request: " + url)
        return found

    def picture(self, path, selector):
        box = self.evaluate(f"(() => {{ const b = document.querySelector({json.dumps(selector)}).getBoundingClientRect();"
                            "return {x: b.x + scrollX, y: b.y + scrollY, width: b.width, height: b.height, scale: 1}; })()")
        shot = self.send("Page.captureScreenshot", format="png", clip=box, captureBeyondViewport=True)
        path.write_bytes(base64.b64decode(shot["data"]))

    def close(self):
        try:
            self.send("Browser.close")
            self.process.wait(10)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.profile, ignore_errors=True)


FRAMES = "[...document.querySelectorAll('.gears canvas:not([hidden])')].map(c => c.toDataURL())"
TIME = "document.querySelector('.gears').gearbenchState.time"
PLAY = "document.querySelector('.gears button')"
RANGE = "document.querySelector('.gears input[type=range]')"


def check(browser, page, failures, pictures):
    """Checks the viewer of one page."""

    def expect(holds, what):
        print(f"{'ok  ' if holds else 'FAIL'} {page.name}: {what}")
        if not holds:
            failures.append(f"{page.name}: {what}")

    browser.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])
    browser.open(page)
    panels = browser.evaluate("document.querySelectorAll('.gears .panel').length")
    expect(panels >= 1, f"the viewer has {panels} panels")
    if not panels:
        return
    expect(not browser.messages(), f"no message and no request on loading {browser.messages()[:2]}")
    expect(not browser.evaluate("document.querySelector('.gears').gearbenchState.playing"), "it does not start by itself")
    names = browser.evaluate("[...document.querySelectorAll('.gears button, .gears input, .gears select, .gears canvas')]"
                             ".filter(e => !(e.labels && e.labels.length) && !e.getAttribute('aria-label') && !e.textContent.trim()).length")
    expect(names == 0, "every control has a label")

    browser.evaluate("window.heard = []; window.addEventListener('gearbench:time', e => heard.push([e.detail.seconds, e.detail.source])); 0")
    browser.evaluate(f"{RANGE}.value = 0; {RANGE}.dispatchEvent(new Event('input', {{bubbles: true}})); 0")
    browser.settle()
    start, first = browser.evaluate(TIME), browser.evaluate(FRAMES)
    heard = browser.evaluate("heard")
    expect(heard and heard[-1] == [start, "gears"], "moving the range dispatches the time")

    # By keys alone: focus on the button, space.
    browser.evaluate(f"{PLAY}.focus(); 0")
    browser.key(" ", "Space", " ")
    for _ in range(40):
        time.sleep(0.1)
        if browser.evaluate(TIME) > start:
            break
    browser.settle()
    second = browser.evaluate(FRAMES)
    expect(browser.evaluate(TIME) > start, "the space key on the button plays")
    expect(all(a != b for a, b in zip(first, second)), "two frames of each model differ")
    browser.key(" ", "Space", " ")
    browser.settle()
    expect(not browser.evaluate("document.querySelector('.gears').gearbenchState.playing"), "the space key pauses")
    before = browser.evaluate(TIME)
    browser.key("Tab")
    browser.key("Tab")
    browser.key("Tab")
    browser.key("ArrowRight")
    browser.settle()
    expect(browser.evaluate("document.activeElement.type") == "range" and browser.evaluate(TIME) != before,
           "the range follows Play, back and next in the order of keys, and arrows move it")

    # The cursor of the page moves the viewer, which does not answer.
    ends = browser.evaluate(f"(() => {{ const s = document.querySelector('.gears').gearbenchState; heard.length = 0;"
                            f"const t = {start} + 0.5 * ({before} - {start});"
                            "window.dispatchEvent(new CustomEvent('gearbench:time', {detail: {seconds: t, source: 'test'}}));"
                            "return [t, s.time, heard.length]; })()")
    expect(ends[0] == ends[1] and ends[2] == 1, "an event of another source moves it without an answer")

    # Both views, where there are two.
    space = browser.evaluate("(() => { const b = [...document.querySelectorAll('.gears button')].find(b => ['3D', 'Section'].includes(b.textContent));"
                             "if (!b) return false; b.click(); return true; })()")
    browser.settle()
    if space:
        other = browser.evaluate("[...document.querySelectorAll('.gears canvas:not([hidden])')].map(c => { const s = document.createElement('canvas');"
                                 "s.width = s.height = 64; const x = s.getContext('2d'); x.drawImage(c, 0, 0, 64, 64);"
                                 "return new Set(new Uint32Array(x.getImageData(0, 0, 64, 64).data.buffer)).size; })")
        expect(all(n > 8 for n in other), f"the other view is drawn ({other} colours)")
        browser.evaluate("[...document.querySelectorAll('.gears button')].find(b => ['3D', 'Section'].includes(b.textContent)).click(); 0")
        browser.settle()
    if pictures:
        peak = browser.evaluate("JSON.parse(document.querySelector('.gears script').textContent).start_s")
        browser.evaluate(f"window.dispatchEvent(new CustomEvent('gearbench:time', {{detail: {{seconds: {peak}, source: 'test'}}}})); 0")
        browser.settle()
        browser.picture(pictures / f"{page.parent.parent.name or page.stem}_light.png", ".gears")
    browser.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    browser.settle()
    dark = browser.evaluate(FRAMES)
    expect(all(a != b for a, b in zip(second, dark)), "a dark page has dark pictures")
    if pictures:
        browser.picture(pictures / f"{page.parent.parent.name or page.stem}_dark.png", ".gears")
    browser.send("Emulation.setEmulatedMedia", media="print", features=[])
    printed = browser.evaluate("[getComputedStyle(document.querySelector('.gears')).display,"
                               "getComputedStyle(document.querySelector('figure.moving .pan')).display]")
    expect(printed == ["none", "block"], "print has the still picture")
    browser.send("Emulation.setEmulatedMedia", media="")
    expect(not browser.messages(), f"no message in all of this {browser.messages()[:2]}")
    size = page.stat().st_size
    spatial = browser.evaluate("JSON.parse(document.querySelector('.gears script').textContent).spatial")
    most = 4e6 if spatial else 2e6
    expect(size < most, f"the page has {size / 1e6:.2f} MB, at most {most / 1e6:.0f} MB")


def main(arguments):
    pictures = None
    if arguments[:1] == ["--pictures"]:
        pictures = pathlib.Path(arguments[1])
        pictures.mkdir(parents=True, exist_ok=True)
        arguments = arguments[2:]
    if not arguments:
        print(__doc__)
        return 2
    program = os.environ.get("GEARBENCH_CHROMIUM") or next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if not program:
        print("skipped: there is no Chromium (set GEARBENCH_CHROMIUM)")
        return 0
    failures = []
    browser = Browser(program)
    try:
        for page in arguments:
            check(browser, pathlib.Path(page), failures, pictures)
    finally:
        browser.close()
    print(f"{len(failures)} checks failed" if failures else "all checks hold")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
