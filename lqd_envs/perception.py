"""The perception API: what is perceived at one moment, and the text that describes it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

Vector3 = tuple[float, float, float]


class Info(TypedDict):
    """What is perceived at one moment; the same eight keys in every task.

    Lengths are in metres, angles in radians, positions in the world frame: the robot's base at the
    origin, x away from it, y to its left, z up, the table top at z = 0. An orientation
    (roll, pitch, yaw) stands for the rotation matrix Rz(yaw) Ry(pitch) Rx(roll).

    Attributes:
        object_position: Base of the object.
        object_orientation: Roll, pitch and yaw of the object's base; zero at the start, but for the
            yaw where an instance has turned the object.
        object_table_contact: Whether the object touches the table.
        robot_table_contact: Whether the robot's hand, a finger, or link 6 or 7 touches the table;
            nothing else of it can.
        gripper_position: The point midway between the fingertips.
        gripper_orientation: Roll, pitch and yaw of the gripper; zero when the fingers point
            straight down and close along y.
        gripper_contacts: For each link of the object, whether the gripper touches it.
        joint_positions: For each joint of the object, its position in rad or m; 0 is closed.
    """

    object_position: Vector3
    object_orientation: Vector3
    object_table_contact: bool
    robot_table_contact: bool
    gripper_position: Vector3
    gripper_orientation: Vector3
    gripper_contacts: dict[str, bool]
    joint_positions: dict[str, float]


Infos = list[Info]
"""The moments of one motion in order, from its start to its end."""

SuccessFunction = Callable[[Infos], bool]
FitnessFunction = Callable[[Info], float]
TimestampFunction = Callable[[Infos], Info | None]
QuantityFunction = Callable[[Info], tuple[float, ...]]
DescriptorFunction = Callable[[Infos], tuple[float, ...] | None]


@dataclass(frozen=True)
class ObjectJoint:
    """One joint of a task's object.

    Attributes:
        name: The joint's name, a key of `Info.joint_positions`.
        unit: `"rad"` for a hinge, `"m"` for a slide.
        upper: Position at which it is fully open; 0 is closed.
    """

    name: str
    unit: str
    upper: float


@dataclass(frozen=True)
class PerceptionSchema:
    """The names with which one task fills the perception API.

    Attributes:
        base: What the object's base is, in words.
        fixed: Whether the object is fixed to the table.
        links: Names of the object's links, the keys of `Info.gripper_contacts`.
        joints: The object's joints, the keys of `Info.joint_positions`.
    """

    base: str
    fixed: bool
    links: tuple[str, ...]
    joints: tuple[ObjectJoint, ...] = ()

    def text(self) -> str:
        """Return the perception API as the language model is shown it.

        Returns:
            The definition of a typed dictionary, one commented line per key.
        """
        never_moves = "; it is fixed to the table and never moves" if self.fixed else ""
        always_true = "; always true, it is fixed there" if self.fixed else ""
        links = ", ".join(f'"{link}"' for link in self.links)
        joints = "; ".join(
            f'"{joint.name}" ({joint.unit}, from 0, closed, to {joint.upper:.2f}, fully open)'
            for joint in self.joints
        )
        lines = [
            (
                "object_position: tuple[float, float, float]",
                f"x, y, z of the object's base ({self.base}{never_moves})",
            ),
            (
                "object_orientation: tuple[float, float, float]",
                "roll, pitch, yaw of the object's base; zero at the start",
            ),
            ("object_table_contact: bool", f"the object touches the table{always_true}"),
            (
                "robot_table_contact: bool",
                "any part of the robot, its fixed base aside, touches the table",
            ),
            (
                "gripper_position: tuple[float, float, float]",
                "x, y, z of the point midway between the fingertips",
            ),
            (
                "gripper_orientation: tuple[float, float, float]",
                "roll, pitch, yaw of the gripper; zero when the fingers point straight down and "
                "close along y",
            ),
            (
                "gripper_contacts: dict[str, bool]",
                f"for each link of the object, whether the gripper touches it; keys: {links}",
            ),
            (
                "joint_positions: dict[str, float]",
                "for each joint of the object, its position; keys: "
                f"{joints or 'none, the dictionary is empty'}",
            ),
        ]
        return "class Info(TypedDict):\n" + "\n".join(
            f"    {declaration:<50}# {comment}" for declaration, comment in lines
        )


@dataclass(frozen=True)
class Columns:
    """The perception of N motions at T moments, one array per key of `Info`.

    Attributes:
        schema: Names of the links and joints that the last two arrays run over.
        object_position: (N, T, 3) float64, m.
        object_orientation: (N, T, 3) float64, rad.
        object_table_contact: (N, T) bool.
        robot_table_contact: (N, T) bool.
        gripper_position: (N, T, 3) float64, m.
        gripper_orientation: (N, T, 3) float64, rad.
        gripper_contacts: (N, T, links) bool.
        joint_positions: (N, T, joints) float64, rad or m.
    """

    schema: PerceptionSchema
    object_position: NDArray[np.float64]
    object_orientation: NDArray[np.float64]
    object_table_contact: NDArray[np.bool_]
    robot_table_contact: NDArray[np.bool_]
    gripper_position: NDArray[np.float64]
    gripper_orientation: NDArray[np.float64]
    gripper_contacts: NDArray[np.bool_]
    joint_positions: NDArray[np.float64]

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return the eight arrays by key of `Info`, in its order."""
        return {key: getattr(self, key) for key in Info.__annotations__}

    def rows(self, rows: NDArray[np.intp]) -> "Columns":
        """Return the chosen motions alone."""
        chosen = {key: array[rows] for key, array in self.arrays().items()}
        return Columns(schema=self.schema, **chosen)

    def until(self, moment: int) -> "Columns":
        """Return the motions as they were at a moment: that one is the last that is left."""
        seen = {key: array[:, : moment + 1] for key, array in self.arrays().items()}
        return Columns(schema=self.schema, **seen)

    def spread(self, rows: NDArray[np.intp], *, n: int) -> "Columns":
        """Return n motions of which these are the given rows, and all others zero or False."""
        spread = {key: np.zeros((n, *a.shape[1:]), a.dtype) for key, a in self.arrays().items()}
        for key, array in self.arrays().items():
            spread[key][rows] = array
        return Columns(schema=self.schema, **spread)

    def infos(self, i: int) -> Infos:
        """Return motion `i` as a list of T dictionaries of plain floats, bools and tuples."""
        links = self.schema.links
        joints = [joint.name for joint in self.schema.joints]
        return [
            Info(
                object_position=(position[0], position[1], position[2]),
                object_orientation=(orientation[0], orientation[1], orientation[2]),
                object_table_contact=on_table,
                robot_table_contact=robot_on_table,
                gripper_position=(gripper[0], gripper[1], gripper[2]),
                gripper_orientation=(rpy[0], rpy[1], rpy[2]),
                gripper_contacts=dict(zip(links, contacts, strict=True)),
                joint_positions=dict(zip(joints, positions, strict=True)),
            )
            for (
                position,
                orientation,
                on_table,
                robot_on_table,
                gripper,
                rpy,
                contacts,
                positions,
            ) in zip(
                self.object_position[i].tolist(),
                self.object_orientation[i].tolist(),
                self.object_table_contact[i].tolist(),
                self.robot_table_contact[i].tolist(),
                self.gripper_position[i].tolist(),
                self.gripper_orientation[i].tolist(),
                self.gripper_contacts[i].tolist(),
                self.joint_positions[i].tolist(),
                strict=True,
            )
        ]
