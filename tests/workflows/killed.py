"""Starts a workflow and kills it, its mpirun and its ranks at once, as a power cut would."""
import os
import subprocess
import time


def kill_after_checkpoint(command, run, env, log):
    """Runs the command until the folder `run` has a checkpoint, then sends SIGKILL to all that it started. Tells whether the run was cut short."""
    with open(log, "w", encoding="utf-8") as text:
        process = subprocess.Popen(command, env=env, stdout=text, stderr=text, start_new_session=True)
        end = time.time() + 200
        while not (os.path.isdir(run) and any(name.startswith("checkpoint_") and name.endswith(".h5") for name in os.listdir(run))):
            assert process.poll() is None and time.time() < end, open(log, encoding="utf-8").read()
            time.sleep(0.01)
        # mpirun gives its ranks groups of their own, so the session is what holds all of them
        subprocess.run(["pkill", "-KILL", "-s", str(process.pid)], check=False)
        process.wait()
    return not os.path.exists(os.path.join(run, "run.json"))
