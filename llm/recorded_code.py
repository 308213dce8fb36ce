"""The code that ships with the package, in its recordings."""

from functools import cache

from lqd_llm.recordings import available_samples, available_tasks, load_recording


@cache
def recorded_sources() -> frozenset[str]:
    """Return the code of every function in the recordings that ship with the package.

    White space at its end is left out: a file that a function was written to ends with one newline.

    Raises:
        RecordingError: A recording cannot be read or is not of the right form.
    """
    return frozenset(
        function.code.rstrip()
        for task in available_tasks()
        for sample in available_samples(task)
        for exchange in load_recording(task, sample=sample).exchanges.values()
        for function in exchange.reply.functions
    )


def is_recorded(code: str) -> bool:
    """Return whether code is that of a function that ships with the package.

    Such code was read and tried before it was shipped; any other is run in a complete sandbox only,
    unless its user says otherwise.

    Raises:
        RecordingError: A recording cannot be read or is not of the right form.
    """
    return code.rstrip() in recorded_sources()
