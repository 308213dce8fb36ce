"""How fast motions are simulated: `python -m benchmarks.throughput [TASK...]`.

Everything is timed in one process and in turns, since a machine's speed drifts; what counts are the
medians of the ratios within each round.
"""

import copy
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import click
import gymnasium as gym
import mujoco
import numpy as np
from mujoco.rollout import Rollout
from numpy.typing import NDArray

from lqd_envs import PAPER_TASKS, ManipulationVectorEnv, SolutionSpace, get_task, rollout
from lqd_envs.motion import MotionPlan, plan_in_scene
from lqd_envs.rollout import simulate
from lqd_envs.scene import Scene, load_scene
from lqd_envs.tasks.task import Task
from lqd_envs.verdict import Verdict

_VECTOR_ENVS = 256
_PEER_ENVS = 64
_VECTOR_STEPS = 25
_PEER_STEPS = 10
_STATE = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)

Contender = Callable[[], float]
"""Runs once, and returns its physics steps per second."""


@dataclass(frozen=True)
class Motions:
    """Valid motions of one task, ready to be simulated.

    Attributes:
        scene: The task's scene.
        solutions: (n, 9) solutions.
        plan: Their starts and actions.
    """

    scene: Scene
    solutions: NDArray[np.float64]
    plan: MotionPlan

    @classmethod
    def draw(cls, task: Task, *, n: int) -> "Motions":
        """Draw random solutions until `n` of them can be started."""
        scene, rng = load_scene(task), np.random.default_rng(0)
        found: list[NDArray[np.float64]] = []
        while sum(map(len, found)) < n:
            batch = SolutionSpace().sample(4 * n, rng=rng)
            found.append(batch[plan_in_scene(scene, batch).verdicts == Verdict.VALID])
        solutions = np.concatenate(found)[:n]
        return cls(scene=scene, solutions=solutions, plan=plan_in_scene(scene, solutions))

    @property
    def physics_steps(self) -> int:
        """Physics steps of all motions together."""
        return len(self.solutions) * self.plan.actions.shape[1] * self.scene.substeps


def floor(motions: Motions, *, threads: int, model: mujoco.MjModel | None = None) -> Contender:
    """Return `mujoco.rollout` of the same states and controls, recording only the state."""
    scene, plan = motions.scene, motions.plan
    model = model or scene.model
    controls = np.repeat(scene.action_map.controls(plan.actions), scene.substeps, axis=1)
    data = mujoco.MjData(model)
    states = np.empty((len(controls), mujoco.mj_stateSize(model, _STATE)))
    for row, qpos in enumerate(scene.start_qpos(plan.starts)):
        mujoco.mj_resetData(model, data)
        data.qpos[:] = qpos
        mujoco.mj_getState(model, data, states[row], _STATE)
    record = np.empty((*controls.shape[:2], states.shape[1]))
    pool = Rollout(nthread=threads if threads > 1 else 0)
    datas = [mujoco.MjData(model) for _ in range(max(threads, 1))]

    def run() -> float:
        began = time.perf_counter()
        pool.rollout(
            [model] * len(states),
            datas,
            states,
            controls,
            skip_checks=True,
            nstep=controls.shape[1],
            state=record,
        )
        return motions.physics_steps / (time.perf_counter() - began)

    return run


def batch_simulation(motions: Motions, *, threads: int) -> Contender:
    """Return our simulation and recording of the same starts and controls."""

    def run() -> float:
        began = time.perf_counter()
        simulate(motions.scene, motions.solutions, motions.plan, threads=threads)
        return motions.physics_steps / (time.perf_counter() - began)

    return run


def whole_rollout(motions: Motions, *, threads: int) -> Contender:
    """Return `lqd_envs.rollout`, from solutions to trajectories."""

    def run() -> float:
        began = time.perf_counter()
        rollout(motions.scene.task, motions.solutions, threads=threads)
        return motions.physics_steps / (time.perf_counter() - began)

    return run


def stepping(
    envs: gym.vector.VectorEnv, motions: Motions, *, steps: int, starts: bool
) -> Contender:
    """Return the stepping of a vector env along the motions' first actions."""
    rows = np.arange(envs.num_envs) % len(motions.solutions)
    actions = motions.plan.actions[rows]
    options = {"arm": motions.plan.starts[rows]} if starts else None

    def run() -> float:
        envs.reset(options=options)
        began = time.perf_counter()
        for k in range(steps):
            envs.step(actions[:, k])
        return envs.num_envs * steps * motions.scene.substeps / (time.perf_counter() - began)

    return run


def planning_cost(task: Task, *, n: int) -> float:
    """Return the CPU time of inverse kinematics and validity checks, in ms a solution asked."""
    scene = load_scene(task)
    solutions = SolutionSpace().sample(n, rng=np.random.default_rng(1))
    began = time.process_time()
    plan_in_scene(scene, solutions)
    return 1e3 * (time.process_time() - began) / n


