"""Vector environment for stable-baselines3: `VecEnv(task, 64)`, with the simulations, seeds and tasks of `eyesim.gym`.

The step that ends an episode also begins the next one, as stable-baselines3 requires; `eyesim.gym.VectorEnv` does not
do this. The step returns the first observation of the new episode, and `infos[i]["terminal_observation"]` is the last
observation of the old one.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from stable_baselines3.common.vec_env import VecEnv as _VecEnv  # type: ignore[import-not-found]

from .gym import Rows, Task, _of_one_robot, _task


class VecEnv(_VecEnv):  # type: ignore[misc]
    """Many robots, each in its own scene; one call steps all of them in parallel.

    The options are the same as for `eyesim.gym.Task`.
    """

    def __init__(
        self, scene: str | os.PathLike[str] | Task, num_envs: int = 1, threads: int | None = None, **options: Any
    ) -> None:
        """From a scene's path or text, or from a task; `threads` is by default the number of cores."""
        self.task = _task(scene, options)
        self._rows = _of_one_robot(Rows(self.task, num_envs, threads))
        self._returns = np.zeros(num_envs)
        self._actions: npt.NDArray[Any] = np.zeros((num_envs, 2))
        self.render_mode = None
        super().__init__(num_envs, self._rows.observation_space, self._rows.action_space)

    def reset(self) -> npt.NDArray[Any]:
        """Begins the next episode of each simulation; after a call of `seed`, the first episodes of these seeds."""
        if self._seeds[0] is not None:
            self._rows.seed(self._seeds)
        self._reset_seeds()
        self._reset_options()
        self._returns[:] = 0.0
        return self._rows.observations(self._rows.begin())

    def step_async(self, actions: npt.NDArray[Any]) -> None:
        """Stores the actions for `step_wait`."""
        self._actions = np.asarray(actions)

    def step_wait(self) -> tuple[npt.NDArray[Any], npt.NDArray[np.float32], npt.NDArray[np.bool_], list[dict[str, Any]]]:
        """Drives all robots for one period; where an episode has ended, the next one begins."""
        rows = self._rows
        readings = rows.step(rows.commands(self._actions))
        terminated = rows.terminated(readings)
        done = terminated | (readings.steps >= self.task.horizon)
        rewards = rows.rewards(readings, self._actions)
        self._returns += rewards
        observations = rows.observations(readings)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        if done.any():
            for index in np.flatnonzero(done):
                infos[index] = {
                    "terminal_observation": observations[index].copy(),
                    "TimeLimit.truncated": not bool(terminated[index]),
                    # As `VecMonitor` would add it; stable-baselines3 prints the means of return and length.
                    "episode": {"r": float(self._returns[index]), "l": int(readings.steps[index])},
                }
            self._returns[done] = 0.0
            begun = rows.begin(done.astype(np.uint8))
            observations = observations.copy()
            observations[done] = rows.observations(begun)[done]
        return observations, rewards.astype(np.float32), done, infos

    def close(self) -> None:
        """Does nothing: the memory is freed when the last reference to this object is gone."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The attribute of this object, repeated for each selected simulation."""
        return [getattr(self, attr_name)] * len(self._get_indices(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Raises `AttributeError`: the simulations have no attributes of their own."""
        raise AttributeError(f"`{attr_name}` cannot be set: simulations of a vector have no attributes of their own")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Raises `AttributeError`: the simulations have no methods of their own."""
        raise AttributeError(f"`{method_name}` cannot be called: simulations of a vector have no methods of their own")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Returns False for each selected simulation."""
        return [False] * len(self._get_indices(indices))

    def _get_indices(self, indices: int | Sequence[int] | None) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else indices
