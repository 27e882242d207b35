"""``python -m snooker_env``: which commands are there?"""

from ._command import until_closed

COMMANDS = {
    "watch": "watch a player's visit or frame in the browser, or keep it as a page or a film",
    "play": "play in the browser, against a player or a person",
    "advice": "what recorded strokes say of a player",
    "benchmark": "judge a player on the tasks, check and compare results",
}

if __name__ == "__main__":
    with until_closed():
        print("Commands of snooker_env; each with --help says more.\n")
        for name, what in COMMANDS.items():
            print(f"  python -m snooker_env.{name:<10} {what}")
