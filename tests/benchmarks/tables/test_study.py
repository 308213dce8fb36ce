import pytest

from benchmarks.tables.ablation_study import ABLATIONS, CROSSINGS
from benchmarks.tables.study import METHODS, TABLES, TASKS, StudyError


def test_each_scale_runs_every_method_on_every_task_with_every_seed():
    for study in TABLES.values():
        assert len(set(study.cells)) == len(study.cells)
        assert set(study.cells) == {
            cell for task in TASKS for method in METHODS for cell in study.group(task, method)
        }


def test_the_scales_are_those_that_were_asked_for():
    sizes = {name: (s.evaluations, len(s.seeds)) for name, s in TABLES.items()}
    assert sizes == {"smoke": (320, 1), "small": (20_480, 10), "paper": (102_400, 5)}


def test_at_the_scale_of_the_paper_drawer_and_grasp_are_complete_first():
    tasks = [cell.task for cell in TABLES["paper"].cells]

    assert set(tasks[: len(tasks) // 2]) == {"drawer", "grasp"}


def test_the_family_compares_ours_with_each_other_method_by_task_and_measure():
    family = TABLES["small"].family

    assert len(set(family)) == 4 * 2 * 5
    assert {hypothesis.one for hypothesis in family} == {"ours"}
    assert {h.measure for h in family} == {"success_archive_size", "ground_truth_cells"}


def test_some_cells_can_be_chosen():
    cells = TABLES["small"].chosen(tasks=["push"], methods=["ga", "ours"], seeds=[3])

    assert [(c.task, c.method, c.seed, c.sample) for c in cells] == [
        ("push", "ours", 3, 3),
        ("push", "ga", 3, 3),
    ]


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ({"tasks": ["kettle"]}, "Expected some of .*grasp.*, but got kettle; leave it out"),
        ({"seeds": [4, 10]}, "Expected some of 0, .*9, which .*, but got 10; leave it out"),
        ({"methods": ["best"]}, "Expected some of ours, direct, .*, but got best"),
    ],
)
def test_what_is_not_declared_is_refused(choice, message):
    with pytest.raises(StudyError, match=message):
        TABLES["small"].chosen(**{"tasks": None, "methods": None, "seeds": None} | choice)


def test_the_ablations_have_each_recording_with_each_of_three_seeds():
    study, crossing = ABLATIONS["small"], CROSSINGS["small"]

    for task in study.tasks:
        crossed = crossing.cells(task)
        assert {(cell.sample, cell.seed) for cell in crossed} == {
            (sample, seed) for sample in range(5) for seed in range(3)
        }
        assert set(crossed) <= set(study.cells)
    # Six variants with ten seeds; of the fifteen crossed cells three are among them.
    assert len(study.cells) == len(set(study.cells)) == 2 * (6 * 10 + 12)
    assert len(study.family) == 2 * 2 * 5
