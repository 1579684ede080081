"""The sealed file: whole after every kill, on every file system, and any changed bit is found."""

import errno
import os
import subprocess
import sys

import numpy as np
import pytest

from anisogran.dem import sealed
from anisogran.dem.sealed import previous_of, read_sealed, write_sealed
from anisogran.outcome import InputError


def test_the_last_digits_are_sealed_too(tmp_path):
    """Each of the 512 bits of the seal itself, and each of the first and last bits of the rest."""
    write_sealed(tmp_path / "a", "{}", {"x": np.arange(3.0)})
    good = (tmp_path / "a").read_bytes()
    for bit in [*range(200), *range(8 * len(good) - 700, 8 * len(good))]:
        damaged = bytearray(good)
        damaged[bit // 8] ^= 1 << bit % 8
        (tmp_path / "b").write_bytes(damaged)
        with pytest.raises(InputError, match=r"has no seal|is damaged"):
            read_sealed(tmp_path / "b")


WRITER = """
import importlib.util, sys
import numpy as np
spec = importlib.util.spec_from_file_location("sealed", sys.argv[2])
sealed = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sealed)
count = int(sealed.read_sealed(sys.argv[1])[0])
print("at work", flush=True)
while True:
    count += 1
    sealed.write_sealed(sys.argv[1], str(count), {"x": np.full(20_000, float(count))})
"""


@pytest.mark.hard_case("F1")
def test_fifty_kills_while_writing_leave_a_whole_file(rng, tmp_path):
    """A process that does nothing but write is killed at a random moment, and the next goes on from its file.

    Fifty starts of the whole room would take a minute, so the writer loads sealed.py alone; the kills of whole runs are below.
    """
    path = tmp_path / "a.npz"
    write_sealed(path, "0", {"x": np.zeros(20_000)})
    counts = [0]
    for _ in range(50):
        child = subprocess.Popen([sys.executable, "-c", WRITER, path, sealed.__file__], stdout=subprocess.PIPE, text=True)
        assert child.stdout.readline() == "at work\n"
        with pytest.raises(subprocess.TimeoutExpired):
            child.wait(rng.uniform(0, 0.03))
        child.kill()
        child.communicate()
        text, arrays = read_sealed(path)
        np.testing.assert_array_equal(arrays["x"], float(text))
        if counts[-1] or int(text) > 1:
            text_before, arrays_before = read_sealed(previous_of(path))
            np.testing.assert_array_equal(arrays_before["x"], float(text_before))
            assert int(text_before) < int(text)
        counts.append(int(text))
    assert np.all(np.diff(counts) >= 0)
    assert counts[-1] > 50  # they have really been writing
    write_sealed(path, "end", {})
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.npz", "a.npz.previous"]


def test_a_file_system_without_hard_links_will_do(rng, tmp_path, monkeypatch):
    def refuse(*paths):
        raise OSError(errno.EPERM, os.strerror(errno.EPERM))

    monkeypatch.setattr(os, "link", refuse)
    for text in ("first", "second", "third"):
        write_sealed(tmp_path / "a", text, {})
    assert (read_sealed(tmp_path / "a")[0], read_sealed(previous_of(tmp_path / "a"))[0]) == ("third", "second")
    assert len(list(tmp_path.iterdir())) == 2


def test_a_link_is_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "file")
    write_sealed(tmp_path / "link", "text", {})
    assert (tmp_path / "link").is_symlink()
    assert read_sealed(tmp_path / "file")[0] == "text"
