"""How does an external program play the benchmark? For each line with a state, it writes a line with a stroke, using
only the standard library.

    python -m snooker_env.benchmark run SnookerBreak-v0 --agent program:"python examples/program_player.py" \\
        --training-shots 0 --simulated-shots 0 --episodes 20

The strategy is simple: take the open line to a pocket with the most room, at a speed that carries the ball there.
Without an open line, play full at the nearest ball on. docs/play/protocol.md describes every field.
"""

import json
import math
import sys


def answer(state):
    """The answer to a state, in the form of POST api/stroke."""
    if state["phase"] == "choice":  # after a foul by the opponent
        return {"choice": "play"}
    lines = [line for line in state["lines"] if line["open"]]
    if lines:
        line = max(lines, key=lambda line: line["tolerance"])
        speed = min(6.0, 1.2 + 0.7 * line["to_ball"] + 0.9 * line["to_pocket"])
        return {"speed": speed, "aim_at": {"pot": [line["ball"], line["pocket"]]}}
    x, y = state["positions"]["cue"]
    balls = [state["positions"][name] for name in state["balls_on"]]
    bx, by = min(balls, key=lambda ball: math.dist((x, y), ball))
    return {"speed": 2.0, "aim": math.atan2(by - y, bx - x)}


def main():
    """Answer every line until there are no more."""
    for line in sys.stdin:
        print(json.dumps(answer(json.loads(line))), flush=True)


if __name__ == "__main__":
    main()
