"""Environments: the checks of Gymnasium and PettingZoo, seeds, and a policy that learns."""

import dataclasses
import multiprocessing
import warnings

import eyesim.gym
import eyesim.pettingzoo
import gymnasium
import numpy as np
import pytest
from eyesim import _native
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test, parallel_seed_test

WALL = eyesim.gym.WALL_FOLLOW

PAIR = """
[world]
file = "%sim%/worlds/obstacles.wld"

[[robot]]
type = "%sim%/robis/ring.robi"
x_mm = 700
y_mm = 350

[[robot]]
type = "%sim%/robis/ring.robi"
x_mm = 3300
y_mm = 3000
"""


def actions(count, steps, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (steps, count, 2)).astype(np.float32)


def test_gymnasium_finds_it_and_accepts_it():
    env = gymnasium.make("eyesim/WallFollow-v0")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)
    assert env.observation_space.shape == (8,)
    vector = gymnasium.make_vec("eyesim/WallFollow-v0", num_envs=3)
    assert isinstance(vector.unwrapped, eyesim.gym.VectorEnv) and vector.num_envs == 3


def test_pettingzoo_accepts_it():
    env = eyesim.pettingzoo.ParallelEnv(PAIR, horizon=50, jitter=(0.1, 0.1, 1.0), noise="mild")
    parallel_api_test(env, num_cycles=200)
    parallel_seed_test(lambda: eyesim.pettingzoo.ParallelEnv(PAIR, horizon=50, jitter=(0.1, 0.1, 1.0), noise="mild"))
    first, _ = env.reset(seed=1)
    other, _ = env.reset(seed=2)
    assert not np.array_equal(first["robot_1"], other["robot_1"])


def test_each_robot_has_its_own_limits():
    scene = PAIR.replace("%sim%/robis/ring.robi", "S4", 1)
    speeds = [robot.max_speed for robot in eyesim.load(scene).robots]
    assert speeds[0] != speeds[1]
    env = eyesim.pettingzoo.ParallelEnv(scene, observe=lambda readings: readings.speed[:, None])
    env.reset(seed=1)
    observations = env.step({agent: np.array([1.0, 0.0], np.float32) for agent in env.agents})[0]
    assert [observations[agent][0] for agent in env.agents] == pytest.approx(speeds)


def test_seeds_are_whole_numbers_one_for_each_environment():
    vector = eyesim.gym.VectorEnv(WALL, 3)
    first = vector.reset(seed=np.int64(5))[0]
    assert np.array_equal(first, vector.reset(seed=[5, 6, 7])[0])
    with pytest.raises(ValueError, match="2 seeds for 3 simulations"):
        vector.reset(seed=[1, 2])
    for seed in (1.5, "7", [1, 2, 3.5]):
        with pytest.raises(TypeError):
            vector.reset(seed=seed)


def episodes(vector, seed, steps):
    """Observations, rewards and ends of all steps."""
    rows = [vector.reset(seed=seed)[0]]
    # Robots drive ahead, so that some touch a wall.
    ahead = np.abs(actions(16, steps)) * (0.4, 0.3)
    for action in ahead[:, : vector.num_envs].astype(np.float32):
        observation, reward, terminated, truncated, _ = vector.step(action)
        rows.append(np.column_stack([observation, reward, terminated, truncated]))
    return np.stack([np.resize(row, (vector.num_envs, 11)) if index else np.pad(row, ((0, 0), (0, 3))) for index, row in enumerate(rows)])


def test_an_episode_does_not_depend_on_the_number_of_environments():
    many = eyesim.gym.VectorEnv(WALL, 16, threads=3, horizon=60)
    few = eyesim.gym.VectorEnv(WALL, 5, threads=1, horizon=60)
    of_many, of_few = episodes(many, 7, 200), episodes(few, 7, 200)
    assert np.array_equal(of_many[:, :5], of_few)
    assert [many.digest(index) for index in range(5)] == [few.digest(index) for index in range(5)]
    # Some episodes end by termination and some by truncation, and episodes differ from each other.
    assert of_few[1:, :, 9].any() and of_few[1:, :, 10].any()
    assert len({row.tobytes() for row in of_many[0]}) == 16


