"""What the multi-BD archive costs beside plain pyribs: `python -m benchmarks.archive_add`.

Both are given the same generations in turns, in one process, since a machine's speed drifts; what
counts are the medians of the ratios within each generation.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import click
import numpy as np
from numpy.typing import NDArray
from ribs.archives import GridArchive
from ribs.typing import BatchData, FieldDesc

from lqd_envs import SolutionSpace
from lqd_search import GridSpec, MultiBDArchive, learn_grid_spec

_EXTRA: FieldDesc = {
    "evaluation": ((), np.int64),
    "expert": ((), np.bool_),
    "ground_truth": ((3,), np.float64),
    "digest": ((), np.uint64),
}
_BLOCK = 10
_CELLS = 10_000
_DEFINED = 0.6


@dataclass(frozen=True, eq=False)
class Landscape:
    """A made-up task: smooth functions of a solution, in the place of simulated motions.

    Attributes:
        lengths: For each descriptor its number of measures.
        waves: For each descriptor (9, d) weights of its measures.
        gates: (9, descriptors) weights of whether a descriptor is defined.
        goal: (9,) the solution of the highest fitness.
    """

    lengths: tuple[int, ...]
    waves: tuple[NDArray[np.float64], ...]
    gates: NDArray[np.float64]
    goal: NDArray[np.float64]

    @classmethod
    def draw(cls, *, grids: int, rng: np.random.Generator) -> "Landscape":
        """Draw one with 2, 3 and 4 measures in turns."""
        dim = SolutionSpace().dim
        lengths = tuple(2 + i % 3 for i in range(grids))
        return cls(
            lengths=lengths,
            waves=tuple(rng.normal(size=(dim, length)) for length in lengths),
            gates=rng.normal(size=(dim, grids)),
            goal=SolutionSpace().sample(1, rng=rng)[0],
        )

    def evaluate(
        self, solutions: NDArray[np.float64], *, first: int, rng: np.random.Generator
    ) -> BatchData:
        """Return the batch that the archive is given: every field and all measures."""
        distance = np.linalg.norm(solutions - self.goal, axis=1)
        gate = solutions @ self.gates + rng.normal(size=(len(solutions), len(self.lengths)))
        defined = gate < np.quantile(gate, _DEFINED, axis=0)
        blocks = [
            np.where(defined[:, [i]], np.sin(solutions @ waves), np.nan)
            for i, waves in enumerate(self.waves)
        ]
        return {
            "solution": solutions,
            "objective": -distance + rng.normal(0.0, 0.1, len(solutions)),
            "measures": np.concatenate(blocks, axis=1),
            "success": distance < 1.5,
            "evaluation": np.arange(first, first + len(solutions)),
            "expert": distance < 1.4,
            "ground_truth": solutions[:, :3] + solutions[:, 6:],
            "digest": rng.integers(2**64, size=len(solutions), dtype=np.uint64),
        }


@dataclass(frozen=True, eq=False)
class Generations:
    """The generations of one search, to be added again and again.

    Attributes:
        specs: The grids' shapes, by descriptor, in order.
        batches: One for each generation.
        filled: For each generation the share of all cells that were filled after it.
    """

    specs: dict[str, GridSpec]
    batches: list[BatchData]
    filled: list[float]

    def blocks(self) -> dict[str, slice]:
        """Return the generations by tens, with their names."""
        return {
            f"{start + 1}-{min(start + _BLOCK, len(self.batches))}": slice(start, start + _BLOCK)
            for start in range(0, len(self.batches), _BLOCK)
        }

    def new_archive(self) -> MultiBDArchive:
        """Make an empty archive with all grids."""
        archive = MultiBDArchive(
            descriptors={name: len(spec.dims) for name, spec in self.specs.items()},
            solution_dim=SolutionSpace().dim,
            extra_fields=_EXTRA,
            seed=0,
        )
        for name, spec in self.specs.items():
            archive.set_grid(name, spec)
        return archive

    def new_plain(self) -> list[GridArchive]:
        """Make empty archives of pyribs with the same cells and fields."""
        return [
            GridArchive(
                solution_dim=SolutionSpace().dim,
                dims=spec.dims,
                ranges=spec.ranges,
                extra_fields={"success": ((), np.bool_), **_EXTRA},
            )
            for spec in self.specs.values()
        ]

    def of_each_grid(self, batch: BatchData) -> list[BatchData]:
        """Return for each grid the rows of a batch that are defined there, its measures alone."""
        ends = np.cumsum([0, *(len(spec.dims) for spec in self.specs.values())])
        parts = []
        for start, end in pairwise(ends):
            rows = ~np.isnan(batch["measures"][:, start])
            part = {name: column[rows] for name, column in batch.items()}
            parts.append(part | {"measures": part["measures"][:, start:end]})
        return parts


def search(*, batch: int, grids: int, generations: int, seed: int) -> Generations:
    """Search a landscape: random solutions first, then mutants of the archive's elites."""
    rng, space = np.random.default_rng(seed), SolutionSpace()
    landscape = Landscape.draw(grids=grids, rng=rng)
    batches = [landscape.evaluate(space.sample(batch, rng=rng), first=0, rng=rng)]
    drawn = Generations(_learn_specs(landscape, batches[0]), batches, filled=[])
    archive = drawn.new_archive()
    cells = sum(spec.cells for spec in drawn.specs.values())
    for generation in range(generations):
        archive.add(**batches[generation])
        drawn.filled.append(sum(map(len, archive.grids.values())) / cells)
        if generation + 1 < generations:
            parents = archive.sample_elites(batch)["solution"]
            children = space.mutate(parents, rng=rng)
            first = batch * (generation + 1)
            batches.append(landscape.evaluate(children, first=first, rng=rng))
    return drawn


