"""How does an external program play the benchmark? It reads a state a line and writes a stroke a line:
standard library alone.

    python -m snooker_env.benchmark run SnookerBreak-v0 --agent program:"python examples/program_player.py" \\
        --training-shots 0 --simulated-shots 0 --episodes 20

The strategy is the simplest: of the open lines to pockets the one with the most room, at a speed that carries
the ball there; without one, full at the nearest ball on. The protocol page of the documentation
(docs/play/protocol.md) describes every field.
"""

import json
import math
import sys


def answer(state):
    """The answer to a state, as POST api/stroke takes it."""
    if state["phase"] == "choice":  # after a foul of the other player
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
