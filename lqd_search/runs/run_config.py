"""What a run was asked to do, and with what: enough to do it again."""

import json
import platform
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from typing import Any

from lqd_search.runs.json_form import check_form, known_keys

RUN_FORMAT = 4
"""Version of the run folder's layout; a reader refuses one that it does not know."""

_PACKAGES = (
    "lqd-envs",
    "gymnasium",
    "gymnasium-robotics",
    "mujoco",
    "numpy",
    "pymoo",
    "ribs",
    "scipy",
)


def installed_versions() -> dict[str, str]:
    """Return the versions of Python and of every package whose version can change a result."""
    return {"python": platform.python_version()} | {name: version(name) for name in _PACKAGES}


NO_MODEL = "none"
"""The `llm` of a run that the expert steered."""


@dataclass(frozen=True)
class RunConfig:
    """A run's configuration, as it stands in `config.json`.

    Attributes:
        task: Id of the task.
        instruction: The sentence that the language model was given.
        method: Name of the method.
        seed: Seed of everything random.
        sample: Which of several inferences of the task.
        evaluations: Evaluations to spend.
        batch_size: Solutions in a generation.
        explored: Number of fitness functions that there are, for the exploration of `ours`.
        failure_competition: How two failures compete for a cell: `fitness` or `coin`.
        switches: The switches of `ours_plus` that are on, in alphabetical order; none for others.
        llm: Where the functionals come from: `replay`, `record` or `live`, `folder` for one that
            the user named, `none` where the expert steers.
        prompt_hashes: For each kind of inference, the hash of its prompts.
        model: The model that wrote the functionals, as far as it is known.
        provenance: How its replies were taken.
        functionals: Digest of the functionals, by which it shows when their files were changed.
        lengths: How many numbers each quantity gives, by name, and the direct descriptor under
            `direct.descriptor`.
        dropped: One sentence for each function of the replies that is not used.
        repaired: One sentence for each function that the model had to repair.
        remarks: One sentence for each function that adds little.
        usage: What the model's answers took: tokens by kind, and `cost` in USD where it is known.
        usage_in_words: The same in a few words; empty where no model was asked.
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
    explored: int
    failure_competition: str
    llm: str
    prompt_hashes: dict[str, str]
    model: str
    provenance: str
    functionals: str
    lengths: dict[str, int]
    switches: tuple[str, ...] = ()
    dropped: tuple[str, ...] = ()
    repaired: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    usage: dict[str, int | float | None] = field(default_factory=dict)
    usage_in_words: str = ""
    versions: dict[str, str] = field(default_factory=installed_versions)
    format: int = RUN_FORMAT

    @property
    def steered_by_expert(self) -> bool:
        """Whether the expert steered the run, and nothing was inferred for it."""
        return self.llm == NO_MODEL

    def to_json(self) -> str:
        """Return the text of `config.json`."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> "RunConfig":
        """Return the configuration that was written; keys that it does not know are left out.

        Raises:
            FormError: A key is missing, or its value is of another type.
        """
        check_form(data, cls)
        known = known_keys(data, cls)
        names = ("switches", "dropped", "repaired", "remarks")
        return cls(**{**known, **{name: tuple(known[name]) for name in names}})

    def changed_versions(self) -> dict[str, tuple[str, str]]:
        """Return which versions are others here: for each its name, the run's and this one's."""
        here = installed_versions()
        names = [*self.versions, *(name for name in here if name not in self.versions)]
        pairs = {name: (self.versions.get(name, "none"), here.get(name, "none")) for name in names}
        return {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}
