#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""examples/cluster/sweep.sbatch on a Slurm of one node that is started for it: a task that is killed and sent again, a node
that dies with all that runs on it and comes back, and the merged table, against one process.

slurm_test.py HEXAPLAST SCENE DIRECTORY; ends with 77 where there is no Slurm."""
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

EXAMPLE = pathlib.Path(__file__).resolve().parents[3] / "examples" / "cluster" / "sweep.sbatch"
VARY = ["--vary", "bar/material.yieldStress=100:800:4", "--vary", "bar/material.plasticFlowRate=1,2,4", "--steps", "500"]

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
ReturnToService=2
SlurmdTimeout=10
AuthInfo=cred_expire=5
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


def processes_of_tasks(conf):
    """Of all tasks of this Slurm: by their numbers what each has in its environment."""
    found = {}
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            environment = dict(word.split("=", 1) for word in (entry / "environ").read_bytes().decode().split("\0") if "=" in word)
        except (OSError, UnicodeDecodeError):
            continue  # it has ended
        if environment.get("SLURM_CONF") == str(conf) and "SLURM_ARRAY_TASK_ID" in environment:
            found[int(entry.name)] = environment
    return found


def parent_of(process):
    return int(pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


def kill_task(conf, task):
    processes = [number for number, its in processes_of_tasks(conf).items() if its["SLURM_ARRAY_TASK_ID"] == str(task)]
    if not processes:
        sys.exit(f"slurm_test: task {task} has ended before it could be killed")
    for process in processes:
        kill(process)


def kill_node(conf, slurmd):
    """Everything at once, as by a power failure: nothing can tell Slurm of it."""
    slurmd.kill()
    processes = processes_of_tasks(conf)
    parents = set()
    for process in processes:
        try:
            parents.add(parent_of(process))
        except OSError:
            pass
    steps = [parent for parent in parents - set(processes)
             if pathlib.Path(f"/proc/{parent}/comm").read_text().startswith("slurmstepd")]
    if not steps:
        sys.exit("slurm_test: no task was there when the node was killed")
    for process in [*steps, *processes]:
        kill(process)
    slurmd.wait()


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
        call("sbatch", f"--array={array}", EXAMPLE, "study", "3", scene, *VARY, cwd=place)

    def is_idle():
        return not call("squeue", "-h", "-o", "%T").strip()

    shards = [place / "study" / f"shard_{i}" for i in (1, 2, 3)]
    try:
        start("slurmctld")
        start("slurmd")
        wait_for(is_up, "a Slurm of one node")
        submit("1-3")
        wait_for(lambda: num_rows(shards[0]) > 0, "a run of the first task")
        kill_task(conf, 1)
        wait_for(lambda: "1" not in call("squeue", "-h", "-t", "RUNNING", "-o", "%K").split(), "that Slurm notices the failure")
        wait_for(lambda: num_rows(shards[1]) > 0, "a run of the second task")
        kill_node(conf, daemons["slurmd"])
        done = [num_rows(shard) for shard in shards]
        wait_for(lambda: call("sinfo", "-h", "-o", "%t").startswith("down"), "that Slurm finds the node dead")
        start("slurmd")
        wait_for(is_idle, "the end of the tasks that Slurm starts again")
        if num_rows(shards[0]) != done[0]:
            sys.exit("slurm_test: Slurm has started the task again that failed by itself")
        submit("1")
        wait_for(is_idle, "the end of the task that is sent again")
        if not all(before < num_rows(shard) for before, shard in zip(done, shards)):
            sys.exit(f"slurm_test: {done} runs were done when all was killed, {[num_rows(shard) for shard in shards]} in the end")
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
