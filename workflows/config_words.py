#!/usr/bin/env python3
"""The words of --config that a case reads. usage: config_words.py check|help SNAKEFILE NAME WORDS OF workflows/run...

    check   refuses words that the case does not read, and keys of a sweep that no case has, before anything runs: exit 2
    help    prints what the case is and its words

The words are read from the text of the Snakefile and of the files that it includes: config.get("WORD", ...), config["WORD"], "WORD" in config,
config.setdefault("WORD", ...). Any other use of config is an error of the Snakefile, and is refused as well, so that no word is ever missing here. A
Snakefile that hands config on names the file that knows its words: CHECKED_BY = "settings.py", with WORDS and check(words, folder).
"""
import difflib
import importlib.util
import io
import os
import re
import sys
import tokenize
from dataclasses import dataclass, field

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
sys.dont_write_bytecode = True
from case_keys import Wrong, axes_of  # noqa: E402

CONFIG = r"(?<![\w.-])config\b"   # neither --config nor params.config
READ = re.compile(CONFIG + r"""(?:\s*\.\s*(?:get|setdefault)\s*\(|\s*\[)\s*(["'])([\w-]+)\1(?:\s*,\s*("[^"]*"|'[^']*'|[0-9.]+)\s*\))?""")
ASKED = re.compile(r"""(["'])([\w-]+)\1\s+(?:not\s+)?in\s+config\b(?!\s*[.\[(])""")
OTHER = re.compile(CONFIG + r"(?!\s*=[^=])|^\s*configfile\s*:", re.M)
INCLUDE = re.compile(r"""^\s*include\s*:\s*(["'])(.+?)\1""", re.M)
CHECKED_BY = re.compile(r"""^CHECKED_BY = (["'])(\S+)\1""", re.M)
WHOLE_NUMBERS = {"ranks": 0, "threads": 1, "replicas": 1, "minutes": 1}   # of pipeline.smk, and the least of each
SIZE = "small is for a first look, if the case has it; a wrong size is refused with those that there are"
DESCRIBED = re.compile(r"^#   (\w+)=(\S*) {2,}(\S.*)$", re.M)   # in the comment at the top of a file


@dataclass
class Words:
    own: dict = field(default_factory=dict)      # word of the Snakefile -> its default as a text, "" where it is computed
    shared: dict = field(default_factory=dict)   # of the files that it includes
    described: dict = field(default_factory=dict)   # word -> (what follows "=", meaning)
    checked_by: str = ""                         # the file that knows further words

    @property
    def all(self):
        return list(dict.fromkeys([*self.own, *self.shared]))


def without_comments(text):
    lines = text.splitlines(keepends=True)
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column] + "\n"
    return "".join(lines)


def words_of(snakefile):
    """The words that a Snakefile and the files that it includes read."""
    with open(snakefile, encoding="utf-8") as file:
        text = file.read()
    code, words = without_comments(text), Words()
    for found in READ.finditer(code):
        default = (found[3] or "").strip("\"'")
        words.own[found[2]] = words.own.get(found[2]) or default
    for found in ASKED.finditer(code):
        words.own.setdefault(found[2], "")
    words.described = {name: (form, meaning) for name, form, meaning in DESCRIBED.findall(text)}
    if found := CHECKED_BY.search(code):
        words.checked_by = os.path.join(os.path.dirname(snakefile), found[2])
    elif found := OTHER.search(ASKED.sub("", READ.sub("", code))):
        line = READ.sub("", ASKED.sub("", code))[:found.end()].rpartition("\n")[2].strip()
        raise Wrong(f"{snakefile}: '{line}': config is used in a way from which its words cannot be found; write config.get(\"WORD\", DEFAULT) "
                    "(workflows/config_words.py)")
    for _, name in INCLUDE.findall(code):
        included = words_of(os.path.join(os.path.dirname(snakefile), name))
        words.shared = {**included.own, **included.shared, **words.shared}
        words.described = {**included.described, **words.described}
    # a case that only sets the default of a shared word reads no word of its own
    words.own = {name: default for name, default in words.own.items() if name not in words.shared}
    return words


def snakefile_of(case):
    """case: a name, or the path of a case of the user."""
    return os.path.join(HERE, "own_case.smk") if case.endswith(".toml") else os.path.join(HERE, case, "Snakefile")


def given_in(arguments):
    """The words behind --config, as a list."""
    words, times, is_config = [], 0, False
    for argument in arguments:
        if argument in ("--config", "-C"):
            times, is_config = times + 1, True
        elif found := re.match(r"--config=|-C(?=.)", argument):
            times, is_config = times + 1, False
            words.append(argument[found.end():])
        elif argument.startswith("-"):
            is_config = False
        elif is_config:
            words.append(argument)
    if times > 1:   # Snakemake would take the last and forget the others without a message
        raise Wrong(f"--config is given {times} times; write all words after one: --config {' '.join(words)}")
    return words


