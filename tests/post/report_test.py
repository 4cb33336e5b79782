#!/usr/bin/env python3
"""Opens report.html in headless Chromium as a reader does: at desktop and phone width, nothing in the console, nothing from the
network, the 3D view drawn, turned and a body picked, all frames played as `scree-post bodies` has them, printed to PDF.
Exit 77: there is no Chromium (Debian: apt-get install chromium).
usage: report_test.py REPORT.html REPORT.json SCRATCH, with REPORT.csv, come.html, come.json, come.csv and one.html next to REPORT.html"""
import base64
import collections
import csv
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

REPORT, NUMBERS, SCRATCH = sys.argv[1:4]
BROWSER = next((p for p in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if p), None)
if BROWSER is None:
    print("SKIPPED: no Chromium on PATH (Debian: apt-get install chromium)")
    sys.exit(77)


class Browser:
    """Chromium over its debugging pipe: JSON messages that end in a zero byte, commands on descriptor 3, answers on 4."""

    def __init__(self, profile):
        to_read, self.commands = os.pipe()
        self.answers, to_write = os.pipe()
        arguments = [BROWSER, "--headless=new", "--remote-debugging-pipe", "--no-sandbox", "--disable-gpu-sandbox", "--use-angle=swiftshader",
                     "--enable-unsafe-swiftshader", "--disable-dev-shm-usage", "--no-first-run", "--disable-background-networking",
                     "--user-data-dir=" + profile, "about:blank"]

        def wire():
            saved_in, saved_out = os.dup(to_read), os.dup(to_write)  # 3 and 4 themselves may be among them
            os.dup2(saved_in, 3)
            os.dup2(saved_out, 4)
        self.process = subprocess.Popen(arguments, preexec_fn=wire, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        os.close(to_read)
        os.close(to_write)
        self.buffer, self.number, self.events = b"", 0, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = None
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]

    def message(self):
        while b"\0" not in self.buffer:
            part = os.read(self.answers, 1 << 20)
            assert part, "Chromium ended"
            self.buffer += part
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        command = {"id": self.number, "method": method, "params": parameters}
        if getattr(self, "session", None):
            command["sessionId"] = self.session
        os.write(self.commands, json.dumps(command).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                assert "error" not in answer, (method, answer["error"])
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, method):
        while True:
            for event in self.events:
                if event.get("method") == method:
                    self.events.remove(event)
                    return event
            self.events.append(self.message())

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in result, (expression, result["exceptionDetails"])
        return result["result"].get("value")

    def close(self):
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()


def drag(browser, x, y, dx, dy):
    browser.call("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", buttons=1, clickCount=1)
    for step in (0.5, 1.0):
        browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + step * dx, y=y + step * dy, button="left", buttons=1)
    browser.call("Input.dispatchMouseEvent", type="mouseReleased", x=x + dx, y=y + dy, button="left", clickCount=1)


