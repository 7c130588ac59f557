"""Environments for PettingZoo: all robots of a scene act at once, each with its own observations and rewards."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from pettingzoo import ParallelEnv as _ParallelEnv  # type: ignore[import-untyped]

from .gym import Rows, Task, _task


class ParallelEnv(_ParallelEnv[str, npt.NDArray[Any], npt.NDArray[Any]]):  # type: ignore[misc]
    """The robots of a scene as agents `robot_1`, `robot_2`, ...; the options are the same as for `eyesim.gym.Task`.

    The functions of the task get a row for each robot. A robot whose episode is terminated stands still as an obstacle until all other
    episodes have ended. Episodes depend on the seed in the same way as in `eyesim.gym.Env`.
    """

    metadata = {"name": "eyesim_v0", "render_modes": []}

    def __init__(self, scene: str | os.PathLike[str] | Task, render_mode: None = None, **options: Any) -> None:
        """From a scene's path or text, or from a task."""
        self.task = _task(scene, options)
        self.render_mode = render_mode
        self._rows = Rows(self.task, 1, threads=1)
        self.possible_agents = [f"robot_{number}" for number in range(1, self._rows.robots + 1)]
        self.agents: list[str] = []
        self.observation_spaces = {agent: self._rows.observation_space for agent in self.possible_agents}
        self.action_spaces = {agent: self._rows.action_space for agent in self.possible_agents}

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Space of an agent's observations."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Space of an agent's actions."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, npt.NDArray[Any]], dict[str, dict[str, Any]]]:
        """Begins the next episode; with `seed`, the first one of that seed."""
        self._rows.seed(seed)
        readings = self._rows.begin()
        self.agents = list(self.possible_agents)
        return self._of_agents(self._rows.observations(readings)), {agent: {} for agent in self.agents}

    def step(
        self, actions: dict[str, npt.NDArray[Any]]
    ) -> tuple[
        dict[str, npt.NDArray[Any]], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]
    ]:
        """Drives all robots for one period; does nothing before a reset and after the end of all episodes."""
        if not self.agents:
            return {}, {}, {}, {}, {}
        given = [np.asarray(actions[agent]) for agent in self.agents]
        rows = [self.possible_agents.index(agent) for agent in self.agents]
        all_actions = np.zeros((self._rows.robots, *np.shape(given[0])), given[0].dtype)
        all_actions[rows] = given
        commands = np.zeros((self._rows.robots, 2))
        commands[rows] = self._rows.commands(all_actions)[rows]
        readings = self._rows.step(commands)
        observations = self._of_agents(self._rows.observations(readings))
        rewards = self._of_agents(self._rows.rewards(readings, all_actions).tolist())
        terminated = self._of_agents(self._rows.terminated(readings).tolist())
        truncated = self._of_agents((readings.steps >= self.task.horizon).tolist())
        infos: dict[str, dict[str, Any]] = {agent: {} for agent in self.agents}
        self.agents = [agent for agent in self.agents if not (terminated[agent] or truncated[agent])]
        return observations, rewards, terminated, truncated, infos

    def _of_agents(self, rows: Any) -> dict[str, Any]:
        return {agent: rows[self.possible_agents.index(agent)] for agent in self.agents}
