#!/usr/bin/env bash
# Makes anew what results/ keeps. In a clone with the extras train, test, render and data, on a quiet machine:
#
#     bash results/make.sh PART        all: every part but weights, days
#                                      physics: charts of benchmarks and their figures, some minutes;
#                                      with TRACKED=FILE the real shots of that file, too
#                                      pictures: charts of kept figures, diagrams, films, screenshots, README's break, some minutes
#                                      agents: trains the models of results/weights, compares all players, hours
#                                      weights: the models of FOLDER into results/weights, those into the package
#                                      curves [OPTION ...]: what plain Stable-Baselines3 learns, with options of
#                                      agents.curves: days; its table goes into docs/agents/curves.md
#                                      leaderboard [AGENT ...]: judges them all, or these alone, then its page: days
#
# Complete runs and files are left as they are and incomplete ones resumed; remove one to make it again.
# agents: FOLDER holds the runs [runs/experiments], JOBS run side by side [2], ONLY='ppo_value_' picks runs and compares
# nothing, LIST=1 prints the commands, RAY=HEAD:6379 plays on a Ray cluster (docs/scale.md). The tables again, from the
# stored figures: python -m agents.report results/agents/*.json
set -uo pipefail
cd "$(dirname "$0")/.."
shopt -s nullglob
export FOLDER=${FOLDER:-runs/experiments}

module() { # its name, then its options
    ${LIST:+printf '%q '} python -m "$@" || exit
    ${LIST:+echo}
}

physics() {
    for name in paper scene tradeoff; do
        module "benchmarks.$name" --json "results/physics/$name.json" --out results/pictures
    done
    (module benchmarks.stability --fuzz 200000 --json results/physics/stability.json) ||
        echo "a random shot raised an error: see results/physics/stability.json" >&2
    # the tracked shots are not in the clone, see docs/validation/real_shots.md
    [[ -z ${TRACKED:-} ]] || module benchmarks.real_shots "$TRACKED" --json results/physics/real_shots.json
}

pictures() {
    for what in charts diagrams films screens; do
        ${LIST:+echo} python results/make_pictures.py $what || exit
    done
    module snooker_env.watch --agent planner --at-least 130 --out results/pictures/break.gif --speed 6
}

models() { # name, then the options of train.py
    local long="--imitate 153600 --steps 1507328"
    for seed in 0 1 2 3 4; do echo "ppo_value-$seed --agent ppo_value --seed $seed $long"; done
    echo "strokes --agent strokes --seed 1 --steps 1000000"
    for noise in none amateur club; do echo "ppo_value_$noise --agent ppo_value --noise $noise $long"; done
}

train() {
    local name=$1
    shift
    [[ -f $FOLDER/$name/results.json ]] && return
    rm -rf "${FOLDER:?}/$name"
    python train.py "$@" --parallel one --out "$FOLDER/$name" > "$FOLDER/$name.txt" 2>&1 ||
        { echo "$name failed: see $FOLDER/$name.txt" >&2; return 1; }
    echo "$(date +%H:%M) $name"
}
export -f train

train_models() { # those whose names begin as ONLY says
    chosen=$(models | grep -E "^(${ONLY:-.*})") || { echo "ONLY='$ONLY' names no run" >&2; exit 2; }
    if [[ -n ${LIST:-} ]]; then
        sed 's/^[^ ]* /python train.py /' <<< "$chosen"
    else
        mkdir -p "$FOLDER"
        xargs -d '\n' -P "${JOBS:-2}" -I{} bash -c 'train {}' <<< "$chosen" || exit 1
    fi
}

agents() {
    train_models
    [[ -n ${ONLY:-} ]] && exit
    module examples.self_play --out "$FOLDER/self_play"
    module agents.evaluate --layouts held_out=500 --noise professional --against search best_pot --agent \
        planner best_pot ghost_ball search stroke_value strokes ppo_value random \
        ${RAY:+--ray "$RAY"} --json results/agents/visits.json --markdown results/agents/visits.md
    module agents.tournament random ghost_ball best_pot stroke_value search planner tactician \
        --cue real --miss clear_path --frames 40 --threads 1 --resume --out results/agents/ladder.json --markdown results/agents/ladder.md ${RAY:+--ray "$RAY"}
}

