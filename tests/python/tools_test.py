#!/usr/bin/env python3
"""Calls of the tools: what comes back, progress, and errors by their exit codes."""
import contextlib
import io
import os
import signal
import stat
import threading
import unittest
from unittest import mock

import scree
from small_run import CASE, InFolder, make, write_box


class ToolsTest(InFolder):
    def fake(self, script):
        """A tool `scree-solver` in a folder of its own; SCREE_BIN for it."""
        folder = self.path("fake")
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, "scree-solver")
        with open(path, "w", encoding="utf-8") as file:
            file.write("#!/bin/bash\n" + script)
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
        return mock.patch.dict(os.environ, SCREE_BIN=folder)

    def test_the_whole_way(self):
        write_box(self.path("box.stl"), 8)
        shapes = scree.import_mesh(self.path("box.stl"), self.path("rock.shape.h5"), unit="mm", name="rock", progress=False)
        self.assertAlmostEqual(shapes["rock"].volume, 512e-9, delta=1e-18)
        case = scree.Case.from_text(CASE)
        case["time.duration"] = "1 ms"
        scene = scree.pack(case, self.path("way.scene.h5"), ranks=2, progress=False,
                           set={"pairs.*.friction": 0.75, "contact.margin": "0.5 mm", "output.every": 0.001, "populations.0.count": 8})
        self.assertEqual(scree.Case(self.path("way.toml"))["time.duration"], "1 ms")
        self.assertEqual((scene.pair("chalk", "steel")["friction"], scene.settings["margin"]), (0.75, 0.0005))
        run = scree.solve(scene, self.path("other.run"), threads=1, progress=False)
        self.assertEqual((run.name, run.outcome["outcome"], run.outcome["threads"]), ("other", "completed", 1))
        again = scree.solve(scene, self.path("other.run"), restart="auto", progress=False)
        self.assertEqual(again.outcome["state_hash"], run.outcome["state_hash"])
        with contextlib.suppress(scree.MachineError):  # without a display the page has no pictures
            page = scree.report(run, json=self.path("numbers.json"), progress=False)
            self.assertEqual(page, self.path("other.report.html"))
            self.assertTrue(os.path.exists(self.path("numbers.json")))

    def test_a_call_gives_output_and_messages(self):
        scree.generate("cube", self.path("cube.shape.h5"), size="1 cm", progress=False)
        made = scree.call("mesher", "info", self.path("cube.shape.h5"), progress=False)
        self.assertIn("cube", made.output)
        self.assertEqual(made.command[1:], ("info", self.path("cube.shape.h5")))
        with self.fake('printf "%s|" "$@"; echo note >&2'):
            made = scree.call("solver", "x", 1, a_b=True, none=None, off=False, list_=["p", "q"], pair=(1.5, "r"), from_=2, progress=False)
            self.assertEqual(made.output, "x|1|--a-b|--list|p|--list|q|--pair|1.5|r|--from|2|")
            self.assertEqual(made.messages, "note\n")

    def test_progress_is_passed_on(self):
        lines = 'echo "scree-solver: note: hello" >&2; echo "solver:  45 %  t = 9.024 ms, 0.3 s left" >&2'
        with self.fake(lines):
            seen = []
            with contextlib.redirect_stderr(io.StringIO()) as shown:
                scree.call("solver", progress=seen.append)
            self.assertEqual(seen, [scree.Progress("solver", 0.45, "t = 9.024 ms, 0.3 s left")])
            self.assertEqual(shown.getvalue(), "scree-solver: note: hello\n")
            with contextlib.redirect_stderr(io.StringIO()) as shown:
                scree.call("solver")
            self.assertEqual(len(shown.getvalue().splitlines()), 2)
            with contextlib.redirect_stderr(io.StringIO()) as shown:
                scree.call("solver", progress=False)
            self.assertEqual(shown.getvalue(), "")
        with contextlib.redirect_stderr(io.StringIO()):
            seen = []
            make(self.folder)
            scree.solve(self.path("bed.scene.h5"), self.path("seen.run"), progress=seen.append)
        self.assertTrue(all(0 <= one.share <= 1 for one in seen))
        self.assertLessEqual({one.name for one in seen}, {"solver"})

    def test_each_exit_code_has_its_exception(self):
        kinds = {1: scree.InternalError, 2: scree.UsageError, 3: scree.InputError, 4: scree.MachineError, 5: scree.RunInvalid, 130: scree.Interrupted, 77: scree.InternalError}
        for code, kind in kinds.items():
            with self.fake(f'echo "solver: 10 % x" >&2; echo "scree-solver: error: what is wrong" >&2; echo "  and more" >&2; exit {code}'):
                with self.assertRaises(kind) as caught:
                    scree.call("solver", "a.scene.h5", progress=False)
            error = caught.exception
            self.assertIsInstance(error, scree.ScreeError)
            self.assertEqual((error.exit_code, error.command[1]), (code, "a.scene.h5"))
            self.assertIn("what is wrong\n  and more", error.message)
            self.assertIn("10 %", error.output)
            self.assertEqual(str(error), error.message)
        self.assertEqual((str(error), error.exit_code), ("what is wrong\n  and more", 77))
        with self.fake("kill -TERM $$"), self.assertRaisesRegex(scree.Interrupted, "SIGTERM") as caught:
            scree.call("solver", progress=False)
        self.assertEqual((caught.exception.exit_code, caught.exception.signal), (143, signal.SIGTERM))

    def test_errors_of_the_real_tools(self):
        with self.assertRaisesRegex(scree.InputError, "none.toml: cannot be read"):
            scree.pack(self.path("none.toml"), self.path("x.scene.h5"), progress=False)
        with open(self.path("bad.toml"), "w", encoding="utf-8") as file:
            file.write("x = 1\n")
        with self.assertRaisesRegex(scree.UsageError, "bad.toml:1: x: unknown key"):
            scree.pack(self.path("bad.toml"), self.path("x.scene.h5"), progress=False)
        with self.assertRaisesRegex(scree.UsageError, "no-such"):
            scree.call("mesher", "no-such", progress=False)

    def test_tools_that_are_not_there(self):
        with mock.patch.dict(os.environ, SCREE_BIN=self.folder), self.assertRaisesRegex(scree.UsageError, "scree-mesher: not found in SCREE_BIN"):
            scree.call("mesher", "info")
        with self.assertRaisesRegex(scree.MachineError, "no-mpirun: cannot be started"):
            scree.call("solver", "--version", ranks=2, mpirun=["no-mpirun"], progress=False)

    def test_ctrl_c_stops_the_tool_and_is_raised_again(self):
        ended = self.path("ended")
        with self.fake(f'trap "touch {ended}; exit 130" INT; echo started >&2; for i in $(seq 1000); do sleep 0.05; done'):
            def stop_when_started(text):
                if text == "started\n":
                    threading.Timer(0.1, signal.pthread_kill, [threading.main_thread().ident, signal.SIGINT]).start()
            shown = mock.Mock(write=stop_when_started)
            with contextlib.redirect_stderr(shown), self.assertRaises(KeyboardInterrupt):
                scree.call("solver")
        self.assertTrue(os.path.exists(ended))


if __name__ == "__main__":
    unittest.main()
