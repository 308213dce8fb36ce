"""The sensors that put perception into `sensordata`, and the reading of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from lqd_envs.perception import Columns, PerceptionSchema
from lqd_envs.scenes.panda import GRIPPER, GRIPPER_SITE, ROBOT_BASE
from lqd_envs.scenes.workspace import TABLE

OBSTACLES = "obstacles"
"""Name of the body that holds an instance's obstacles, in the scenes that have any."""

_FOUND = 1 << int(mujoco.mjtConDataField.mjCONDATA_FOUND)
_DISTANCE = 1 << int(mujoco.mjtConDataField.mjCONDATA_DIST)
_CLOSEST = 1
_ROBOT_CONTACT = "robot_contact"
_OBJECT_CONTACT = "object_contact"
_OBSTACLE_CONTACT = "robot_obstacle"


def add_sensors(
    spec: mujoco.MjSpec, *, schema: PerceptionSchema, base: str, fast_points: Sequence[str]
) -> None:
    """Add to `spec` every sensor that `SensorReader` reads.

    Args:
        spec: A scene with robot, table and object.
        schema: The task's names; its links are bodies and its joints are joints of `spec`.
        base: The body whose frame is the object's base.
        fast_points: Sites on the object whose speed is watched, the farthest of each moving part.
    """
    objects, kinds = mujoco.mjtObj, mujoco.mjtSensor

    def add(name: str, kind: mujoco.mjtSensor, objtype: mujoco.mjtObj, objname: str) -> None:
        spec.add_sensor(name=name, type=kind, objtype=objtype, objname=objname)

    def add_contact(name: str, *, first: tuple[mujoco.mjtObj, str], **second: object) -> None:
        spec.add_sensor(
            name=name,
            type=kinds.mjSENS_CONTACT,
            objtype=first[0],
            objname=first[1],
            intprm=[_FOUND | _DISTANCE, _CLOSEST, 1],
            **second,
        )

    add("object_position", kinds.mjSENS_FRAMEPOS, objects.mjOBJ_XBODY, base)
    add("object_orientation", kinds.mjSENS_FRAMEQUAT, objects.mjOBJ_XBODY, base)
    add("gripper_position", kinds.mjSENS_FRAMEPOS, objects.mjOBJ_SITE, GRIPPER_SITE)
    add("gripper_orientation", kinds.mjSENS_FRAMEQUAT, objects.mjOBJ_SITE, GRIPPER_SITE)
    for joint in schema.joints:
        add(f"joint:{joint.name}", kinds.mjSENS_JOINTPOS, objects.mjOBJ_JOINT, joint.name)
    for point in fast_points:
        add(f"speed:{point}", kinds.mjSENS_FRAMELINVEL, objects.mjOBJ_SITE, point)
    table = {"reftype": objects.mjOBJ_GEOM, "refname": TABLE}
    if not schema.fixed:
        add_contact("object_table", first=(objects.mjOBJ_XBODY, base), **table)
    if not schema.fixed or _has_obstacles(spec):
        add_contact(_OBJECT_CONTACT, first=(objects.mjOBJ_XBODY, base))
    add_contact("robot_table", first=(objects.mjOBJ_XBODY, ROBOT_BASE), **table)
    for link in schema.links:
        add_contact(
            f"gripper:{link}",
            first=(objects.mjOBJ_XBODY, GRIPPER),
            reftype=objects.mjOBJ_BODY,
            refname=link,
        )
    add_contact(_ROBOT_CONTACT, first=(objects.mjOBJ_XBODY, ROBOT_BASE))
    if _has_obstacles(spec):
        add_contact(
            _OBSTACLE_CONTACT,
            first=(objects.mjOBJ_XBODY, ROBOT_BASE),
            reftype=objects.mjOBJ_BODY,
            refname=OBSTACLES,
        )


def _has_obstacles(spec: mujoco.MjSpec) -> bool:
    return spec.body(OBSTACLES) is not None


