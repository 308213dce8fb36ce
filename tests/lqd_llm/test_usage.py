import json
from typing import get_args

import anthropic.types
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_llm.model_options import DEFAULT_MODEL
from lqd_llm.usage import PRICES, Price, Usage, answer_usage, total_usage

REPORTED = {
    "input_tokens": 1_000,
    "cache_creation_input_tokens": 2_000,
    "cache_read_input_tokens": 4_000,
    "output_tokens": 3_000,
    "service_tier": "standard",
}

usages = st.builds(
    Usage,
    requests=st.integers(0, 9),
    input_tokens=st.integers(0, 99),
    cost=st.integers(0, 8).map(float),
    unpriced=st.sets(st.sampled_from("abc")).map(sorted).map(tuple),
)


def test_tokens_are_counted_and_priced():
    usage = answer_usage(REPORTED, model="claude-opus-5-5")

    assert usage.input_tokens == 1_000
    assert usage.cache_write_tokens == 2_000
    assert usage.cache_read_tokens == 4_000
    assert usage.output_tokens == 3_000
    # 1,000 at $4, 2,000 at $5, 4,000 at $0.20 and 3,000 at $20 per million
    assert usage.total_cost == pytest.approx(0.0748)


def test_model_with_a_date_has_the_price_of_its_name():
    dated = answer_usage(REPORTED, model="claude-haiku-4-5-20251001")

    assert dated.total_cost == answer_usage(REPORTED, model="claude-haiku-4-5").total_cost


def test_unknown_model_has_no_cost_and_says_so():
    usage = answer_usage(REPORTED, model="claude-next")

    assert usage.total_cost is None
    assert usage.output_tokens == 3_000
    assert usage.summary() == (
        "1 request, 7,000 tokens sent (4,000 of them from the cache), 3,000 received, "
        "cost unknown (no price of claude-next is known)"
    )


@pytest.mark.parametrize("reported", [None, {}, {"input_tokens": 3}, 7, "many"])
def test_usage_that_is_not_reported_is_not_zero(reported):
    usage = answer_usage(reported, model=DEFAULT_MODEL)

    assert usage == Usage(requests=1, unreported=1)
    assert usage.total_cost is None
    assert usage.summary() == "1 request, usage not reported"


def test_counts_of_another_type_count_nothing():
    usage = answer_usage({"input_tokens": "9", "output_tokens": None}, model=DEFAULT_MODEL)

    assert (usage.input_tokens, usage.output_tokens, usage.total_cost) == (0, 0, 0.0)


def test_sum_in_words():
    known = answer_usage(REPORTED, model="claude-opus-5-5")
    words = total_usage([known, known, Usage(requests=1, unreported=1)]).summary()

    assert words == (
        "3 requests, 14,000 tokens sent (8,000 of them from the cache), 6,000 received, "
        "about $0.15, usage of 1 not reported"
    )
    assert total_usage([]).summary() == "0 requests"


@given(usages, usages, usages)
def test_adding_is_associative_and_zero_is_neutral(a, b, c):
    assert (a + b) + c == a + (b + c) == total_usage([a, b, c])
    assert a + Usage() == Usage() + a == a


def test_dictionary_can_be_written_as_json():
    usage = answer_usage(REPORTED, model="claude-next")

    assert json.loads(json.dumps(usage.to_dict())) == {
        "requests": 1,
        "unreported": 0,
        "input_tokens": 1_000,
        "cache_write_tokens": 2_000,
        "cache_read_tokens": 4_000,
        "output_tokens": 3_000,
        "cost": None,
        "unpriced": ["claude-next"],
    }


def test_prices_are_of_models_that_the_sdk_knows():
    names, _ = get_args(anthropic.types.Model)

    assert set(PRICES) <= set(get_args(names))
    assert DEFAULT_MODEL in PRICES
    assert PRICES[DEFAULT_MODEL] == Price(input=4.0, cache_read=0.20, output=20.0)
