#!/usr/bin/env python3
"""Films of the made-up run, whose bodies all move by (0.1, 0.2, 0.3) m/s: decoded again, they show what single pictures show, in time.

usage: film_test.py SCREE_POST MAKE_SAMPLE_RUN FOLDER    Exit 77: ffmpeg is missing.
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

import numpy

POST, MAKE, FOLDER = (str(pathlib.Path(a).resolve()) for a in sys.argv[1:4])
RUN = "sample.run"
SIZE = (320, 240)
# one camera from above, for films and pictures alike
LOOK = ["--from", "0", "0", "1", "--up", "0", "1", "0", "--at", "0.08", "0.09", "0.1", "--size", "320", "240", "--no-walls", "--no-legend"]


def call(*words, code=0, path=None):
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "XAUTHORITY")}
    if path is not None:
        environment["PATH"] = path
    result = subprocess.run([POST, *words], capture_output=True, text=True, env=environment, cwd=FOLDER)
    assert result.returncode == code, (words, result)
    return result.stdout + result.stderr


def decoded(name):
    """Pictures of a film or a PNG: count x height x width x 3."""
    raw = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", name, "-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                         capture_output=True, check=True, cwd=FOLDER).stdout
    return numpy.frombuffer(raw, numpy.uint8).reshape(-1, SIZE[1], SIZE[0], 3).astype(float)


def probed(name):
    words = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=codec_name,width,height,nb_read_frames,r_frame_rate", "-of", "json"]
    return json.loads(subprocess.run([*words, name], capture_output=True, check=True, cwd=FOLDER).stdout)["streams"][0]


def loss(a, b):
    """Signal to noise of two pictures [dB]."""
    return 10 * numpy.log10(255 ** 2 / max(1e-9, numpy.mean((a - b) ** 2)))


def centre(picture):
    """Mean column and row of what is drawn."""
    rows, columns = numpy.nonzero(picture.min(axis=2) < 240)
    return numpy.array([columns.mean(), rows.mean()])


class Film(unittest.TestCase):
    def test_each_format_has_every_frame_at_its_rate(self):
        for name, codec in (("f.mp4", "h264"), ("f.webm", "vp9"), ("f.gif", "gif")):
            with self.subTest(name):
                words = call("film", RUN, "-o", name, "--rate", "10", "--no-time", *LOOK)
                self.assertIn("3 frames, 0.3 s of film", words)
                self.assertIn("for 0.2 s of the run: as fast as it happens", words)
                found = probed(name)
                self.assertEqual((found["codec_name"], found["width"], found["height"], found["nb_read_frames"], found["r_frame_rate"]),
                                 (codec, *SIZE, "3", "10/1"))
                film = decoded(name)
                for k in range(3):  # each is its own frame more than any other's
                    call("picture", RUN, "-o", "p.png", "--frame", str(k), *LOOK)
                    picture = decoded("p.png")[0]
                    losses = [loss(film[i], picture) for i in range(3)]
                    self.assertGreater(losses[k], 26)
                    self.assertEqual(max(range(3), key=losses.__getitem__), k)

    def test_what_moves_in_the_run_moves_in_the_film(self):
        call("film", RUN, "-o", "moves.mp4", "--no-time", *LOOK)
        film = decoded("moves.mp4")
        right, down = centre(film[2]) - centre(film[0])
        # 2 cm to the right and 4 cm up; the camera, some 0.5 m above, sees what rises by 6 cm spread by a tenth about its middle
        self.assertGreater(right, 4)
        self.assertAlmostEqual(-down / right, 2, delta=0.3)

    def test_one_scale_of_colours_holds_for_all_frames(self):
        """By height: 5 to 12 cm at the start, 6 cm more at the end."""
        call("film", RUN, "-o", "scale.mp4", "--colour", "z", "--no-time", *LOOK)
        film = decoded("scale.mp4")
        whole = ["--range", "0.05", "0.18"]
        for k in (0, 2):
            call("picture", RUN, "-o", "p.png", "--frame", str(k), "--colour", "z", *whole, *LOOK)
            self.assertGreater(loss(film[k], decoded("p.png")[0]), 26)
        call("picture", RUN, "-o", "own.png", "--frame", "2", "--colour", "z", *LOOK)
        call("picture", RUN, "-o", "p.png", "--frame", "2", "--colour", "z", *whole, *LOOK)
        self.assertGreater(loss(film[2], decoded("p.png")[0]), loss(film[2], decoded("own.png")[0]) + 6)

    def test_the_camera_goes_round(self):
        call("film", RUN, "-o", "turn.mp4", "--frames", "0,2", "--turn", "180", "--no-time", "--from", "1", "0", "0.6", *LOOK[8:])
        film = decoded("turn.mp4")
        # a quarter of a turn about z takes (1, 0, 0.6) to (0, 1, 0.6)
        call("picture", RUN, "-o", "p.png", "--frame", "2", "--from", "0", "1", "0.6", *LOOK[8:])
        self.assertGreater(loss(film[1], decoded("p.png")[0]), 26)
        call("picture", RUN, "-o", "p.png", "--frame", "2", "--from", "1", "0", "0.6", *LOOK[8:])
        self.assertLess(loss(film[1], decoded("p.png")[0]), 24)

    def test_the_time_stands_in_the_corner(self):
        call("film", RUN, "-o", "time.mp4", *LOOK)
        call("film", RUN, "-o", "none.mp4", "--no-time", *LOOK)
        corner = lambda name: decoded(name)[:, :40, :120].min(axis=3)
        self.assertTrue((corner("time.mp4") < 128).any(axis=(1, 2)).all())
        self.assertFalse((corner("none.mp4") < 128).any())

    def test_mistakes_are_named(self):
        self.assertIn("the numbers of a film are even, for instance 322 240", call("film", RUN, "-o", "x.mp4", "--size", "321", "240", code=2))
        self.assertIn("write -o x.mp4", call("film", RUN, "-o", "x", code=2))
        self.assertIn("--cut q=1: expected an axis", call("film", RUN, "-o", "x.mp4", "--cut", "q=1", code=2))
        self.assertIn("--range 2 1", call("film", RUN, "-o", "x.mp4", "--range", "2", "1", code=2))
        # ffmpeg 5 ends with 1, ffmpeg 7 (Debian 13) with 254
        self.assertRegex(call("film", RUN, "-o", "nowhere/x.mp4", *LOOK, code=4), r"cannot write nowhere/x\.mp4: ffmpeg ended with exit code (1|254): ")
        shutil.rmtree(pathlib.Path(FOLDER, "bin"), ignore_errors=True)
        pathlib.Path(FOLDER, "bin").mkdir()
        pathlib.Path(FOLDER, "bin", "Xvfb").symlink_to(shutil.which("Xvfb"))
        self.assertIn("install the package ffmpeg", call("film", RUN, "-o", "x.mp4", *LOOK, code=4, path=f"{FOLDER}/bin"))
        self.assertEqual([f for f in os.listdir(FOLDER) if f.lstrip(".").startswith("x.")], [])

    def test_a_full_disk_leaves_no_film(self):
        # an ffmpeg whose files end at 1 kB: writing beyond it fails, as on a full disk
        folder = pathlib.Path(FOLDER, "narrow")
        folder.mkdir(exist_ok=True)
        (folder / "ffmpeg").write_text(f"#!/bin/bash\ntrap '' XFSZ\nulimit -f 1\nexec {shutil.which('ffmpeg')} \"$@\"\n")
        (folder / "ffmpeg").chmod(0o755)
        for ending in ("webm",):  # ffmpeg itself ends with 0 here, and with an error for the others
            said = call("film", RUN, "-o", f"full.{ending}", *LOOK, code=4, path=f"{folder}:{os.environ['PATH']}")
            self.assertIn(f"cannot write full.{ending}: ffmpeg ended with", said)
            self.assertNotIn("wrote", said)
        self.assertEqual([f for f in os.listdir(FOLDER) if "full." in f], [])

    def test_a_killed_film_leaves_no_film(self):
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "XAUTHORITY")}
        for k in range(2):
            tool = subprocess.Popen([POST, "film", RUN, "-o", "killed.mp4", "--size", "2048", "2048", "--jobs", str(k + 1)], cwd=FOLDER,
                                    env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(1)
            tool.send_signal(signal.SIGTERM)
            self.assertIn(tool.wait(60), (-signal.SIGTERM, 0))
            if tool.returncode != 0:
                self.assertEqual(sorted(path.name for path in pathlib.Path(FOLDER).glob("*killed.mp4*")), [])


if __name__ == "__main__":
    if shutil.which("ffmpeg") is None:
        print("SKIPPED: ffmpeg is not on PATH")
        sys.exit(77)
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(FOLDER)
    subprocess.run([MAKE, f"{FOLDER}/{RUN}"], check=True)
    unittest.main(argv=[sys.argv[0], "-v"])
