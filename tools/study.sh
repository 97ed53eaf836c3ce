#!/bin/sh
# The paper's experiment in shards, on all cores of one or of many machines.
#
#   tools/study.sh DIR [SHARDS] [options of `sortie study paper`]
#
# By GNU parallel: a job for each shard, done ones skipped when run again (--resume), and
# within a shard done runs skipped. With many machines: SSHLOGINFILE=hosts tools/study.sh ...,
# DIR on a file system that all of them see. As a SLURM array of the same line:
#
#   sbatch --array=1-64 --wrap \
#     'sortie study paper --out DIR/shard-$SLURM_ARRAY_TASK_ID --shard $SLURM_ARRAY_TASK_ID/64 --resume'
#   and when all are done: sortie study merge DIR/shard-* --out DIR/whole
set -eu
dir=$1
shards=${2:-8}
[ $# -gt 1 ] && shift
shift
mkdir -p "$dir"
# One thread each: the shards share the cores between them.
RAYON_NUM_THREADS=1
export RAYON_NUM_THREADS
seq "$shards" | parallel --joblog "$dir/joblog" --resume-failed --retries 2 \
    ${SSHLOGINFILE:+--sshloginfile "$SSHLOGINFILE" --workdir . --env RAYON_NUM_THREADS} \
    sortie study paper --out "$dir/shard-{}" --shard "{}/$shards" --resume "$@"
sortie study merge "$dir"/shard-* --out "$dir/whole"
