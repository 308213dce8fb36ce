"""From solutions to values: functionals, simulation, and where they run."""
