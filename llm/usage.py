"""What answers took: tokens, and what they cost."""

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import reduce
from operator import add
from typing import Any


@dataclass(frozen=True)
class Price:
    """The list price of a model's tokens, in USD per million.

    Attributes:
        input: Tokens that are sent.
        cache_read: Tokens that are sent and found in the prompt cache.
        output: Tokens of the reply, those spent on thinking included.
    """

    input: float
    cache_read: float
    output: float

    @property
    def cache_write(self) -> float:
        """Tokens that are sent and put into the prompt cache for five minutes."""
        return 1.25 * self.input


PRICES: Mapping[str, Price] = {
    "claude-fable-5-2": Price(8.0, 0.20, 40.0),
    "claude-fable-5-1": Price(10.0, 0.25, 50.0),
    "claude-fable-5": Price(10.0, 1.0, 50.0),
    "claude-mythos-5-1": Price(10.0, 0.25, 50.0),
    "claude-mythos-5": Price(10.0, 1.0, 50.0),
    "claude-opus-5-5": Price(4.0, 0.20, 20.0),
    "claude-opus-5": Price(5.0, 0.50, 25.0),
    "claude-opus-4-8": Price(5.0, 0.50, 25.0),
    "claude-opus-4-7": Price(5.0, 0.50, 25.0),
    "claude-opus-4-6": Price(5.0, 0.50, 25.0),
    "claude-opus-4-5": Price(5.0, 0.50, 25.0),
    "claude-sonnet-5-5": Price(2.0, 0.10, 10.0),
    "claude-sonnet-5": Price(2.0, 0.20, 10.0),
    "claude-sonnet-4-6": Price(3.0, 0.30, 15.0),
    "claude-sonnet-4-5": Price(3.0, 0.30, 15.0),
    "claude-haiku-5-5": Price(0.10, 0.01, 0.50),
    "claude-haiku-4-5": Price(1.0, 0.10, 5.0),
}
"""Anthropic's list prices of November 2026, for prompts as short as ours; discounts and surcharges
are left out."""

_SNAPSHOT_DATE = re.compile(r"-[0-9]{8}$")
_MILLION = 1_000_000


@dataclass(frozen=True)
class Usage:
    """Tokens and cost of a number of answers; two of them can be added.

    Attributes:
        requests: How many answers there are.
        unreported: How many of them came without their usage. Their tokens and cost are unknown
            and not in the sums.
        input_tokens: Tokens that were sent and neither read from the prompt cache nor put there.
        cache_write_tokens: Tokens that were sent and put into the prompt cache.
        cache_read_tokens: Tokens that were sent and read from the prompt cache.
        output_tokens: Tokens of the replies, those spent on thinking included.
        cost: Their list price in USD, as far as prices are known.
        unpriced: Models of which `PRICES` has no price, in order; their tokens are not in `cost`.
    """

    requests: int = 0
    unreported: int = 0
    input_tokens: int = 0
    cache_write_tokens: int = 0
    cache_read_tokens: int = 0
    output_tokens: int = 0
    cost: float = 0.0
    unpriced: tuple[str, ...] = ()

    def __add__(self, other: "Usage") -> "Usage":
        return Usage(
            requests=self.requests + other.requests,
            unreported=self.unreported + other.unreported,
            input_tokens=self.input_tokens + other.input_tokens,
            cache_write_tokens=self.cache_write_tokens + other.cache_write_tokens,
            cache_read_tokens=self.cache_read_tokens + other.cache_read_tokens,
            output_tokens=self.output_tokens + other.output_tokens,
            cost=self.cost + other.cost,
            unpriced=tuple(sorted({*self.unpriced, *other.unpriced})),
        )

    @property
    def total_cost(self) -> float | None:
        """The cost in USD, or None where that of some answer is unknown."""
        return None if self.unreported or self.unpriced else self.cost

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON can hold them, and `total_cost` as `cost`."""
        return {**asdict(self), "cost": self.total_cost, "unpriced": list(self.unpriced)}

    def summary(self) -> str:
        """Return the usage in words: how many requests and tokens, and about what they cost."""
        requests = f"{self.requests} request{'' if self.requests == 1 else 's'}"
        if self.unreported == self.requests:
            return f"{requests}, usage not reported" if self.requests else requests
        sent = self.input_tokens + self.cache_write_tokens + self.cache_read_tokens
        parts = [
            requests,
            f"{sent:,} tokens sent ({self.cache_read_tokens:,} of them from the cache)",
            f"{self.output_tokens:,} received",
            self._cost_in_words(),
        ]
        if self.unreported:
            parts.append(f"usage of {self.unreported} not reported")
        return ", ".join(parts)

    def _cost_in_words(self) -> str:
        if self.unpriced:
            return f"cost unknown (no price of {', '.join(self.unpriced)} is known)"
        return f"about ${self.cost:.2f}"


def answer_usage(reported: object, *, model: str) -> Usage:
    """Return the usage of one answer.

    Args:
        reported: What the API reported under `usage`; anything else counts as not reported.
        model: The model that answered, as the API reported it.
    """
    if not isinstance(reported, Mapping) or "output_tokens" not in reported:
        return Usage(requests=1, unreported=1)
    tokens = Usage(
        requests=1,
        input_tokens=_count(reported, "input_tokens"),
        cache_write_tokens=_count(reported, "cache_creation_input_tokens"),
        cache_read_tokens=_count(reported, "cache_read_input_tokens"),
        output_tokens=_count(reported, "output_tokens"),
    )
    price = PRICES.get(_SNAPSHOT_DATE.sub("", model))
    if price is None:
        return tokens + Usage(unpriced=(model,))
    millionths = (
        price.input * tokens.input_tokens
        + price.cache_write * tokens.cache_write_tokens
        + price.cache_read * tokens.cache_read_tokens
        + price.output * tokens.output_tokens
    )
    return tokens + Usage(cost=millionths / _MILLION)


def total_usage(usages: "list[Usage]") -> Usage:
    """Return the sum of a list of usages."""
    return reduce(add, usages, Usage())


def _count(reported: Mapping[str, Any], name: str) -> int:
    value = reported.get(name)
    return value if isinstance(value, int) else 0
