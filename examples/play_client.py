"""How does a program play over the text protocol? It requests the state, sends strokes, and plays its visit
to the end.

It uses the standard library alone.

    python -m snooker_env.play --no-browser --layout colours      # prints an address
    python examples/play_client.py http://127.0.0.1:41234/TOKEN/

The strategy is simple: the open line to a pocket with the largest tolerance, at a speed that carries the ball
there; without an open line, full at the nearest ball on. ``docs/play/protocol.md`` describes every field.
"""

import argparse
import http.client
import json
import math
import sys
import urllib.error
import urllib.request


def ask(address, name, fields=None):
    """The answer to a GET, or to a POST with ``fields``. If the server refuses, the program ends with the
    server's message."""
    body = None if fields is None else json.dumps(fields).encode()
    try:
        request = urllib.request.Request(
            f"{address.rstrip('/')}/api/{name}", body, {"Content-Type": "application/json"}
        )
        with urllib.request.urlopen(request, timeout=60) as reply:
            return json.load(reply)
    except urllib.error.HTTPError as error:
        message = error.read().decode(errors="replace")
        try:
            message = json.loads(message)["error"]
        except (ValueError, TypeError, KeyError):
            message = f"{address} answers {error.code}, and is no server of snooker_env.play"
        raise SystemExit(f"{name}: {message}") from None
    except (urllib.error.URLError, http.client.HTTPException, OSError) as error:
        raise SystemExit(
            f"{address}: no answer ({getattr(error, 'reason', error)}); "
            "is python -m snooker_env.play running there?"
        ) from None
    except ValueError:
        raise SystemExit(
            f"{address}: this is no address of python -m snooker_env.play, as http://127.0.0.1:41234/TOKEN/"
        ) from None


def chosen(state):
    """The stroke to play, in the form of the protocol."""
    ways = [line for line in state["lines"] if line["open"]]
    if ways:
        best = max(ways, key=lambda line: line["tolerance"])
        run = best["to_ball"] + 0.6 + best["to_pocket"] / max(0.2, math.cos(best["cut"])) ** 2
        return {
            "speed": min(6.0, 0.6 + 1.1 * math.sqrt(run)),
            "aim_at": {"pot": [best["ball"], best["pocket"]]},
        }
    x, y = state["positions"]["cue"]
    places = [state["positions"][name] for name in state["balls_on"]]
    bx, by = min(places, key=lambda place: math.dist(place, (x, y)))
    return {"speed": 2.0, "aim": math.atan2(by - y, bx - x)}


def main(argv=None):
    """Play one visit of the player whose turn it is, and print its strokes."""
    parser = argparse.ArgumentParser(
        description="Play a visit over the text protocol of python -m snooker_env.play."
    )
    parser.add_argument("address", help="the address that the server printed")
    parser.add_argument("--text", action="store_true", help="print the table in words before each stroke")
    args = parser.parse_args(argv)
    state = ask(args.address, "state")
    if state["phase"] == "choice":
        state = ask(args.address, "stroke", {"choice": "play"})["state"]
    player = state["striker"]
    while state["phase"] == "stroke" and state["striker"] == player and not state["thinking"]:
        if args.text:
            print(state["text"], end="\n\n")
        answer = ask(args.address, "stroke", chosen(state))
        state = answer["state"]
        print(state["last"])
        if not answer["stroke"]["points"]:
            break
    print(state["words"], f"Score {state['scores'][0]}-{state['scores'][1]}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
