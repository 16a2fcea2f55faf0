#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
#
#     problems/large/slurm.sh STUDY FOLDER PARTS
#
# A study as a job array of Slurm: PARTS jobs, then their journals merged where this was called.
# A job that is requeued, or begun again after it was killed, goes on from its journal. FOLDER
# must be seen by all nodes; the result is FOLDER/<study>/, the same bytes as of one run.
#SBATCH --job-name=modetune --requeue --open-mode=append --output=/dev/null
set -eu
modetune=${MODETUNE:-modetune}
name=$(basename "$1" .json)
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then
    exec "$modetune" run "$1" -o "$2" --quiet --resume --shard "$SLURM_ARRAY_TASK_ID/$3" \
        --threads "${SLURM_CPUS_PER_TASK:-1}"
fi
sbatch --wait --array="1-$3" "$0" "$@"
exec "$modetune" merge "$1" "$2/$name".*-of-"$3".journal -o "$2"
