"""Stable-baselines3 with `eyesim.sb3.VecEnv`; its installation is too large for every run of the tests: `pip install stable-baselines3`."""

import hashlib

import eyesim.gym
import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed: pip install stable-baselines3")
sb3 = pytest.importorskip("eyesim.sb3")

WALL = eyesim.gym.WALL_FOLLOW


def test_it_has_the_episodes_of_single_environments():
    vector, env = sb3.VecEnv(WALL, 3, horizon=30), eyesim.gym.Env(WALL, horizon=30)
    vector.seed(20)
    first = vector.reset()
    assert np.array_equal(env.reset(seed=22)[0], first[2])
    ends = []
    for action in np.random.default_rng(0).uniform(-1, 1, (100, 3, 2)).astype(np.float32):
        observations, rewards, dones, infos = vector.step(action)
        alone, reward, terminated, truncated, _ = env.step(action[2])
        assert rewards[2] == np.float32(reward) and dones[2] == (terminated or truncated)
        if dones[2]:
            assert np.array_equal(infos[2]["terminal_observation"], alone)
            assert infos[2]["TimeLimit.truncated"] == truncated and infos[2]["episode"]["l"] <= 30
            ends.append(truncated)
            alone, _ = env.reset()
        assert np.array_equal(observations[2], alone)
    assert ends


def train(steps=100_000):
    """Trains a policy by PPO on one thread; returns the model and the mean return of the latest episodes after each rollout."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback

    class Returns(BaseCallback):
        def _on_rollout_end(self):
            history.append(float(np.mean([episode["r"] for episode in self.model.ep_info_buffer])))

        def _on_step(self):
            return True

    torch.set_num_threads(1)
    history = []
    env = sb3.VecEnv(WALL, 32, horizon=200)
    model = PPO("MlpPolicy", env, n_steps=128, batch_size=512, n_epochs=5, learning_rate=1e-3, seed=0, device="cpu")
    model.learn(steps, callback=Returns())
    return model, history


def digest(model):
    return hashlib.sha256(b"".join(value.numpy().tobytes() for value in model.policy.state_dict().values())).hexdigest()[:16]


def test_ppo_learns_to_follow_a_wall_twice_with_the_same_numbers():
    model, history = train()
    again, same = train()
    print(f"\nmean return {history[0]:.1f} to {history[-1]:.1f}, weights {digest(model)}; again {same[-1]:.1f}, {digest(again)}")
    assert history == same and digest(model) == digest(again)
    assert history[-1] > history[0] + 20
