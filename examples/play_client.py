"""How does a program play over the text protocol? It asks what is on, strikes, and goes on to the end of its visit: standard library alone.

    python -m snooker_env.play --no-browser --layout colours      # prints an address
    python examples/play_client.py http://127.0.0.1:41234/TOKEN/

The strategy is the simplest: of the open lines to pockets the one with the most room, at a speed that carries the ball there; without one,
full at the nearest ball on. ``docs/protocol.md`` describes every field.
"""

import argparse
import http.client
import json
import math
import sys
import urllib.error
import urllib.request


def ask(address, name, fields=None):
    """GET, or POST with fields: the answer. Ends the program with the server's own words if it refuses."""
    body = None if fields is None else json.dumps(fields).encode()
    try:
        request = urllib.request.Request(f"{address.rstrip('/')}/api/{name}", body, {"Content-Type": "application/json"})
        with urllib.request.urlopen(request, timeout=60) as reply:
            return json.load(reply)
    except urllib.error.HTTPError as error:
        said = error.read().decode(errors="replace")
        try:
            said = json.loads(said)["error"]
        except (ValueError, TypeError, KeyError):
            said = f"{address} answers {error.code}, and is no server of snooker_env.play"
        raise SystemExit(f"{name}: {said}") from None
    except (urllib.error.URLError, http.client.HTTPException, OSError) as error:
        raise SystemExit(
            f"{address}: no answer ({getattr(error, 'reason', error)}); is python -m snooker_env.play running there?"
        ) from None
    except ValueError:
        raise SystemExit(f"{address}: this is no address of python -m snooker_env.play, as http://127.0.0.1:41234/TOKEN/") from None


def chosen(state):
    """The stroke to play, as the protocol takes it."""
    ways = [line for line in state["lines"] if line["open"]]
    if ways:
        best = max(ways, key=lambda line: line["tolerance"])
        run = best["to_ball"] + 0.6 + best["to_pocket"] / max(0.2, math.cos(best["cut"])) ** 2
        return {"speed": min(6.0, 0.6 + 1.1 * math.sqrt(run)), "aim_at": {"pot": [best["ball"], best["pocket"]]}}
    x, y = state["positions"]["cue"]
    places = [state["positions"][name] for name in state["balls_on"]]
    bx, by = min(places, key=lambda place: math.dist(place, (x, y)))
    return {"speed": 2.0, "aim": math.atan2(by - y, bx - x)}


def main(argv=None):
    """Play one visit of whoever is to play, and tell of it."""
    parser = argparse.ArgumentParser(description="Play a visit over the text protocol of python -m snooker_env.play.")
    parser.add_argument("address", help="what the server printed")
    parser.add_argument("--text", action="store_true", help="print the table as a blind player hears of it before each stroke")
    given = parser.parse_args(argv)
    state = ask(given.address, "state")
    if state["phase"] == "choice":
        state = ask(given.address, "stroke", {"choice": "play"})["state"]
    player = state["striker"]
    while state["phase"] == "stroke" and state["striker"] == player and not state["thinking"]:
        if given.text:
            print(state["text"], end="\n\n")
        answer = ask(given.address, "stroke", chosen(state))
        state = answer["state"]
        print(state["last"])
        if not answer["stroke"]["points"]:
            break
    print(state["words"], f"Score {state['scores'][0]}-{state['scores'][1]}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
