"""Where solutions are kept: grids, the multi-BD archive, and who wins a cell."""
