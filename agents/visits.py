"""How well does an agent play a visit, and what has it learned? Held-out visits, and what their figures say.

``settings`` is any object with the fields of ``train.Settings`` that a function reads.
"""

import gymnasium
import numpy as np

from snooker_env.envs.actions import MAX_SPEED, MIN_SPEED

from .view import options_of, with_pots

EVAL_LAYOUT, EVAL_SEED = "held_out", 1_000_000


def evaluate(settings, act, visits):
    """Figures of ``visits`` held-out visits, seeds EVAL_SEED, EVAL_SEED + 1, ...: the same tables for every agent ``act(observations)``.

    All are played side by side; what is played on a table after its visit has ended does not count.
    """
    tables = gymnasium.make_vec("Snooker-v0", visits, vectorization_mode="vector_entry_point", **options_of(settings, EVAL_LAYOUT))
    observations, _ = tables.reset(seed=EVAL_SEED)
    played = np.zeros((visits, 4))  # strokes, pots, points, fouls
    going = np.ones(visits, bool)
    while going.any():
        actions = np.zeros((visits, tables.single_action_space.shape[0]), np.float32)
        actions[going] = act(with_pots(observations[going]))
        observations, _, ended, _, info = tables.step(actions)
        played[going] += np.column_stack([going, info["points"] > 0, info["points"], info["foul"]])[going]
        going &= ~ended
    tables.close()
    strokes, scoring, points, fouls = played.T
    rate = scoring.sum() / strokes.sum()
    error = lambda x: float(np.std(x, ddof=1) / np.sqrt(visits))  # noqa: E731
    return {
        "pots_a_visit": float(scoring.mean()), "pots_a_visit_se": error(scoring), "points_a_visit": float(points.mean()),
        "points_a_visit_se": error(points), "pot_rate": float(rate), "pot_rate_se": error(scoring - rate * strokes) / float(strokes.mean()),
        "fouls_a_visit": float(fouls.mean()), "fouls_a_visit_se": error(fouls), "longest_break": int(points.max()), "visits": visits,
        "strokes": int(strokes.sum()),
    }  # fmt: skip


def evaluate_all(settings, model):
    """The trained agent, its own average shot played every time (has it learned to read the table, or just one good shot?), random play."""
    shots, rng = [], np.random.default_rng(settings.seed)

    def trained(observations):
        shots.append(model.predict(observations, deterministic=True)[0])
        return shots[-1]

    figures = {"trained": evaluate(settings, trained, settings.eval_visits)}
    shots = np.concatenate(shots)
    average = np.mean(shots, axis=0)
    figures["average_shot"] = evaluate(settings, lambda _: average, settings.eval_visits)
    figures["random"] = evaluate(settings, lambda seen: rng.uniform(-1.0, 1.0, (len(seen), len(average))), settings.eval_visits)
    style = {"action_mean": average.tolist(), "action_sd": np.std(shots, axis=0).tolist()}
    style["cue_speed_mean"] = MIN_SPEED + 0.5 * (style["action_mean"][0] + 1.0) * (MAX_SPEED - MIN_SPEED)
    return {"layout": EVAL_LAYOUT, "first_seed": EVAL_SEED, "agents": figures, "style": style}


def lesson(settings, steps, evaluation):
    """What was learned, in one sentence that follows from the figures: a difference counts from two standard errors on."""
    trained, average, random = (evaluation["agents"][name] for name in ("trained", "average_shot", "random"))

    def better(a, b):
        return a["points_a_visit"] - b["points_a_visit"] > 2.0 * np.hypot(a["points_a_visit_se"], b["points_a_visit_se"])

    def made(agent):
        return f"{agent['pots_a_visit']:.2f} pots and {agent['points_a_visit']:.2f} points a visit"

    start, figures = f"In {steps:,} shots {settings.algo.upper()} learned", f"{made(trained)} against {made(random)} of random play"
    if not better(trained, random):
        return f"{start} nothing that {trained['visits']} visits can show: {figures}."
    if better(trained, average):
        return f"{start} to pot and to read the table: {figures}, and {made(average)} of its own average shot played every time."
    return f"{start} one shot that pots, but not to read the table: {figures}, and {made(average)} of its average shot played every time."


def show(evaluation):
    """Print the figures."""
    import rich.box
    import rich.console
    import rich.table

    visits = evaluation["agents"]["random"]["visits"]
    title = f"A visit, over {visits} held-out ones, the same for all (± standard error)"
    table = rich.table.Table(title=title, box=rich.box.SIMPLE, pad_edge=False)
    table.add_column("agent", no_wrap=True)
    for name in ("pots", "points", "fouls", "pot rate", "best"):
        table.add_column(name, justify="right", no_wrap=True)
    for name, f in evaluation["agents"].items():
        cells = [f"{f[key]:.2f} ± {f[key + '_se']:.2f}" for key in ("pots_a_visit", "points_a_visit", "fouls_a_visit")]
        cells += [f"{100 * f['pot_rate']:.1f} ± {100 * f['pot_rate_se']:.1f} %", str(f["longest_break"])]
        table.add_row(name.replace("_", " "), *cells)
    rich.console.Console().print(table)
