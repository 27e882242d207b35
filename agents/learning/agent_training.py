"""How is an agent of ``hyperparams/`` trained? By expert iteration, if its recipe says so, then by PPO, rollout by rollout."""

from dataclasses import replace

import numpy as np
from stable_baselines3.common.callbacks import BaseCallback

from snooker_env.checks import refuse
from snooker_env.planning import processors

from ..features.observed import training_tables
from .expert_iteration import ExpertIteration, judge_rewards
from .hyperparameters import Recipe
from .loop import Part
from .run_folder import load_model, read_checkpoint, save_checkpoint

POINTS_OF_THE_CURVE = 20


class PolicyGradient(Part):
    """PPO up to ``steps`` shots, in whole rollouts. ``before`` comes from ``get_state``. If the agent has its own value of
    positions, that value adds to the rewards."""

    unit = "shots"

    def __init__(self, recipe, model, threads, steps, before=None):
        self._recipe, self._model, self._threads, self._steps = recipe, model, threads, steps
        self.what, self.rollout = recipe.method, model.n_envs * model.n_steps
        left = max(0, steps - model.num_timesteps)
        self.total = model.num_timesteps + self.rollout * -(-left // self.rollout)
        self.now = f"this rollout of {self.rollout:,} shots"
        self.curve, self._spent, self._begun = [], 0.0, False
        if before:
            self.curve, self._spent, self._begun = (before[name] for name in ("curve", "seconds", "begun"))
        self.running = None
        """Sums of the visits that were in progress when the run was saved."""

    @property
    def done(self):
        return self._model.num_timesteps

    def get_state(self):
        """The state without the model and the tables."""
        return {"curve": self.curve, "seconds": self.seconds, "begun": self._begun}

    @property
    def figures(self):
        """Round, losses and points of the last visits, in words."""
        losses, recent = self._model.logger.name_to_value, self._recent
        words = [f"round {self.done // self.rollout:,} of {self.total // self.rollout:,}"]
        known = ((name, losses.get(f"train/{name}_loss")) for name in ("policy_gradient", "value"))
        words += [f"{name.partition('_')[0]} loss {loss:.3g}" for name, loss in known if loss is not None]
        words += [f"{np.mean(recent):.2f} points a visit"] if recent else []
        return ", ".join(words)

    @property
    def _recent(self):
        return [visit["r"] for visit in self._model.ep_info_buffer or ()]

    def begin(self):
        if self._recipe.expert:
            judge_rewards(self._model.get_env(), self._model.policy, self._threads)

    def play(self, rest):
        fresh, self._begun = not self._begun, True
        between = _Between(self, rest, None if fresh else self.running)
        left = self._steps - self.done
        self._model.learn(left, between, tb_log_name=self._recipe.name, reset_num_timesteps=fresh)
        if self.done >= self.total:
            self.note()

    def note(self):
        """Add a point to the curve if it is time."""
        due = self.done >= len(self.curve) * self._steps // POINTS_OF_THE_CURVE
        # a resumed run calls this a second time
        if self._recent and due and self.done > (self.curve[-1]["steps"] if self.curve else -1):
            self.curve.append({"steps": self.done, "points": round(float(np.mean(self._recent)), 3)})


class _Between(BaseCallback):
    """Asks ``rest`` between two rollouts, when everything played has been used. SB3 can stop only one shot later; a resumed
    run repeats that shot."""

    def __init__(self, part, rest, running):
        super().__init__()
        self._part, self._rest, self._running, self._goes_on = part, rest, running, True

    def _on_training_start(self):
        if self._running is not None:  # learn() begins with a reset, which set them to 0
            self.training_env.running = self._running  # type: ignore[attr-defined]

    def _on_rollout_start(self):
        self._part.note()
        self._goes_on = self._rest()

    def _on_step(self):
        return self._goes_on


def recipe_of(settings):
    """The agent's recipe with the changes of these settings. Raises ValueError."""
    names = ("layout", "noise", "fidelity", "physics", "conditions", "observe_conditions")
    chosen = {name: value for name in names if (value := getattr(settings, name))}
    if "physics" in chosen:
        from agents._lib.physics_option import physics_option

        chosen["physics"] = physics_option(settings.physics)
    numbers = {"n_timesteps": settings.steps, "n_envs": settings.envs}
    numbers = {key: value for key, value in numbers.items() if value}
    if settings.imitate >= 0:
        numbers["imitation"] = settings.imitate
    recipe = Recipe.of(settings.agent, settings.set, chosen, **numbers)
    if recipe.imitation and not recipe.expert:
        raise refuse("imitate", recipe.imitation, f"must be 0 for {recipe.name}: it has no expert iteration")
    if recipe.expert and not recipe.imitation:
        why = "PPO needs the value that expert iteration learns"
        raise refuse("imitate", 0, f"must be 1 or more for {recipe.name}: {why}")
    return recipe


class AgentTraining:
    """Open a run of these settings in the folder ``out``, new or resumed. Raises ValueError."""

    def __init__(self, settings, out, resume):
        state = read_checkpoint(out) if resume else None
        recipe, self.out = recipe_of(settings), out
        if state:
            recipe = replace(recipe, env_kwargs=state["options"])
        self.recipe, threads = recipe, 1 if settings.parallel == "one" else processors()
        self.settings = replace(
            settings, steps=recipe.n_timesteps, envs=recipe.n_envs, imitate=recipe.imitation
        )
        self.tables = training_tables(recipe.n_envs, threads=threads, **recipe.env_kwargs)
        if state:
            self.model = load_model(out, state, recipe.algo, self.tables, settings.seed)
        else:
            self.model = recipe.new_model(self.tables, settings.seed)
        self.model.tensorboard_log = str(out / "tb")
        *before, last = state["parts"] if state else [None]
        self.expert = None
        if recipe.imitation:
            expert = (self.model, self.tables, recipe.imitation, settings.seed, threads)
            self.expert = ExpertIteration(*expert, *before)
        self.ppo = PolicyGradient(recipe, self.model, threads, recipe.n_timesteps, last)
        self.ppo.running = state["running"] if state else None
        self.parts = [part for part in (self.expert, self.ppo) if part]
        if last and self.expert and self.expert.done >= self.expert.total and not last["begun"]:
            self.tables.reset()  # applies the given state, because PPO begins with another reset

    def save(self):
        """Write the checkpoint."""
        self.model.imitated = self.expert.done if self.expert else 0
        save_checkpoint(self.out, self.model, self.parts)

    def close(self):
        """Release the tables."""
        self.tables.close()
