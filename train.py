"""How is an agent trained to play Snooker-v0? Train one, evaluate it on held-out tables beside simple
players, and report the result.

    python train.py                                    six minutes on two cores: a value and a policy by expert iteration, then PPO
    python train.py --steps 1507328 --imitate 153600   the weights of the package: 17 minutes
    python train.py --agent ppo_mask --seed 1 --out runs/mine
    python train.py --agent stroke_value               a player that simulates no shot, in 15 minutes
    python train.py --resume --out runs/mine           continue from the last checkpoint after Ctrl-C, a kill or a power cut

Files of a run folder:

* ``checkpoint.pkl``: everything that a resumed run needs. It is a pickle, and loading a pickle runs code:
  --resume only your own runs.
* ``model.zip``: the trained model. ``python -m agents.evaluate`` and --start read it as plain data;
  ``PPO.load`` of Stable-Baselines3 unpickles it.
* of ``stroke_value``: ``stroke_value.json``, its settings, the data and weights of each round, and ``strokes.npz``, the
  trained networks.
* ``results.json``: every figure. ``tb/``: the curves (``tensorboard --logdir runs``).
* ``train.lock``, while the run goes on: two runs cannot share a folder (``commands/lock.py``).

Where to read on: ``agents/features/`` has the observations, ``agents/hyperparams/`` the settings of each
agent, ``agents/learning/`` the networks, the expert iteration, the imitation and the files of a run,
``agents/evaluation/`` the evaluation. This file has the settings and the run.
"""

import argparse
import json
import os
import shlex
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path

from commands.lifecycle import command, needs, of_disk, python

with needs("train.py"):
    import sb3_contrib  # noqa: F401 - imported here so that a missing package is reported before anything starts
    import tensorboard  # noqa: F401 - likewise
    import torch

    import snooker_env
    from agents.cluster.job import ClusterError
    from agents.cluster.mirror import Mirror, copied, left
    from agents.cluster.ray_cluster import add_ray, checked_ray, place
    from agents.evaluation.training_summary import conclusion, evaluate, held_out, show
    from agents.features.observed import training_tables
    from agents.learning.callback import RunCallback, Stop, goal_of, imitate, rollout_of
    from agents.learning.expert_iteration import ExpertIteration, judge_rewards
    from agents.learning.hyperparameters import Recipe, names
    from agents.learning.imitation import Imitation
    from agents.learning.learn_strokes import SETTINGS, StrokeSettings, StrokeTraining
    from agents.learning.models import load_weights, zipped
    from agents.learning.run_folder import claimed, go_on, kept, load_model, options_of, read_checkpoint
    from commands.files import write_atomic
    from commands.physics_option import physics_option
    from commands.provenance import commit, software
    from snooker_env import player
    from snooker_env.checks import refuse
    from snooker_env.game import HELD_OUT
    from snooker_env.planning import processors
    from snooker_env.players.weights import STROKES
    from snooker_env.progress import Progress

# settings
# ------------------------------------------------------------------------------------------------------------


def option(default, text, **more):
    """A dataclass field that is also a command-line option."""
    return field(default=default, metadata={"help": text, **more})


