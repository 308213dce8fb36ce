import numpy as np

from lqd_search.archives.worth import worth_of


def test_without_an_objective_an_elite_is_worth_the_least():
    objective = np.array([0.5, np.nan, -1e308])

    assert worth_of(objective).tolist() == [0.5, -np.inf, -1e308]
    assert np.isnan(objective[1])
