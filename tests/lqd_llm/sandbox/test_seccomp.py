"""The filter, run by an interpreter of its own: on this machine only one architecture can be."""

import re
import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lqd_llm.sandbox.seccomp import filter_program
from lqd_llm.sandbox.system_calls import ALLOWED, CHECKED, FATAL

ALLOW, REFUSE, KILL = 0x7FFF0000, 0x00050001, 0x80000000
MACHINES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
PLACE = {"x86_64": 0, "aarch64": 1}
PROT_READ, PROT_WRITE, PROT_EXEC = 1, 2, 4
PRIVATE, ANONYMOUS = 2, 32


def verdict(machine, number, *arguments, architecture=None):
    """What the filter answers to a call."""
    told = MACHINES[machine] if architecture is None else architecture
    padded = (*arguments, *[0] * (6 - len(arguments)))
    data = struct.pack("<IIQ6Q", number, told, 0, *padded)
    program = [struct.unpack("<HBBI", code) for code in filter_program(machine, answers=3)]
    at = word = 0
    while True:
        code, if_true, if_false, k = program[at]
        at += 1
        match code:
            case 0x20:
                (word,) = struct.unpack_from("<I", data, k)
            case 0x15:
                at += if_true if word == k else if_false
            case 0x35:
                at += if_true if word >= k else if_false
            case 0x45:
                at += if_true if word & k else if_false
            case 0x06:
                return k


@pytest.mark.parametrize("machine", MACHINES)
def test_only_what_is_on_the_list_is_answered(machine):
    place = PLACE[machine]
    allowed = {numbers[place] for numbers in ALLOWED.values()}
    checked = {numbers[place] for numbers in CHECKED.values()}
    fatal = {numbers[place] for numbers in FATAL.values()} - {None}
    assert not allowed & fatal
    for number in set(range(600)) - checked:
        expected = ALLOW if number in allowed else KILL if number in fatal else REFUSE
        assert verdict(machine, number) == expected


@pytest.mark.parametrize("machine", MACHINES)
def test_arguments_decide_about_files_and_memory(machine):
    calls = {name: numbers[PLACE[machine]] for name, numbers in CHECKED.items()}
    assert verdict(machine, calls["read"], 0) == ALLOW
    assert verdict(machine, calls["read"], 1) == REFUSE
    assert verdict(machine, calls["write"], 3) == ALLOW
    assert verdict(machine, calls["write"], 1) == REFUSE
    assert verdict(machine, calls["write"], 2) == REFUSE
    both = PROT_READ | PROT_WRITE
    assert verdict(machine, calls["mmap"], 0, 9, both, PRIVATE | ANONYMOUS) == ALLOW
    assert verdict(machine, calls["mmap"], 0, 9, both, PRIVATE, 3) == REFUSE
    assert verdict(machine, calls["mmap"], 0, 9, PROT_EXEC, PRIVATE | ANONYMOUS) == REFUSE
    assert verdict(machine, calls["mprotect"], 0, 9, both) == ALLOW
    assert verdict(machine, calls["mprotect"], 0, 9, both | PROT_EXEC) == REFUSE


@pytest.mark.parametrize("machine", MACHINES)
@given(number=st.integers(0, 2**32 - 1), architecture=st.integers(0, 2**32 - 1))
def test_another_architecture_ends_the_worker(machine, number, architecture):
    expected = KILL if architecture != MACHINES[machine] else verdict(machine, number)
    assert verdict(machine, number, architecture=architecture) == expected


@given(st.integers(0, 600))
def test_the_other_numbers_of_x86_end_the_worker(number):
    assert verdict("x86_64", 0x40000000 | number) == KILL


# On aarch64 the numbers are those of the generic header.
@pytest.mark.parametrize(
    ("column", "header"),
    [(0, "x86_64-linux-gnu/asm/unistd_64.h"), (1, "asm-generic/unistd.h")],
)
def test_the_numbers_are_those_of_the_headers(column, header):
    path = Path("/usr/include", header)
    if not path.exists():
        pytest.skip(f"{path} is not installed")
    found = re.findall(r"#define __NR(?:3264)?_(\w+)\s+(\d+)", path.read_text())
    known = {name: int(number) for name, number in found}
    for table in (ALLOWED, CHECKED, FATAL):
        for name, numbers in table.items():
            assert numbers[column] == known.get(name), name