@dataclass(frozen=True)
class Settings:
    """The settings of a run."""

    agent: str = option(
        "ppo_value",
        "the agent to train: a file of agents/hyperparams, or stroke_value",
        choices=(*names(), "stroke_value"),
    )
    steps: int = option(0, "total number of shots, rounded up to whole rollouts; 0: the recipe's")
    envs: int = option(0, "number of parallel tables; 0: the recipe's")
    parallel: str = option(
        "auto",
        "threads for the tables: auto is one for each processor; results do not depend on it",
        choices=("auto", "one"),
    )
    seed: int = option(0, "random seed of tables, weights and exploration")
    layout: str = option("", "layout of the training tables [the recipe's]")
    noise: str = option(
        "", "execution noise: none, professional, amateur, club, robot or olympiad [the recipe's]"
    )
    fidelity: str = option("", "of the simulation: fast, standard, reference or euler:N [the recipe's]")
    physics: str = option(
        "", "of the tables: paper, match, or with changes as paper,mu_bb=marlow [the recipe's]"
    )
    conditions: str = option(
        "",
        "fixed, or drawn: each episode has a table of its own [the recipe's]",
        choices=("", "fixed", "drawn"),
    )
    observe_conditions: bool = option(
        False, "let the agent observe the constants of its table; with --conditions drawn"
    )
    imitate: int = option(
        -1, "positions of pre-training, by expert iteration or imitation; -1: the recipe's number"
    )
    start: str = option(
        "", "initial weights: a model with the same network, its .zip or run folder (read as plain data)"
    )
    set: tuple = option((), "change hyperparameters, for example gamma=0", nargs="+")
    eval_visits: int = option(
        500, f"visits of the final evaluation, each on a held-out table of its own, at most {HELD_OUT}"
    )
    checkpoint_every: int = option(100_000, "shots between two checkpoints")


BOUNDS = {
    "steps": (0, 10**12),
    "envs": (0, 2**24),
    "seed": (0, 2**32 - 1),
    "imitate": (-1, 10**9),
    "eval_visits": (2, HELD_OUT),
    "checkpoint_every": (1, 10**12),
}
FREE_ON_RESUME = ("steps", "parallel", "eval_visits", "checkpoint_every")
"""How long and where, not what; the learning rate falls over the new steps."""


def parse(argv):
    """(parser, options given on the command line, the rest)."""
    parser = argparse.ArgumentParser(
        "train.py", "python train.py [options]", (__doc__ or "").partition("\n")[0]
    )
    for f in fields(Settings):
        name = "--" + f.name.replace("_", "-")
        if isinstance(f.default, bool):
            parser.add_argument(name, action="store_true", default=argparse.SUPPRESS, help=f.metadata["help"])
            continue
        parser.add_argument(
            name,
            type=str if f.name == "set" else type(f.default),
            choices=f.metadata.get("choices"),
            default=argparse.SUPPRESS,
            metavar=None if "choices" in f.metadata else f.name.split("_")[-1].upper(),
            nargs=f.metadata.get("nargs"),
            help=f.metadata["help"] + (f" [{f.default}]" if f.default not in ("", (), 0) else ""),
        )
    parser.add_argument("--out", type=Path, help="the run's folder [runs/AGENT-SEED]")
    what = "continue the run in that folder; options left out keep their values"
    parser.add_argument("--resume", action="store_true", help=what)
    add_ray(parser)
    what = "copy each checkpoint to this folder or fsspec URL; --resume goes on from there"
    parser.add_argument("--mirror", metavar="URL", help=what)
    what = "do not say every few seconds how far it is"
    parser.add_argument("--no-progress", action="store_true", help=what)
    chosen = vars(parser.parse_args(argv))
    rest = {name: chosen.pop(name) for name in ("out", "resume", "no_progress", "ray", "mirror")}
    for name, (low, high) in BOUNDS.items():
        if not low <= chosen.get(name, low) <= high:
            value = f"--{name.replace('_', '-')} is {chosen[name]}"
            parser.error(f"{value}, must be an integer in [{low}, {high}]")
    if "set" in chosen:
        chosen["set"] = tuple(chosen["set"])
    agent, seed = chosen.get("agent", Settings.agent), chosen.get("seed", Settings.seed)
    rest["out"] = rest["out"] or Path("runs", f"{agent}-{seed}")
    return parser, chosen, argparse.Namespace(**rest)


