"""The paper's tables with error bars, and ablations of `ours`.

`python -m benchmarks.tables` runs methods on tasks with seeds, and `python -m
benchmarks.tables.ablations` the variants of `ours`; docs/benchmarks.md says what is declared
beforehand and how to read them.
"""
