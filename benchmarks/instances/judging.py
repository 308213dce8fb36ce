"""Judging the archive of a run by instances: simulate its motions, and count those that solve."""

from collections.abc import Callable, Iterator, Sequence
from time import perf_counter
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.candidates import Candidates, candidates_of
from benchmarks.instances.fingerprint import fingerprint
from benchmarks.instances.judged_run import JudgedRun
from benchmarks.instances.judgement import FilterFigures, Judgement
from benchmarks.instances.provenance import Provenance
from lqd_envs import rollout
from lqd_envs.instances import Instance
from lqd_search.adaptation import solving

_CHUNK = 512


class Judging:
    """Judges the archive of one run by instances of its task.

    Args:
        run: The run.
        cap: Most motions of the archive that are drawn for simulation in each instance whose
            dynamics are its own. What selectors choose is simulated beside them.
        threads: Threads to simulate on.
    """

    def __init__(self, run: JudgedRun, *, cap: int, threads: int) -> None:
        self._run, self._cap, self._threads = run, cap, threads
        seed = crc32(run.label.digest.encode())
        self._filters = candidates_of(run.archive, cap=cap, seed=seed)
        self._declared = fingerprint(cap)
        self._provenance = Provenance.here(threads=threads)

    def judge(self, instances: Sequence[Instance]) -> Iterator[Judgement]:
        """Judge instances; those whose dynamics are the task's share one simulation.

        Args:
            instances: Instances of the run's task.
        """
        shared = [instance for instance in instances if instance.same_dynamics]
        if shared:
            yield from self._judge_shared(shared)
        for instance in instances:
            if not instance.same_dynamics:
                yield self._judge_own(instance)

    @property
    def _every(self) -> NDArray[np.intp]:
        return np.unique(np.concatenate([f.rows for f in self._filters.values()]))

    @property
    def _sampled(self) -> NDArray[np.intp]:
        return np.unique(np.concatenate([f.simulated for f in self._filters.values()]))

    def _judge_shared(self, instances: Sequence[Instance]) -> Iterator[Judgement]:
        fields, rows = self._run.archive.fields, self._every
        solved = np.zeros((len(instances), len(self._run.archive)), dtype=bool)
        different = 0
        begun = perf_counter()
        for start in range(0, len(rows), _CHUNK):
            chunk = rows[start : start + _CHUNK]
            motions = rollout(self._run.task, fields["solution"][chunk], threads=self._threads)
            different += int((motions.digests() != fields["digest"][chunk]).sum())
            for i, instance in enumerate(instances):
                solved[i, chunk] = instance.solved_by(motions)
        share = (perf_counter() - begun) / len(instances)
        for i, instance in enumerate(instances):
            yield self._judgement(
                instance, solved[i], judged=lambda f: f.rows, different=different, seconds=share
            )

    def _judge_own(self, instance: Instance) -> Judgement:
        archive, rows = self._run.archive, self._sampled
        solved = np.zeros(len(archive), dtype=bool)
        begun = perf_counter()
        if len(rows):
            solved[rows] = solving(
                archive.fields["solution"][rows],
                task=self._run.task,
                instance=instance,
                threads=self._threads,
            )
        seconds = perf_counter() - begun
        return self._judgement(
            instance, solved, judged=lambda f: f.sample, different=0, seconds=seconds
        )

    def _judgement(
        self,
        instance: Instance,
        solved: NDArray[np.bool_],
        *,
        judged: Callable[[Candidates], NDArray[np.intp]],
        different: int,
        seconds: float,
    ) -> Judgement:
        evaluation = self._run.archive.fields["evaluation"]
        return Judgement(
            run=self._run.label,
            instance=instance.name,
            cap=self._cap,
            declared=self._declared,
            solved=bool(solved.any()),
            different=different,
            filters={
                name: FilterFigures.of(found, solved, judged=judged(found), evaluation=evaluation)
                for name, found in self._filters.items()
            },
            provenance=self._provenance.took(seconds),
        )
