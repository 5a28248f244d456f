"""A Slurm of one node on this machine, for tests: munged, slurmctld and slurmd with files, sockets and ports of their own below a folder, ended
with the test.

    with local_slurm.running(folder) as environment: subprocess.run(["sbatch", ...], env=environment)
"""

import contextlib
import getpass
import os
import pathlib
import shutil
import socket
import subprocess
import time

PROGRAMS = ("munged", "munge", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel")
CONFIGURATION = """ClusterName=local
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
MinJobAge=3600
MaxArraySize={most}
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def path_with_sbin():
    return os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])


def lacking():
    """Programs that are not installed."""
    return [program for program in PROGRAMS if shutil.which(program, path=path_with_sbin()) is None]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def wait_for(what, words, patience=30.0):
    """Until `what` is true; AssertionError with words() after `patience` seconds."""
    end = time.monotonic() + patience
    while not what():
        assert time.monotonic() < end, words()
        time.sleep(0.1)


@contextlib.contextmanager
def running(folder, cores=2, most=1001):
    """The environment in which Slurm's commands find this Slurm."""
    folder = pathlib.Path(folder)
    for name in ("", "state", "spool"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    folder.chmod(0o755)
    key = folder / "munge.key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o600)
    host = socket.gethostname().split(".")[0]
    configuration = folder / "slurm.conf"
    configuration.write_text(CONFIGURATION.format(host=host, folder=folder, user=getpass.getuser(), ports=free_ports(2), cores=cores, most=most))
    environment = {**os.environ, "SLURM_CONF": str(configuration), "PATH": path_with_sbin()}
    processes = []

    def start(*words):
        log = (folder / f"{words[0]}.out").open("w")
        processes.append(subprocess.Popen(words, env=environment, stdout=log, stderr=subprocess.STDOUT, start_new_session=True))

    def said(*words):
        return subprocess.run(words, env=environment, capture_output=True, text=True).stdout

    def logs():
        return "\n".join(path.read_text(errors="replace")[-1500:] for path in sorted(folder.glob("*.log")) + sorted(folder.glob("*.out")))

    try:
        start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={key}", f"--pid-file={folder}/munged.pid",
              f"--log-file={folder}/munged.log", f"--seed-file={folder}/munged.seed")
        wait_for(lambda: (folder / "munge.socket").exists(), logs)
        start("slurmctld", "-D", "-i", "-f", str(configuration))
        wait_for(lambda: "main" in said("sinfo", "--noheader"), logs)
        start("slurmd", "-D", "-f", str(configuration))
        wait_for(lambda: "idle" in said("sinfo", "--noheader", "--format=%T"), logs)
        yield environment
    finally:
        subprocess.run(["scancel", f"--user={getpass.getuser()}"], env=environment, capture_output=True)
        for process in reversed(processes):
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
