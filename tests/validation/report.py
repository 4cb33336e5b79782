"""What a case measured against what it should be: the printed table, and one row per run for the error-against-time CSV."""
import csv
import os

import numpy

# docs/reference/validation-plan.md, section 4.5; what a run does not have stays empty
COLUMNS = ["case", "commit", "compiler", "isa", "precision", "threads", "ranks", "integrator", "law", "ttd", "steps_per_contact", "step",
           "margin", "triangles", "steps", "contacts_per_step", "pairs_per_step", "wall_median", "wall_min", "t_search", "t_contact",
           "t_integrate", "t_halo", "t_migrate", "t_output", "error_e", "error_t", "error_traj", "energy_drift_slope", "energy_drift_rms",
           "angular_momentum_drift", "momentum_drift", "max_depth_ratio", "max_residual",
           "checks", "missed", "worst_check", "measured", "expected", "tolerance", "error_over_tolerance"]


class Check:
    """measured against expected: |measured - expected| <= tolerance, in the kind's measure."""

    def __init__(self, case, what, measured, expected, tolerance, kind, note):
        self.case, self.what, self.measured, self.expected = case, what, measured, expected
        self.tolerance, self.kind, self.note = tolerance, kind, note
        if kind == "relative":
            self.error = abs(measured - expected) / abs(expected)
        elif kind == "absolute":
            self.error = abs(measured - expected)
        elif kind == "at most":
            self.error = measured
        elif kind == "at least":
            self.error = -measured
        else:
            raise ValueError(kind)
        # a NaN holds nothing
        self.holds = bool(self.error <= (-tolerance if kind == "at least" else tolerance))
        # how much of the tolerance is used: 1 at the limit; nothing to tell apart where a tolerance is 0
        if kind == "at least":
            self.used = tolerance / measured if measured > 0 else float("inf")
        else:
            self.used = self.error / tolerance if tolerance > 0 else (0.0 if self.holds else float("inf"))

    def cells(self):
        limit = f"{self.tolerance:.3g}"
        if self.kind == "at most":
            return [number(self.measured), "", f"<= {limit}", ""]
        if self.kind == "at least":
            return [number(self.measured), "", f">= {limit}", ""]
        return [number(self.measured), number(self.expected), f"{limit} {'rel' if self.kind == 'relative' else 'abs'}", f"{self.error:.2g}"]


def number(value):
    if isinstance(value, (bool, numpy.bool_)):
        return str(bool(value))
    return f"{value:.8g}"


class Report:
    """Collects checks and runs. explained: {(case, what): why} for misses that physics explains; they are still misses."""

    def __init__(self, csv_path=None):
        self.checks, self.csv_path, self.rows = [], csv_path, []  # rows: of the case at work, written when it ends
        self.case, self.seconds, self.steps, self.contacts, self.runs = "", 0.0, 0, 0.0, 0

    def begin(self, case):
        self.rows = []
        self.case, self.seconds, self.steps, self.contacts, self.runs = case, 0.0, 0, 0.0, 0

    def check(self, what, measured, expected=0.0, tolerance=0.0, kind="relative", note=""):
        c = Check(self.case, what, float(measured), float(expected), float(tolerance), kind, note)
        self.checks.append(c)
        print(f"  {'ok  ' if c.holds else 'MISS'} {what}: " + ", ".join(
            f"{name} {cell}" for name, cell in zip(("measured", "expected", "tolerance", "error"), c.cells()) if cell) + (f"  ({note})" if note else ""), flush=True)
        return c.holds

    def at_most(self, what, measured, limit, note=""):
        return self.check(what, measured, 0, limit, "at most", note)

    def at_least(self, what, measured, limit, note=""):
        return self.check(what, measured, 0, limit, "at least", note)

    def run(self, run, **errors):
        """Notes a run: its time, steps and contacts for the printed table, and a row of the CSV with the errors given."""
        self.seconds += run.wall_seconds
        self.steps += run.steps
        self.runs += 1
        contacts = float(numpy.mean(run.log["contacts"])) if len(run.log["contacts"]) else 0.0
        self.contacts = max(self.contacts, contacts)
        self.rows.append(row_of(self.case, run, run.walls, **errors))
        return run

    def end(self):
        """Writes the rows of the case, each with the check that came closest to its limit: no time without an error."""
        own = [c for c in self.checks if c.case == self.case]
        worst = max(own, key=lambda c: c.used, default=None)
        for row in self.rows:
            row.update(checks=len(own), missed=len(self.misses(self.case)))
            if worst:
                row.update(worst_check=worst.what, measured=worst.measured, expected=worst.expected if worst.kind in ("relative", "absolute") else "",
                           tolerance=worst.tolerance, error_over_tolerance=worst.used)
            if self.csv_path:
                append_row(self.csv_path, row)

    def misses(self, case=None):
        return [c for c in self.checks if not c.holds and case in (None, c.case)]


def row_of(case, run, walls=None, **errors):
    settings, provenance = run.record["settings"]["settings"], run.record["provenance"]
    energy = run.energy()
    phases = run.record["phases"]
    row = dict.fromkeys(COLUMNS, "")
    row.update(case=case, commit=provenance["git"][:12] + ("+" if provenance["git_dirty"] else ""), compiler=provenance["compiler"],
               isa=provenance["instruction_set"], threads=run.record["threads"], ranks=run.record["ranks"],
               precision="double", integrator=settings["integrator"], law=settings["law"], ttd="brute-force",  # the solver has one exact distance
               steps_per_contact=settings["steps_per_contact"], step=run.step, margin=settings["margin"],
               triangles=sum(len(mesh[1]) for mesh in run.case.solids.values()) if run.case else "", steps=run.steps,
               contacts_per_step=f"{numpy.mean(run.log['contacts']):.4g}", wall_median=numpy.median(walls or [run.wall_seconds]),
               wall_min=min(walls or [run.wall_seconds]), max_depth_ratio=run.max_depth_ratio)
    for phase in ("search", "contact", "integrate", "halo", "migrate", "output"):
        row["t_" + phase] = phases.get(phase, "")
    scale = max(run.record["energy"]["kinetic_peak"], 1e-300)
    if len(energy) > 2 and run.times[-1] > 0:
        time = run.log["time"]
        row["energy_drift_slope"] = numpy.polyfit(time, energy / scale, 1)[0]
        row["energy_drift_rms"] = numpy.std(energy / scale)
    row.update(errors)
    return row


def append_row(path, row):
    new = not os.path.exists(path)
    with open(path, "a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS)
        if new:
            writer.writeheader()
        writer.writerow({name: f"{value:.9g}" if isinstance(value, (float, numpy.floating)) else value for name, value in row.items()})
