"""The scenes: the robot at its table, and one object each, built with MjSpec."""