@dataclass(frozen=True)
class SensorReader:
    """Turns `sensordata` into perception, for one moment as for many motions.

    Attributes:
        schema: The task's names.
        slices: Where each sensor's values are in `sensordata`.
    """

    schema: PerceptionSchema
    slices: dict[str, slice]

    @classmethod
    def of(cls, model: mujoco.MjModel, *, schema: PerceptionSchema) -> "SensorReader":
        """Return the reader for a compiled scene."""
        names = [model.sensor(i).name for i in range(model.nsensor)]
        starts = model.sensor_adr
        ends = starts + model.sensor_dim
        return cls(
            schema=schema,
            slices={n: slice(int(a), int(b)) for n, a, b in zip(names, starts, ends, strict=True)},
        )

    def columns(self, sensordata: NDArray[np.float64]) -> Columns:
        """Return the perception in `sensordata`.

        Args:
            sensordata: (N, T, nsensordata) values of N motions at T moments.

        Returns:
            Columns of shape (N, T, ...).
        """
        moments = sensordata.shape[:2]
        links = [self._touches(sensordata, f"gripper:{link}") for link in self.schema.links]
        joints = [
            sensordata[..., self.slices[f"joint:{joint.name}"].start]
            for joint in self.schema.joints
        ]
        return Columns(
            schema=self.schema,
            object_position=sensordata[..., self.slices["object_position"]],
            object_orientation=self._orientation(sensordata, "object_orientation"),
            object_table_contact=(
                np.ones(moments, dtype=bool)
                if self.schema.fixed
                else self._touches(sensordata, "object_table")
            ),
            robot_table_contact=self._touches(sensordata, "robot_table"),
            gripper_position=sensordata[..., self.slices["gripper_position"]],
            gripper_orientation=self._orientation(sensordata, "gripper_orientation"),
            gripper_contacts=np.stack(links, axis=-1),
            joint_positions=(
                np.stack(joints, axis=-1) if joints else np.zeros((*moments, 0), dtype=np.float64)
            ),
        )

    def robot_touches(self, sensordata: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return (...) bool: whether the robot touches anything.

        Its hand, fingers and links 6 and 7 can touch the table and the object; obstacles, where
        the scene has any, every link that moves.
        """
        return self._touches(sensordata, _ROBOT_CONTACT)

    @property
    def sees_obstacles(self) -> bool:
        """Whether the scene has obstacles."""
        return _OBSTACLE_CONTACT in self.slices

    def robot_touches_obstacle(self, sensordata: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return (...) bool: whether any link of the robot touches an obstacle of the scene."""
        if not self.sees_obstacles:
            return np.zeros(sensordata.shape[:-1], dtype=bool)
        return self._touches(sensordata, _OBSTACLE_CONTACT)

    def depth(self, sensordata: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (...) float64: the deepest contact of robot or object, in m, at least 0."""
        depths = [
            np.where(
                self._touches(sensordata, name), -sensordata[..., self.slices[name].start + 1], 0.0
            )
            for name in (_ROBOT_CONTACT, _OBJECT_CONTACT)
            if name in self.slices
        ]
        return np.asarray(np.maximum(np.max(depths, axis=0), 0.0))

    def speed(self, sensordata: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (...) float64: speed of the object's fastest watched point, in m/s."""
        speeds = [
            np.linalg.norm(sensordata[..., part], axis=-1)
            for name, part in self.slices.items()
            if name.startswith("speed:")
        ]
        return np.max(speeds, axis=0) if speeds else np.zeros(sensordata.shape[:-1])

    def quaternion(self, sensordata: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """Return (..., 4) float64: a frame's unit quaternion, w first and at least 0."""
        quaternion = sensordata[..., self.slices[name]]
        return np.where(quaternion[..., :1] < 0.0, -quaternion, quaternion)

    def _touches(self, sensordata: NDArray[np.float64], name: str) -> NDArray[np.bool_]:
        return sensordata[..., self.slices[name].start] > 0.0

    def _orientation(self, sensordata: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        quaternion = sensordata[..., self.slices[name]]
        rotation = Rotation.from_quat(quaternion.reshape(-1, 4), scalar_first=True)
        # Rz(yaw) Ry(pitch) Rx(roll) is scipy's extrinsic "xyz".
        angles = rotation.as_euler("xyz", suppress_warnings=True)
        return np.asarray(angles).reshape(*quaternion.shape[:-1], 3)
