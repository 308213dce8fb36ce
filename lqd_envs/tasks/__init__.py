"""The tasks, one a file, and their registry."""
