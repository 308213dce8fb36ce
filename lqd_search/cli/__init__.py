"""The `lqd` command."""
