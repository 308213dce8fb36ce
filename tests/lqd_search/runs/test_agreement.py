import pytest

from lqd_search.runs.agreement import Agreement


@pytest.mark.parametrize(
    ("both", "inferred_only", "expert_only", "agreement"),
    [
        (3, 1, 0, ("75.0%", "100.0%")),
        (0, 2, 3, ("0.0%", "0.0%")),
        (0, 0, 3, ("-", "0.0%")),
        (0, 2, 0, ("0.0%", "-")),
        (0, 0, 0, ("-", "-")),
    ],
)
def test_precision_and_recall(both, inferred_only, expert_only, agreement):
    counts = {"both": both, "inferred_only": inferred_only, "expert_only": expert_only}

    assert Agreement.of(counts | {"neither": 9}) == Agreement(*agreement)
