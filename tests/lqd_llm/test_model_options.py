import math
from typing import get_args, get_type_hints

import anthropic.types
import pytest
from anthropic.types import OutputConfigParam

from lqd_envs.errors import LQDError
from lqd_llm.errors import ModelOptionsError
from lqd_llm.model_options import DEFAULT_MODEL, EFFORTS, ModelOptions


def test_defaults():
    options = ModelOptions()

    assert options.model == DEFAULT_MODEL == "claude-opus-5-5"
    assert options.effort is None
    assert (options.max_tokens, options.timeout, options.max_retries) == (20_000, 600.0, 4)


def test_the_sdk_knows_the_default_model_and_the_efforts():
    names, _ = get_args(anthropic.types.Model)
    effort, _ = get_args(get_type_hints(OutputConfigParam)["effort"])

    assert DEFAULT_MODEL in get_args(names)
    assert set(EFFORTS) <= set(get_args(effort))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"model": " "},
            "Expected the name of a model, but got ' '; pass one such as claude-opus-5-5.",
        ),
        (
            {"effort": "extreme"},
            "Expected an effort, but got 'extreme'; pass one of low, medium, high, xhigh, max, or "
            "none for the model's own default.",
        ),
        ({"max_tokens": 0}, "Expected max_tokens of at least 1, but got 0; raise it."),
        (
            {"timeout": 0.0},
            "Expected a finite timeout of more than 0 seconds, but got 0.0; change it.",
        ),
        ({"max_retries": -1}, "Expected max_retries of at least 0, but got -1; pass 0"),
    ],
)
def test_values_out_of_range_are_refused(changes, message):
    with pytest.raises(ModelOptionsError) as caught:
        ModelOptions(**changes)

    assert str(caught.value).startswith(message)
    assert isinstance(caught.value, LQDError)


@pytest.mark.parametrize("timeout", [math.nan, math.inf, -1.0])
def test_timeout_is_a_positive_finite_number(timeout):
    with pytest.raises(ModelOptionsError, match="Expected a finite timeout of more than 0 seconds"):
        ModelOptions(timeout=timeout)
