"""What archives are worth on occasions that nobody named beforehand: the paper's Equation 1.

`python -m benchmarks.instances RUN...` judges the archives of runs by instances of their tasks;
docs/benchmarks.md says what is declared beforehand and how to read the tables.
"""
