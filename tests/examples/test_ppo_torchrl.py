"""Does TorchRL collect what the tables play, and does its PPO run?"""

import numpy as np
import torch

from agents.players.trained import load_player
from snooker_env import SnookerEnv
from tests.trainers import needed

check_env_specs = needed("torchrl.envs.utils").check_env_specs
example = needed("examples.ppo_torchrl")


def test_a_rollout_is_what_single_tables_play():
    """The first observation of the next visit follows the end of one. The last one of a visit is 0: TorchRL
    0.14 expects it under another name if observations are a dict. Nothing is learned from it, as visits are
    terminated and never truncated."""
    tables = example.tables("club", 5)
    torch.manual_seed(0)

    def choose(mask):
        assert mask.dtype == torch.bool and mask.any(-1).all()
        return torch.multinomial(mask.float(), 1).squeeze(-1)

    policy = needed("tensordict.nn").TensorDictModule(choose, ["action_mask"], ["action"])
    rollout = tables.rollout(12, policy=policy, break_when_any_done=False, auto_reset=True)
    ends = 0
    for k in range(example.TABLES):
        env = SnookerEnv(action="discrete", observation="masked", noise="club")
        env.reset(seed=5 + k)  # TorchRL seeds by a reset of its own, and begins with the next one
        seen, _ = env.reset()
        for t in range(12):
            row = rollout[k, t]
            assert np.array_equal(row["observations"].numpy(), seen["observations"])
            assert np.array_equal(row["action_mask"].numpy(), seen["action_mask"].astype(bool))
            seen, reward, terminated, _, _ = env.step(int(row["action"]))
            after = row["next"]
            if not terminated or after["observations"].any():
                assert np.array_equal(after["observations"].numpy(), seen["observations"])
                assert np.array_equal(after["action_mask"].numpy(), seen["action_mask"].astype(bool))
            assert after["reward"].item() == reward
            assert after["done"].item() == after["terminated"].item() == terminated
            if terminated:
                ends, (seen, _) = ends + 1, env.reset()
    assert ends > 100
    check_env_specs(tables)


def test_it_trains_and_its_file_is_played_by_our_protocol(tmp_path, capsys):
    before = torch.random.get_rng_state(), torch.get_num_threads()
    example.main(["--steps", "24576", "--seed", "1", "--out", str(tmp_path / "p.npz")])
    torch.random.set_rng_state(before[0]), torch.set_num_threads(before[1])
    lines = [line for line in capsys.readouterr().out.splitlines() if " points a visit" in line]
    points = [float(line.partition(" shots, ")[2].partition(" ")[0]) for line in lines]
    assert len(points) == 3 and points[-1] > 1.2 * points[0]
    assert load_player(tmp_path / "p.npz").model.num_timesteps == 24576