def recipe_of(settings):
    """The agent's recipe with the changes of these settings. Raises ValueError."""
    chosen = {"layout": settings.layout, "noise": settings.noise, "fidelity": settings.fidelity}
    chosen["physics"] = physics_option(settings.physics) if settings.physics else ""
    chosen |= {"conditions": settings.conditions, "observe_conditions": settings.observe_conditions}
    numbers = {"n_timesteps": settings.steps, "n_envs": settings.envs}
    numbers = {key: value for key, value in numbers.items() if value}
    if settings.start:
        if settings.imitate > 0:
            wanted = "must be 0 or left out with --start: the weights given there are already trained"
            raise refuse("imitate", settings.imitate, wanted)
        numbers["imitation"] = 0
    elif settings.imitate >= 0:
        numbers["imitation"] = settings.imitate
    chosen = {key: value for key, value in chosen.items() if value}
    recipe = Recipe.of(settings.agent, settings.set, chosen, **numbers)
    if recipe.imitation and recipe.algo != "ppo_mask":
        wanted = f"must be 0 for {recipe.name}: only agents with masks can imitate the search"
        raise refuse("imitate", recipe.imitation, wanted)
    if recipe.expert and not recipe.imitation and not settings.start:
        why = "PPO needs the value that is learned there"
        raise refuse("imitate", 0, f"must be 1 or more for {recipe.name} without --start: {why}")
    return recipe


# the run
# ------------------------------------------------------------------------------------------------------------


def command_of(settings):
    """The command that repeats this run."""
    words = ["python", "train.py"]
    for f in fields(Settings):
        value = getattr(settings, f.name)
        same = value == f.default or f.name in ("parallel", "eval_visits", "checkpoint_every")
        if isinstance(value, bool):
            words += [f"--{f.name.replace('_', '-')}"] * value
        elif f.name == "agent" or not same:
            words += [f"--{f.name}", *map(str, value if f.name == "set" else [value])]
    return shlex.join(words)


def open_run(parser, chosen, out, resume):
    """(settings, checkpoint or None) from the folder and the options given."""
    if not resume:
        return Settings(**chosen), None
    state, was = read_checkpoint(out, Settings)
    for name, value in chosen.items():
        if value != getattr(was, name) and name not in FREE_ON_RESUME:
            differs = (
                f"--{name.replace('_', '-')} is {value!r} but the run in {out} has {getattr(was, name)!r}"
            )
            parser.error(f"{differs}: give the same or leave it out")
    return replace(was, **chosen), state


def prepared(parser, chosen, rest, ending):
    """(settings, recipe, checkpoint or None, tables, model). Every wrong input is refused here, before the work.

    ``ending`` releases the folder and the tables.
    """
    out, resume, ray = rest.out, rest.resume, rest.ray
    try:
        mirror = Mirror(rest.mirror) if rest.mirror else None
        if resume:
            if mirror:
                mirror.fetch(out)
            ending.enter_context(claimed(out, resume))
        settings, state = open_run(parser, chosen, out, resume)
        recipe = recipe_of(settings)
        if state:
            recipe = replace(recipe, env_kwargs=options_of(out, state))
        checked_ray(ray)
        if ray and not recipe.imitation:
            why = "only expert iteration and imitation are played on a cluster"
            raise refuse("ray", ray, f"must be left out for {recipe.name}: {why}")
        settings = replace(settings, steps=recipe.n_timesteps, envs=recipe.n_envs, imitate=recipe.imitation)
        threads = 1 if settings.parallel == "one" else None
        tables = training_tables(recipe.n_envs, threads=threads, **recipe.env_kwargs)
        ending.callback(tables.close)
        if state:
            model = load_model(out, state, recipe.algo, tables)
        else:
            model = recipe.new_model(tables, settings.seed)
            if settings.start:
                load_weights(model, Path(settings.start))
            ending.enter_context(claimed(out, resume))  # last, so that a wrong option leaves no folder behind
        tempfile.TemporaryFile(dir=out).close()
        if mirror:
            what = {name: value for name, value in asdict(settings).items() if name not in FREE_ON_RESUME}
            mirror.claim(out, what, resume)
            ending.callback(left, out)
    except ValueError as error:
        parser.error(str(error))
    except OSError as error:
        parser.error(f"out = {str(out)!r}: must be a folder that can be written ({error.strerror})")
    return settings, recipe, state, tables, model


