#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An ensemble through a real Slurm, with a killed task, a time limit, a lost node and a cancellation
on the way, ends with the states that one machine computes by itself.

    python3 slurm_test.py PROGRAM MANIFEST [KEEP]

Ends with 77, and says why, where Slurm cannot be started. With KEEP its folder stays.
"""
import collections
import json
import os
import pathlib
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

from one_node_slurm import MISSED_AFTER, OneNodeSlurm, missing, processes, wait_for

PROGRAM, MANIFEST = sys.argv[1:3]
KEEP = len(sys.argv) > 3
CYCLES, MORE_CYCLES = 5, 7
# Variables of Slurm's programs that would break a campaign if they reached them: its jobs would not be
# seen, begun in part only, ended early, not queued again, not named, or sent to another cluster.
HOSTILE = {
    "SQUEUE_PARTITION": "gpu", "SQUEUE_USERS": "nobody", "SQUEUE_STATES": "COMPLETED",
    "SQUEUE_FORMAT": "%i", "SQUEUE_FORMAT2": "jobid", "SQUEUE_ACCOUNT": "none",
    "SBATCH_TIMELIMIT": "1", "SBATCH_ARRAY_INX": "1", "SBATCH_NO_REQUEUE": "1",
    "SBATCH_SIGNAL": "KILL@600", "SBATCH_OUTPUT": "/dev/null", "SBATCH_ERROR": "/dev/null",
    "SBATCH_INPUT": "/nowhere", "SBATCH_JOB_NAME": "mine", "SBATCH_OPEN_MODE": "truncate",
    "SBATCH_EXPORT": "NONE", "SBATCH_WAIT": "1", "SLURM_CLUSTERS": "elsewhere",
    "SBATCH_CLUSTERS": "elsewhere", "SLURM_RESTART_COUNT": "1", "SLURM_ARRAY_TASK_ID": "7",
    "SLURM_MEM_PER_CPU": "1", "SLURM_MEM_PER_NODE": "1",
    # This one is kept: jobs run in the partition that it names.
    "SBATCH_PARTITION": "other"}
STARTED = time.monotonic()


def say(text):
    print(f"{time.monotonic() - STARTED:6.1f} s  {text}", flush=True)


def require(condition, text):
    if not condition:
        raise AssertionError(text)


class Campaign:
    def __init__(self, slurm, folder):
        self.slurm = slurm
        # A name that every shell and Slurm itself would misread unless it is quoted.
        self.place = folder / "it's a \"100%j\" $HOME;x"
        self.place.mkdir()
        self.store = self.place / "the store"
        self.here = None
        self.folder = None  # of the last submission

    def shearcell(self, *words, store=None, code=0):
        done = subprocess.run(
            [PROGRAM, *words, "--store", str(store or self.store)], cwd=self.place,
            env={**self.slurm.environment, **HOSTILE}, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            check=False)
        require(done.returncode == code, f"{words}: code {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def run_here(self, cycles):
        """The same on this machine alone, while the cluster is at work."""
        self.here = subprocess.Popen(
            [PROGRAM, "run", MANIFEST, "--scale", "smoke", "--cycles", str(cycles), "--quiet",
             "--store", str(self.place / "here")], stdout=subprocess.DEVNULL)

    def submit(self, cycles, *limits):
        said = json.loads(self.shearcell(
            "submit", MANIFEST, "--scale", "smoke", "--cycles", str(cycles),
            "--cpus-per-task", "1", *limits, "--json"))
        if said["submission"]:
            self.folder = pathlib.Path(said["folder"])
            say(f"job {said['job']} of {len(said['tasks'])} tasks, merged by {said['fold_job']}")
        return said

    def status(self):
        return json.loads(self.shearcell("status", "--json"))

    def checkpoints(self, task):
        """How many the task's store holds; its log is left alone."""
        return len(list((self.folder / f"task-{task}" / "objects").rglob("*.h5")))

    def worker(self, task):
        """The task's program, when it runs."""
        found = processes(PROGRAM, " resume ", str(self.folder / f"task-{task} "))
        return found[0] if found else None

    def new_checkpoint(self, task):
        before = self.checkpoints(task)
        wait_for(f"a checkpoint of task {task}", lambda: self.checkpoints(task) > before)

    def wait_until_merged(self):
        wait_for("an empty queue", lambda: self.slurm.queue() == {}, 300)


def events(store, kind=None):
    with sqlite3.connect(f"file:{store / 'store.sqlite'}?mode=ro", uri=True) as log:
        rows = log.execute("SELECT stream, type, payload FROM events ORDER BY seq").fetchall()
    return [(stream, json.loads(payload)) for stream, type, payload in rows if kind in (None, type)]


def states(store):
    """{(run, step): state hash}; nothing recorded twice."""
    found = {}
    for stream, body in events(store, "CheckpointRecorded"):
        key = stream, body["step"]
        require(key not in found, f"{key} was recorded twice")
        found[key] = body["state_hash"]
    return found


def work(store):
    """{run: particle-steps}"""
    sums = collections.Counter()
    for stream, body in events(store, "CheckpointRecorded"):
        sums[stream] += body["particle_steps"]
    return sums


