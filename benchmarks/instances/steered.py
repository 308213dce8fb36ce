"""What of a method's archive comes from the expert, and how its rows say so."""

from collections.abc import Iterable

from lqd_search.methods.steering import DIRECT, EXPERT, MESH, STEERING

_SUCCESS = {
    MESH: "the inferred success function",
    DIRECT: "the success function of the direct reply",
}


def shown(method: str) -> str:
    """Return a method's name as a table shows it, marked where the expert steered it."""
    return f"{method} (expert)" if STEERING[method] == EXPERT else method


def describe_steering(methods: Iterable[str]) -> str:
    """Return in words whose success condition the inferred filter is, method by method.

    Args:
        methods: Names of the methods.
    """
    by_steering: dict[str, list[str]] = {}
    for method in dict.fromkeys(methods):
        by_steering.setdefault(STEERING[method], []).append(f"`{method}`")
    parts = [
        f"of {_listed(by_steering[steering])} it is {what}"
        for steering, what in _SUCCESS.items()
        if steering in by_steering
    ]
    sentences = []
    if parts:
        sentences.append(
            f"The inferred condition is the one that steered the run: {'; '.join(parts)}."
        )
    if EXPERT in by_steering:
        sentences.append(
            f"Rows marked (expert), those of {_listed(by_steering[EXPERT])}, are of no method that "
            "a robot could use: success, fitness and measures of these archives are the expert's. "
            "Both filters are the expert's condition there, and `best` and `diverse` choose with an"
            " expert's knowledge."
        )
    return " ".join(sentences)


def _listed(names: list[str]) -> str:
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))