def look(browser, name, width, height, phone):
    browser.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone)
    browser.call("Page.navigate", url="file://" + os.path.abspath(REPORT))
    browser.wait_for("Page.loadEventFired")
    wide = browser.value("document.documentElement.scrollWidth")
    assert wide <= width, f"{name}: the page is {wide} pixels wide on a screen of {width}: " + browser.value("[...document.querySelectorAll('*')].filter(e => e.getBoundingClientRect().right > " + str(width) + ").map(e => e.tagName + '.' + e.className).slice(0, 12).join()")
    assert browser.value("document.querySelector('#verdicts .verdict h3').textContent") == "Outcome"
    assert browser.value("document.querySelector('section').id") == "verdicts", "the verdicts come first"
    assert browser.value("[...document.images].every(i => i.naturalWidth > 0)"), f"{name}: a picture is broken"

    browser.value("document.getElementById('view-canvas').scrollIntoView({block: 'center'})")
    covered = browser.value("window.screeView.covered()")
    assert 0.02 < covered < 0.95, f"{name}: bodies and walls cover {covered} of the 3D view"
    body = browser.value("window.screeView.visible()")
    assert body, f"{name}: no body is seen"
    for kind in ("mousePressed", "mouseReleased"):
        browser.call("Input.dispatchMouseEvent", type=kind, x=body["x"], y=body["y"], button="left", buttons=1, clickCount=1)
    panel = browser.value("document.getElementById('view-panel').textContent")
    assert panel.startswith("Body %d:" % body["id"]) and " m/s" in panel, (name, panel, body)
    before, near = browser.value("window.screeView.cameraFrom()"), browser.value("window.screeView.distance()")
    drag(browser, body["x"], body["y"], 60, 25)
    assert browser.value("window.screeView.cameraFrom()") != before, f"{name}: dragging does not turn"
    browser.value("document.querySelector('.tools [name=nearer]').click()")
    assert browser.value("window.screeView.distance()") < near, f"{name}: the button does not zoom"
    for setting in ("speed", "material"):
        browser.value(f"(s => {{ s.value = '{setting}'; s.dispatchEvent(new Event('change')); }})(document.querySelector('.tools [name=colour]'))")
    browser.value("(c => { if (!c.disabled) c.click(); })(document.querySelector('.tools [name=contacts]'))")
    assert browser.value("window.screeView.covered()") > 0.005
    shot = browser.call("Page.captureScreenshot", format="png")["data"]
    with open(os.path.join(SCRATCH, name + ".png"), "wb") as f:
        f.write(base64.b64decode(shot))
    full = browser.call("Page.captureScreenshot", format="png", captureBeyondViewport=True)["data"]
    with open(os.path.join(SCRATCH, name + "-page.png"), "wb") as f:
        f.write(base64.b64decode(full))
    return browser.value("document.body.innerText")


def press(browser, key):
    for kind in ("keyDown", "keyUp"):
        browser.call("Input.dispatchKeyEvent", type=kind, key=key, code={" ": "Space"}.get(key, key), text=key if key == " " else "")


def choose(browser, name, value):
    browser.value(f"(s => {{ s.value = {json.dumps(value)}; s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); }})"
                  f"(document.querySelector('.view [name={name}]'))")


def canvas(browser):
    """The pixels of the view as they are drawn now, as text."""
    browser.value("window.screeView.covered()")  # draws
    return browser.value("document.getElementById('view-canvas').toDataURL()")


def load(browser, page):
    browser.call("Page.navigate", url="file://" + os.path.abspath(page))
    browser.wait_for("Page.loadEventFired")
    browser.value("document.getElementById('view-canvas').scrollIntoView({block: 'center'})")


def bodies_of(path):
    """Rows by time, in order: id, place, quaternion x y z w, velocity."""
    frames = collections.OrderedDict()
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            frames.setdefault(float(row["time"]), []).append([float(row[c]) for c in "id x y z qx qy qz qw vx vy vz".split()])
    return frames


def poses_are_those_of_the_run(browser, tables, numbers):
    """Each frame of the page against the table of `scree-post bodies`: the same bodies, within the errors that the page states."""
    with open(numbers) as file:
        view = json.load(file)["view"]
    text = browser.value("document.querySelector('#view .note').textContent")
    assert f"{view['position_error']:.2g} m" in text and f"{view['angle_error'] * 180 / math.pi:.2g} degrees" in text, text
    assert 0 < view["position_error"] < 1e-4 * view["smallest_diameter"] and 0 < view["angle_error"] < math.radians(0.01), view
    times = browser.value("window.screeView.frames.map(f => f[1])")
    assert len(times) == view["frames"] == view["frames_of_run"], (times, view)
    counts, slack, worst = [], 1e-7 * view["smallest_diameter"], 0
    for k, time in enumerate(times):
        choose(browser, "frame", k)
        shown = browser.value("document.querySelector('.player output').textContent")
        assert f"t = {float(f'{time:.4g}'):g} s" in shown, (time, shown)
        found, expected = browser.value("window.screeView.poses()"), tables.get(time, [])
        counts.append(len(found))
        assert [b[0] for b in found] == [b[0] for b in expected], (time, "the bodies are others")
        for a, b in zip(found, expected):
            distance = math.dist(a[1:4], b[1:4])
            worst = max(worst, distance)
            assert distance <= view["position_error"] + slack, (time, a, b)
            # of small angles: twice the distance between the quaternions, of which both signs are one orientation
            angle = 2 * min(math.dist(a[4:8], b[4:8]), math.dist([-c for c in a[4:8]], b[4:8]))
            assert angle <= view["angle_error"] + 1e-6, (time, angle, view)
            assert all(abs(v - w) <= 2e-5 * abs(w) for v, w in zip(a[8:11], b[8:11])), (time, a, b)
    assert worst > 0.3 * view["position_error"], (worst, "the error that the page states is not that of its bodies")
    return counts


