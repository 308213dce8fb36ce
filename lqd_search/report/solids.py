"""The shapes that scenes are made of, as triangles."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Points: TypeAlias = NDArray[np.float64]

_AROUND = 24
_CAP = 6


@dataclass(frozen=True, eq=False)
class Solid:
    """A surface made of triangles.

    Attributes:
        vertices: (v, 3) float64, m.
        faces: (f, 3) int64, rows of `vertices`, counterclockwise as seen from outside.
    """

    vertices: Points
    faces: NDArray[np.int64]

    def moved(self, rotation: Points, position: Points) -> "Solid":
        """Return it turned by a (3, 3) rotation matrix and then moved by a (3,) vector."""
        return Solid(self.vertices @ rotation.T + position, self.faces)

    def simplified(self, cell: float) -> "Solid":
        """Return it with all vertices of each cube of that side, in m, made one at their mean."""
        corner = np.floor(self.vertices / cell).astype(np.int64)
        _, cluster = np.unique(corner, axis=0, return_inverse=True)
        counts = np.bincount(cluster)
        sums = [np.bincount(cluster, weights=column) for column in self.vertices.T]
        faces = cluster[self.faces]
        a, b, c = faces.T
        faces = faces[(a != b) & (b != c) & (c != a)]
        # Of triangles that have become the same, one: the first corner is made the smallest.
        turn = np.argmin(faces, axis=1)
        faces = np.stack([faces[np.arange(len(faces)), (turn + i) % 3] for i in range(3)], axis=1)
        return Solid(np.stack(sums, axis=1) / counts[:, None], np.unique(faces, axis=0))


def joined(solids: list[Solid]) -> Solid:
    """Return several solids, at least one, as one."""
    starts = np.cumsum([0, *(len(solid.vertices) for solid in solids[:-1])])
    return Solid(
        np.concatenate([solid.vertices for solid in solids]),
        np.concatenate([s.faces + start for s, start in zip(solids, starts, strict=True)]),
    )


def box(half_size: Points) -> Solid:
    """Return a box about the origin of the given (3,) half sizes."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Solid(signs * half_size, _triangles(np.array(quads)))


def capsule(radius: float, half_length: float) -> Solid:
    """Return a capsule along z; a sphere, where its half length is 0."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 2 * _CAP)
    shift = np.where(np.arange(2 * _CAP) < _CAP, -half_length, half_length)
    return _turned(radius * np.cos(angle), radius * np.sin(angle) + shift)


def cylinder(radius: float, half_length: float) -> Solid:
    """Return a cylinder along z."""
    radii = np.array([0.0, radius, radius, 0.0])
    return _turned(radii, half_length * np.array([-1.0, -1.0, 1.0, 1.0]))


def _turned(radii: Points, heights: Points) -> Solid:
    """Return the outline turned about z: (k,) radii and heights from the bottom to the top."""
    angle = np.arange(_AROUND) * (2 * np.pi / _AROUND)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    flat = radii[:, None, None] * ring
    height = np.broadcast_to(heights[:, None, None], (len(radii), _AROUND, 1))
    i, j = np.mgrid[: len(radii) - 1, :_AROUND]
    k = (j + 1) % _AROUND
    corners = [i * _AROUND + j, i * _AROUND + k, (i + 1) * _AROUND + k, (i + 1) * _AROUND + j]
    quads = np.stack([corner.ravel() for corner in corners], axis=1)
    return Solid(np.concatenate([flat, height], axis=2).reshape(-1, 3), _triangles(quads))


def _triangles(quads: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
