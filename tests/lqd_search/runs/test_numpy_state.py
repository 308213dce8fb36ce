import io
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from lqd_search.runs.numpy_state import (
    BIT_GENERATORS,
    NumPyStateError,
    array_of,
    bit_generator_of,
    describe,
    dtype_of,
    generator_of,
    reduce_numpy,
)
from lqd_search.runs.state_pickle import pickle_state, unpickle_state

LEAVES = st.one_of(
    hnp.boolean_dtypes(),
    hnp.integer_dtypes(endianness="?"),
    hnp.floating_dtypes(endianness="?"),
    hnp.complex_number_dtypes(endianness="?"),
    hnp.unicode_string_dtypes(endianness="?"),
    hnp.byte_string_dtypes(),
    hnp.datetime64_dtypes(),
    hnp.timedelta64_dtypes(),
)
SHAPES = st.sampled_from([(), (2,), (1, 3)])


@st.composite
def records(draw):
    fields = draw(st.lists(st.tuples(LEAVES, SHAPES), min_size=1, max_size=4))
    named = [(f"f{i}", *field) for i, field in enumerate(fields)]
    return np.dtype(named, align=draw(st.booleans()))


DTYPES = st.one_of(LEAVES, records())


def again(value):
    return unpickle_state(pickle_state(value))


@given(hnp.arrays(DTYPES, hnp.array_shapes(min_dims=0, min_side=0, max_side=4)))
def test_an_array_comes_back_bit_for_bit(array):
    read = again(array)
    assert (read.dtype, read.shape) == (array.dtype, array.shape)
    # What lies between the fields of a record is no part of it.
    for name in array.dtype.names or (...,):
        assert read[name].tobytes() == array[name].tobytes()
    assert pickle_state(read) == pickle_state(array)
    assert read.flags.writeable


@given(DTYPES)
def test_a_dtype_comes_back(dtype):
    read = again(dtype)
    assert read == dtype
    assert read.isalignedstruct == dtype.isalignedstruct


def test_an_aligned_record_comes_back_with_its_gaps():
    fields = [("flag", "?"), ("solution", "<f8", (3,)), ("n", "<i8")]
    records = np.zeros(4, np.dtype(fields, align=True))
    records["solution"] = np.arange(12.0).reshape(4, 3)
    read = again(records)
    assert read.dtype == records.dtype
    assert read.dtype.itemsize == 40
    assert np.array_equal(read, records)
    assert again(records[2]) == records[2]


@pytest.mark.parametrize(
    "scalar",
    [
        np.float64(0.1),
        np.bool_(True),
        np.uint8(7),
        np.str_("é"),
        np.datetime64(3, "s"),
        np.int64(-1),
    ],
)
def test_a_scalar_comes_back(scalar):
    read = again(scalar)
    assert type(read) is type(scalar)
    assert read == scalar


def test_records_in_records_come_back_without_what_is_between_their_fields():
    inner = np.dtype([("flag", "?"), ("x", "<f8", (2,))], align=True)
    outer = np.dtype([("flag", "?"), ("inner", inner, (3,)), ("n", "<i2")], align=True)
    clean, dirty = np.zeros(2, outer), np.frombuffer(b"\xff" * 2 * outer.itemsize, outer).copy()
    for array in (clean, dirty):
        array["inner"]["x"] = np.arange(12.0).reshape(2, 3, 2)
        array["inner"]["flag"], array["flag"], array["n"] = True, False, 7
    assert pickle_state(clean) == pickle_state(dirty)
    assert pickle_state(clean[1]) == pickle_state(dirty[1])
    assert np.array_equal(again(dirty), clean)


def test_order_in_memory_and_write_protection_are_kept():
    column_wise = np.asfortranarray(np.arange(6.0).reshape(2, 3))
    protected = np.arange(3)
    protected.flags.writeable = False
    strided = np.arange(12).reshape(3, 4)[:, ::2]
    one, two, three = again([column_wise, protected, strided])
    assert one.flags.f_contiguous
    assert one.flags.writeable
    assert not two.flags.writeable
    assert np.array_equal(three, strided)


def test_arrays_that_are_one_stay_one():
    array = np.zeros(3)
    one, two = again([array, array])
    assert one is two


@pytest.mark.parametrize("name", BIT_GENERATORS)
def test_a_generator_goes_on_and_spawns_as_it_would_have(name):
    rng = np.random.Generator(getattr(np.random, name)(np.random.SeedSequence([3, 4])))
    rng.spawn(2)
    # One of 32 bits leaves the other half of a draw behind.
    rng.integers(9, size=3, dtype=np.uint32)
    twin = again(rng)
    for one, two in [(rng, twin), *zip(rng.spawn(2), twin.spawn(2), strict=True)]:
        assert one.integers(9, size=3, dtype=np.uint32).tolist() == (
            two.integers(9, size=3, dtype=np.uint32).tolist()
        )
        assert one.normal(size=5).tolist() == two.normal(size=5).tolist()


def test_generators_that_share_their_bits_go_on_sharing_them():
    rng = np.random.default_rng(2)
    one, two = again([rng, np.random.Generator(rng.bit_generator)])
    assert [one.random(), two.random()] == rng.random(2).tolist()


@pytest.mark.parametrize(
    "value",
    [np.array([{}], object), np.dtype(object), np.dtype([("a", object)]), np.zeros(1, "V8")],
)
def test_objects_in_an_array_are_refused(value):
    with pytest.raises(NumPyStateError, match=r"it holds the dtype .*none of numbers or text"):
        reduce_numpy(value)


def test_titles_of_fields_are_refused():
    with pytest.raises(NumPyStateError, match="whose fields have titles"):
        reduce_numpy(np.dtype([(("title", "name"), "<f8")]))


def test_what_is_not_numpys_is_left_alone():
    assert [reduce_numpy(value) for value in (1, "a", [np.zeros(2)], np.float64, np)] == [None] * 5


@pytest.mark.parametrize(
    "description",
    ["|O8", "O", "f8,O", "<f8 ", "|V8", 3, ("|O8", (2,)), (("a",), ("|O8",), (0,), 8, False), ()],
)
def test_no_file_makes_a_dtype_of_objects(description):
    with pytest.raises(NumPyStateError, match="none of numbers or text"):
        dtype_of(description)


def test_no_file_makes_an_array_larger_than_its_bytes():
    with pytest.raises(TypeError, match="too small"):
        array_of("<f8", (3,), "C", True, b"12345678")
    with pytest.raises(NumPyStateError, match="it holds list where bytes belongs"):
        array_of("<f8", (1,), "C", True, [1.0])


def test_no_file_makes_a_generator_of_something_else():
    with pytest.raises(NumPyStateError, match="it holds int where BitGenerator belongs"):
        generator_of(3)
    with pytest.raises(NumPyStateError, match="it holds int where SeedSequence belongs"):
        bit_generator_of("PCG64", {}, 3)
    with pytest.raises(NumPyStateError, match="the bit generator 'default_rng'"):
        bit_generator_of("default_rng", {}, np.random.SeedSequence(1))


@given(hnp.arrays(np.float64, hnp.array_shapes(min_dims=1, max_dims=3)))
def test_the_forms_serve_any_pickle(array):
    function, arguments = reduce_numpy(array)
    arguments = pickle.load(io.BytesIO(pickle.dumps(arguments)))
    assert function(*arguments).tobytes() == array.tobytes()
    assert describe(array.dtype) == "<f8"
