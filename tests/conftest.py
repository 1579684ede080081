"""Floating-point trouble is an error in the tests, and randomness is seeded."""

import signal

import numpy as np
import pytest

pytest_plugins = ["hard_case_page"]


@pytest.fixture(autouse=True, scope="session")
def hear_interrupts():
    """Also where the tests run in the background of a shell, which has them ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def strict_floating_point():
    with np.errstate(all="raise", under="ignore"):
        yield


@pytest.fixture
def rng():
    return np.random.default_rng(20050603)


@pytest.fixture
def damages(rng):
    """A function (content, count) that gives damaged copies of the bytes: in turn a bit flipped, the end cut off, a block zeroed."""

    def copies(good, count):
        for trial in range(count):
            damaged = bytearray(good)
            place = int(rng.integers(len(good)))
            match trial % 3:
                case 0:
                    damaged[place] ^= 1 << int(rng.integers(8))
                case 1:
                    del damaged[place:]
                case 2:
                    size = int(rng.integers(1, 600))
                    damaged[place : place + size] = bytes(len(damaged[place : place + size]))
            if damaged == good:  # zeros upon zeros
                damaged[place] ^= 1
            yield damaged

    return copies
