"""What of an archive comes from the expert."""

from benchmarks.instances.steered import describe_steering, shown


def test_what_the_expert_steers_is_marked():
    assert shown("handcrafted") == "handcrafted (expert)"
    assert [shown(name) for name in ("ours", "direct", "ga", "random")] == [
        *("ours", "direct", "ga", "random")
    ]


def test_the_inferred_condition_is_named_for_each_method():
    text = describe_steering(["direct", "ga", "ours", "ours_plus", "random", "ours"])

    assert text == (
        "The inferred condition is the one that steered the run: of `ours`, `ours_plus` and "
        "`random` it is the inferred success function; of `direct` and `ga` it is the success "
        "function of the direct reply."
    )


def test_what_the_expert_steers_is_explained_where_it_is_there():
    assert "(expert), those of `handcrafted`, are" in describe_steering(["handcrafted", "ours"])
    assert describe_steering(["handcrafted"]).startswith("Rows marked (expert)")