def peak_memory() -> float:
    """Return the peak memory of a fresh process that rolls out 2,048 random motions, in GiB."""
    code = (
        "import re, numpy, lqd_envs, pathlib;"
        "space = lqd_envs.SolutionSpace();"
        "solutions = space.sample(2048, rng=numpy.random.default_rng(2));"
        "lqd_envs.rollout('LQD/Faucet-v0', solutions);"
        # Not getrusage: what it tells includes the process that this one was forked from.
        "status = pathlib.Path('/proc/self/status').read_text();"
        "print(re.search(r'VmHWM:\\s*(\\d+) kB', status)[1])"
    )
    output = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout
    return int(output) / 2**20


def without_contacts(scene: Scene) -> mujoco.MjModel:
    """Return the scene's model with contacts disabled."""
    model = copy.copy(scene.model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return model


def medians(contenders: dict[str, Contender], *, rounds: int) -> tuple[
    dict[str, float], dict[str, float]
]:  # fmt: skip
    """Run all contenders in turns.

    Args:
        contenders: What to run; the first is what the others are compared with.
        rounds: How often.

    Returns:
        Median physics steps per second, and the median ratio to the first within a round.
    """
    for run in contenders.values():
        run()
    speeds = {name: np.empty(rounds) for name in contenders}
    for k in range(rounds):
        for name, run in contenders.items():
            speeds[name][k] = run()
    first = next(iter(speeds.values()))
    return (
        {name: float(np.median(speed)) for name, speed in speeds.items()},
        {name: float(np.median(speed / first)) for name, speed in speeds.items()},
    )


def measure(task: Task, *, threads: int, motions: int, rounds: int) -> list[str]:
    """Return rows of a Markdown table for one task and number of threads."""
    drawn = Motions.draw(task, n=motions)
    kwargs = {"task": task.id}
    wide = ManipulationVectorEnv(_VECTOR_ENVS, threads=threads, **kwargs)
    narrow = ManipulationVectorEnv(_PEER_ENVS, threads=threads, **kwargs)
    peers = {
        "SyncVectorEnv, 64": gym.make_vec(task.id, _PEER_ENVS, vectorization_mode="sync"),
        "AsyncVectorEnv, 64": gym.make_vec(task.id, _PEER_ENVS, vectorization_mode="async"),
    }
    contenders = {
        "`mujoco.rollout`, the floor": floor(drawn, threads=threads),
        "simulating and recording": batch_simulation(drawn, threads=threads),
        "`lqd_envs.rollout`": whole_rollout(drawn, threads=threads),
        "vector env, 256": stepping(wide, drawn, steps=_VECTOR_STEPS, starts=True),
        "vector env, 64": stepping(narrow, drawn, steps=_PEER_STEPS, starts=True),
        **{
            name: stepping(envs, drawn, steps=_PEER_STEPS, starts=False)
            for name, envs in peers.items()
        },
        "the floor without contacts": floor(
            drawn, threads=threads, model=without_contacts(drawn.scene)
        ),
    }
    speeds, ratios = medians(contenders, rounds=rounds)
    for envs in (wide, narrow, *peers.values()):
        envs.close()
    per_motion = drawn.physics_steps / len(drawn.solutions)
    return [
        f"| {task.name} | {threads} | {name} | {speed / per_motion:,.0f} | {ratios[name]:.2f} |"
        for name, speed in speeds.items()
    ]


@click.command()
@click.argument("task_ids", metavar="[TASK]...", nargs=-1)
@click.option("--motions", type=click.IntRange(min=1), default=128, show_default=True)
@click.option("--rounds", type=click.IntRange(min=1), default=10, show_default=True)
def main(*, task_ids: tuple[str, ...], motions: int, rounds: int) -> None:
    """Time simulation, vector envs and their peers in each TASK, on 1 and 2 threads."""
    tasks = [get_task(task_id) for task_id in task_ids] or list(PAPER_TASKS)
    click.echo("| task | threads | what | motions per second | ratio to the floor |")
    click.echo("|---|---:|---|---:|---:|")
    for task in tasks:
        for threads in (1, 2):
            for row in measure(task, threads=threads, motions=motions, rounds=rounds):
                click.echo(row)
    click.echo("\n| task | planning, ms of CPU a solution asked |\n|---|---:|")
    for task in tasks:
        cost = float(np.median([planning_cost(task, n=2_048) for _ in range(3)]))
        click.echo(f"| {task.name} | {cost:.2f} |")
    click.echo(f"\nPeak memory of a process that rolls out 2,048 motions: {peak_memory():.2f} GiB.")


if __name__ == "__main__":
    main()