def test_a_vector_has_the_episodes_of_single_environments():
    vector, env = eyesim.gym.VectorEnv(WALL, 3, horizon=30), eyesim.gym.Env(WALL, horizon=30)
    first = vector.reset(seed=20)[0]
    is_over = False
    assert np.array_equal(env.reset(seed=22)[0], first[2])
    for action in actions(3, 100):
        observation, reward, terminated, truncated, _ = vector.step(action)
        if is_over:  # the step after an end only resets
            assert reward[2] == 0 and not terminated[2] and not truncated[2]
            assert np.array_equal(env.reset()[0], observation[2])
            is_over = False
            continue
        alone, own, *ends, _ = env.step(action[2])
        assert np.array_equal(alone, observation[2])
        assert own == reward[2] and ends == [terminated[2], truncated[2]]
        is_over = any(ends)


def test_a_contact_terminates_and_time_truncates():
    env = eyesim.gym.Env(WALL, horizon=10_000)
    env.reset(seed=0)
    ends = []
    while not ends:
        _, reward, terminated, truncated, _ = env.step(np.array([1.0, 0.0], np.float32))
        ends = [terminated, truncated] if terminated or truncated else []
    assert ends == [True, False] and reward < -9
    env = eyesim.gym.Env(WALL, horizon=5)
    env.reset(seed=0)
    still = np.zeros(2, np.float32)
    assert [env.step(still)[2:4] for _ in range(5)] == [(False, False)] * 4 + [(False, True)]


def test_a_reset_is_a_fresh_start():
    env = eyesim.gym.Env(WALL)
    env.reset(seed=3)
    digest = env.digest
    for action in actions(1, 30):
        env.step(action[0])
    assert env.digest != digest
    env.reset(seed=3)
    assert env.digest == digest


def test_an_episode_is_a_new_simulation_with_its_seed():
    env = eyesim.gym.Env(WALL, starts=(), jitter=(0.0, 0.0, 0.0), noise="real")
    env.reset(seed=5)
    for action in actions(1, 40):
        env.step(action[0])
    env.reset()
    sim = eyesim.load(WALL.scene, seed=_native.episode_seed(5, 1), noise="real")
    robot = sim.robot()
    for _ in range(60):
        env.step(np.array([0.5, 0.25], np.float32))
        robot.drive(0.5 * robot.max_speed, 0.25 * robot.max_turn)
        sim.step(0.05)
    assert env.digest == sim.digest


def test_a_forked_process_goes_on_alone():
    vector = eyesim.gym.VectorEnv(WALL, 4, threads=2)
    vector.reset(seed=1)

    def go_on():
        return [vector.step(action)[0].tolist() for action in actions(4, 20, seed=2)]

    fork = multiprocessing.get_context("fork")
    queue = fork.SimpleQueue()
    child = fork.Process(target=lambda: queue.put(go_on()))
    child.start()
    of_child = queue.get()
    child.join()
    assert child.exitcode == 0 and of_child == go_on()


def test_readings_keep_their_values():
    kept = []
    env = eyesim.gym.Env(WALL, observe=lambda readings: kept.append(readings) or readings.pose)
    env.reset(seed=1)
    poses = [env.step(action[0])[0] for action in actions(1, 10)]
    assert np.array_equal(np.array([readings.pose[0] for readings in kept[-10:]], np.float32), poses)
    assert [int(readings.steps[0]) for readings in kept[-10:]] == list(range(1, 11))


def test_a_task_around_any_scene():
    env = eyesim.gym.Env(
        WALL.scene,
        observe=lambda readings: readings.pose,
        act=lambda actions, limits: np.column_stack([actions[:, 0], 0 * actions[:, 0]]),
        reward=lambda readings, actions: readings.speed,
        action_space=gymnasium.spaces.Box(0.0, 0.3, (1,)),
    )
    first, _ = env.reset(seed=0)
    observation, reward, *_ = env.step(np.array([0.2], np.float32))
    assert first == pytest.approx([0.7, 0.35, np.pi], abs=1e-6) or first == pytest.approx([0.7, 0.35, -np.pi], abs=1e-6)
    assert first[0] - observation[0] == pytest.approx(0.01, abs=1e-6) and reward == pytest.approx(0.2)
    with pytest.raises(ValueError, match="has 2 robots, expected one"):
        eyesim.gym.Env(PAIR)
    with pytest.raises(eyesim.Error, match="1 starts for 2 robots"):
        eyesim.pettingzoo.ParallelEnv(PAIR, starts=[(1.0, 1.0, 0.0)])


