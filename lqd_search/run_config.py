"""What a run was asked to do, and with what: enough to do it again."""

import json
import platform
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from typing import Any

RUN_FORMAT = 1
"""Version of the run folder's layout; a reader refuses one that it does not know."""

_PACKAGES = ("lqd-envs", "gymnasium", "gymnasium-robotics", "mujoco", "numpy", "ribs", "scipy")


def installed_versions() -> dict[str, str]:
    """Return the versions of Python and of every package whose version can change a result."""
    return {"python": platform.python_version()} | {name: version(name) for name in _PACKAGES}


@dataclass(frozen=True)
class RunConfig:
    """A run's configuration, as it stands in `config.json`.

    Attributes:
        task: Id of the task.
        instruction: The sentence that the language model was given.
        method: Name of the method.
        seed: Seed of everything random.
        sample: Which recorded sample of the model's replies.
        evaluations: Evaluations to spend.
        batch_size: Solutions in a generation.
        prompt_hashes: For each kind of inference, the hash of its prompts.
        model: The model that wrote the functionals, as far as it is known.
        provenance: How its replies were taken.
        dropped: One sentence for each function of the replies that is not used.
        versions: Of Python and of the packages.
        format: Version of the run folder's layout.
    """

    task: str
    instruction: str
    method: str
    seed: int
    sample: int
    evaluations: int
    batch_size: int
    prompt_hashes: dict[str, str]
    model: str
    provenance: str
    dropped: tuple[str, ...]
    versions: dict[str, str] = field(default_factory=installed_versions)
    format: int = RUN_FORMAT

    def to_json(self) -> str:
        """Return the text of `config.json`."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> "RunConfig":
        """Return the configuration that was written.

        Raises:
            TypeError: A key is missing or unknown.
        """
        return cls(**{**data, "dropped": tuple(data.get("dropped", ()))})
