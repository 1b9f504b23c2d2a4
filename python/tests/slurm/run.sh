#!/bin/sh
# A study through dask-jobqueue on a real Slurm of one node, with a worker killed on the way. As root, on Debian:
#
#   apt-get install --no-install-recommends slurm-wlm slurm-client slurmctld slurmd slurm-wlm-basic-plugins munge
#   pip install 'fecontact[studies]' dask-jobqueue
#   python/tests/slurm/run.sh PYTHON
#
# It sets Slurm up in a temporary folder, runs study.py, and ends Slurm. What it says stands in output.txt.
set -eu
python=${1:-python3}
here=$(cd "$(dirname "$0")" && pwd)
D=$(mktemp -d -t fecontact-slurm-XXXXXX)
HOST=$(hostname -s)
chmod 755 "$D"
mkdir "$D/spool" "$D/state"
cat > "$D/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$HOST(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
StateSaveLocation=$D/state
SlurmdSpoolDir=$D/spool
SlurmctldPidFile=$D/slurmctld.pid
SlurmdPidFile=$D/slurmd.pid
SlurmctldLogFile=$D/slurmctld.log
SlurmdLogFile=$D/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1
MpiDefault=none
ReturnToService=2
SwitchType=switch/none
NodeName=$HOST NodeAddr=127.0.0.1 CPUs=2 RealMemory=4000 State=UNKNOWN
PartitionName=main Nodes=$HOST Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$D/slurm.conf
end() {
    for name in slurmd slurmctld munged; do
        if [ -f "$D/$name.pid" ]; then kill "$(cat "$D/$name.pid")" || true; fi
    done
}
trap end EXIT INT TERM
install -d -o munge -g munge -m 755 /run/munge
install -d -o munge -g munge /var/log/munge /var/lib/munge "$D/munge"
runuser -u munge -- /usr/sbin/munged --pid-file="$D/munge/munged.pid"
cp "$D/munge/munged.pid" "$D/munged.pid"
slurmctld
sleep 2
slurmd
sleep 2
sinfo
"$python" "$here/study.py" "$D/study"
