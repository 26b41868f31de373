# SPDX-License-Identifier: GPL-3.0-or-later
"""A real Slurm of one node in a folder: munged, slurmctld and slurmd from Debian's packages.

    with OneNodeSlurm(folder) as slurm:
        slurm.ask("squeue")      # slurm.environment is what Slurm's programs need

Needs root. All of its processes end with the block, whatever happened.
"""
import ctypes
import os
import pwd
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel", "sinfo"]

# Everything that Slurm would wait for is short: half a minute to find a warning due, which cannot be
# changed, is the longest.
CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
CredType=cred/munge
# A job that is queued again waits as long as credentials last.
AuthInfo=socket={folder}/munge/socket,cred_expire=5
SlurmUser=root
SlurmdUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
# It runs beside other work, on whatever cores and memory there are.
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1,sched_min_interval=0
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=60
BatchStartTimeout=1
KillWait=10
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus}
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
PartitionName=other Nodes={host} MaxTime=INFINITE State=UP Hidden=YES
"""


def missing():
    """Why this machine cannot run it, or None."""
    if os.geteuid() != 0:
        return "it needs root"
    names = [name for name in PROGRAMS if shutil.which(name) is None]
    if names:
        return f"{', '.join(names)} not installed (Debian packages slurm-wlm and munge)"
    return None


# Slurm requeues what a node that comes back does not run any more, when it was begun this long before:
# BatchStartTimeout and MessageTimeout.
MISSED_AFTER = 12


def wait_for(what, condition, seconds=120):
    """The condition's first true value; looked at again and again."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.05)
    raise TimeoutError(f"not within {seconds} s: {what}")


def processes(*words):
    """Process ids whose command lines hold all of the words."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/cmdline", "rb") as file:
                line = file.read().replace(b"\0", b" ").decode(errors="replace")
        except (OSError, ValueError):
            continue
        if entry.isdigit() and all(word in line for word in words):
            found.append(int(entry))
    return found


def parents():
    """Parent of every process."""
    found = {}
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/stat") as file:
                found[int(entry)] = int(file.read().rsplit(")", 1)[1].split()[1])
        except (OSError, ValueError):
            pass
    return found


def descendants(process):
    parent = parents()
    found = [process]
    for one in found:
        found += [child for child in parent if parent[child] == one]
    return found[1:]


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


def end_with_parent():
    """In a child: even a killed test leaves no daemon behind."""
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class OneNodeSlurm:
    def __init__(self, folder, cpus=2):
        self.folder = folder
        self.host = socket.gethostname().split(".")[0]
        self.daemons = {}
        controller_port, node_port = free_ports(2)
        for name in ["munge", "state", "spool"]:
            os.makedirs(f"{folder}/{name}")
        with open(f"{folder}/slurm.conf", "w") as file:
            file.write(CONFIGURATION.format(host=self.host, folder=folder, cpus=cpus,
                                            controller_port=controller_port, node_port=node_port))
        # No job is limited by cgroups, and a container need not have them.
        with open(f"{folder}/cgroup.conf", "w") as file:
            file.write("CgroupPlugin=cgroup/v1\n")
        # Of the daemons and of ask(). The tested program gets its own, with hostile variables.
        self.environment = {name: value for name, value in os.environ.items()
                            if not name.startswith(("SBATCH_", "SQUEUE_", "SLURM_"))}
        self.environment["SLURM_CONF"] = f"{folder}/slurm.conf"

    def __enter__(self):
        try:
            self.start_munge()
            self.start("slurmctld", ["slurmctld", "-D"])
            self.start_node()
            return self
        except BaseException:
            self.__exit__()
            raise

    def __exit__(self, *_):
        own = [p for daemon in self.daemons.values() for p in descendants(daemon.pid)]
        for daemon in reversed(self.daemons.values()):
            kill(daemon.pid)
            daemon.wait()
        # Daemons that watch jobs have left their parent; without Slurm nobody starts new ones.
        for process in [*own, *self.job_processes()]:
            kill(process)

    def start(self, name, words, **options):
        with open(f"{self.folder}/{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen(
                words, stdin=subprocess.DEVNULL, stdout=out, stderr=out, env=self.environment,
                start_new_session=True, preexec_fn=end_with_parent, **options)

    def start_munge(self):
        user = pwd.getpwnam("munge")
        own = f"{self.folder}/munge"
        with open(f"{own}/key", "wb") as key:
            key.write(os.urandom(128))
        for path in [own, f"{own}/key"]:
            os.chown(path, user.pw_uid, user.pw_gid)
        os.chmod(f"{own}/key", 0o400)
        os.chmod(own, 0o755)
        self.start("munged", ["munged", "--foreground", f"--key-file={own}/key",
                              f"--socket={own}/socket", f"--pid-file={own}/pid",
                              f"--log-file={own}/log", f"--seed-file={own}/seed"],
                   user="munge", group="munge", extra_groups=[])
        wait_for("munged", lambda: os.path.exists(f"{own}/socket"))

    def start_node(self):
        self.start("slurmd", ["slurmd", "-D", "-N", self.host])
        wait_for("the node", lambda: self.ask("sinfo", "--noheader", "--format=%T")
                 in ("idle", "mixed", "allocated"))

    def job_processes(self):
        """Of the node: its jobs' scripts, what these started, and the daemons that watch them."""
        scripts = processes(f"{self.folder}/spool/")
        parent = parents()
        daemons = [parent[script] for script in scripts if parent.get(script, 1) != 1]
        return daemons + scripts + [p for script in scripts for p in descendants(script)]

    def lose_node(self):
        """The node is gone at once, with its daemon and everything that ran there."""
        kill(self.daemons["slurmd"].pid)
        self.daemons["slurmd"].wait()
        lost = self.job_processes()
        for process in lost:
            kill(process)
        # Every process has a space in its command line here, but one that has ended has none.
        wait_for("the node's processes to be gone", lambda: not set(lost) & set(processes(" ")))

    def ask(self, *words):
        """What one of Slurm's programs says; None when it fails."""
        done = subprocess.run(words, env=self.environment, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, check=False)
        return done.stdout.strip() if done.returncode == 0 else None

    def queue(self):
        """{"7_2": "RUNNING", "8": "PENDING"}; None when Slurm does not answer."""
        lines = self.ask("squeue", "--noheader", "--array", "--format=%i %T")
        return None if lines is None else dict(line.split() for line in lines.splitlines())
