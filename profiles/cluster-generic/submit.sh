#!/bin/sh
# Hand one job to the scheduler and print its number, and nothing else. Here: Slurm's sbatch; for another
# scheduler put its own command, as qsub. Cores, MB, minutes and the rule come first, the job's script last.
sbatch --parsable --cpus-per-task="$1" --mem="$2" --time="$3" --job-name="$4" \
    --output=.snakemake/cluster-%j.log "$5"