def plays(browser):
    """Controls, keys and settings of the page that was loaded last, which has three frames and a lid that moves."""
    value = browser.value
    assert not value("window.screeView.playing()"), "it plays by itself"
    assert value("window.screeView.state.frame") == 2, "the frame of the pictures is shown first"
    assert value("document.querySelector('.player [name=frame]').max") == "2"
    last = canvas(browser)
    choose(browser, "frame", 0)
    first = canvas(browser)
    assert first != last, "the slider changes nothing"
    places = value("window.screeView.wallPlaces()")
    assert abs(places[9]) < 1e-12, places  # the lid, at the start
    choose(browser, "frame", 1)
    assert abs(value("window.screeView.wallPlaces()")[9] + 0.01) < 1e-12, "the lid does not move: 0.1 m/s for 0.1 s"
    assert value("document.querySelector('.tools [name=contacts]').disabled"), "forces of another frame"

    # keys in the view: space plays, arrows turn
    value("document.getElementById('view-canvas').focus({preventScroll: true})")
    before = value("window.screeView.cameraFrom()")
    press(browser, "ArrowLeft")
    assert value("window.screeView.cameraFrom()") != before and value("window.screeView.state.frame") == 1, "an arrow turns the view"
    choose(browser, "rate", 50)
    choose(browser, "frame", 0)
    press(browser, " ")
    assert value("window.screeView.playing()"), "space does not play"
    value("new Promise((done, failed) => { const start = Date.now(), wait = () => !window.screeView.playing() ? done() :"
          " Date.now() - start > 30000 ? failed('it does not end') : setTimeout(wait, 20); wait(); })")
    assert value("window.screeView.state.frame") == 2, "it ends at the last frame"
    value("document.querySelector('.player [name=play]').click()")
    assert value("window.screeView.playing() && window.screeView.state.frame === 0"), "the button begins again"
    value("document.querySelector('.player [name=play]').click()")
    assert not value("window.screeView.playing()"), "the button does not stop it"

    # colours: one scale for all frames, its ends in the legend
    choose(browser, "frame", 0)
    choose(browser, "colour", "height")
    assert value("document.querySelector('.legend').textContent") == "height z 0.05 to 0.18 m in all frames"
    by_height = canvas(browser)
    choose(browser, "colour", "speed")
    speed = float(f"{math.hypot(0.1, 1 / 3):.4g}")
    assert value("document.querySelector('.legend').textContent") == f"speed 0 to {speed:g} m/s in all frames"
    assert canvas(browser) != by_height
    choose(browser, "colour", "shape")

    # walls and cut
    covered = {}
    for walls in ("hidden", "edges", "translucent", "opaque"):
        choose(browser, "walls", walls)
        covered[walls] = value("window.screeView.covered()")
    assert covered["hidden"] < covered["edges"] < covered["translucent"] and covered["opaque"] > 1.2 * covered["edges"], covered
    choose(browser, "walls", "hidden")
    whole = value("window.screeView.covered()")
    assert value("document.querySelector('.cut-tools').hidden")
    choose(browser, "cut", "x")
    assert not value("document.querySelector('.cut-tools').hidden")
    half = value("window.screeView.covered()")
    value("document.querySelector('[name=cut-side]').click()")
    other = value("window.screeView.covered()")
    assert 0 < half < 0.95 * whole and 0 < other < 0.95 * whole, (whole, half, other)
    place = value("window.screeView.state.cutAt")
    body = value("window.screeView.visible()")  # what is cut away is not picked
    assert body, "no body is seen through the cut"
    side = value("window.screeView.state.cutSide")
    x = [b[1] for b in value("window.screeView.poses()") if b[0] == body["id"]][0]
    assert side * (x - place) < 0.06, (body, x, place, side)  # no body is larger
    choose(browser, "cut-at", 0)
    end = value("window.screeView.covered()")
    choose(browser, "cut-at", 1000)
    ends = sorted((end, value("window.screeView.covered()")))
    assert ends[0] == 0 and abs(ends[1] - whole) < 0.01 * whole, (ends, whole)
    choose(browser, "cut", "off")
    assert value("window.screeView.covered()") == whole


