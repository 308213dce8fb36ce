import numpy as np
import pytest

from lqd_search.report.solids import box, capsule, cylinder, joined


def volume(solid):
    """Signed volume: positive where all faces are counterclockwise as seen from outside."""
    a, b, c = (solid.vertices[solid.faces[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


@pytest.mark.parametrize(
    ("solid", "expected"),
    [
        (box(np.array([0.5, 1.0, 1.5])), 6.0),
        (cylinder(1.0, 0.5), np.pi),
        (capsule(1.0, 0.0), 4.0 / 3.0 * np.pi),
        (capsule(1.0, 0.5), 7.0 / 3.0 * np.pi),
    ],
    ids=["box", "cylinder", "sphere", "capsule"],
)
def test_a_solid_is_closed_faces_outwards_and_has_about_its_volume(solid, expected):
    assert volume(solid) == pytest.approx(expected, rel=0.05)
    # Each edge that is not a point is passed once in each direction.
    places = np.unique(solid.vertices.round(9), axis=0, return_inverse=True)[1][solid.faces]
    edges = np.concatenate([places[:, [0, 1]], places[:, [1, 2]], places[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    counts = {(int(a), int(b)): 0 for a, b in edges}
    for a, b in edges:
        counts[int(a), int(b)] += 1
    assert all(counts.get((b, a)) == n for (a, b), n in counts.items())


def test_a_moved_solid_is_turned_first():
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

    moved = box(np.array([2.0, 1.0, 1.0])).moved(quarter, np.array([10.0, 0.0, 0.0]))

    assert np.ptp(moved.vertices, axis=0).tolist() == [2.0, 4.0, 2.0]
    assert moved.vertices.mean(axis=0).tolist() == [10.0, 0.0, 0.0]


def test_joined_solids_keep_their_faces():
    whole = joined([box(np.ones(3)), box(np.ones(3)).moved(np.eye(3), np.full(3, 5.0))])

    assert volume(whole) == pytest.approx(16.0)


def test_a_simplified_solid_keeps_its_place_and_has_no_face_twice():
    sphere = capsule(1.0, 0.0)

    simple = sphere.simplified(0.5)

    assert len(simple.faces) < len(sphere.faces)
    assert len(np.unique(np.sort(simple.faces, axis=1), axis=0)) == len(simple.faces)
    assert volume(simple) == pytest.approx(volume(sphere), rel=0.2)
    assert np.abs(simple.vertices.mean(axis=0)).max() < 0.1
