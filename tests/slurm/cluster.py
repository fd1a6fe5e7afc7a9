"""Start a Slurm of one node in a separate folder: no service of the machine, no root, no cgroups, no database."""
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import time

PACKAGES = ["slurmctld", "slurmd", "slurm-client"]
CONFIGURATION = """\
ClusterName=epcont
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/none
CredType=cred/none
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=1,sched_min_interval=100000
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
KillWait=5
OverTimeLimit=0
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def install():
    """Install Debian's packages, if they are missing and root is allowed to."""
    if shutil.which("slurmctld") and shutil.which("slurmd") and shutil.which("sbatch"):
        return
    if os.geteuid() != 0 or not shutil.which("apt-get"):
        sys.exit("missing packages; please run: sudo apt-get update && sudo apt-get install -y " + " ".join(PACKAGES))
    # Packages must not start services of the machine: policy-rc.d tells them so, if there is no other.
    policy = pathlib.Path("/usr/sbin/policy-rc.d")
    ours = not policy.exists()
    if ours:
        policy.write_text("#!/bin/sh\nexit 101\n")
        policy.chmod(0o755)
    try:
        command = ["apt-get", "install", "-y", "--no-install-recommends", "-o", "DPkg::Lock::Timeout=120", *PACKAGES]
        environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        if subprocess.run(command, env=environment, capture_output=True).returncode:
            subprocess.run(["apt-get", "update"], env=environment, capture_output=True, check=True)
            subprocess.run(command, env=environment, check=True)
    finally:
        if ours:
            policy.unlink()


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Cluster:
    """Runs inside `with`; SLURM_CONF tells its commands where it is."""

    def __init__(self, folder):
        self.folder, self.processes = pathlib.Path(folder), []

    def __enter__(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
        path = self.folder / "slurm.conf"
        path.write_text(CONFIGURATION.format(host=socket.gethostname().split(".")[0], ports=free_ports(2), user=user, folder=self.folder))
        os.environ["SLURM_CONF"] = str(path)
        try:
            for name in ("slurmctld", "slurmd"):
                self.processes.append(subprocess.Popen([shutil.which(name), "-D"], stdout=subprocess.DEVNULL,
                                                       stderr=open(self.folder / f"{name}.err", "wb")))
            self.wait_until_idle(60)
        except BaseException:
            self.__exit__()
            raise
        return self

    def wait_until_idle(self, seconds):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            said = subprocess.run(["sinfo", "--noheader", "--format=%T"], capture_output=True, text=True).stdout.strip()
            if said == "idle":
                return
            time.sleep(0.3)
        logs = "".join(f"== {path.name}\n{path.read_text()[-3000:]}" for path in sorted(self.folder.glob("*.[le][or][gr]")))
        raise RuntimeError(f"the node did not come up (sinfo: {said or 'no answer'})\n{logs}")

    def __exit__(self, *_):
        subprocess.run(["scancel", "--user", str(os.getuid())], capture_output=True)
        for process in reversed(self.processes):
            process.terminate()
        for process in self.processes:
            try:
                process.wait(15)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