WRONG = {
    "observe": lambda readings: np.stack([readings.speed, readings.turn]),
    "act": lambda actions, limits: actions[:, 0],
    "reward": lambda readings, actions: readings.speed[:, None],
    "terminated": lambda readings: (readings.ranges < 0.1).any(),
}


@pytest.mark.parametrize("name", WRONG)
def test_each_function_gives_a_row_for_each_robot(name):
    task = dataclasses.replace(WALL, **{name: WRONG[name]})
    still = np.zeros(2, np.float32)
    for env, action in ((eyesim.gym.Env(task), still), (eyesim.gym.VectorEnv(task, 3), np.stack([still] * 3))):
        with pytest.raises(ValueError, match=f"^{name}: an array of shape .* a row for each robot"):
            env.reset(seed=1)
            env.step(action)
    agents = eyesim.pettingzoo.ParallelEnv(PAIR, **{name: WRONG[name]} if name != "observe" else {"observe": lambda readings: readings.speed[0]})
    with pytest.raises(ValueError, match=f"^{name}: "):
        agents.reset(seed=1)
        agents.step({agent: still for agent in agents.agents})


def test_actions_fit_their_space():
    vector = eyesim.gym.VectorEnv(WALL, 2)
    vector.reset(seed=1)
    for action in (np.zeros(2), np.zeros((1, 2)), np.zeros((2, 1))):
        with pytest.raises(ValueError, match=r"^actions: .*: expected \(2, 2\)"):
            vector.step(action)
    with pytest.raises(ValueError, match="^action_space: .* give an `act`"):
        eyesim.gym.Env(WALL, action_space=gymnasium.spaces.Discrete(3))
    with pytest.raises(ValueError, match="^observe: "):
        eyesim.gym.Env(WALL, observation_space=gymnasium.spaces.Box(0, 1, (3,))).reset(seed=1)


def test_starts_are_finite():
    for wrong in ({"starts": [(np.nan, 1.0, 0.0)]}, {"jitter": (0.0, np.inf, 0.0)}, {"jitter": (-0.1, 0.0, 0.0)}):
        with pytest.raises(ValueError, match="expected finite numbers"):
            eyesim.gym.Env(WALL, **wrong)


def test_a_step_without_agents_does_nothing():
    env = eyesim.pettingzoo.ParallelEnv(PAIR, horizon=1)
    assert env.step({}) == ({}, {}, {}, {}, {})
    env.reset(seed=1)
    env.step({agent: np.zeros(2, np.float32) for agent in env.agents})
    assert env.agents == [] and env.step({}) == ({}, {}, {}, {}, {})


def learn(generations=30, pairs=24):
    """Trains a linear policy by an evolution strategy with antithetic pairs and ranks.

    Returns the mean return of each generation and the policy."""
    vector = eyesim.gym.VectorEnv(WALL, 2 * pairs, horizon=200)
    random = np.random.default_rng(1)
    policy, history = np.zeros((9, 2)), []
    for generation in range(generations):
        deviation = random.normal(size=(pairs, 9, 2))
        policies = policy + 0.3 * np.concatenate([deviation, -deviation])
        returns = rollout(vector, policies, seed=1000 * generation)
        ranks = returns.argsort().argsort() / (2 * pairs - 1) - 0.5
        policy += 0.6 * np.tensordot(ranks[:pairs] - ranks[pairs:], deviation, 1) / pairs
        history.append(returns.mean())
    return history, policy


def rollout(vector, policies, seed):
    """Return of the first episode of each policy."""
    observation, _ = vector.reset(seed=seed)
    returns, alive = np.zeros(len(policies)), np.ones(len(policies), bool)
    for _ in range(200):
        inputs = np.column_stack([observation, np.ones(len(policies))])
        action = np.tanh(np.einsum("ni,nia->na", inputs, policies)).astype(np.float32)
        observation, reward, terminated, truncated, _ = vector.step(action)
        returns += reward * alive
        alive &= ~(terminated | truncated)
    return returns


def test_a_policy_learns_to_follow_a_wall():
    history, policy = learn()
    again, same = learn()
    assert history == again and np.array_equal(policy, same)
    vector = eyesim.gym.VectorEnv(WALL, 32, horizon=200)
    learnt = rollout(vector, np.repeat(policy[None], 32, 0), seed=99_999)
    # Standing still earns 0; at most 200 are possible, at full speed and at the right distance all the time.
    assert np.median(learnt) > 40 and np.mean(history[-3:]) > np.mean(history[:3]) + 20