def speaker(settings, recipe, quiet):
    """``part_of(number, what, total, unit, done)``: the ``Progress`` of a part of this run; number 0 is before
    PPO, 2 the evaluation."""
    before = int(recipe.imitation > 0)

    def part_of(number, what, total, unit, done=0):
        what = f"{settings.agent}, part {number + before} of {2 + before}, {what}"
        return Progress(what, total, unit, done=done, to=sys.stdout, quiet=quiet)

    return part_of


def train(out, settings, recipe, state, tables, model, part_of, ray=None):
    """Imitate, then train, to the end or to a signal. Simulations of the imitation are played by the cluster
    at ``ray``, if it is given.

    Returns (``RunCallback``, or None if stopped before it; the curve of the imitation; the signal or None).
    """
    threads = 1 if settings.parallel == "one" else processors()
    imitation = state["imitation"] if state else []
    begun = state["imitating"] if state else None
    model.tensorboard_log = str(out / "tb")
    with Stop() as stop:
        if begun or (recipe.imitation and not state):
            teacher = ExpertIteration if recipe.expert else Imitation
            with place(ray, threads) as where:
                imitated = teacher(model, tables, recipe.imitation, settings.seed, threads, begun, where)
                of_all = f"{imitated.done:,} of {imitated.states:,} positions"
                print(f"{settings.agent} in {out}: {recipe.pretraining}{where.says}, {of_all}", flush=True)
                what = f"{recipe.pretraining}{where.says}"
                with part_of(0, what, imitated.states, "positions", imitated.done) as progress:
                    completed = imitate(imitated, out, settings, model, stop, progress)
            if not completed:
                print(f"Saved at {imitated.done:,} of {imitated.states:,} positions. {go_on(out)}")
                return None, imitated.curve, stop.signal
            imitation = imitated.curve
        if state and not begun:
            seconds, curve, running = (state[name] for name in ("seconds", "curve", "running"))
        else:
            seconds, curve, running = 0.0, [], None
        if recipe.expert:
            judge_rewards(tables, model.policy, threads)
        stop.running = f"this rollout of {rollout_of(model):,} shots"
        goal, asked = goal_of(model, settings.steps), settings.steps
        progress = part_of(1, recipe.method, goal, "shots", model.num_timesteps)
        callback = RunCallback(out, settings, seconds, curve, imitation, running, stop, progress)
        played = f"{model.num_timesteps:,} of {goal:,} shots played"
        if goal > asked > model.num_timesteps:
            played += f" ({asked:,} asked for; whole rollouts of {rollout_of(model):,})"
        print(f"{settings.agent} in {out}: {played}", flush=True)
        if model.num_timesteps >= settings.steps:
            print("All steps are done: nothing left to train.", flush=True)
        else:
            fresh = state is None or begun is not None
            with progress:
                model.learn(
                    settings.steps - model.num_timesteps,
                    callback,
                    tb_log_name=settings.agent,
                    reset_num_timesteps=fresh,
                )
        if stop.signal:
            done = (
                "; training is complete, the evaluation is left"
                if model.num_timesteps >= settings.steps
                else ""
            )
            print(f"Saved at {callback.saved or model.num_timesteps:,} shots{done}. {go_on(out)}")
        return callback, imitation, stop.signal


def trained_parts(recipe, model, seconds, imitation):
    """What was learned from, part by part: how much of what, in how many seconds, and how much a second."""
    parts = (
        [(recipe.pretraining, "positions", imitation[-1]["states"], imitation[-1]["seconds"])]
        if imitation
        else []
    )
    parts.append((recipe.method, "shots", model.num_timesteps, seconds))
    return [
        {
            "part": name,
            "unit": unit,
            "amount": amount,
            "seconds": took,
            "per_second": amount / max(took, 1e-9),
        }
        for name, unit, amount, took in parts
    ]


