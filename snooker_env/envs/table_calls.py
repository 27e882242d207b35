"""What may many tables be asked for one by one? Everything public that a table has for itself."""

from typing import Any

from .._check import refuse

_ONE_TABLE = "simulate_batch, or SnookerEnv for one table"
NOT_OF_A_TABLE = {
    "reset": 'reset(options={"reset_mask": ...})', "step": "step", "set_state": 'reset(options={"states": ...})', "render": "render",
    "close": "close", "last_shot": _ONE_TABLE, "history": _ONE_TABLE, "keep_history": _ONE_TABLE, "spec": "the attribute spec",
    "unwrapped": "this environment", "get_wrapper_attr": "call", "set_wrapper_attr": "another environment",
}  # fmt: skip
"""What ``call`` does not do for single tables, and what there is instead: the tables play, end and begin together."""


def check_name(name: Any) -> None:
    """Raise ValueError unless it names something public that a table has for itself."""
    if not isinstance(name, str) or name in NOT_OF_A_TABLE or name.startswith("_"):
        instead = NOT_OF_A_TABLE.get(name) if isinstance(name, str) else None
        raise refuse("name", name, "must be something public that a table has for itself" + (f"; use {instead}" if instead else ""))
