#!/usr/bin/env bash
# Slurm with one node in a folder, without systemd: slurm_here.sh start|stop FOLDER. To be run as root.
# Needs Debian's packages slurmctld, slurmd, slurm-client and munge. `start` writes FOLDER/slurm.conf, which
# SLURM_CONF has to name for sbatch and the others, and waits until the node takes jobs. All listens on the
# loopback alone.
set -euo pipefail
what=$1
folder=$(realpath -m -- "$2")
host=$(hostname -s)
export SLURM_CONF=$folder/slurm.conf

running() { # file with the id of a process
    [ -s "$1" ] && kill -0 "$(cat "$1")" 2> /dev/null
}

stop() {
    scancel --user "$(id -un)" 2> /dev/null || true
    for _ in $(seq 50); do
        [ -z "$(squeue --noheader 2> /dev/null)" ] && break
        sleep 0.2
    done
    for one in slurmd slurmctld munged; do
        if running "$folder/$one.pid"; then kill "$(cat "$folder/$one.pid")"; fi
    done
}

if [ "$what" = stop ]; then
    stop
    exit 0
fi

mkdir -p "$folder"/{state,spool,munge}
chmod 0700 "$folder/munge"
dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
chmod 0400 "$folder/munge/key"
free=$(python3 -c 'import socket
held = [socket.socket() for _ in range(2)]
[one.bind(("127.0.0.1", 0)) for one in held]
print(*(one.getsockname()[1] for one in held))')
read -r port_ctl port_d <<< "$free"
# cred_expire is also how long a job that was requeued waits; 120 s if not given
cat > "$SLURM_CONF" <<END
ClusterName=here
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port_ctl
SlurmdPort=$port_d
SlurmUser=root
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1
ReturnToService=2
MpiDefault=none
JobRequeue=1
KillWait=10
MinJobAge=60
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(free -m | awk '/Mem:/ {print int($2 * 0.9)}') State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
munged --force --socket="$folder/munge.socket" --key-file="$folder/munge/key" --pid-file="$folder/munged.pid" \
    --seed-file="$folder/munge/seed" --log-file="$folder/munge/log"
slurmctld -f "$SLURM_CONF"
slurmd -f "$SLURM_CONF"
for _ in $(seq 300); do
    if sinfo --noheader --format=%t 2> /dev/null | grep --quiet --extended-regexp 'idle|mix|alloc'; then exit 0; fi
    sleep 0.2
done
echo "no node took jobs within a minute; see $folder/slurmctld.log and slurmd.log" >&2
stop
exit 1
