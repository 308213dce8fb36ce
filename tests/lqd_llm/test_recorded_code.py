from lqd_llm import available_samples, is_recorded, load_recording, recorded_sources
from lqd_llm.recordings import available_tasks


def test_all_code_that_ships_is_recorded(task, sample):
    for exchange in load_recording(task.name, sample=sample).exchanges.values():
        for function in exchange.reply.functions:
            assert is_recorded(function.code)
            assert is_recorded(function.code.rstrip())
            assert not is_recorded(f"{function.code}0")
            assert not is_recorded(f" {function.code}")


def test_no_other_code_is():
    assert not is_recorded("")
    assert not is_recorded("def fitness(info):\n    return 0.0\n")
    assert "" not in recorded_sources()


def test_tasks_are_those_that_have_samples(task):
    assert task.name in available_tasks()
    assert all(available_samples(name) for name in available_tasks())
