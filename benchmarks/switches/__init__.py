"""What each switch of `ours_plus` gains on its own: `python -m benchmarks.switches --out DIR`."""
