#!/usr/bin/env python3
"""Names and paths as users have them, through all four tools: bytes that are no UTF-8, blanks, commas, quotes and markup.
usage: names_test.py BIN FOLDER"""
import csv
import html.parser
import json
import os
import shutil
import subprocess
import sys

BIN, FOLDER = os.path.abspath(os.fsencode(sys.argv[1])), os.fsencode(sys.argv[2])
ODD = b"b\xe4ll, \"a\" <b> 'c'"   # Latin-1
MATERIAL = "<!--<script>"
WALL = 'floor, left "a"'
shutil.rmtree(FOLDER, ignore_errors=True)
os.makedirs(FOLDER)
os.chdir(FOLDER)


def tool(name, *words, code=0, text=b""):
    """Runs a tool in the folder; its exit code and a part of what it prints are as expected."""
    command = [os.path.join(BIN, name.encode()), *(w if isinstance(w, bytes) else w.encode() for w in words)]
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=100)
    assert result.returncode == code and text in result.stdout, f"{command}: exit {result.returncode}, expected {code} with {text}:\n{result.stdout}"


def table(path):
    """Rows of a CSV table, all as long as its header; lines with units left out."""
    with open(path, newline="", encoding="utf-8", errors="surrogateescape") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    assert len(rows) > 1 and {len(row) for row in rows} == {len(rows[0])}, (path, rows)
    return [dict(zip(rows[0], row)) for row in rows[1:]]


tool("scree-mesher", "generate", "sphere", "--radius", "1cm", "--analytic", "-o", ODD + b".shape.h5", "--name", "ball")
tool("scree-mesher", "generate", "box", "--size", "1cm,1cm,1cm", "-o", ODD + b".box.shape.h5", "--name", "box, small")
tool("scree-mesher", "describe", ODD + b".box.shape.h5", "--csv", ODD + b".csv")
assert table(ODD + b".csv")[0]["shape"] == "box, small"
with open(ODD + b".off", "w") as file:
    file.write("OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n")
tool("scree-mesher", "import", ODD + b".off", "-o", ODD + b".solid.shape.h5")
shutil.copy(ODD + b".shape.h5", b"ball.shape.h5")
with open(ODD + b".toml", "w") as file:
    file.write(f"""title = "names"
gravity = [0, 0, -9.81]
time = {{ duration = "0.01 s" }}
contact = {{ margin = 0 }}
shapes.ball.file = "ball.shape.h5"
materials.'{MATERIAL}'.density = "2500 kg/m^3"
materials.'glass, clear'.density = "2500 kg/m^3"
pairs = [{{ between = ['{MATERIAL}', 'glass, clear'], stiffness = "2 kN/m", restitution = 0.3, friction = 0.3 }}]
bodies = [{{ shape = "ball", material = '{MATERIAL}', position = [0, 0, 0.0101] }}]
output = {{ every = "0.005 s", contacts = true }}
[[walls]]
name = '{WALL}'
shape = {{ plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }} }}
material = 'glass, clear'
""")
tool("scree-decomposer", "pack", ODD + b".toml", "-o", ODD + b".scene.h5")
tool("scree-solver", ODD + b".scene.h5", "-o", ODD + b".run")

# the record names what is there, byte by byte
with open(os.path.join(ODD + b".run", b"run.json"), encoding="utf-8") as file:
    record = json.load(file)
words = record["provenance"]["command"]
back = b"".join(bytes([ord(c) - 0xF700]) if 0xF780 <= ord(c) <= 0xF7FF else c.encode() for c in words[-1])
assert back == ODD + b".run", (words, back)

tool("scree-post", "report", ODD + b".run", "-o", ODD + b".html", "--json", ODD + b".json")
with open(ODD + b".json", encoding="utf-8") as file:
    numbers = json.load(file)
assert all(file["state"] == "same" for file in numbers["files"]), numbers["files"]


class Page(html.parser.HTMLParser):
    """Sections of the page, and what stands in its elements of data."""
    def __init__(self):
        super().__init__()
        self.sections, self.data, self.inside, self.text = [], "", False, ""

    def handle_starttag(self, tag, attributes):
        self.sections += [dict(attributes)["id"]] if tag == "section" else []
        self.inside = dict(attributes).get("id") == "view-data"
        assert tag != "script" or not attributes or self.inside, attributes

    def handle_endtag(self, tag):
        self.inside = self.inside and tag != "script"

    def handle_data(self, data):
        if self.inside:
            self.data += data
        self.text += data


with open(ODD + b".html", encoding="utf-8") as file:   # fails where it is no UTF-8
    text = file.read()
page = Page()
page.feed(text)
assert page.sections[-1] == "repeat" and len(page.sections) == 10, page.sections
assert "<" not in page.data, "a browser may take it for the end of the data, or for its beginning"
assert json.loads(page.data)["materials"] == [MATERIAL, "glass, clear"]
assert "$'b\\xe4ll" in page.text, "the commands do not name the file as a shell takes it"

tool("scree-post", "statistics", ODD + b".run", "-o", ODD + b".statistics", "--no-charts", "--by-material")
assert {row["group"] for row in table(ODD + b".statistics/summary.csv")} == {"all", f"material {MATERIAL}", "material glass, clear", f"wall 1 {WALL}"}
for name in os.listdir(ODD + b".statistics"):
    if name.endswith(b".csv") and name != b"force_chains.csv":
        table(os.path.join(ODD + b".statistics", name))
shutil.copytree(ODD + b".run", b"other " + ODD + b".run")
tool("scree-post", "compare", ODD + b".run", b"other " + ODD + b".run", "-o", ODD + b".comparison")
for name in (b"statistics.csv", b"divergence.csv"):
    table(os.path.join(ODD + b".comparison", name))
tool("scree-post", "bodies", ODD + b".run", "-o", ODD + b".bodies.csv")
tool("scree-post", "contacts", ODD + b".run", "-o", ODD + b".contacts.csv")
tool("scree-post", "scaling", ODD + b".run", "-o", ODD + b".scaling")
assert table(ODD + b".scaling/scaling.csv")
tool("scree-post", "vtk", ODD + b".run", "-o", ODD + b".vtk") if "--vtk" in sys.argv else None
tool("scree-post", "paraview", ODD + b".run") if "--vtk" in sys.argv else None

# what is no text is refused by name where text is needed
with open(b"latin.toml", "wb") as file:
    file.write(b"title = \"b\xe4ll\"\n")
tool("scree-decomposer", "pack", "latin.toml", "-o", "x.scene.h5", code=2, text=b"latin.toml")
print("all as expected")
