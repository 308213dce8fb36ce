"""The errors that this project raises on purpose."""


class LQDError(Exception):
    """Root of every error that LQD raises on purpose.

    Its message says what was expected, what came, the names available where a name was wrong, and
    what to do. The `lqd` command prints it as one sentence and exits with status 2.
    """
