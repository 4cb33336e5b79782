#!/usr/bin/env python3
"""No page uses words whose meaning a reader must guess. usage: words_test.py ROOT

docs/develop/style.md, "Words of pages", has the reason. Left out: code between backquotes and fences, targets of links, and what is generated
(the tables of keys in decomposer/CASE.md, and the pages of GENERATED, whose words are those of tests and workflows).
"""
import os
import re
import sys

ENDINGS = (".md",)  # pages only
GENERATED = {"docs/results/validation.md", "docs/results/stability.md", "workflows/stability/notes.md"}
LEFT_OUT = {"build", "out"}  # folders

# pattern: what to write in its place
FORBIDDEN = {
    r"rooms? of (?:its|their|the|a) (?:pair|contact)s?": "maximum overlap",
    r"crowd(?:s|ed)?": "cluster, clustered vertices",
    r"hears?|tells?|told": "reports, prints, finds, distinguishes",
    r"looks|looked at": "examines, examined",
    r"reckon(?:s|ed)?": "computes, uses",
    r"anew": "again",
    r"besides?": "next to, beyond, in addition to, compared with",
    r"in place of": "instead of",
    r"go(?:es)? with": "is proportional to, depends on, is combined with",
    r"for ever|forever": "indefinitely",
    r"nobody|somebody|who": "no body, which body, the person's role",
    r"lack(?:s|ed)?": "need, miss, have no",
    r"corners? (?:and|or) edges?|edges? (?:and|or) corners?|corners? of (?:the|a) mesh(?:es)?": "vertices and edges",
    r"wait on the way|(?:one|its own) way to go|slack on way": "travel, displacement, degree of freedom",
    r"doubts": "warns, warnings of a case",
    r"mends?|mended": "repairs, corrects",
    r"do not mind|never mind": "are not affected by",
    r"issue \d+": "what changed",
    r"part of a core": "shared core",
}
# (page, words around a match): quotations
EXEMPT = set()


def prose(text):
    """The text without code, targets of links and generated tables; line numbers stay."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match[0])

    text = re.sub(r"^<!-- keys .*?^<!-- end -->", blank, text, flags=re.S | re.M)
    text = re.sub(r"^```.*?^```", blank, text, flags=re.S | re.M)
    text = re.sub(r"`[^`\n]*`", blank, text)
    return re.sub(r"\]\([^)\s]*\)", blank, text)


def main():
    root, wrong, count = sys.argv[1], [], 0
    pattern = re.compile("|".join(rf"(?P<w{k}>\b(?:{words})\b)" for k, words in enumerate(FORBIDDEN)), re.I)
    better = list(FORBIDDEN.values())
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if not name.startswith(".") and name not in LEFT_OUT)
        for name in sorted(names):
            page = os.path.relpath(os.path.join(folder, name), root)
            if not name.endswith(ENDINGS) or page in GENERATED:
                continue
            count += 1
            with open(os.path.join(root, page), encoding="utf-8") as file:
                text = prose(file.read())
            for match in pattern.finditer(text):
                if any(page == where and words in text[max(0, match.start() - 60): match.end() + 60] for where, words in EXEMPT):
                    continue
                line = text.count("\n", 0, match.start()) + 1
                wrong.append(f"{page}:{line}: '{match[0]}': write {better[int(match.lastgroup[1:])]}")
    assert count > 50, f"only {count} pages found"
    assert not wrong, "\n".join(wrong)
    print(f"{count} pages are free of {len(FORBIDDEN)} kinds of words")


main()
