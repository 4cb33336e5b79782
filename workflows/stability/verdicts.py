"""The table of a session: what was held, refused with a named reason, or failed."""
import re

import numpy

from scene import ToolError

HELD, REFUSED, FAILED = "held", "refused", "failed"


class Table:
    """Rows (case, what, verdict, figure) of one session."""

    def __init__(self):
        self.rows, self.case = [], ""

    def add(self, what, verdict, figure):
        self.rows.append({"case": self.case, "what": what, "verdict": verdict, "figure": figure})
        print(f"  {verdict:8} {what}: {figure}", flush=True)

    def figure(self, what, value, limit, text=""):
        """Held when value <= limit; NaN is never held."""
        self.add(what, HELD if value <= limit else FAILED, f"{text + ' ' if text else ''}{value:.3g} (at most {limit:.3g})")

    def truth(self, what, holds, text):
        self.add(what, HELD if holds else FAILED, text)

    def refusal(self, what, error):
        """A named refusal, or a failure when the tool crashed or said nothing."""
        said = [line for line in error.text.splitlines() if "error:" in line]
        message = said[-1].split("error:", 1)[1].strip() if said else ""
        message = re.sub(r"/[^ :]*/", "", message)  # folders of this machine
        verdict = REFUSED if error.code in (2, 3, 5) and message else FAILED
        self.add(what, verdict, f"exit {error.code}: {message[:220] or 'no message: ' + error.text.strip()[-160:]}")

    def must_refuse(self, what, action, words=""):
        """A refusal that says these words is the right answer; another one, or going on, is a failure."""
        try:
            action()
        except ToolError as error:
            if words in error.text:
                self.refusal(what, error)
            else:
                self.add(what, FAILED, f"refused, but not for '{words}': {error.text.strip()[-200:]}")
        else:
            self.add(what, FAILED, "accepted in silence")


def finite(run):
    return bool(numpy.isfinite(run.x).all() and numpy.isfinite(run.v).all() and numpy.isfinite(run.w).all() and numpy.isfinite(run.q).all())
