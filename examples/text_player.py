"""How does a language model play? It reads the table in words and answers with a stroke; here a rule takes its place.

    python -m snooker_env.benchmark text --agent program:"python examples/text_player.py" --visits 10

Put your model into ``answer``: give it ``INSTRUCTIONS`` and the text, and return what it writes. An answer that is no stroke
comes back with the next state as ``error``, two times a stroke. docs/benchmark.md has the rules of the track.
"""

import json
import math
import re
import sys

INSTRUCTIONS = """You play snooker. Each message describes the table. Answer with one JSON object and nothing else:
{"speed": 2.0, "side": 0.0, "top": -0.2, "aim_at": {"pot": ["red 3", "top left"]}}
speed: of the cue, 0.2 to 7 m/s (2 is soft, 4 hard). side, top: where the tip strikes, -0.5 to 0.5 of the radius
(top > 0 follows, < 0 draws back). aim_at: a ball that may be struck first, and the pocket; or "aim": a
direction in radians instead."""

LINE = re.compile(
    r"  ([a-z]+(?: \d+)?), ((?:top|middle|bottom) (?:left|right)): open, .*?may err ([\d.]+) deg"
)
BALL = re.compile(r"  \* ([a-z]+(?: \d+)?): \(([-+\d.]+), ([-+\d.]+)\)")
CUE = re.compile(r"    cue: \(([-+\d.]+), ([-+\d.]+)\)")


def answer(text, error=None):
    """The answer to the table in words: the open line that forgives most; else towards a ball on."""
    lines = LINE.findall(text)
    if lines:
        ball, pocket, _ = max(lines, key=lambda line: float(line[2]))
        return json.dumps({"speed": 2.3, "aim_at": {"pot": [ball, pocket]}})
    (x, y), (_, bx, by) = CUE.search(text).groups(), BALL.search(text).groups()
    return json.dumps({"speed": 2.0, "aim": math.atan2(float(by) - float(y), float(bx) - float(x))})


def main():
    """Answer every state until there are no more."""
    for line in sys.stdin:
        state = json.loads(line)
        print(answer(state["text"], state.get("error")), flush=True)


if __name__ == "__main__":
    main()
