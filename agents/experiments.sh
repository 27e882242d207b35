#!/usr/bin/env bash
# How were the figures of agents/results/*.md made? Trains every agent and compares them: hours. Finished runs are kept.
#
#     bash agents/experiments.sh [FOLDER [JOBS]]     runs/experiments, 2 runs side by side, each on one core
#
# Make the tables again from the stored figures, without playing: python -m agents.report agents/results/*.json
# Some of the runs only, without the comparison: ONLY='fore-|gamma0-' bash agents/experiments.sh. List the commands: LIST=1 bash ...
# On a Ray cluster (docs/scale.md): RAY=HEAD:6379 bash agents/experiments.sh, or RAY=local; the figures are the same.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-runs/experiments} jobs=${2:-2}
export folder

runs() { # name, then the options of train.py
    for k in 0 1 2 3 4; do echo "value-$k --seed $k"; done
    for noise in none amateur club; do echo "value-$noise --noise $noise"; done
    for n in 9600 38400; do echo "curve-$n --imitate $n --steps 16384"; done
    for k in 0 1 2 3 4; do echo "fore-$k --agent ppo_foresight --seed $k"; done
    for k in 0 1 2 3 4; do echo "mask-$k --agent ppo_mask --steps 1000000 --seed $k"; done
    echo "mask5M-0 --agent ppo_mask"
    for k in 0 1 2 3 4; do echo "gamma0-$k --agent ppo_foresight --set gamma=0 --seed $k"; done
    for fidelity in fast reference; do echo "$fidelity-0 --agent ppo_foresight --fidelity $fidelity"; done
    for physics in match marlow; do echo "$physics-0 --agent ppo_foresight --physics ${physics/marlow/paper,mu_bb=marlow}"; done
    for noise in none amateur club; do echo "$noise-0 --agent ppo_foresight --noise $noise"; done
    for k in 0 1 2 3 4; do echo "absolute-$k --agent ppo_absolute --steps 500000 --seed $k"; done
    for k in 0 1 2 3 4; do echo "target-$k --agent ppo_target --steps 1000000 --seed $k"; done
    echo "tqc-0 --agent tqc_target"
    for k in 0 1 2; do echo "lineup-$k --agent ppo_mask --layout line_up --steps 300000 --seed $k"; done
}
later() { # these start from the weights of earlier runs
    echo "taught-0 --agent ppo_mask --start $folder/value-0 --envs 256 --set learning_rate=lin_5e-4 n_epochs=2 batch_size=2048 n_steps=64"
    for k in 0 1 2; do echo "curriculum-$k --agent ppo_mask --start $folder/lineup-$k --steps 700000 --seed $k"; done
}
last() { # this one from those of a later one
    echo "again-0 --agent ppo_mask --start $folder/taught-0 --envs 256 --steps 3000000 --set learning_rate=lin_5e-4 n_epochs=2 batch_size=2048 n_steps=64"
}

train() {
    local name=$1
    shift
    [[ -f $folder/$name/results.json ]] && return
    rm -rf "${folder:?}/$name"
    local cluster=() # only expert iteration and imitation are played on a cluster: of these recipes
    [[ -n ${RAY:-} && " $* " =~ " ppo_foresight " || -n ${RAY:-} && ! " $* " =~ " --agent " ]] && cluster=(--ray "$RAY")
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
module agents.curves "ppo_foresight=$folder/fore-?" "ppo_foresight_gamma0=$folder/gamma0-?" \
    "ppo_mask=$folder/mask-?" "ppo_absolute=$folder/absolute-?" "ppo_target=$folder/target-?" "tqc_target=$folder/tqc-?"
evaluate main --against ghost_ball ppo_foresight_gamma0 --agent \
    "ppo_foresight=$folder/fore-?" "ppo_foresight_gamma0=$folder/gamma0-?" ghost_ball foresight_rule ppo_mask "ppo_mask_1M=$folder/mask-?" \
    geometric random
evaluate aim --against ghost_ball --layouts held_out --noise professional --agent \
    "ppo_absolute=$folder/absolute-?" "ppo_target=$folder/target-?" "tqc_target=$folder/tqc-?" ghost_ball
evaluate imitation_against_rule --against foresight_rule --noise professional --agent "ppo_foresight=$folder/fore-?" foresight_rule
evaluate curriculum --against ghost_ball ppo_mask_1M --layouts held_out line_up --noise professional --agent \
    "curriculum=$folder/curriculum-?" "ppo_mask_1M=$folder/mask-[012]" ghost_ball
evaluate fidelity --layouts held_out --noise professional --fidelity fast standard reference --agent \
    "fast=$folder/fast-?" "standard=$folder/fore-0" "reference=$folder/reference-?"
evaluate physics --layouts held_out --noise professional --physics paper match paper,mu_bb=marlow --agent \
    "paper=$folder/fore-0" "match=$folder/match-?" "marlow=$folder/marlow-?"
evaluate noise --layouts held_out --agent \
    "none=$folder/none-?" "professional=$folder/fore-0" "amateur=$folder/amateur-?" "club=$folder/club-?"

evaluate planner --layouts held_out --noise professional club --against search foresight_rule best_pot ppo_mask \
    --picture agents/pictures/destinations.png --agent "planner=planner@$folder/value-?" best_pot ghost_ball search \
    foresight_rule "ppo_value=$folder/value-?" ppo_mask
evaluate model_free --layouts held_out --noise professional --against best_pot ppo_mask_5M --agent \
    "ppo_mask_finetuned=$folder/again-0" "ppo_mask_finetuned_5M=$folder/taught-0" "ppo_value=$folder/value-?" "ppo_mask_5M=$folder/mask5M-0" best_pot
evaluate planner_parts --layouts held_out=400 line_up=200 colours=200 random:3=200 --noise professional club --against search --agent \
    "planner=planner@$folder/value-[012]" "planner_value=planner_value@$folder/value-[012]" \
    "planner_policy=planner_policy@$folder/value-[012]" search
[[ -n ${LIST:-} ]] || git show f19a568:agents/players/search.py | sed "s/from \.\.features/from agents.features/" > "$folder/search_before.py"
PYTHONPATH=$folder evaluate planner_budgets --layouts held_out=200 --noise professional --against search search_before --agent \
    "planner_30=planner_30@$folder/value-0" "planner_60=planner_60@$folder/value-0" "planner=planner@$folder/value-0" \
    "planner_500=planner_500@$folder/value-?" "planner_2000=planner_2000@$folder/value-0" search search_before=search_before:Search
evaluate planner_curve --layouts held_out=400 --noise professional --against search --agent "positions_9600=planner@$folder/curve-9600" \
    "positions_38400=planner@$folder/curve-38400" "positions_153600=planner@$folder/value-0" search
evaluate planner_club --layouts held_out --noise club --against search foresight_rule --agent \
    "planner=planner@$folder/value-club" search foresight_rule
evaluate planner_noise --layouts held_out=300 --against search --agent "none=planner@$folder/value-none" \
    "professional=planner@$folder/value-0" "amateur=planner@$folder/value-amateur" "club=planner@$folder/value-club" search
evaluate planner_rekeyed --layouts held_out=500 --noise professional --rekey --against search --agent \
    "planner=planner@$folder/value-0" search
evaluate planner_147 --layouts break_off=50 --noise none --against search --agent "planner_2000=planner_2000@$folder/value-none" search
module agents.value_quality --agent "planner@$folder/value-0" --visits 500 --layouts held_out line_up colours random:3 \
    --noise professional club --markdown agents/results/value_quality.md
