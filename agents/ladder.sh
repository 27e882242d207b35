#!/usr/bin/env bash
# How was agents/results/ladder.md made? A tournament of the players of this repository: about 5 minutes on one idle core.
#
#     bash agents/ladder.sh [FILE.json]     agents/results/ladder.json, and the tables beside it
#
# Run again after an interruption, it goes on. Slow players meet the others in fewer frames. LIST=1 bash agents/ladder.sh prints the command.
set -euo pipefail
cd "$(dirname "$0")/.."
file=${1:-agents/results/ladder.json}
export OMP_NUM_THREADS=1 # the networks are small: more threads than one make them slower
command=(python -m agents.tournament random ghost_ball geometric ppo_target ppo_mask ppo_foresight search search_200
    --frames 60 --fewer ppo_foresight=20 search_200=20 --threads 1 --resume --out "$file" --markdown "${file%.json}.md")
if [[ -n ${LIST:-} ]]; then
    printf '%q ' "${command[@]}"
    echo
    exit
fi
"${command[@]}"
