import numpy as np
import pytest

from lqd_envs import SolutionSpace
from lqd_search import EmitterError
from lqd_search.emitters.contact_variation import ContactVariation
from lqd_search.emitters.variation import Mutation

SPACE = SolutionSpace()
STILL = SolutionSpace(position_std=0.0, orientation_std=0.0, motion_std=0.0)
CONTACT = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])


def elites_of(contacts, *, seed=0):
    contacts = np.array(contacts, float)
    solutions = SPACE.sample(len(contacts), rng=np.random.default_rng(seed))
    return {"solution": solutions, "contact": contacts}


def vary(variation, elites, n, *, seed=1):
    parents = np.arange(n) % len(elites["solution"])
    return parents, variation(elites, parents, rng=np.random.default_rng(seed))


def test_the_start_stands_back_from_the_contact_along_the_motion():
    elites = elites_of([CONTACT])
    variation = ContactVariation(STILL, otherwise=Mutation(STILL), share=1.0)
    _, children = vary(variation, elites, 2000)
    assert SPACE.feasible(children).all()
    inside = (np.abs(children[:, :3]) < 1.0).all(axis=1)
    assert inside.mean() > 0.9
    # In metres: a unit of the start is 0.1 m, of the motion 0.2 m.
    start, motion = 0.1 * children[inside, :3], 0.2 * children[inside, 6:]
    way = 0.1 * CONTACT[:3] - start
    length = np.linalg.norm(motion, axis=1)
    back = (way * motion).sum(axis=1) / length**2
    # The contact lies on the motion, before its middle.
    assert np.allclose(way, back[:, None] * motion, atol=1e-12)
    assert (back.min(), back.max()) == pytest.approx((0.0, 0.5), abs=0.01)
    assert np.allclose(children[:, 3:6], CONTACT[3:], atol=1e-12)
    assert (length.min(), length.max()) == pytest.approx((0.05, 0.20), abs=0.003)


def test_a_share_of_the_parents_that_touched_it_is_varied_so():
    elites = elites_of([CONTACT, [np.nan] * 6])
    parents, children = vary(ContactVariation(STILL, otherwise=Mutation(STILL)), elites, 4000)
    changed = (children != elites["solution"][parents]).any(axis=1)
    assert not changed[parents == 1].any()
    assert changed[parents == 0].mean() == pytest.approx(0.25, abs=0.03)


def test_where_nothing_was_touched_all_children_are_made_otherwise():
    elites = elites_of([[np.nan] * 6] * 3)
    _, children = vary(ContactVariation(SPACE, otherwise=Mutation(SPACE), share=1.0), elites, 9)
    expected = SPACE.mutate(elites["solution"][np.arange(9) % 3], rng=np.random.default_rng(1))
    assert np.array_equal(children, expected)


@pytest.mark.parametrize("n", [0, 1, 300])
def test_children_are_feasible_and_the_same_each_time(n):
    far = [[9.0, -9.0, 0.5, 1.7, -3.0, 4.0], CONTACT, [np.nan] * 6]
    elites = elites_of(far)
    for column in elites.values():
        column.setflags(write=False)
    variation = ContactVariation(SPACE, otherwise=Mutation(SPACE))
    _, children = vary(variation, elites, n)
    assert children.shape == (n, 9)
    assert SPACE.feasible(children).all()
    assert np.array_equal(vary(variation, elites, n)[1], children)


@pytest.mark.parametrize(
    "options", [{"share": -0.1}, {"share": 1.1}, {"share": np.nan}, {"farthest": -1.0}]
)
def test_parts_outside_their_interval_are_refused(options):
    with pytest.raises(EmitterError, match="Expected a share from 0 to 1 and a finite distance"):
        ContactVariation(SPACE, otherwise=Mutation(SPACE), **options)


def test_an_archive_without_contacts_is_refused():
    elites = {"solution": SPACE.sample(3, rng=np.random.default_rng(0)), "success": np.ones(3)}

    with pytest.raises(
        EmitterError,
        match=r"^Expected the field 'contact' among those of the elites, but there are only "
        r"solution, success; store it: add \{'contact': \(\(6,\), np\.float64\)\} to the pass",
    ):
        vary(ContactVariation(SPACE, otherwise=Mutation(SPACE)), elites, 3)
