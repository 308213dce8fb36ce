"""What stands in the report on archives and instances beside the tables."""

from benchmarks.instances.candidates import most_looked_at
from benchmarks.instances.declared import SUBSETS
from benchmarks.instances.fixed_motion import SPLITS
from benchmarks.instances.results import Results
from benchmarks.instances.steered import describe_steering
from benchmarks.instances.two_way import CONFIDENCE, RESAMPLES
from benchmarks.tables.made_on import describe_made_on
from lqd_search.adaptation import SELECTORS


def describe(results: Results) -> str:
    """Return what was judged and how to read it."""
    evaluations = sorted({run.evaluations for run in results.judgements})
    selectors = "; ".join(f"`{s.name}`, {s.summary}" for s in SELECTORS.values())
    sentences = [
        f"{len(results.judgements)} runs of {' and '.join(f'{n:,}' for n in evaluations)} "
        f"evaluations, judged by the first instances of seed {results.seed}. A motion solves an "
        "instance if the task's expert calls it a success and what the instance asks is met, "
        "simulated in the scene of the instance.",
        "Motions are those of the archive that the inferred condition approves, which is all that a"
        " robot has, and beside them those that the expert approves. "
        + describe_steering(run.method for run in results.judgements),
        f"Selectors see neither the instance nor the expert's word: {selectors}; `random` is the "
        "expectation of a random choice.",
        "The control is one fixed motion of each archive, whatever the instance: that of the "
        "highest fitness, which is the first choice of `best`; the one that solves the most "
        "instances of the kind, chosen in hindsight, so that no fixed motion does better; and the "
        "one that solves the most of one half of the instances, judged on the other half, "
        f"{SPLITS} times at random and both ways round. Of equally good ones it is the one "
        "that was evaluated first, and all that were looked at in every instance can be chosen. "
        "What is chosen in hindsight is an upper bound: how far some motion of those looked at is "
        "above it is the least that having them all is worth. What is chosen on one half is what "
        "to expect in an instance of the kind that was not known when the motion was chosen, by as "
        "many others as half of them are; by more of them a better one might be chosen.",
        f"In instances with obstacles and changes, at most {results.cap:,} motions of an archive "
        "are drawn at random, once for each run, and looked at together with what selectors choose,"
        f" at most {most_looked_at(results.cap):,}. Where an archive has more, as the tables say, "
        "the probability that some motion of the whole archive solves an instance is at least what "
        "is given, and so is that of the fixed one in hindsight. In the others all motions are "
        "judged.",
        "Of random subsets, the probability that some motion solves is exact; selectors choose from"
        f" {SUBSETS} random subsets of each size. An archive that is smaller is taken whole.",
        f"Brackets are {CONFIDENCE:.0%} intervals of {RESAMPLES:,} bootstrap resamples of runs and "
        "of instances. Where a method has a single run, they are of instances alone. A fixed motion"
        " is not chosen anew in a resample.",
    ]
    if results.different:
        sentences.append(
            f"{results.different:,} motions, simulated again in the task itself, were not bit for "
            "bit what their run saw: other versions or another processor made it."
        )
    return "\n\n".join(sentences)


def describe_making(results: Results) -> str:
    """Return on what the judgements were made, and how long that took."""
    made = [one.provenance for by_name in results.judgements.values() for one in by_name.values()]
    if not made:
        return "Nothing was judged."
    threads = " or ".join(map(str, sorted({one.threads for one in made})))
    sentences = [
        f"{len(made):,} judgements took {sum(one.seconds for one in made) / 3600:.1f} hours, with "
        f"simulation on {threads} {'thread' if threads == '1' else 'threads'}.",
        *describe_made_on(made),
        f"Commit: {' / '.join(dict.fromkeys(one.commit or 'unknown' for one in made))}.",
    ]
    return "\n\n".join(sentences)
