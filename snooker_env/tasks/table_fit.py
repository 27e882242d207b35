"""Do the layouts fit a table? Snooker-v0 needs snooker's bed, with any pockets."""

from functools import lru_cache

import numpy as np

from .._lib.check import refuse
from ..game.layouts import STORED_IN, LayoutPlan, bank, plan_of
from ..geometry import BALL_RADIUS, HALF_LENGTH, HALF_WIDTH
from ..physics.table import SAME_BALL, UNBOUNDED, Table, TableLike, deepest
from .observations import REACH

ROUNDING = 1e-9  # tolerance of noses, jaws and falls [m]


def table_of(table: TableLike) -> Table:
    """The ``Table`` of an environment's argument; ValueError unless it leaves every place free that a layout may deal: the noses
    must be snooker's, and no jaw or fall may reach a ball at |x| <= 0.86275, |y| <= 1.75825."""
    cloth = Table.of(table)
    if cloth is UNBOUNDED:
        raise refuse("table", table, 'must be "match", "tight" or a Table')
    if cloth.ball_radius is not None and abs(cloth.ball_radius - BALL_RADIUS) > SAME_BALL:
        made = f"this one is made for balls of radius {cloth.ball_radius:g} m, snooker's have {BALL_RADIUS:g}"
        allowed = f'must be "match", "tight" or a Table of snooker\'s bed in Snooker-v0: {made}'
        raise refuse("table", cloth.name, allowed)
    _check_noses(cloth)
    _check_pockets(cloth)
    past, most = deepest(cloth.jaws, cloth.falls, cloth.bounds, BALL_RADIUS), (REACH - 1.0) * HALF_WIDTH
    if past > most:
        allowed = f"must let no ball rest more than {most:.3g} m past the noses, where observations end (one can {past:.3g} m past them)"
        raise refuse("table", cloth.name, allowed)
    return cloth


def _check_noses(cloth: Table) -> None:
    for axis, half in enumerate((HALF_WIDTH, HALF_LENGTH)):
        for side in (-1, 1):
            levels = cloth.noses[(cloth.noses[:, 0] == axis) & (cloth.noses[:, 1] == side), 2]
            if not len(levels) or np.abs(levels - half).max() > ROUNDING:
                at = f"{'xy'[axis]} = {side * half:g}"
                places = ", ".join(f"{side * level:g}" for level in levels) or "none"
                allowed = f"must have its noses at {at} in Snooker-v0, whose layouts are made for that bed (found {places})"
                raise refuse("table", cloth.name, allowed)


def _check_pockets(cloth: Table) -> None:
    room = np.array([HALF_WIDTH, HALF_LENGTH]) - BALL_RADIUS
    kinds = ("jaws", cloth.jaws, BALL_RADIUS), ("falls", cloth.falls, 0.0)
    for name, circles, more in kinds:
        reach = circles[:, 2] + more
        inside = reach - np.hypot(*np.maximum(np.abs(circles[:, :2]) - room, 0.0).T)
        if len(inside) and inside.max() > ROUNDING:
            k = int(inside.argmax())
            free = f"|x| <= {room[0]:g}, |y| <= {room[1]:g} in Snooker-v0, whose layouts put balls there"
            into = f"{name}[{k}], its whole circle, reaches {inside[k]:.3g} m into that"
            allowed = f"must leave a ball's centre free in {free}: {into}"
            raise refuse("table", cloth.name, allowed)


def fit_plan(layout: str, cloth: Table) -> LayoutPlan:
    """The ``LayoutPlan`` of a layout on a table, without the stored tables that do not fit its pockets."""
    plan = plan_of(layout)
    return plan_of(layout, _unfit(cloth, STORED_IN[layout][0])) if len(plan.tables) else plan


@lru_cache(8)
def _unfit(cloth: Table, which: str) -> tuple[int, ...]:
    """Indices of the tables of a bank with a ball, as dealt or mirrored, in a jaw or over a fall."""
    if cloth is Table.preset("match"):
        return ()  # the stored tables were played on it
    tables = bank(which)
    return tuple(sorted({*cloth.unfit(tables, BALL_RADIUS), *cloth.unfit(tables * (-1.0, 1.0), BALL_RADIUS)}))
