#!/bin/sh
# with_slurm.sh COMMAND [ARGUMENT...]
# Runs a command on a Slurm cluster of its own: munged, slurmctld and slurmd on 127.0.0.1, one node "node" with four
# CPUs in one partition "all". Needs neither systemd nor cgroups nor a host name that resolves, and runs as root or as
# anybody else. Keys, sockets, states and logs lie in a temporary folder; whatever happens, everything that the cluster started is stopped and the folder
# removed. The command finds the cluster by SLURM_CONF, its logs in the folder of that file.
# Exit status: the command's; 77 where there is no Slurm to start, or where only root could start it; 1 where it does not
# come up for root either, and with GLADSTONE_SLURM=required in the environment instead of 77. Its logs then go to stderr.
set -eu

skip() {  # REASON
  [ "${GLADSTONE_SLURM:-}" != required ] || { echo "not skipped, since GLADSTONE_SLURM=required: $1" >&2; exit 1; }
  echo "skipped: $1" >&2
  exit 77
}

# Ends all that runs on the cluster in this folder: daemons, steps and jobs carry its SLURM_CONF in their environment.
end_cluster() {
  for _ in 1 2 3; do
    grep -lasFxz "SLURM_CONF=$1/slurm.conf" /proc/[0-9]*/environ | grep -o '[0-9]*' | xargs -r kill -KILL 2>/dev/null || :
  done
  rm -rf "$1"
}

if [ "${1:-}" = --end-after ]; then  # PID FOLDER: the guard, in a session of its own, so that kill -9 leaves nothing
  while kill -0 "$2" 2>/dev/null; do sleep 0.2; done
  end_cluster "$3"
  exit
fi

PATH=$PATH:/usr/sbin:/sbin
for program in munged slurmctld slurmd sbatch; do
  command -v $program >/dev/null || skip "no $program here; install Debian's packages munge, slurmctld, slurmd and slurm-client"
done
# root or anybody, but jobs are started by name
user=$(id -un 2>/dev/null) || skip "user $(id -u) has no name, and Slurm starts no jobs then; run as root"

folder=$(mktemp -d /tmp/gladstone_slurm_XXXXXX)
log=$folder/log
setsid --fork "$0" --end-after $$ "$folder" >"$folder/guard" 2>&1 </dev/null
trap 'end_cluster "$folder"' EXIT
trap 'exit 143' TERM
trap 'exit 130' INT
trap 'exit 129' HUP
chmod 755 "$folder"  # munged wants its socket within reach of everybody
mkdir "$folder/state" "$folder/spool" "$log"

# A port below those that the system hands out, at which nobody listens (/proc/net/tcp: local address, port in hex).
free_port() {
  while :; do
    port=$((20000 + $(od -An -N2 -tu2 /dev/urandom) % 12000))
    grep -qsi "^ *[0-9]*: [0-9a-f]*:$(printf %04x $port) " /proc/net/tcp /proc/net/tcp6 || break
  done
  echo "$port"
}

write_configuration() {
  cat >"$folder/slurm.conf" <<END
ClusterName=gladstone_test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=5
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=10000
MaxArraySize=${SLURM_MAX_ARRAY_SIZE:-1001}
JobRequeue=1
KillWait=1
ReturnToService=2
SlurmdParameters=config_overrides
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$log/slurmctld
SlurmdLogFile=$log/slurmd
NodeName=node NodeHostname=localhost NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=node Default=YES MaxTime=10 State=UP
END
  echo 'CgroupPlugin=cgroup/v1' >"$folder/cgroup.conf"  # never used, but detecting one fails where there is none
}

on_cluster() { env SLURM_CONF="$folder/slurm.conf" "$@"; }

start() {
  write_configuration
  on_cluster slurmctld -D -i >"$log/slurmctld.err" 2>&1 </dev/null &
  controller=$!
  on_cluster slurmd -D -N node >"$log/slurmd.err" 2>&1 </dev/null &
  node=$!
  for _ in $(seq 300); do  # at most 30 s
    kill -0 $controller 2>/dev/null && kill -0 $node 2>/dev/null || return 1  # a port was taken after all, perhaps
    [ "$(on_cluster timeout 5 sinfo -h -o %T 2>/dev/null)" != idle ] || return 0
    sleep 0.1
  done
  return 1
}

(umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
on_cluster munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
  --pid-file="$folder/munge.pid" --seed-file="$folder/munge.seed" --log-file="$log/munged" \
  >"$log/munged.err" 2>&1 </dev/null &
for _ in $(seq 50); do
  [ ! -S "$folder/munge.socket" ] || break
  sleep 0.1
done

start || { kill $controller $node 2>/dev/null; start; } || {
  echo "the Slurm cluster did not come up; what it said:" >&2
  tail -n 20 "$log"/* >&2
  [ "$user" = root ] && exit 1
  skip "run as root"
}
on_cluster "$@"
