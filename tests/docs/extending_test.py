#!/usr/bin/env python3
"""Does what docs/develop/extending.md says, in a scratch copy of the tree. usage: extending_test.py ROOT SCRATCH [--build]

Comments in the page, before a fenced block, say what becomes of the block:
  <!-- new file PATH -->                      the block is the file
  <!-- in PATH, after: TEXT -->               the block comes after the one line that holds TEXT
  <!-- in PATH, before: TEXT -->              the block comes before it
  <!-- in PATH, replace: TEXT -->             the block takes its place
  <!-- run -->                                the block is run, all in one folder, with the tools of the scratch tree in PATH
Without --build only the places are looked up, which takes no time; with it the scratch tree is built and the run blocks are run.
"""
import os
import re
import shutil
import subprocess
import sys

PAGE = "docs/develop/extending.md"
BLOCK = re.compile(r"^<!-- (new file|in|run)\s*([^\n]*?)\s*-->\n```\w*\n(.*?)^```$", flags=re.S | re.M)
TARGETS = ["scree-solver", "scree-decomposer", "scree-post"]


def copy_tree(root, scratch):
    shutil.copytree(root, scratch, ignore=shutil.ignore_patterns(".git", "build", "out", "__pycache__"))


def insert(scratch, words, block):
    path, where = words.split(", ", 1)
    side, anchor = where.split(": ", 1)
    full = os.path.join(scratch, path)
    assert os.path.isfile(full), f"{PAGE} names {path}, which is not there"
    with open(full, encoding="utf-8") as file:
        lines = file.readlines()
    places = [k for k, line in enumerate(lines) if anchor in line]
    assert len(places) == 1, f"{PAGE}: '{anchor}' is in {len(places)} lines of {path}, not in one"
    at = places[0] + (1 if side == "after" else 0)
    with open(full, "w", encoding="utf-8") as file:
        file.writelines(lines[:at] + [block] + lines[at + (1 if side == "replace" else 0):])


def main():
    root, scratch = sys.argv[1:3]
    with open(os.path.join(root, PAGE), encoding="utf-8") as file:
        page = file.read()
    shutil.rmtree(scratch, ignore_errors=True)
    os.makedirs(scratch)
    tree = os.path.join(scratch, "tree")
    copy_tree(root, tree)
    scripts, changes = [], 0
    for kind, words, block in BLOCK.findall(page):
        if kind == "run":
            scripts.append(block)
            continue
        changes += 1
        if kind == "in":
            insert(tree, words, block)
            continue
        path = os.path.join(tree, words)
        assert not os.path.exists(path), f"{PAGE} makes {words}, which is there already"
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(block)
    assert changes > 0 and scripts, f"{PAGE} has no blocks that are done"
    print(f"{changes} changes made", flush=True)
    if "--build" not in sys.argv:
        shutil.rmtree(scratch)
        return
    build = os.path.join(scratch, "build")
    subprocess.run(["cmake", "-S", tree, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DSCREE_BENCHMARKS=OFF"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", build, "--target", *TARGETS], check=True)
    environment = dict(os.environ, PATH=os.path.join(build, "bin") + os.pathsep + os.environ["PATH"], ROOT=tree)
    os.makedirs(os.path.join(scratch, "runs"))
    for script in scripts:
        subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=os.path.join(scratch, "runs"), env=environment, check=True)
    print(f"{len(scripts)} runs did what the page says")
    shutil.rmtree(scratch)


main()
