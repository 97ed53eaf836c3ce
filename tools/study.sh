#!/bin/sh
# The paper's experiment in shards, on all cores of one or of many machines.
#
#   tools/study.sh DIR SHARDS [options of `sortie study paper`]
#
# By GNU parallel: a job for each shard. Run again after a failure or a kill, it skips the
# shards that are done, and within a shard the runs that are done. With many machines:
# SSHLOGINFILE=hosts tools/study.sh ..., where DIR is on a file system that all of them see
# and `sortie` on their path. The same line as a SLURM array, here of 64 shards:
#
#   sbatch --array=1-64 --cpus-per-task=1 --export=ALL,RAYON_NUM_THREADS=1 --wrap \
#     'sortie study paper --out DIR/shard-$SLURM_ARRAY_TASK_ID --shard $SLURM_ARRAY_TASK_ID/64 --resume'
#   and when all are done: sortie study merge DIR/shard-* --out DIR/whole
set -eu
dir=${1:?usage: tools/study.sh DIR SHARDS [options of sortie study paper]}
shards=${2:?usage: tools/study.sh DIR SHARDS [options of sortie study paper]}
shift 2
mkdir -p "$dir"
# One thread each: the shards share the cores between them.
RAYON_NUM_THREADS=1
export RAYON_NUM_THREADS
seq "$shards" | parallel --quote --joblog "$dir/joblog" --resume-failed --retries 2 \
    ${SSHLOGINFILE:+--sshloginfile "$SSHLOGINFILE" --workdir . --env RAYON_NUM_THREADS} \
    sortie study paper --out "$dir/shard-{}" --shard "{}/$shards" --resume "$@"
[ -e "$dir/whole/study.json" ] || sortie study merge "$dir"/shard-* --out "$dir/whole"
