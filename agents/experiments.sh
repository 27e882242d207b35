#!/usr/bin/env bash
# How were the figures of agents/results/*.md made? Trains every agent and compares them: hours. Finished runs are kept.
#
#     bash agents/experiments.sh [FOLDER [JOBS]]     runs/experiments, 2 runs side by side, each on one core
#
# Make the tables again from the stored figures, without playing: python -m agents.report agents/results/*.json
# Some of the runs only, without the comparison: ONLY='ppo_mask-' bash agents/experiments.sh. List the commands: LIST=1 bash ...
# On a Ray cluster (docs/scale.md): RAY=HEAD:6379 bash agents/experiments.sh, or RAY=local; the figures are the same.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-runs/experiments} jobs=${2:-2}
export folder

runs() { # name, then the options of train.py
    echo "ppo_value-0 --seed 0"
    for noise in none amateur club; do echo "ppo_value_$noise --noise $noise"; done
    for k in 0 1 2; do echo "ppo_mask-$k --agent ppo_mask --steps 1000000 --seed $k"; done
}
later() { # it starts from the policy of the planner
    echo "tuned --agent ppo_mask --start $folder/ppo_value-0 --set learning_rate=lin_5e-4"
}
last() { # and goes on from there
    echo "ppo_mask_finetuned --agent ppo_mask --start $folder/tuned --steps 3000000 --set learning_rate=lin_5e-4"
}

train() {
    local name=$1
    shift
    [[ -f $folder/$name/results.json ]] && return
    rm -rf "${folder:?}/$name"
    local cluster=() # only expert iteration is played on a cluster
    [[ -n ${RAY:-} && ! " $* " =~ " --agent " ]] && cluster=(--ray "$RAY")
    python train.py "$@" "${cluster[@]}" --parallel one --no-progress --out "$folder/$name" > "$folder/$name.txt" 2>&1 ||
        { echo "$name failed: see $folder/$name.txt" >&2; return 1; }
    echo "$(date +%H:%M) $name"
}
export -f train
grep -qE "^(${ONLY:-.*})" <<< "$(runs; later; last)" || { echo "ONLY='$ONLY' names no run" >&2; exit 2; } # no pipe: grep -q leaves early
for list in runs later last; do
    if [[ -z ${LIST:-} ]]; then
        mkdir -p "$folder"
        "$list" | { grep -E "^(${ONLY:-.*})" || [[ $? == 1 ]]; } | xargs -d '\n' -r -P "$jobs" -I{} bash -c 'train {}'
    else
        "$list" | sed 's/^[^ ]* /python train.py /'
    fi
done
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
module agents.curves "ppo_value=$folder/ppo_value-0"
# the published models, by their names
evaluate visits --layouts held_out=500 --noise professional --against search best_pot --picture agents/pictures/destinations.png --agent \
    planner best_pot ghost_ball search stroke_value ppo_mask_finetuned ppo_value ppo_mask random
module agents.value_quality --visits 500 --layouts held_out --noise professional --markdown agents/results/value_quality.md
