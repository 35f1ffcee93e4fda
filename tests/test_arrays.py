"""What all parts reduce arrays with, against numpy itself."""

import platform
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from z2r.arrays import by_column, lengths, products, stack_columns, times

LONG = 40_000  # rows: several blocks of what BLAS multiplies in one thread

shapes = st.tuples(st.integers(1, 9), st.integers(1, 9))


def noise(*shape: int) -> np.ndarray:
    return np.random.default_rng(sum(shape)).normal(size=shape)


@given(shapes, st.sampled_from([0, 1, 7, LONG]))
def test_products_and_times_are_those_of_numpy(shape, n):
    one, other = (noise(n, size) for size in shape)
    np.testing.assert_allclose(products(one, other), one.T @ other, atol=1e-9)
    np.testing.assert_allclose(times(noise(*shape), noise(shape[1], n)), noise(*shape) @ noise(shape[1], n), atol=1e-9)


@pytest.mark.parametrize("size", [1, 64, 600])
def test_products_of_many_columns_are_those_of_numpy(size):
    wide = noise(500, size).astype(np.float32)
    np.testing.assert_allclose(products(wide, wide), wide.T @ wide, rtol=1e-3, atol=1e-3)
    assert products(wide, wide).dtype == np.float32


FAULTS = """
import resource, sys
import numpy as np
from z2r.arrays import keep_freed_memory

def n_faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt

def use():
    several = [np.ones(2**17) for _ in range(8)]

if sys.argv[1] == "kept":
    keep_freed_memory()
use()
before = n_faults()
for _ in range(20):
    use()
print(n_faults() - before)
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="when memory is given back is a matter of the C library")
def test_memory_that_is_freed_is_not_asked_of_the_system_again():
    kept, given_back = (
        int(subprocess.run([sys.executable, "-c", FAULTS, how], capture_output=True, check=True).stdout)
        for how in ("kept", "given back")
    )
    assert kept < given_back / 10


@given(st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)), min_size=1))
def test_lengths_are_those_of_numpy(vectors):
    x, y = np.array(vectors).T
    np.testing.assert_allclose(lengths(x, y), np.hypot(x, y))


@given(shapes, st.sampled_from([0, 1, 255, 256, 1000]))
def test_each_column_lies_in_one_piece(shape, n):
    values = noise(n, shape[0])
    for found in (by_column(values), stack_columns([*values.T])):
        np.testing.assert_array_equal(found, values)
        assert found.T.flags.c_contiguous
