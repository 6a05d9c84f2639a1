#!/usr/bin/env bash
# Runs a command beside a Slurm of one node, whose daemons and files live in a scratch folder as long as the command runs:
#   tests/support/slurm.sh FOLDER COMMAND [WORD...]
# The command finds it through SLURM_CONF. Exit status: that of the command; 77, with a line that says why, where Slurm is
# not installed; 2 where it does not start.
set -euo pipefail
folder=$(realpath "${1:?usage: slurm.sh FOLDER COMMAND [WORD...]}")
shift
PATH=$PATH:/usr/sbin:/sbin
for program in munged slurmctld slurmd sbatch scontrol; do
  command -v "$program" >/dev/null && continue
  echo "slurm: $program is not installed; apt-get install slurmctld slurmd slurm-client munge"
  exit 77
done

free_port() {
  local port
  while port=$((20000 + RANDOM)) && (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do :; done
  echo "$port"
}
daemons=()
stop() { # stop PID, with force if need be
  kill "$1" 2>/dev/null || return 0
  { sleep 5 && kill -KILL "$1"; } >/dev/null 2>&1 &
  local forced=$!
  wait "$1" 2>/dev/null || true
  kill "$forced" 2>/dev/null || true
}
finish() { # the last that was started first, since it needs the others
  for ((at = ${#daemons[@]} - 1; at >= 0; --at)); do stop "${daemons[at]}"; done
}
trap finish EXIT
start() { # start NAME PROGRAM [WORD...]
  "${@:2}" >"$folder/$1.log" 2>&1 &
  daemons+=($!)
}
await() { # await WHAT COMMAND [WORD...]
  for ((tries = 0; tries < 150; ++tries)); do
    "${@:2}" >/dev/null 2>&1 && return
    sleep 0.2
  done
  echo "slurm: $1 does not start:" >&2
  tail -qn 5 "$folder"/*.log >&2
  exit 2
}

mkdir -p "$folder/state" "$folder/spool"
head -c 1024 /dev/urandom >"$folder/munge.key"
chmod 400 "$folder/munge.key"
user=$(id -un)
node=$(hostname -s)
export SLURM_CONF=$folder/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=scratch
SlurmctldHost=$node(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=2
SlurmdParameters=config_overrides
NodeName=$node NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
start munged munged --foreground --force --socket="$folder/munge.socket" --key-file="$folder/munge.key" \
  --pid-file="$folder/munge.pid" --log-file="$folder/munge.log" --seed-file="$folder/munge.seed"
await munged munge --socket="$folder/munge.socket" --no-input
start slurmctld slurmctld -D
await slurmctld scontrol ping
start slurmd slurmd -D
await slurmd bash -c 'sinfo --noheader --states=idle --format=%n | grep -q .'
"$@"
