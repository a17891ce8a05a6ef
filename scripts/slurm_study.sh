#!/usr/bin/env bash
# Runs a small study on a real Slurm of one node, kills a job in the middle, resumes, and compares its
# results and table with those of the same study without Slurm, byte for byte.
#
# Starts munged, slurmctld and slurmd with a configuration, key and ports of its own in a temporary
# folder, and ends them. Needs root and Debian's slurm-wlm and munge; without them it says so and ends.
set -euo pipefail
cd "$(dirname "$0")/.."
loopgap=.venv/bin/loopgap

for program in munged slurmctld slurmd sbatch; do
  command -v "$program" >/dev/null || PATH=$PATH:/usr/sbin
  command -v "$program" >/dev/null || {
    echo "slurm study: not run, $program is not installed (apt-get install slurm-wlm munge)"
    exit 0
  }
done
[ "$(id -u)" = 0 ] || { echo "slurm study: not run, it needs root to start Slurm"; exit 0; }

work=$(mktemp -d)
chmod 755 "$work"
pids=()
finish() {
  status=$?
  [ $status = 0 ] || tail -n 20 "$work"/*.log >&2 || true
  scancel --user=root 2>/dev/null || true
  for ((i = ${#pids[@]} - 1; i >= 0; i--)); do
    kill "${pids[i]}" 2>/dev/null || true
    wait "${pids[i]}" 2>/dev/null || true
  done
  rm -rf "$work"
  exit $status
}
trap finish EXIT

free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'; }
host=$(hostname -s)
mkdir -m 755 "$work"/{state,spool,bin}
dd if=/dev/urandom of="$work/munge.key" bs=1024 count=1 status=none
chmod 400 "$work/munge.key"
cat >"$work/slurm.conf" <<EOF
ClusterName=loopgap
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CryptoType=crypto/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=1
MinJobAge=3600
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
# A cluster has an accounting database, which submitit asks for the state of its jobs; here the
# controller is asked instead.
cat >"$work/bin/sacct" <<'EOF'
#!/bin/sh
echo "JobID|State|NodeList"
scontrol show job -o | sed -n \
  's/^JobId=\([0-9]*\) ArrayJobId=\([0-9]*\) ArrayTaskId=\([0-9]*\) .* JobState=\([A-Z]*\) .* NodeList=\([^ ]*\) .*/\2_\3|\4|\5/p'
EOF
chmod 755 "$work/bin/sacct"
export SLURM_CONF=$work/slurm.conf PATH=$work/bin:$PATH

munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" \
  --pid-file="$work/munged.pid" --log-file="$work/munged.log" --seed-file="$work/munged.seed" \
  >"$work/munged.out" 2>&1 & pids+=($!)
sleep 1
slurmctld -D >"$work/slurmctld.log" 2>&1 & pids+=($!)
slurmd -D -N "$host" >"$work/slurmd.log" 2>&1 & pids+=($!)
for _ in $(seq 60); do
  [ "$(sinfo --noheader --format=%t 2>/dev/null)" = idle ] && break
  sleep 0.5
done
sinfo

study=(-m experiment=splits "split.index=range(0,4)" acquisition.cycles=5 acquisition.steps_per_cycle=40
  camera.width_px=504 camera.height_px=378 vision.workers=1 selection.k_max=3)
echo "--- without Slurm"
LOOPGAP_CACHE=$work/cache_local "$loopgap" "${study[@]}" hydra.sweep.dir="$work/local" >"$work/local.log" 2>&1

on_slurm() {
  LOOPGAP_CACHE=$work/cache_slurm "$loopgap" "${study[@]}" hydra/launcher=slurm \
    hydra.launcher.submitit_folder="$work/submitit/%j" hydra.sweep.dir="$work/slurm"
}
echo "--- on Slurm, with one job killed"
on_slurm >"$work/slurm.log" 2>&1 & sweep=$!
until grep -qs '"running"' "$work"/slurm/*/job.json; do
  kill -0 $sweep 2>/dev/null || { echo "slurm study: the sweep ended before a job ran"; exit 1; }
  sleep 0.2
done
victim=$(grep -ls '"running"' "$work"/slurm/*/job.json | head -n 1 | xargs dirname | xargs basename)
job=$(squeue --noheader --array --states=RUNNING --format="%K %A" | awk -v task="$victim" '$1 == task {print $2}')
scontrol listpids "$job" | awk '$3 == "0" {print $1}' | xargs kill -9
echo "killed job $victim with kill -9"
status=0; wait $sweep || status=$?
grep -E "jobs are missing|^  job " "$work/slurm.log" || true
[ $status = 1 ] || { echo "slurm study: expected exit status 1 of the killed sweep; found $status"; exit 1; }
while [ "$(squeue --noheader | wc -l)" -gt 0 ]; do sleep 0.5; done

echo "--- resumed"
on_slurm >"$work/resumed.log" 2>&1
grep -E "done before|made|0 left" "$work/resumed.log" | tail -n 1
for file in results.parquet results.csv tables/splits/{table.tex,table.md,table.csv,comparisons.csv,numbers.tex}; do
  cmp "$work/local/$file" "$work/slurm/$file"
done
pickles=$(find "$work/slurm" "$work/local" -name "*.pkl" -o -name "*.pickle" -o -name "*.joblib")
[ -z "$pickles" ] || { echo "slurm study: pickles among the results: $pickles"; exit 1; }
cat "$work/slurm/tables/splits/table.md"
echo "slurm study: 4 jobs, one killed and resumed; results and tables are the local ones, byte for byte"
