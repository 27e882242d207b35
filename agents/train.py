"""How does ``train.py`` train? It opens the run, plays its rounds, evaluates the agent and writes the results."""

import json
import shlex
import sys
from contextlib import ExitStack
from dataclasses import asdict, replace

import matplotlib  # noqa: F401 - imported here so that a missing package is reported first
import tensorboard  # noqa: F401 - for the same reason
import torch

import snooker_env
from agents._lib.files import write_atomic
from agents._lib.lifecycle import command, python
from agents._lib.provenance import provenance

from .evaluation.learning_curve import LearningCurve
from .evaluation.training_summary import conclusion, evaluate, held_out, show
from .learning.agent_training import AgentTraining
from .learning.learn_strokes import AGENT, StrokeTraining
from .learning.loop import Loop
from .learning.models import zip_model
from .learning.run_folder import claim, keep_settings, kept_settings
from .learning.settings import FREE_ON_RESUME, Settings, parse


def open_run(given, out, resume, ending):
    """Open the training in the folder, new or resumed. ``ending`` releases its resources. Any invalid input raises ValueError
    here, before the work starts."""
    settings = Settings(**given)
    if resume:
        ending.enter_context(claim(out, resume))
        was = kept_settings(out, Settings)
        for name, value in given.items():
            if value != getattr(was, name) and name not in FREE_ON_RESUME:
                differs = f"{value!r} but the run in {out} has {getattr(was, name)!r}"
                raise ValueError(
                    f"--{name.replace('_', '-')} is {differs}: give that value or leave the option out"
                )
        settings = replace(was, **given)
    kind = StrokeTraining if settings.agent == AGENT else AgentTraining
    training = kind(settings, out, resume)
    ending.callback(training.close)
    if not resume:
        ending.enter_context(claim(out, resume))  # last, so that an invalid option leaves no folder behind
    keep_settings(out, training.settings)
    return training


def judge_agent(training, loop):
    """Play held-out visits and write the model. Return the conclusion, figures, results, the player to watch and its noise."""
    model, expert, settings = training.model, training.expert, training.settings
    parts = [
        {"part": part.what, "unit": part.unit, "amount": part.done, "seconds": part.seconds}
        | {"per_second": part.done / max(part.seconds, 1e-9)}
        for part in training.parts
    ]
    lines = [
        f"{p['part']}: {p['amount']:,} {p['unit']} in {p['seconds']:.0f} s, {p['per_second']:,.0f} a second"
        for p in parts
    ]
    print("\n".join(lines) + " (learning included)", flush=True)
    write_atomic(training.out / "model.zip", zip_model(model))
    figures = evaluate(training.recipe, model, settings.eval_visits, loop)
    learned = conclusion(settings.agent, model.num_timesteps, model.imitated, figures)
    if training.ppo.curve:
        learning = LearningCurve(settings.agent, training.ppo.curve, figures)
        print("", *learning.text(), sep="\n")
        learning.draw(training.out / "curve.png", training.ppo.seconds)
    curve = expert.curve if expert else []
    results = {
        "steps": model.num_timesteps,
        "simulated_shots": model.num_timesteps + sum(one["simulated_shots"] for one in curve[-1:]),
        "seconds": sum(part["seconds"] for part in parts),
        "parts": parts,
        "curve": training.ppo.curve,
        "imitation": curve,
    }
    best = f"planner@{training.out}" if "search" in figures else str(training.out)
    return learned, figures, results, best, training.recipe.env_kwargs.get("noise", "none")


def judge_strokes(training, loop):
    """Like ``judge_agent``, for ``stroke_value``."""
    best, noise = f"{AGENT}@{training.write()}", "professional"
    players = {"trained": best, "ghost_ball": "ghost_ball", "random": "random"}
    players = {name: snooker_env.player(one) for name, one in players.items()}
    figures = held_out(players, training.settings.eval_visits, loop, noise=noise, cue=training.strokes.cue)
    learned = conclusion(AGENT, training.visits.trial_shots, 0, figures)
    results = {
        "steps": sum(part.trial_shots for part in training.parts),
        "simulated_shots": sum(part.simulated for part in training.parts),
        "without": "those of its teachers, the planner and the tactician",
        "curve": {part.name: part.curve for part in training.parts},
    }
    return learned, figures, results, best, noise


def report(training, learned, figures, results, best, noise):
    """Write and print the results of a run, and the command that shows its best player with these errors."""
    out, settings = training.out, training.settings
    results = provenance(settings.command, settings.seed) | {"settings": asdict(settings)} | results
    results |= {"learned": learned, "evaluation": figures}
    write_atomic(out / "results.json", json.dumps(results, indent=1).encode())
    show(figures)
    # half of the longest break, because the command searches other visits than the evaluation's
    points = figures["planner" if "search" in figures else "trained"]["longest_break"] // 2
    words = ["--agent", best, "--noise", str(noise), "--at-least", str(points)]
    watch = shlex.join([python(), "-m", "snooker_env.watch", *words])
    without = f", without {results['without']}" if "without" in results else ""
    print(f"{learned}\nShots simulated in training{without}: {results['simulated_shots']:,}.")
    if (out / "curve.png").is_file():
        print(f"Learning curve: {out / 'curve.png'}")
    print(f"Figures: {out / 'results.json'}\nWatch a break:  {watch}")
    if (out / "tb").is_dir():
        print(f"All curves: tensorboard --logdir {out / 'tb'}")


@command("train.py")
def main(argv=None):
    """Train, evaluate, save. Exit code 0, or 128 + the signal that stopped it."""
    parser, given, rest = parse(argv)
    # more threads do not speed up such a small network, and the tables use the processors
    torch.set_num_threads(1)
    # these checks take a twentieth of the time
    torch.distributions.Distribution.set_default_validate_args(False)
    with ExitStack() as ending:
        try:
            training = open_run(given, rest.out, rest.resume, ending)
        except ValueError as error:
            parser.error(str(error))
        except OSError as error:
            parser.error(f"out = {str(rest.out)!r}: must be a folder that can be written ({error.strerror})")
        again = f"Continue with:  {shlex.join([python(), 'train.py', '--resume', '--out', str(rest.out)])}"
        loop = Loop(training.settings.agent, training.parts, training.save, again, 1)
        try:
            snooker_env.warmup()
            if (number := loop.run()) is not None:
                return 128 + number
            judge = judge_strokes if isinstance(training, StrokeTraining) else judge_agent
            report(training, *judge(training, loop))
        except (KeyboardInterrupt, OSError):
            print(loop.again, file=sys.stderr)
            raise
    return 0