def refuse(word, value, name, known):
    near = difflib.get_close_matches(word, known, 1)
    raise Wrong(f"--config {word}={value}: {name} has no word '{word}'" + (f", did you mean '{near[0]}'? There are: " if near else "; there are: ") +
                (", ".join(known) or "none"))


def module_of(path):
    folder = os.path.dirname(path)
    if folder not in sys.path:
        sys.path.append(folder)
    spec = importlib.util.spec_from_file_location("checked_by", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["checked_by"] = module   # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def check(snakefile, name, given, is_points=False):
    """Refuses words of --config that the case does not read. given: WORD=VALUE each. is_points: they are given together with points=."""
    words, values = words_of(snakefile), {}
    for word in given:
        key, equals, value = word.partition("=")
        if not equals or not key:
            raise Wrong(f"--config {word}: expected WORD=VALUE; words of {name}: {', '.join(words.all) or 'none'}")
        values[key] = value
    if words.checked_by and not is_points and "points" not in values:
        try:
            module = module_of(words.checked_by)
        except ImportError:
            return   # before ./setup; the Snakefile checks again
        try:
            module.check(values, os.environ.get("PWD", os.getcwd()))
        except ValueError as error:
            raise Wrong(str(error)) from None
        return
    for key, value in values.items():
        if key not in words.all:
            refuse(key, value, name, words.all)
        if not value.strip():
            raise Wrong(f"--config {key}=: a value is missing; leave {key} out for what it is without")
        if key in WHOLE_NUMBERS and key in words.shared and not (re.fullmatch(r"[0-9]{1,9}", value) and int(value) >= WHOLE_NUMBERS[key]):
            raise Wrong(f"--config {key}={value}: expected a whole number from {WHOLE_NUMBERS[key]} on")
    axes = axes_of(values.get("sweep", ""))
    if int(values.get("replicas", 1)) > 1 and any(axis[0][0] == "seed" for axis in axes):
        raise Wrong(f"--config replicas={values['replicas']}: the sweep has seeds of its own, and replicas would be the same runs again; leave one of the two out")


def sentence(text):
    """Markdown of a cell as plain text, to the end of its first sentence."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text).replace("**", "").replace("`", "").replace(r"\|", "|")
    return re.split(r"(?<=[^.]\.)\s", text.strip(), maxsplit=1)[0].rstrip(".")


def what_it_is(snakefile):
    """The first part of the README of a case, to the end of its commands; of a case of the user the comment at the top of own_case.smk. And its README."""
    readme = os.path.join(os.path.dirname(snakefile), "README.md")
    if os.path.basename(snakefile) == "Snakefile" and os.path.exists(readme):
        with open(readme, encoding="utf-8") as file:
            text = file.read()
        said = []
        for part in re.sub(r"^# .*\n", "", text).strip("\n").split("\n\n"):
            if part.startswith(("#", "|", "![")) or said and said[-1].startswith("    "):
                break
            said.append(part)
        return "\n\n".join(said), text
    with open(snakefile, encoding="utf-8") as file:
        return "\n".join(re.sub(r"^# ?", "", line) for line in re.match(r"(?:#.*\n)*", file.read())[0].splitlines() if not DESCRIBED.match(line)), ""


def show_help(snakefile, name):
    words = words_of(snakefile)
    said, readme = what_it_is(snakefile)
    own, shared = dict(words.own), dict(words.shared)
    if words.checked_by:
        try:
            module = module_of(words.checked_by)
            own = {**module.WORDS, **own}
            shared = {word: default for word, default in shared.items() if word not in {*own, *module.NOT_WORDS}}
        except ImportError as missing:
            print(f"workflows/run: note: {missing}; ./setup installs it, and this page then has all words", file=sys.stderr)
    table = {word: sentence(cells.split(" | ")[-1].rstrip(" |")) for word, cells in re.findall(r"^\| `(\w+)` \|(.*)\|\s*$", readme, re.M)
             if words.checked_by}

    def row(word, default):
        form, meaning = ("", table[word]) if word in table else words.described.get(word, ("", SIZE if word == "size" else ""))
        meaning += (" " if meaning else "") + (f"(default {default})" if default not in ("", None) else "")
        return f"  {f'{word}={form}':<26} {meaning}".rstrip()

    print(f"{said}\n\nWords of --config, all after one --config, WORD=VALUE each:")
    for word, default in own.items():
        print(row(word, default))
    if shared:
        print("and those of all cases that are made of runs of the solver:" if own else "(those of all cases that are made of runs of the solver)")
        for word, default in shared.items():
            print(row(word, default))
    page = os.path.relpath(os.path.join(os.path.dirname(snakefile), "README.md"), os.path.dirname(HERE)) if readme else "docs/user/cookbook.md"
    print(f"\nMore: {page}. Options such as --out FOLDER, --dry-run, --cores: workflows/run --help\nAll further words go to Snakemake: snakemake --help")


def main():
    what, snakefile, name, *arguments = sys.argv[1:]
    try:
        if what == "help":
            show_help(snakefile, name)
        else:
            check(snakefile, name, given_in(arguments))
    except Wrong as reason:
        print(f"workflows/run: error: {reason}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
