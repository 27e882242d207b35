"""Which attributes can be read and which methods called for each of many tables? Everything public that
belongs to one table."""

import copy
from typing import Any

import numpy as np

from .._check import refuse
from ..tasks.tables import Tables
from .snooker import SnookerEnv

_ONE_TABLE = "simulate_batch, or SnookerEnv for one table"
NOT_OF_A_TABLE = {
    "reset": 'reset(options={"reset_mask": ...})',
    "step": "step",
    "set_state": 'reset(options={"states": ...})',
    "render": "render",
    "close": "close",
    "last_shot": _ONE_TABLE,
    "history": _ONE_TABLE,
    "keep_history": _ONE_TABLE,
    "spec": "the attribute spec",
    "unwrapped": "this environment",
    "get_wrapper_attr": "call",
    "set_wrapper_attr": "another environment",
}
"""Names that ``call`` refuses, and their replacements: the tables play, end and begin together."""


def check_name(name: Any) -> None:
    """Raise ValueError unless it is a public name that belongs to one table."""
    if not isinstance(name, str) or name in NOT_OF_A_TABLE or name.startswith("_"):
        instead = NOT_OF_A_TABLE.get(name) if isinstance(name, str) else None
        raise refuse(
            "name",
            name,
            "must be something public that a table has for itself" + (f"; use {instead}" if instead else ""),
        )


class TableCalls:
    """Access to the attributes and methods of ``SnookerEnv`` for each table of a ``SnookerVectorEnv``."""

    tables: Tables
    _one: SnookerEnv
    _generator_seeds: list[int]
    np_random: Any

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Read an attribute or call a method of each table, as ``SyncVectorEnv.call`` does.

        ``name``: name of the attribute or method. ``*args``: positional arguments of the method.
        ``**kwargs``: keyword arguments of the method. Returns one value for each table. ValueError if the
        name does not belong to one table. AttributeError if ``SnookerEnv`` has no such name.
        """
        check_name(name)
        found = [getattr(self._table(k, generator), name) for k, generator in enumerate(self.np_random)]
        return tuple(each(*args, **kwargs) if callable(each) else each for each in found)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Read an attribute of ``SnookerEnv`` for each table.

        ``name``: name of the attribute. Returns one value for each table. ValueError if the name does not
        belong to one table. AttributeError if ``SnookerEnv`` has no such name.
        """
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Refuse to set an attribute: the tables share everything. Make another environment instead.

        ``name``: name of the attribute. ``values``: its values. AttributeError always.
        """
        raise AttributeError(f"{name} cannot be set: the tables share everything; make another environment")

    def _table(self, k: int, generator: np.random.Generator) -> SnookerEnv:
        """Table k as a ``SnookerEnv`` that shares the table's state."""
        env = copy.copy(self._one)
        env.tables, env._np_random, env._np_random_seed = (
            self.tables.view(k),
            generator,
            self._generator_seeds[k],
        )
        return env
