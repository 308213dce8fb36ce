"""A task's scene as the browser draws it: coloured triangles that move with a body."""

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias, TypedDict

import mujoco
import numpy as np
from numpy.typing import NDArray

from lqd_search.report.numbers import whole
from lqd_search.report.solids import Solid, box, capsule, cylinder, joined

STEP = 1e-4
"""What one unit of a vertex or of a pose stands for: 0.1 mm, and the same of a quaternion."""

FIXED = -1
"""The body of what never moves; its vertices are in the world frame."""

# Larger meshes are made smaller: those of the arm have 130,000 triangles, a hundred times what a
# picture of this size can show.
_LARGE_MESH = 1_000
_CELL = 0.006
_SHOWN_GROUPS = 3

_Shape: TypeAlias = Callable[[NDArray[np.float64]], Solid]

_SHAPES: Mapping[int, _Shape] = {
    int(mujoco.mjtGeom.mjGEOM_PLANE): lambda size: box(np.array([size[0], size[1], 0.0])),
    int(mujoco.mjtGeom.mjGEOM_BOX): box,
    int(mujoco.mjtGeom.mjGEOM_SPHERE): lambda size: capsule(size[0], 0.0),
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): lambda size: capsule(size[0], size[1]),
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): lambda size: cylinder(size[0], size[1]),
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): lambda size: _stretched(capsule(1.0, 0.0), size),
}


class Part(TypedDict):
    """What of a body has one color: flat lists of vertices, in units of `STEP`, and of faces."""

    body: int
    color: list[float]
    vertices: list[int]
    faces: list[int]


def scene_parts(model: mujoco.MjModel, data: mujoco.MjData) -> list[Part]:
    """Return what a scene shows.

    Args:
        model: The scene.
        data: Any state of it whose kinematics are computed.

    Returns:
        Parts by body and color. The bodies that can move are given by their number.
    """
    groups: dict[tuple[int, tuple[float, ...]], list[Solid]] = {}
    for geom in np.flatnonzero(model.geom_group < _SHOWN_GROUPS).tolist():
        solid = _solid(model, geom)
        if solid is not None:
            body, placed = _placed(model, data, geom, solid)
            groups.setdefault((body, _color(model, geom)), []).append(placed)
    return [_part(body, color, joined(solids)) for (body, color), solids in groups.items()]


def moving_bodies(model: mujoco.MjModel) -> NDArray[np.int64]:
    """Return (b,) the numbers of the bodies that can move."""
    return np.flatnonzero(model.body_weldid > 0)


def _solid(model: mujoco.MjModel, geom: int) -> Solid | None:
    kind = int(model.geom_type[geom])
    if kind == int(mujoco.mjtGeom.mjGEOM_MESH):
        return _mesh(model, int(model.geom_dataid[geom]))
    shape = _SHAPES.get(kind)
    return None if shape is None else shape(model.geom_size[geom])


def _mesh(model: mujoco.MjModel, mesh: int) -> Solid:
    vertices = slice(model.mesh_vertadr[mesh], model.mesh_vertadr[mesh] + model.mesh_vertnum[mesh])
    faces = slice(model.mesh_faceadr[mesh], model.mesh_faceadr[mesh] + model.mesh_facenum[mesh])
    solid = Solid(
        model.mesh_vert[vertices].astype(np.float64), model.mesh_face[faces].astype(np.int64)
    )
    return solid.simplified(_CELL) if len(solid.faces) > _LARGE_MESH else solid


def _placed(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, solid: Solid
) -> tuple[int, Solid]:
    body = int(model.geom_bodyid[geom])
    if model.body_weldid[body] == 0:
        return FIXED, solid.moved(data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom])
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.geom_quat[geom])
    return body, solid.moved(rotation.reshape(3, 3), model.geom_pos[geom])


def _color(model: mujoco.MjModel, geom: int) -> tuple[float, ...]:
    material = int(model.geom_matid[geom])
    rgba: Any = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    if material >= 0 and (model.mat_texid[material] >= 0).any():
        # A texture is drawn as the mean of its pixels.
        rgba = _mean_color(model, int(model.mat_texid[material].max()))
    return tuple(round(float(value), 3) for value in rgba[:3])


def _mean_color(model: mujoco.MjModel, texture: int) -> NDArray[np.float64]:
    start, channels = model.tex_adr[texture], model.tex_nchannel[texture]
    pixels = model.tex_height[texture] * model.tex_width[texture]
    data = model.tex_data[start : start + pixels * channels].reshape(pixels, channels)
    return np.asarray(data[:, :3].mean(axis=0) / 255.0, dtype=np.float64)


def _part(body: int, color: tuple[float, ...], solid: Solid) -> Part:
    return {
        "body": body,
        "color": list(color),
        "vertices": whole(solid.vertices, step=STEP),
        "faces": solid.faces.ravel().tolist(),
    }


def _stretched(solid: Solid, size: NDArray[np.float64]) -> Solid:
    return Solid(solid.vertices * size, solid.faces)