os.makedirs(SCRATCH, exist_ok=True)
profile = tempfile.mkdtemp(dir=SCRATCH)
browser = Browser(profile)
signal.alarm(240)  # a browser that hangs ends the test
try:
    for domain in ("Page", "Runtime", "Network", "Log"):
        browser.call(domain + ".enable")
    text = look(browser, "desktop", 1280, 900, False)
    look(browser, "phone", 390, 844, True)
    pdf = base64.b64decode(browser.call("Page.printToPDF", printBackground=True)["data"])
    with open(os.path.join(SCRATCH, "report.pdf"), "wb") as f:
        f.write(pdf)
    browser.call("Emulation.setDeviceMetricsOverride", width=1280, height=900, deviceScaleFactor=1, mobile=False)
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
    load(browser, REPORT)
    plays(browser)
    beside = os.path.dirname(os.path.abspath(REPORT))
    counts = poses_are_those_of_the_run(browser, bodies_of(REPORT.replace(".html", ".csv")), NUMBERS)
    assert counts == [12, 12, 12], counts
    load(browser, os.path.join(beside, "come.html"))
    assert browser.value("window.screeView.state.frame") == 4
    counts = poses_are_those_of_the_run(browser, bodies_of(os.path.join(beside, "come.csv")), os.path.join(beside, "come.json"))
    assert counts == [0] + 8 * [9], counts
    # a picked body that goes: every fourth body is not in a frame
    choose(browser, "frame", 4)
    body = browser.value("window.screeView.visible()")
    for kind in ("mousePressed", "mouseReleased"):
        browser.call("Input.dispatchMouseEvent", type=kind, x=body["x"], y=body["y"], button="left", buttons=1, clickCount=1)
    panel = "document.getElementById('view-panel').textContent"
    assert browser.value(panel).startswith("Body %d:" % body["id"]) and " m/s" in browser.value(panel), browser.value(panel)
    choose(browser, "frame", 4 - int(body["id"]) % 4)
    assert browser.value(panel).startswith("Body %d:" % body["id"]) and "not there at t = 0." in browser.value(panel), browser.value(panel)
    choose(browser, "walls", "hidden")
    choose(browser, "frame", 0)
    assert browser.value("window.screeView.covered()") == 0, "a body is drawn before it is there"
    load(browser, os.path.join(beside, "one.html"))
    assert browser.value("document.querySelector('.player') === null && dataOf('view-data').player === undefined"), "one frame does not play"
    assert browser.value("window.screeView.covered()") > 0.02 and browser.value("window.screeView.visible()")

    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    assert pdf[:5] == b"%PDF-" and pages >= 3, f"{pages} pages printed"

    bad = []
    for event in browser.events:
        if event["method"] == "Runtime.exceptionThrown" or (event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] in ("error", "warning")):
            bad.append(event["params"])
        if event["method"] == "Runtime.consoleAPICalled" and event["params"]["type"] in ("error", "warning", "assert"):
            bad.append(event["params"])
        if event["method"] == "Network.requestWillBeSent" and not event["params"]["request"]["url"].startswith(("file:", "data:", "blob:")):
            bad.append(event["params"]["request"]["url"])
    assert not bad, json.dumps(bad, indent=1)[:3000]
finally:
    browser.close()
    shutil.rmtree(profile, ignore_errors=True)

with open(NUMBERS) as f:
    numbers = json.load(f)
for verdict in numbers["verdicts"]:
    assert verdict["question"] in text and verdict["answer"] in text, verdict
for name, entry in numbers["statistics"]["groups"]["all"].items():
    assert name in text, name
    assert f"{entry['mean']:.5g}" in text or entry["mean"] == 0, (name, entry["mean"])
print(f"desktop, phone, {pages} printed pages and the frames that are played are as they should be")
