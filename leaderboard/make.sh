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

judge() {  # its name, all simulated shots of its training
    labels+=("$1")
    if [ -n "$wanted" ] && ! [[ " $wanted " == *" $1 "* ]]; then return; fi
    $bench run all --agent "$1" --training-shots "$2" --out leaderboard --resume
}

judge random 0
judge ghost_ball 0
judge geometric 0
judge ppo_target 1015808
judge ppo_absolute 507904
judge ppo_mask 1015808
# A step simulates 120 shots for the view, and 1 that is played: 49,152 x 121. Each of 10,240 imitated positions 48 more: x 169.
judge ppo_foresight 7677952
judge ppo_foresight_gamma0 7677952
# The same view, rated by a rule of thumb.
judge foresight_rule 0
# The search over continuous strokes, and with what train.py learns: 153,600 positions x 64 simulated shots, 147,456 x 48 judged choices, PPO.
judge best_pot 0
judge search 0
judge search_2000 0
judge planner 18415616
# To those of planner, two rounds of 384 frames against itself and others: 205,141 positions, each with 120 shots of search and 8 that judge,
# and some 12,000 strokes of the others, 120 shots each.
judge tactician 46113664
judge ppo_value 18415616
judge ppo_mask_finetuned 26443776

$bench table leaderboard/*.json --markdown docs/leaderboard.md --awaited "${labels[@]}"