def simulated(model, imitation):
    """All simulated shots of the training, those of the weights it began with too; None: not known."""
    parts = [model.num_timesteps]
    parts += [one.get("simulated_shots") for one in (*imitation[-1:], model.start) if one]
    return None if None in parts else sum(parts)


def judge(out, settings, recipe, model, callback, imitation, part_of):
    """Play held-out visits, write the model and every figure, print the conclusion."""
    steps, parts = model.num_timesteps, trained_parts(recipe, model, callback.seconds_before, imitation)
    lines = [
        f"{p['part']}: {p['amount']:,} {p['unit']} in {p['seconds']:.0f} s, {p['per_second']:,.0f} a second"
        for p in parts
    ]
    print("\n".join(lines) + " (learning included)", flush=True)
    write_atomic(out / "model.zip", made := zipped(model))
    copied(out, made, "model.zip")
    figures = evaluate(
        recipe, model, settings.eval_visits, lambda total: part_of(2, "evaluation", total, "visits")
    )
    learned = conclusion(settings.agent, steps, model.imitated, figures, model.start)
    results = {
        "command": command_of(settings),
        "settings": asdict(settings),
        "steps": steps,
        "simulated_shots": simulated(model, imitation),
        "seconds": sum(part["seconds"] for part in parts),
        "parts": parts,
        "start": model.start,
        "curve": callback.curve,
        "imitation": imitation,
    }
    best = f"planner@{out}" if "planner" in figures else str(out)
    report(out, results, learned, figures, best, recipe.env_kwargs.get("noise", "none"))
    print(f"Curves: tensorboard --logdir {out / 'tb'}")


def report(out, results, learned, figures, best, noise, without=""):
    """Write and print what a run has brought, and how the player ``best`` is seen under these errors; ``without``:
    what its simulated shots do not hold."""
    results |= {"learned": learned, "evaluation": figures, "versions": software()}
    results |= {"git_commit": commit(), "processors": os.cpu_count()}
    write_atomic(out / "results.json", text := json.dumps(results, indent=1).encode())
    copied(out, text, "results.json")
    show(figures)
    # half of the longest break: other visits than those of the evaluation are played to find it
    points = figures["planner" if "planner" in figures else "trained"]["longest_break"] // 2
    words = ["--agent", best, "--noise", str(noise), "--at-least", str(points)]
    watch = shlex.join([python(), "-m", "snooker_env.watch", *words])
    shots = results["simulated_shots"]
    known = "not known" if shots is None else f"{shots:,}"
    print(f"{learned}\nAll simulated shots of the training{without}: {known}.")
    print(f"Figures: {out / 'results.json'}\nWatch a break:  {watch}")


def strokes_of(parser, given, rest):
    """The ``StrokeSettings`` of a run of ``stroke_value``, whose folder is claimed; of another agent None."""
    out, allowed = rest.out, ("agent", "seed", "set", "eval_visits")
    if rest.resume and (out / SETTINGS).is_file():
        given.setdefault("agent", "stroke_value")
    if given.get("agent") != "stroke_value":
        return None
    for name in (*given, *(name for name in ("ray", "mirror") if getattr(rest, name))):
        if name not in allowed:
            parser.error(f"--{name.replace('_', '-')} must be left out for stroke_value")
    try:
        if not rest.resume:
            return StrokeSettings.of(given.get("seed", 0), given.get("set", ()))
        if "seed" in given or "set" in given:
            parser.error(f"--seed and --set must be left out with --resume: the run in {out} has them")
        return StrokeSettings.read(out)
    except ValueError as error:
        parser.error(str(error))