def compare(campaign):
    require(campaign.here.wait() == 0, "the run on this machine failed")
    here = campaign.place / "here"
    expected, merged = states(here), states(campaign.store)
    # Interruptions recorded states in between; all that one machine records must be there, equal.
    for key, state in expected.items():
        require(merged.get(key) == state, f"{key}: {merged.get(key)} instead of {state}")
    last = {run["id"]: run["state_hash"] for run in campaign.status()["runs"]}
    alone = json.loads(campaign.shearcell("status", "--json", store=here))["runs"]
    require(last == {run["id"]: run["state_hash"] for run in alone}, "last states differ")
    require(work(campaign.store) == work(here), "steps were made twice")
    campaign.shearcell("verify")
    say(f"{len(expected)} states of {len(last)} stages are equal, hash by hash")


def kill_a_task(campaign):
    campaign.new_checkpoint(1)
    program = wait_for("task 1", lambda: campaign.worker(1))
    os.kill(program, signal.SIGKILL)
    wait_for("task 1 begun again", lambda: campaign.worker(1) not in (None, program))
    say("task 1 was killed and begun again")


def pause(campaign):
    """Stops the program of task 2 while it shears, so that it does not end too early."""
    log = campaign.folder / "task-2.log"
    wait_for("task 2 to shear", lambda: log.exists() and "fluid=" in log.read_text())
    campaign.new_checkpoint(2)
    program = wait_for("task 2", lambda: campaign.worker(2))
    os.kill(program, signal.SIGSTOP)
    return program


def let_time_be_over(campaign, program):
    pending = f"{1 << (signal.SIGUSR1 - 1):x}"

    def warned():
        lines = pathlib.Path(f"/proc/{program}/status").read_text().splitlines()
        mask = next(line.split()[1] for line in lines if line.startswith("ShdPnd"))
        return int(mask, 16) & int(pending, 16)

    wait_for("Slurm's warning", warned)
    os.kill(program, signal.SIGCONT)
    wait_for("task 2 queued again", lambda: campaign.worker(2) != program)
    wait_for("task 2 begun again", lambda: campaign.worker(2))
    log = (campaign.folder / "task-2.log").read_text()
    require("interrupted" in log and "queued again" in log, log)
    say("task 2 was warned of its time limit, recorded its state and queued itself again")


def lose_the_node(campaign, begun):
    wait_for("task 2 to be old enough", lambda: time.monotonic() > begun + MISSED_AFTER)
    campaign.slurm.lose_node()
    require(not campaign.worker(2), "the node's work outlived it")
    say("the node is lost")
    campaign.slurm.start_node()
    wait_for("task 2 begun again", lambda: campaign.worker(2))
    say("the node is back, and so is task 2")


def interrupted_in_every_way(campaign):
    # A minute is the shortest limit; the warning comes when Slurm next looks, every half minute.
    said = campaign.submit(CYCLES, "--time", "1", "--warn", "29")
    require(len(said["tasks"]) == 2 and said["left_out"] == 0, f"{said}")
    pause(campaign)
    begun = time.monotonic()
    campaign.run_here(CYCLES)
    queued = [run["queue"] for run in campaign.status()["runs"]]
    require({entry["state"] for entry in queued} == {"running"}, f"{queued}")
    again = campaign.submit(CYCLES)
    require(again["submission"] is None and again["left_out"] == 4, f"{again}")
    require(len(campaign.slurm.queue()) == 3, f"{campaign.slurm.queue()}")
    partitions = campaign.slurm.ask("squeue", "--noheader", "--format=%P").split()
    require(set(partitions) == {"other"}, f"{partitions}")
    kill_a_task(campaign)
    lose_the_node(campaign, begun)
    let_time_be_over(campaign, pause(campaign))
    campaign.wait_until_merged()
    compare(campaign)
    require(campaign.submit(CYCLES)["tasks"] == [], "there is nothing to do")


def cancelled_and_submitted_again(campaign):
    campaign.run_here(MORE_CYCLES)
    said = campaign.submit(MORE_CYCLES)
    campaign.new_checkpoint(1)
    campaign.slurm.ask("scancel", said["job"], said["fold_job"])
    wait_for("an empty queue", lambda: campaign.slurm.queue() == {})
    require(any(run["state"] != "completed" for run in campaign.status()["runs"]), "too late")
    again = campaign.submit(MORE_CYCLES)
    require(again["submission"] not in (None, said["submission"]), f"{again}")
    campaign.wait_until_merged()
    compare(campaign)
    say("a cancelled campaign went on from what it had recorded")


def main():
    if why := missing():
        print(f"skipped: {why}")
        sys.exit(77)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended by a signal"))  # and so cleaned up
    folder = pathlib.Path(tempfile.mkdtemp(prefix="shearcell-slurm-"))
    folder.chmod(0o755)  # munged has a user of its own
    try:
        with OneNodeSlurm(folder) as slurm:
            say("Slurm is up")
            campaign = Campaign(slurm, folder)
            try:
                interrupted_in_every_way(campaign)
                cancelled_and_submitted_again(campaign)
            except BaseException:
                if campaign.here:
                    campaign.here.kill()
                print(slurm.queue())
                for log in [*campaign.place.rglob("*.log"), *folder.glob("*.log")]:
                    print(f"--- {log}\n{log.read_text(errors='replace')[-6000:]}")
                raise
    finally:
        if not KEEP:
            shutil.rmtree(folder, ignore_errors=True)
    say("done")


main()
