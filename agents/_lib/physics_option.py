"""How do you pass physics on the command line? As PRESET or PRESET,FIELD=VALUE,..., for example
``paper,mu_bb=marlow``."""

from snooker_env import Physics
from snooker_env.checks import refuse
from snooker_env.geometry import BALL_RADIUS


def physics_option(text):
    """Convert this text to the environment's option ``physics``, a dict. Raises ValueError."""
    preset, *changes = text.split(",")
    fields = {"preset": preset}
    for change in changes:
        name, equals, value = change.partition("=")
        if not equals:
            raise refuse("physics", text, "must be PRESET or PRESET,FIELD=VALUE,...")
        try:
            fields[name] = value == "True" if value in ("True", "False") else float(value)
        except ValueError:
            fields[name] = value
    made = Physics.of(fields)
    made.check_stopping()
    if made.R != BALL_RADIUS:
        raise refuse("physics", text, f"must keep R at {BALL_RADIUS}, because the table is built for it")
    return fields


def physics_text(physics):
    """Invert ``physics_option``: the text for a preset's name or a dict of fields."""
    fields = dict(physics) if isinstance(physics, dict) else {"preset": physics}
    return ",".join([fields.pop("preset", "paper"), *(f"{name}={value}" for name, value in fields.items())])