weights() {
    python -c "from agents.learning.export import export, keep_models; keep_models('$FOLDER'); export()"
}

curves() {
    module agents.curves --out results/agents/curves.json --markdown results/agents/curves.md \
        --picture results/pictures/curves.png --page docs/agents/curves.md "$@"
}

judge() { # an agent's name, all simulated shots of its training
    [[ -z $wanted || " $wanted " == *" $1 "* ]] || return
    $bench run all --agent "${3:-$1}" --training-shots "$2" --out results/leaderboard --resume
}

judge_seeds() { # the same of five training seeds, the first of which is the package's
    if [[ -z $wanted || " $wanted " == *" $1 "* ]]; then
        (ONLY='ppo_value-[1-4]' train_models) || return
    fi
    judge "$1" "$2" "$1=$3,$(seq -s, -f "$4$FOLDER/ppo_value-%g" 1 4)"
}

judge_each() { # name, form and shots of agents.baseline: five models that are trained on each task
    [[ -z $wanted || " $wanted " == *" $1 "* ]] || return
    tasks=$(python -c "from snooker_env.benchmark import TASKS; print(*TASKS)") || exit 1
    for task in $tasks; do
        file=results/leaderboard/$task.$1.json
        if [ -e "$file" ] && grep -q '"incomplete": null' "$file"; then continue; fi
        python -m agents.baseline "$task" --form "$2" --shots "$3" || return
        models=$(seq -s, -f "runs/baseline/$task.$2.$3.%g.zip" 0 4)
        $bench run "$task" --agent "$1=$models" --trust --training-shots "$3" --out "$file" --resume
    done
}

leaderboard() {
    bench="python -m snooker_env.benchmark" wanted="$*"
    judge random 0
    judge ghost_ball 0
    judge best_pot 0
    judge search 0
    # What train.py learns for each level of errors: 153,600 positions x 64 simulated shots, 147,200 x 48 judged choices,
    # PPO: 18,403,328. To these the worth of positions, by which it decides after a foul: two rounds of 384 frames of
    # tactician against itself and others: 205,141 positions, each with 120 shots of search and 8 that judge, and some
    # 12,000 strokes of the others, 120 shots each.
    judge planner 46101376
    judge tactician 46101376
    # The values of three levels, the worth of the tactician, and 13 million shots of its own: strokes that are tried,
    # play, and its opponents.
    judge stroke_value 96000000
    judge strokes 1000000
    judge ppo_value 18403328
    # planner and ppo_value from five training seeds, all with a professional's errors: those of planner above are the
    # task's.
    judge_seeds planner_seeds 46101376 planner@professional planner@
    judge_seeds ppo_value_seeds 18403328 ppo_value ""
    # A stranger's agents, five training seeds.
    judge_each ppo_50k pot 50000
    judge_each menu_50k strokes 50000
    judge_each ppo_1m pot 1000000
    judge_each menu_1m strokes 1000000
    # What looks at nothing, beside them: it must win no task.
    [[ -n $wanted ]] || $bench degenerate --out results/leaderboard || exit 1
    $bench table results/leaderboard/*.json --markdown docs/leaderboard.md
}

part=${1:-}
case $part in
    all) for part in physics pictures agents curves leaderboard; do bash results/make.sh "$part" || exit; done ;;
    physics | pictures | agents | weights | curves | leaderboard)
        shift && "$part" "$@" || exit
        [[ -n ${LIST:-} ]] || python -m agents.croissant ;; # the checksums of what has changed
    *) echo "PART = '$part': must be all, physics, pictures, agents, weights, curves or leaderboard" >&2 && exit 2 ;;
esac
