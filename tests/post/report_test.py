#!/usr/bin/env python3
"""Opens report.html in headless Chromium as a reader does: at desktop and phone width, nothing in the console, nothing from the
network, the 3D view drawn, turned and a body picked, printed to PDF. Exit 77: there is no Chromium (Debian: apt-get install chromium).
usage: report_test.py REPORT.html REPORT.json SCRATCH"""
import base64
import json
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
print(f"desktop, phone and {pages} printed pages are as they should be")
