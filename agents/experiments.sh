#!/usr/bin/env bash
# How were the figures of agents/results/*.md made? Trains every agent and compares them: hours. Finished runs are kept.
#
#     bash agents/experiments.sh [FOLDER [JOBS]]     runs/experiments, 2 runs side by side, each on one core
#
# Make the tables again from the stored figures, without playing: python -m agents.report agents/results/*.json
# Some of the runs only, without the comparison: ONLY='ppo_value_' bash agents/experiments.sh. List the commands: LIST=1 bash ...
# The evaluation on a Ray cluster (docs/scale.md): RAY=HEAD:6379 bash agents/experiments.sh, or RAY=local; the figures are the same.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-runs/experiments} jobs=${2:-2}
export folder

runs() { # name, then the options of train.py
    local long="--imitate 153600 --steps 1507328"
    for seed in 0 1 2 3 4; do echo "ppo_value-$seed --seed $seed $long"; done
    for noise in none amateur club; do echo "ppo_value_$noise --noise $noise $long"; done
}

train() {
    local name=$1
    shift
    [[ -f $folder/$name/results.json ]] && return
    rm -rf "${folder:?}/$name"
    python train.py "$@" --parallel one --no-progress --out "$folder/$name" > "$folder/$name.txt" 2>&1 ||
        { echo "$name failed: see $folder/$name.txt" >&2; return 1; }
    echo "$(date +%H:%M) $name"
}
export -f train
chosen=$(runs | grep -E "^(${ONLY:-.*})") || { echo "ONLY='$ONLY' names no run" >&2; exit 2; }
if [[ -z ${LIST:-} ]]; then
    mkdir -p "$folder"
    xargs -d '\n' -P "$jobs" -I{} bash -c 'train {}' <<< "$chosen"
else
    sed 's/^[^ ]* /python train.py /' <<< "$chosen"
fi
[[ -n ${ONLY:-} ]] && exit

module() { # its name, then its options
    ${LIST:+printf '%q '} python -m "$@"
    ${LIST:+echo}
}
evaluate() { # name of the output, then the options of agents.evaluate
    local name=$1
    shift
    module agents.evaluate "$@" ${RAY:+--ray "$RAY"} --json "agents/results/$name.json" --markdown "agents/results/$name.md"
}
# the published models, by their names
evaluate visits --layouts held_out=500 --noise professional --against search best_pot --agent \
    planner best_pot ghost_ball search stroke_value ppo_value random
