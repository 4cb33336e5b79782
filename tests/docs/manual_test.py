#!/usr/bin/env python3
"""The manual is built of all pages, its search works from a disk, and wrong pages are named. usage: manual_test.py ROOT SCRATCH   Exit 77: skipped."""
import os
import re
import shutil
import subprocess
import sys

ROOT, SCRATCH = sys.argv[1:3]
NO_PAGES = 3  # parts of generated pages


def build(root, code=0):
    result = subprocess.run(["/usr/bin/python3", os.path.join(root, "docs/manual/build"), "-o", os.path.join(SCRATCH, "manual")], capture_output=True, text=True)
    if result.returncode == 4 and "is missing" in result.stderr and "CI" not in os.environ:
        print(f"SKIPPED: {result.stderr}")
        sys.exit(77)
    assert result.returncode == code, f"exit {result.returncode}, {code} expected\n{result.stdout}{result.stderr}"
    return result.stdout + result.stderr


def page(name):
    with open(os.path.join(SCRATCH, "manual", name), encoding="utf-8") as file:
        return file.read()


def every_page_is_in_it():
    build(ROOT)
    found = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [name for name in folders if not name.startswith(".") and name not in ("build", "out")]
        found += [os.path.relpath(os.path.join(folder, name), ROOT) for name in files if name.endswith(".md")]
    missing = [path for path in found if not os.path.exists(os.path.join(SCRATCH, "manual", re.sub(r"README\.md$|\.md$", lambda m: "index.html" if m[0] == "README.md" else ".html", path)))]
    assert len(found) > 50 and len(missing) == NO_PAGES, missing
    home = page("index.html")
    for path in found:
        if path not in missing:
            target = re.sub(r"README\.md$", "index.html", path).replace(".md", ".html")
            assert f'href="{target}"' in home or target == "index.html", f"{path} is not in the contents"


def what_the_sources_say_is_shown():
    """Where Python-Markdown differs from what forges show."""
    case = page("decomposer/CASE.html")
    assert case.count("<table>") == open(os.path.join(ROOT, "decomposer/CASE.md"), encoding="utf-8").read().count("\n|---"), "a table of CASE.md is no table"
    for folder, _, files in os.walk(os.path.join(SCRATCH, "manual")):
        for name in files:
            if name.endswith(".html"):
                path = os.path.join(folder, name)
                text = re.sub(r"<pre>.*?</pre>", "", page(os.path.relpath(path, os.path.join(SCRATCH, "manual"))), flags=re.S)
                wrong = re.findall(r"^(?:<p>)?(?:\||- |```|<!--).*", text, flags=re.M)
                assert not wrong, f"{path}: not understood as table, list or code: {wrong[:3]}"
                assert "\\|" not in "".join(re.findall(r"<td.*?</td>", text, flags=re.S)), path
    missed = re.findall(r"^- \*\*(\w+)\*\*: .*\n((?:  - .*\n)+)", open(os.path.join(ROOT, "docs/results/validation.md"), encoding="utf-8").read(), flags=re.M)
    assert missed, "no case of docs/results/validation.md has a list below it"
    for case_name, below in missed:
        nested = re.search(rf"<li><strong>{case_name}</strong>.*?</ul>", page("docs/results/validation.html"), flags=re.S)
        assert nested and nested[0].count("<li>") == 1 + below.count("\n"), f"the list below {case_name} is not within it"
    assert re.search(r"<main>.*?<details>\n<summary>[^<]*</summary>\n<table>", page("docs/results/stability.html"), flags=re.S), "no table in the first fold"


def the_search_works_from_a_disk():
    chromium = shutil.which("chromium")
    if not chromium:
        print("no Chromium: the search is not tried; run ./setup")
        return
    for words, first in (("rolling friction", "olling"), ("steps_per_contact", "[time]"), ("nosuchwordatall", "No page has this word")):
        address = "file://" + os.path.abspath(os.path.join(SCRATCH, "manual/solver/index.html")) + "?q=" + words.replace(" ", "+")
        shown = subprocess.run([chromium, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={os.path.join(SCRATCH, 'profile')}", "--dump-dom", address],
                               capture_output=True, text=True, timeout=60).stdout
        results = shown.partition('<div id="results">')[2].partition('<div id="chapters"')[0]
        plain = re.sub(r"<[^>]*>", "", results)
        assert first in plain, f"{words}: {plain[:500]}"
        for link in re.findall(r'href="([^"#]*)', results):
            assert os.path.exists(os.path.join(SCRATCH, "manual/solver", link)), f"the result {link} leads nowhere"


def wrong_pages_are_named():
    small = os.path.join(SCRATCH, "small")
    shutil.copytree(os.path.join(ROOT, "docs/manual"), os.path.join(small, "docs/manual"))
    with open(os.path.join(small, "docs/manual/mkdocs.yml"), encoding="utf-8") as file:
        text = file.read()
    with open(os.path.join(small, "docs/manual/mkdocs.yml"), "w", encoding="utf-8") as file:
        file.write(text[: text.index("nav:")] + "nav:\n  - README.md\n  - More:\n      - docs/*.md\n")
    good = "# Home\n\nSee [there](docs/there.md#a-heading), [here](#home), [code](code/) and [a file](code/a.txt).\n"
    pages = {"README.md": good, "docs/there.md": "# There\n\n## A heading\n\ntext:\n- one\n- two\n", "code/a.txt": "a"}
    for path, text in pages.items():
        os.makedirs(os.path.join(small, os.path.dirname(path)), exist_ok=True)
        with open(os.path.join(small, path), "w", encoding="utf-8") as file:
            file.write(text)
    assert "3 pages" in build(small)
    assert "<li>one</li>" in page("docs/there.html") and "<code>a.txt</code>" in page("code/index.html")
    for path, text, message in (("README.md", good.replace("there.md#a", "nowhere.md#a"), "nowhere.md"), ("README.md", good.replace("#a-heading", "#no-heading"), "no such heading"),
                                ("README.md", good.replace("#home", "#hone"), "index.html: the link to #hone leads to a page that has no such heading"),
                                ("README.md", good.replace("code/a.txt", "code/b.txt"), "code/b.txt"),
                                ("README.md", good + "![](https://example.org/a.png)\n", "a browser would fetch it"),
                                ("code/notes.md", "# Notes\n", "code/notes.md: in no chapter of docs/manual/mkdocs.yml")):
        with open(os.path.join(small, path), "w", encoding="utf-8") as file:
            file.write(text)
        said = build(small, code=3)
        assert message in said, said
        with open(os.path.join(small, "README.md"), "w", encoding="utf-8") as file:
            file.write(good)
    os.remove(os.path.join(small, "code/notes.md"))
    shutil.rmtree(os.path.join(SCRATCH, "manual"))
    os.makedirs(os.path.join(SCRATCH, "manual/own"))
    assert "no manual; remove it" in build(small, code=4)  # a folder of somebody else stays
    assert os.path.isdir(os.path.join(SCRATCH, "manual/own"))


shutil.rmtree(SCRATCH, ignore_errors=True)
os.makedirs(SCRATCH)
every_page_is_in_it()
what_the_sources_say_is_shown()
the_search_works_from_a_disk()
wrong_pages_are_named()
shutil.rmtree(SCRATCH)
print("the manual is built, searched, and refuses wrong pages")
