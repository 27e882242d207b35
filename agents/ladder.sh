#!/usr/bin/env bash
# How was agents/results/ladder.md made? A tournament of the players of this repository: about 5 minutes on one idle core.
#
#     bash agents/ladder.sh [FILE.json]     agents/results/ladder.json, and the tables beside it
#
# Run again after an interruption, it goes on. LIST=1 bash agents/ladder.sh prints the command.
set -euo pipefail
cd "$(dirname "$0")/.."
file=${1:-agents/results/ladder.json}
export OMP_NUM_THREADS=1 # the networks are small: more threads than one make them slower
command=(python -m agents.tournament random ghost_ball best_pot stroke_value search planner tactician
    --cue real --miss clear_path --frames 40 --threads 1 --resume --out "$file" --markdown "${file%.json}.md")
if [[ -n ${LIST:-} ]]; then
    printf '%q ' "${command[@]}"
    echo
    exit
fi
"${command[@]}"