def train_strokes(parser, given, rest, settings):
    """Train ``stroke_value``, evaluate it, save. Exit code 0, or 128 + the signal that stopped it."""
    out, visits = rest.out, given.get("eval_visits", Settings.eval_visits)

    def part_of(number, what, total, unit, done=0):
        what = f"stroke_value, part {number} of 3, {what}"
        return Progress(what, total, unit, done=done, to=sys.stdout, quiet=rest.no_progress)

    with ExitStack() as ending:
        try:
            ending.enter_context(claimed(out, rest.resume, SETTINGS))
            settings.save(out)
            training = StrokeTraining(out, settings)
        except ValueError as error:
            parser.error(str(error))
        except OSError as error:
            parser.error(f"out = {str(out)!r}: must be a folder that can be written ({error.strerror})")
        try:
            snooker_env.warmup()
            with Stop() as stop:
                stop.running = "these tables"
                parts = (training.visits, training.play_visits), (training.frames, training.play_frames)
                for number, (rounds, play) in enumerate(parts, 1):
                    with part_of(
                        number, f"its own {rounds.of}", rounds.total, "tables", rounds.done
                    ) as progress:
                        play(progress, stop)
                    if stop.signal:
                        done = f"{len(rounds.rounds)} of {rounds.many} rounds of {rounds.of}"
                        print(f"Saved at {done}. {go_on(out)}")
                        return 128 + stop.signal
            training.save()
            shared = {"noise": "professional", "cue": settings.cue}
            best = f"stroke_value@{out / STROKES}"
            players = {
                "trained": player(best),
                "ghost_ball": player("ghost_ball"),
                "random": player("random"),
            }
            figures = held_out(
                players, visits, lambda total: part_of(3, "evaluation", total, "visits"), **shared
            )
            shots = sum(rounds.tried for rounds, _ in parts)
            learned = conclusion("stroke_value", training.visits.tried, 0, figures)
            results = {
                "command": shlex.join(["python", "train.py", *settings.words()]),
                "settings": asdict(settings),
                "steps": shots,
                "simulated_shots": sum(rounds.simulated for rounds, _ in parts),
                "curve": {rounds.of: rounds.curve for rounds, _ in parts},
            }
            without = ", without those of the planner and the tactician that it learned from"
            report(out, results, learned, figures, best, shared["noise"], without)
        except KeyboardInterrupt:
            print(f"Interrupted. {go_on(out)}", file=sys.stderr)
            return 130
        except OSError as error:
            raise SystemExit(f"train.py: {of_disk(error, out)}. {go_on(out)}") from None
    return 0


@command("train.py")
def main(argv=None):
    """Train, evaluate, save. Exit code 0, or 128 + the signal that stopped it."""
    parser, given, rest = parse(argv)
    # more threads do not speed up a network this small, and the tables use the processors
    torch.set_num_threads(1)
    # these checks cost a twentieth of the time
    torch.distributions.Distribution.set_default_validate_args(False)
    strokes = strokes_of(parser, given, rest)
    if strokes is not None:
        return train_strokes(parser, given, rest, strokes)
    out = rest.out
    with ExitStack() as ending:
        settings, recipe, state, tables, model = prepared(parser, given, rest, ending)
        try:
            snooker_env.warmup()
            part_of = speaker(settings, recipe, rest.no_progress)
            callback, imitation, stopped = train(
                out, settings, recipe, state, tables, model, part_of, rest.ray
            )
            if stopped:
                return 128 + stopped
            judge(out, settings, recipe, model, callback, imitation, part_of)
        except KeyboardInterrupt:
            print(f"Interrupted. {kept(out)}", file=sys.stderr)
            return 130
        except ClusterError as error:
            raise SystemExit(f"train.py: {error}. {kept(out)}") from None
        except BrokenPipeError:
            print(f"train.py: its output was closed. {kept(out)}", file=sys.stderr)
            raise
        except OSError as error:
            what = f"{out / 'tb'} or the output"  # TensorBoard's errors name no file
            raise SystemExit(f"train.py: {of_disk(error, what)}. {kept(out)}") from None
    return 0


if __name__ == "__main__":
    sys.exit(main())
