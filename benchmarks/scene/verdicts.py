"""Where does a model matter? Its effect against a professional's execution errors and against chaos, and the
sentence that follows.

Used by ``python -m benchmarks.scene``.
"""

from .models import MODELS

FULL, ERRORS, CHAOS = "everything", "a professional's errors", "aim turned by 1e-9 rad"
SHARE = 0.1
"""A model matters in a scene if it moves balls or changes outcomes by more than this share of what a
professional's errors do."""
VISIBLE = 1.0
"""... by more than this [mm] in the middle case ..."""
ENOUGH = 20
"""... over at least so many shots that leave the ball on the table."""
NOTHING = 1e-3
"""A model that moves no ball by more than this [mm] did nothing in the scene."""
FREE = 0.05
"""Costs within this share of 1 cannot be distinguished from none on a shared machine."""


def reasons(row, rows):
    """In what a model moves balls or changes outcomes by more than a tenth of what a professional's errors
    do, and by more than chaos."""
    by_errors, chaos, found = rows[ERRORS], rows[CHAOS], []
    for ball in ("cue", "ball"):
        most = max(SHARE * by_errors[f"{ball}_mm"][0], 2 * chaos[f"{ball}_mm"][0], VISIBLE)
        if row[f"{ball}_mm"][0] > most and row[f"{ball}_shots"] >= ENOUGH:
            found.append(ball)
    if row.get("changed", 0.0) > max(SHARE * by_errors["changed"], 2 * chaos["changed"]):
        found.append("changed")
    return found


def verdict(name, scenes):
    """One model's sentence, from its rows."""
    rows = {scene: s["rows"][name] for scene, s in scenes.items()}
    where = [scene for scene, s in scenes.items() if reasons(rows[scene], s["rows"])]

    def shares(scene):
        """Effect over that of a professional's errors, by what it is an effect on."""
        row, by_errors = rows[scene], scenes[scene]["rows"][ERRORS]
        balls = [b for b in ("cue", "ball") if row[f"{b}_shots"] >= ENOUGH and by_errors[f"{b}_mm"][0]]
        parts = {b: row[f"{b}_mm"][0] / by_errors[f"{b}_mm"][0] for b in balls}
        return {
            **parts,
            "changed": row.get("changed", 0.0) / by_errors["changed"] if by_errors["changed"] else 0.0,
        }

    worst = max(where or rows, key=lambda scene: max(shares(scene).values()))
    row, by_errors, share = rows[worst], scenes[worst]["rows"][ERRORS], shares(worst)
    ball = "ball" if share.get("ball", 0.0) > share.get("cue", 0.0) else "cue"
    mm = row[f"{ball}_mm"]
    figures = (
        f"the {'ball aimed at' if ball == 'ball' else 'cue ball'} stops {mm[0]:.3g} mm off in the middle case, 95 % within {mm[1]:.0f}"
        f" (a professional's errors: {by_errors[f'{ball}_mm'][0]:.3g})"
    )
    model = MODELS[name]
    costs = {scene: r["cost"] for scene, r in rows.items()}
    dearest = max(costs, key=lambda s: costs[s])
    cost = (
        f"It costs at most {costs[dearest]:.2f} x ({dearest})"
        if costs[dearest] > 1 + FREE
        else "Its cost is within the noise"
    )
    changed = f"{row['changed']:.1%} of shots end otherwise (by a professional's errors: {by_errors['changed']:.1%})"
    none = [s for s, r in rows.items() if max(r["cue_mm"][2], r["ball_mm"][2]) < NOTHING and not r["changed"]]
    paid = [f"{s} ({costs[s]:.2f} x)" for s in none]
    idle = f" It does nothing in: {', '.join(paid)}." if paid else ""
    still = [s for s in none if costs[s] > 1 + FREE]
    idle += f" It costs time without effect in: {', '.join(still)}." if still else ""
    if model.added:
        matters = (
            f"it matters in {len(where)} of {len(rows)} scenes"
            if where
            else f"not needed by the {SHARE:.0%} rule"
        )
        return f"{name}: off by default, {matters}. With them, in {worst}, {figures} and {changed}. {cost}.{idle} ({model.product}.)"
    if where:
        return (
            f"{name}: on by default. With {model.instead} instead, in {worst} {figures} and {changed}; it matters in {len(where)} of"
            f" {len(rows)} scenes. {cost}.{idle} ({model.product}.)"
        )
    return (
        f"{name}: not needed by the {SHARE:.0%} rule. With {model.instead} instead, in its worst scene, {worst}, {figures} and {changed}."
        f" {cost}.{idle} ({model.product}.)"
    )