def measure(drawn: Generations) -> NDArray[np.float64]:
    """Add all generations to new archives of both kinds, and time each of the two.

    Returns:
        (2, generations) seconds, those of the multi-BD archive and those of plain pyribs.
    """
    archive, plain = drawn.new_archive(), drawn.new_plain()
    seconds = np.empty((2, len(drawn.batches)))
    for i, batch in enumerate(drawn.batches):
        parts = drawn.of_each_grid(batch)

        def add_to_archive(batch: BatchData = batch) -> None:
            archive.add(**batch)

        def add_to_plain(parts: Sequence[BatchData] = parts) -> None:
            for grid, part in zip(plain, parts, strict=True):
                grid.add(**part)

        # Whoever comes first warms the caches for the other.
        for which in (0, 1) if i % 2 else (1, 0):
            seconds[which, i] = _time((add_to_archive, add_to_plain)[which])
    return seconds


def table(drawn: Generations, rounds: Sequence[NDArray[np.float64]]) -> str:
    """Return the ratios as a Markdown table, by blocks of generations."""
    lines = [
        "| generations | cells filled | multi-BD archive | plain pyribs | ratio | its quartiles |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for name, block in drawn.blocks().items():
        ours, plain = np.concatenate([seconds[:, block] for seconds in rounds], axis=1)
        low, median, high = np.quantile(ours / plain, (0.25, 0.5, 0.75))
        lines.append(
            f"| {name} | {drawn.filled[block][-1]:.0%} | {np.median(ours) * 1e3:.1f} ms "
            f"| {np.median(plain) * 1e3:.1f} ms | {median:.2f} | {low:.2f} to {high:.2f} |"
        )
    return "\n".join(lines)


def _learn_specs(landscape: Landscape, batch: BatchData) -> dict[str, GridSpec]:
    specs, start = {}, 0
    for i, length in enumerate(landscape.lengths):
        block = batch["measures"][:, start : start + length]
        specs[f"d{i}"] = learn_grid_spec(block[~np.isnan(block[:, 0])], cells=_CELLS)
        start += length
    return specs


def _time(run: Callable[[], None]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


@click.command()
@click.option("--batch", type=click.IntRange(min=1), default=2_048, show_default=True)
@click.option("--grids", type=click.IntRange(min=1), default=16, show_default=True)
@click.option("--generations", type=click.IntRange(min=1), default=50, show_default=True)
@click.option("--rounds", type=click.IntRange(min=1), default=7, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, batch: int, grids: int, generations: int, rounds: int, seed: int) -> None:
    """Compare adding generations to the multi-BD archive and to as many plain pyribs grids."""
    drawn = search(batch=batch, grids=grids, generations=generations, seed=seed)
    click.echo(table(drawn, [measure(drawn) for _ in range(rounds)]))


if __name__ == "__main__":
    main()
