#!/usr/bin/env bash
# How is the leaderboard made? Every agent of the repository on every task, then the page. In the root of a clone, on a quiet machine:
#
#     leaderboard/make.sh                  # all that is missing
#     leaderboard/make.sh ghost_ball       # only these agents
#
# Complete files are left as they are, incomplete ones are resumed; remove a file to play it again. All files are checked: their strokes are
# played again. Agents whose files are missing stand on the page as missing.
set -u
cd "$(dirname "$0")/.."
shopt -s nullglob
bench="python -m snooker_env.benchmark"
wanted="$*"
labels=()

wants() {  # whether this agent is to be judged; it stands on the page in any case
    labels+=("$1")
    [ -z "$wanted" ] || [[ " $wanted " == *" $1 "* ]]
}

judge() {  # its name, all simulated shots of its training
    wants "$1" || return
    $bench run all --agent "$1" --training-shots "$2" --out leaderboard --resume
}

judge_seeds() {  # the same of five training seeds, the first of which is the package's
    local label=$1 shots=$2 first=$3 before=$4
    wants "$label" || return
    ONLY='ppo_value-[1-4]' bash agents/experiments.sh || return
    others=$(seq -s, -f "${before}runs/experiments/ppo_value-%g" 1 4)
    $bench run all --agent "$label=$first,$others" --training-shots "$shots" --out leaderboard --resume
}

judge_each() {  # the same of five models that are trained on each task
    wants "$1" || return
    tasks=$(python -c "from snooker_env.benchmark import TASKS; print(*TASKS)") || exit 1
    for task in $tasks; do
        file=leaderboard/$task.$1.json
        if [ -e "$file" ] && grep -q '"incomplete": null' "$file"; then continue; fi
        python leaderboard/baseline.py "$task" || return
        models=$(seq -s, -f "runs/baseline/$task.%g.zip" 0 4)
        $bench run "$task" --agent "$1=$models" --trust --training-shots "$2" --out "$file" --resume
    done
}

judge random 0
judge ghost_ball 0
judge best_pot 0
judge search 0
# What train.py learns for each level of errors: 153,600 positions x 64 simulated shots, 147,200 x 48 judged choices, PPO: 18,403,328. To these
# the worth of positions, by which it decides after a foul: two rounds of 384 frames of tactician against itself and others: 205,141 positions,
# each with 120 shots of search and 8 that judge, and some 12,000 strokes of the others, 120 shots each.
judge planner 46101376
judge tactician 46101376
# The values of three levels, the worth of the tactician, and 13 million shots of its own: strokes that are tried, play, and who plays against it.
judge stroke_value 96000000
judge ppo_value 18403328
# planner and ppo_value from five training seeds, all with a professional's errors: those of planner above are the task's.
judge_seeds planner_seeds 46101376 planner@professional planner@
judge_seeds ppo_value_seeds 18403328 ppo_value ""

# Plain PPO, five training seeds.
judge_each ppo_50k 49152

# What looks at nothing, beside them: it must win no task.
[ -n "$wanted" ] || $bench degenerate --out leaderboard || exit 1

$bench table leaderboard/*.json --markdown docs/leaderboard.md --awaited "${labels[@]}"
