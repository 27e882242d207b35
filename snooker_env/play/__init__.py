"""A page to play snooker, with an advisor, and its HTTP protocol (docs/play/protocol.md)."""
