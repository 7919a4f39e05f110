#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""examples/cluster/sweep.sbatch on a Slurm of one node that is started for it: a task that is killed and sent again, and the
merged table, against one process. A task that Slurm itself starts again, after its node has died, is sent again alike.

slurm_test.py HEXAPLAST SCENE DIRECTORY; ends with 77 where there is no Slurm."""
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import time

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "examples" / "cluster" / "sweep.sbatch"
VARY = ["--vary", "bar/material.yieldStress=100:800:4", "--vary", "bar/material.plasticFlowRate=1,2,4", "--steps", "250"]

CONF = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1
MinJobAge=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=test Nodes={host} Default=YES State=UP MaxTime=INFINITE
"""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def call(*words, **options):
    return subprocess.run(words, check=True, capture_output=True, text=True, **options).stdout


DEADLINE = time.monotonic() + 240  # of all of it: ctest would leave the daemons behind


def wait_for(condition, what):
    while not condition():
        if time.monotonic() > DEADLINE:
            sys.exit(f"slurm_test: {what} did not happen in time")
        time.sleep(0.1)


def num_rows(shard):
    return sum(path.suffix != ".part" for path in shard.glob("run_*"))


def is_up():
    asked = subprocess.run(["sinfo", "-h", "-o", "%t"], capture_output=True, text=True)
    return asked.stdout.strip() == "idle"


def main():
    command, scene, place = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    os.environ["PATH"] += ":/usr/sbin"
    if not all(shutil.which(name) for name in ("slurmctld", "slurmd", "sbatch")):
        skip("slurm-wlm is not installed")
    if os.geteuid() != 0:
        skip("only root can start a Slurm")
    shutil.rmtree(place, ignore_errors=True)
    (place / "state").mkdir(parents=True)
    (place / "spool").mkdir()
    conf = place / "slurm.conf"
    conf.write_text(CONF.format(host=socket.gethostname().split(".")[0], place=place, ports=free_ports(2),
                                cpus=os.cpu_count()))
    os.environ["SLURM_CONF"] = str(conf)
    os.environ["PATH"] = f"{command.parent}:{os.environ['PATH']}"

    daemons = {}

    def start(name):
        with open(place / f"{name}.log", "a") as log:
            daemons[name] = subprocess.Popen([name, "-D", "-f", str(conf)], stdout=log, stderr=log)

    def submit(array):
        """The number of the job."""
        return call("sbatch", "--parsable", f"--array={array}", EXAMPLE, "study", "3", scene, *VARY, cwd=place).strip()

    def is_idle():
        return not call("squeue", "-h", "-o", "%T").strip()

    shards = [place / "study" / f"shard_{i}" for i in (1, 2, 3)]
    try:
        start("slurmctld")
        start("slurmd")
        wait_for(is_up, "a Slurm of one node")
        job = submit("1-3")
        wait_for(lambda: num_rows(shards[0]) > 0, "a run of the first task")
        call("scancel", "--batch", "--signal=KILL", f"{job}_1")
        wait_for(is_idle, "the end of the other tasks")
        done = num_rows(shards[0])
        submit("1")
        wait_for(is_idle, "the end of the task that is sent again")
        if not done < num_rows(shards[0]):
            sys.exit(f"slurm_test: {done} runs were done when the task was killed, and no more in the end")
        runs = [run for log in place.glob("shard_*.log") for run in re.findall(r"^run (\d+) of", log.read_text(), re.MULTILINE)]
        if len(runs) != len(set(runs)):
            sys.exit("slurm_test: a run that was done was carried out again")
        print(call("hexaplast", "sweep", "--out", "study", "--merge", *shards, cwd=place), end="")
    finally:
        for daemon in reversed(daemons.values()):
            daemon.terminate()
            try:
                daemon.wait(timeout=10)
            except subprocess.TimeoutExpired:
                daemon.kill()
    call("hexaplast", "sweep", scene, *VARY, "--out", "one", "--jobs", "2", cwd=place)
    for name in ("sweep.csv", "sweep.svg", "sweep.json"):
        if (place / "study" / name).read_bytes() != (place / "one" / name).read_bytes():
            sys.exit(f"slurm_test: {name} of the job array is not that of one process")


if __name__ == "__main__":
    main()
