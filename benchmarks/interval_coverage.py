"""How often do the 95 % intervals hold the truth? `python -m benchmarks.interval_coverage`."""

import click
import numpy as np
from numpy.typing import NDArray
from scipy.special import expit
from scipy.stats import norm

from benchmarks.instances.fixed_motion import on_the_other_half
from benchmarks.instances.two_way import two_way
from benchmarks.tables.comparison import effect_size
from benchmarks.tables.markdown import markdown_table

_INSTANCES = 20
_MOTIONS = 300
_SORTS = 3
_SEEDS = (5, 10)
_A12 = (0.5, 0.8, 0.92)
_SPREADS = {
    "runs differ": (1.0, 0.0),
    "instances differ": (0.0, 1.0),
    "both differ alike": (1.0, 1.0),
}


def rate_coverage(
    *,
    runs: int,
    spread: tuple[float, float],
    repetitions: int,
    rng: np.random.Generator,
) -> float:
    """Return how often the interval of a mean over runs and instances holds its true value.

    Effects of runs and of instances, and a rest of standard deviation 0.5, are normal.

    Args:
        runs: How many runs.
        spread: Standard deviation of the runs' effects, and of the instances'.
        repetitions: How many intervals are made.
        rng: Draws the values and the resamples.
    """
    held = 0
    for _ in range(repetitions):
        of_runs = spread[0] * rng.standard_normal((runs, 1, 1))
        of_instances = spread[1] * rng.standard_normal((1, _INSTANCES, 1))
        rest = 0.5 * rng.standard_normal((runs, _INSTANCES, 1))
        [rate] = two_way(of_runs + of_instances + rest, rng=rng)
        held += rate.low <= 0.0 <= rate.high
    return held / repetitions


def fixed_motion_coverage(*, runs: int, repetitions: int, rng: np.random.Generator) -> float:
    """Return how often the interval of one fixed motion's worth holds its true value.

    The motion is that of `on_the_other_half`. Instances are of three sorts, and each motion is good
    for one of them; whether it solves one of that sort depends on how good it is, how easy the
    instance is, and chance. The true value is the mean over all repetitions.

    Args:
        runs: How many runs, each with an archive of its own.
        repetitions: How many intervals are made.
        rng: Draws the archives, the instances and the resamples.
    """
    rates = []
    for _ in range(repetitions):
        solves = _made_up_archives(runs, rng)
        values = np.array([on_the_other_half(archive) for archive in solves])
        rates += two_way(values[:, :, None], rng=rng)
    truth = np.mean([rate.value for rate in rates])
    return float(np.mean([rate.low <= truth <= rate.high for rate in rates]))


def _made_up_archives(runs: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Return (runs, instances, motions) which motions solve."""
    shares = rng.dirichlet(np.full(_SORTS, 5.0), size=runs)
    good_for = np.stack([rng.choice(_SORTS, size=_MOTIONS, p=share) for share in shares])
    quality = 0.5 + 0.5 * rng.standard_normal((runs, 1)) + rng.standard_normal((runs, _MOTIONS))
    sort = rng.integers(_SORTS, size=(1, _INSTANCES, 1))
    ease = rng.standard_normal((1, _INSTANCES, 1))
    chance = expit(quality[:, None, :] + ease) * (good_for[:, None, :] == sort)
    return np.asarray(rng.random(chance.shape) < chance)


def effect_coverage(*, seeds: int, a12: float, repetitions: int, rng: np.random.Generator) -> float:
    """Return how often the interval of A12 holds its true value, for normal values.

    Args:
        seeds: How many values there are in each group.
        a12: The true value.
        repetitions: How many intervals are made.
        rng: Draws the values and the resamples.
    """
    shift = np.sqrt(2.0) * norm.ppf(a12)
    held = 0
    for _ in range(repetitions):
        one, other = rng.standard_normal((2, seeds))
        effect = effect_size(one + shift, other, rng=rng)
        held += effect.low <= a12 <= effect.high
    return held / repetitions


@click.command()
@click.option("--repetitions", type=click.IntRange(min=1), default=600, show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
def main(*, repetitions: int, seed: int) -> None:
    """Make intervals of made-up values, and count those that hold the true figure.

    It is known, but for the fixed motion, where it is the mean over all repetitions.
    """
    rng = np.random.default_rng(seed)
    rows = []
    for words, spread in _SPREADS.items():
        for n in _SEEDS:
            share = rate_coverage(runs=n, spread=spread, repetitions=repetitions, rng=rng)
            rows.append((f"rate over {_INSTANCES} instances, {words}", str(n), f"{share:.1%}"))
    for a12 in _A12:
        for n in _SEEDS:
            share = effect_coverage(seeds=n, a12=a12, repetitions=repetitions, rng=rng)
            rows.append((f"A12 of {a12}", str(n), f"{share:.1%}"))
    for n in _SEEDS:
        share = fixed_motion_coverage(runs=n, repetitions=repetitions, rng=rng)
        rows.append(("one fixed motion, the best on the other half", str(n), f"{share:.1%}"))
    click.echo(markdown_table(("interval of", "seeds", "holds the truth"), rows, words=1))


if __name__ == "__main__":
    main()
