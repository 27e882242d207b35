"""What does a learning agent see, and how well does it play a visit? The view of the pots, held-out visits, and what their figures say.

``settings`` is any object with the fields of ``train.Settings`` that a function reads.
"""

from typing import cast

import gymnasium
import numpy as np
from gymnasium import spaces

from snooker_env.envs.actions import MAX_SPEED, MIN_SPEED
from snooker_env.envs.snooker import SnookerEnv
from snooker_env.game.balls import HALF_LENGTH
from snooker_env.game.pots import POCKETS, pots

EVAL_LAYOUT, EVAL_SEED = "held_out", 1_000_000


class PotView(gymnasium.ObservationWrapper):
    """Appends the four widest direct pots to the flat observation, eight numbers each; all 0 where there are fewer.

    1, direction cue ball -> ghost ball (x, y), sine and cosine of the cut, both distances, tolerance. A small network cannot find these
    lines itself in a few minutes: without them the same run makes a third of the pots.
    """

    MOST = 4

    def __init__(self, env):
        super().__init__(env)
        self.observation_space = spaces.Box(-1.0, 1.0, (spaces.flatdim(env.observation_space) + 8 * self.MOST,), np.float32)

    def observation(self, observation):
        table = cast(SnookerEnv, self.unwrapped)
        rows = np.zeros((self.MOST, 8), np.float32)
        for row, (ball, pocket, x, y, cos_cut, tolerance) in zip(
            rows, pots(table.positions, table.on_table, table.on, most=self.MOST), strict=False
        ):
            at = table.positions[int(ball)]
            path, run = np.array([x, y]) - table.positions[0], at - (x, y)
            away = np.hypot(*path)
            path, run = path / away, run / np.hypot(*run)
            to_pocket = np.hypot(*(POCKETS[int(pocket), :2] - at))
            row[:] = 1, *path, path[0] * run[1] - path[1] * run[0], cos_cut, away / HALF_LENGTH - 1, to_pocket / HALF_LENGTH - 1, \
                1 + np.log10(tolerance) / 2  # fmt: skip
        return np.concatenate([observation, np.clip(rows, -1.0, 1.0).ravel()])


def make_env(settings, layout=None):
    """One table as the agent sees it."""
    table = gymnasium.make(
        "Snooker-v0", layout=layout or settings.layout, aim=settings.aim, noise=settings.noise, fidelity=settings.fidelity
    )
    return PotView(table)


def evaluate(settings, act, visits):
    """Figures of ``visits`` held-out visits, seeds EVAL_SEED, EVAL_SEED + 1, ...: the same tables for every agent ``act(observation)``."""
    env = make_env(settings, EVAL_LAYOUT)
    played = np.zeros((visits, 4))  # strokes, pots, points, fouls
    for i in range(visits):
        observation, _ = env.reset(seed=EVAL_SEED + i)
        over = False
        while not over:
            observation, _, over, _, info = env.step(act(observation))
            played[i] += 1, info["points"] > 0, info["points"], info["foul"]
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

    def trained(observation):
        shots.append(model.predict(observation, deterministic=True)[0])
        return shots[-1]

    figures = {"trained": evaluate(settings, trained, settings.eval_visits)}
    average = np.mean(shots, axis=0)
    figures["average_shot"] = evaluate(settings, lambda _: average, settings.eval_visits)
    figures["random"] = evaluate(settings, lambda _: rng.uniform(-1.0, 1.0, average.shape).astype(np.float32), settings.eval_visits)
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
