"""A page to play snooker, with an advisor, and its HTTP protocol: ``python -m snooker_env.play``; see
docs/play/protocol.md."""
