"""Floating-point trouble is an error in the tests, and randomness is seeded."""

import signal

import numpy as np
import pytest


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
