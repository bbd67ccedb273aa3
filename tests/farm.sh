#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Usage: tests/farm.sh BUILD_DIR [SIZE]
# Draws one picture of SIZE (60000x30000) by one process, by GNU parallel, and by a Slurm array on two nodes, which is stopped in the middle
# and started again: they have one hash, and no process holds 600 MB. Slurm's daemons and both nodes run on this machine, with a key,
# settings and ports of their own, and end with the script. The parts take as many bytes as the picture in TMPDIR (5.4 GB). Needs
# section [farm] of packages.txt.
set -euo pipefail
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
    echo "usage: farm.sh BUILD_DIR [SIZE]" >&2
    exit 1
fi
anamorph="$(cd "$1" && pwd)/core/command/anamorph"
size="${2:-60000x30000}"
parts=4
export PATH="$PATH:/usr/sbin:/sbin"

work="$(mktemp -d)"
daemons=()
finish() {
    [ ${#daemons[@]} -eq 0 ] || kill "${daemons[@]}" 2>/dev/null || true
    wait || true
    rm -rf "$work"
}
trap finish EXIT
trap 'exit 1' INT TERM
cd "$work"
fail() {
    echo "farm.sh: $*" >&2
    tail -n 20 "$work"/*.log >&2 || true
    exit 1
}
# wait_for SECONDS COMMAND...: until the command succeeds.
wait_for() {
    local seconds="$1" end
    shift
    end=$((SECONDS + seconds))
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || fail "not so after $seconds s: $*"
        sleep 0.2
    done
}

# A panorama of noise, and its picture turned.
python3 - >noise.ppm <<'END'
import random, sys
sys.stdout.buffer.write(b"P6 2048 1024 255\n" + random.Random(1).randbytes(2048 * 1024 * 3))
END
recipe="noise.ppm.pano?to=equirectangular&yaw=33&pitch=21&roll=7&size=$size"

# Runs a command and writes the most memory that it held at once, in KiB, into a file.
cat >measured <<'END'
#!/usr/bin/python3
import resource, subprocess, sys
code = subprocess.run(sys.argv[2:]).returncode
open(sys.argv[1], "w").write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(code)
END
chmod +x measured
check_memory() {
    local file
    for file in "$@"; do
        [ "$(cat "$file")" -lt 600000 ] || fail "$file: $(cat "$file") KiB"
    done
    echo "$(sort -n "$@" | tail -1) KiB at most"
}

whole="$(./measured whole.kib "$anamorph" hash "$recipe" | cut -c1-32)"
echo "one process: $whole, $(check_memory whole.kib), $SECONDS s"

mkdir by_parallel
seq "$parts" | parallel -j "$(nproc)" ./measured by_parallel/{}.kib "$anamorph" draw "'$recipe'" --part "{}/$parts" -o by_parallel/part.{}
joined="$(./measured by_parallel/join.kib "$anamorph" join by_parallel/part.?)"
[ "$joined" = "$whole" ] || fail "GNU parallel: $joined"
echo "GNU parallel, $parts parts: $joined, $(check_memory by_parallel/*.kib), $SECONDS s"
rm -r by_parallel

# Slurm: a key, a controller and two nodes of one processor each.
mkdir state spool.one spool.two by_slurm
head -c 1024 /dev/urandom >key && chmod 400 key
read -r controller_port one_port two_port < <(python3 - <<'END'
import socket
sockets = [socket.socket() for _ in range(3)]
for s in sockets: s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))
END
)
export SLURM_CONF="$work/slurm.conf"
cat >"$SLURM_CONF" <<END
ClusterName=anamorph
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$controller_port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool.%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MailProg=/bin/true
KillWait=1
NodeName=one NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$one_port CPUs=1 State=UNKNOWN
NodeName=two NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$two_port CPUs=1 State=UNKNOWN
PartitionName=all Nodes=one,two Default=YES State=UP
END
munged --foreground --force --key-file="$work/key" --socket="$work/munge.socket" --pid-file="$work/munge.pid" \
    --log-file="$work/munge.log" --seed-file="$work/munge.seed" >munged.log 2>&1 &
daemons+=($!)
wait_for 30 test -S munge.socket
slurmctld -D -c >slurmctld.log 2>&1 &
daemons+=($!)
for node in one two; do
    slurmd -D -N "$node" >"slurmd.$node.log" 2>&1 &
    daemons+=($!)
done
both_idle() { [ "$(sinfo -h -N -t idle -o %N | wc -l)" -eq 2 ]; }
wait_for 60 both_idle

cat >array.sh <<END
#!/bin/bash
echo "\$SLURMD_NODENAME" >>by_slurm/nodes
./measured "by_slurm/\$SLURM_ARRAY_TASK_ID.kib" \\
    "$anamorph" draw "$recipe" --part "\$SLURM_ARRAY_TASK_ID/$parts" -o "by_slurm/part.\$SLURM_ARRAY_TASK_ID"
END
submit() { sbatch --parsable --array="1-$parts" --chdir="$work" --output="$work/job.%a.log" array.sh; }
begun() { [ "$(cat by_slurm/part.[12].tiles | wc -l)" -gt 200 ]; }
none_left() { [ -z "$(squeue -h)" ]; }

job="$(submit)"
wait_for 300 begun
scancel --signal=KILL --full "$job"
scancel "$job"
wait_for 60 none_left
mkdir stopped
cp by_slurm/*.tiles stopped
echo "Slurm: stopped after $(cat stopped/*.tiles | grep -c ' [0-9a-f]\{32\}$') tiles"
submit >/dev/null
wait_for 3600 none_left
for manifest in stopped/*.tiles; do
    # All lines but the last, which may be half of one, are there still.
    head -n -1 "$manifest" | cmp -n "$(head -n -1 "$manifest" | wc -c)" - "by_slurm/${manifest##*/}" || fail "$manifest was begun anew"
done
[ "$(sort -u by_slurm/nodes | wc -l)" -eq 2 ] || fail "one node drew all"
joined="$(./measured by_slurm/join.kib "$anamorph" join by_slurm/part.?)" || fail "join"
[ "$joined" = "$whole" ] || fail "Slurm: $joined"
echo "Slurm, two nodes, $parts parts: $joined, $(check_memory by_slurm/*.kib), $SECONDS s"
