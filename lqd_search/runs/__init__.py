"""A run on disk: configuration, checkpoints, archive and figures."""
