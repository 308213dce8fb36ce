"""Made-up runs with switches."""

import pytest

from benchmarks.switches.switch_cell import OURS, SwitchCell


@pytest.fixture(scope="session")
def make_cell():
    def make(task="faucet", switches=OURS, seed=100, **changes) -> SwitchCell:
        figures = {
            "evaluations": 20_480,
            "batch_size": 512,
            "success_archive_size": 99,
            "ground_truth_cells": 99,
            "archive_size": 5_000,
            "valid": 10_000,
            "seconds": 100.0,
        }
        return SwitchCell(task, switches, seed, **figures | changes)

    return make
