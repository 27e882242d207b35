"""A page to play on and to ask, and the text protocol below it: ``python -m snooker_env.play``; ``docs/protocol.md`` says all of it."""
