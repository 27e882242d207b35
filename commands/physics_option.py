"""Which physics does a text on the command line mean? PRESET or PRESET,FIELD=VALUE,... as ``paper,mu_bb=marlow``."""

from snooker_env import Physics
from snooker_env.checks import refuse
from snooker_env.geometry import BALL_RADIUS


def physics_option(text):
    """The environment's option ``physics`` for this text, a dict. Raises ValueError."""
    preset, *changes = text.split(",")
    fields = {"preset": preset}
    for change in changes:
        name, equals, value = change.partition("=")
        if not equals:
            raise refuse("physics", text, "must be PRESET or PRESET,FIELD=VALUE,...")
        try:
            fields[name] = float(value)
        except ValueError:
            fields[name] = value
    made = Physics.of(fields)
    made.check_stopping()
    if made.R != BALL_RADIUS:
        raise refuse("physics", text, f"must leave R at {BALL_RADIUS}: the tables are made for it")
    return fields


def physics_text(physics):
    """The text that means this option of the environment: a preset's name or a dict as ``physics_option`` makes it."""
    fields = dict(physics) if isinstance(physics, dict) else {"preset": physics}
    return ",".join([fields.pop("preset", "paper"), *(f"{name}={value}" for name, value in fields.items())])
