"""Which software made a file: versions, commit and a digest of the sources; nothing about the machine or its user."""

import hashlib
import json
import os
import platform
import re
import subprocess
import sys
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path

import anisogran

PACKAGES = ("numpy", "numba", "scipy", "lmfit", "scikit-fem", "xarray", "h5py")
PATIENCE = 1.0  # s; git may wait for a file system that does not answer


def software():
    """A dict of plain strings: versions of anisogran, Python and the packages, platform, `commit` and `sources`.

    `commit` is the git commit that the sources belong to, with "+changes" if they differ from it, or "unknown"; `sources` are the first
    16 hex digits of the SHA-256 of all sources of this package, which tell two versions apart also without git.
    """
    return dict(_software())


@cache
def _software():
    return {
        "anisogran": anisogran.__version__,
        "python": platform.python_version(),
        "platform": sys.platform,
        **{name: _version(name) for name in PACKAGES},
        "commit": _commit_of_tree(_folder()) or _commit_of_install() or "unknown",
        "sources": _digest(_folder()),
    }


def _folder():
    return Path(anisogran.__file__).parent


def _version(name):
    try:
        return version(name)
    except PackageNotFoundError:
        return "absent"


def _digest(folder):
    """The first 16 hex digits of the SHA-256 of all sources in a folder, with their names."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(f"{path.relative_to(folder).as_posix()}\0{path.stat().st_size}\0".encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def _commit_of_tree(folder):
    """The commit of a folder that git tracks; None if it does not, or if git is missing, too old or too slow."""
    if _git(folder, "ls-files", "--error-unmatch", "__init__.py") is None:
        return None  # such as an environment in some other repository
    commit, changes = _git(folder, "rev-parse", "HEAD"), _git(folder, "status", "--porcelain", "--", ".")
    if commit is None or changes is None:
        return None
    return commit.strip() + ("+changes" if changes.strip() else "")


def _git(folder, *words):
    """What git prints, asked in a folder; None if it fails."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}  # set by a hook, of another tree
    command = ["git", "-c", "core.fsmonitor=false", "--no-optional-locks", *words]
    try:
        asked = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=True)
    except (OSError, subprocess.SubprocessError, UnicodeDecodeError):
        return None
    return asked.stdout


def _commit_of_install():
    """The commit that pip installed from (PEP 610), or None."""
    try:
        commit = json.loads(distribution("anisogran").read_text("direct_url.json") or "{}")["vcs_info"]["commit_id"]
    except (PackageNotFoundError, OSError, ValueError, LookupError, TypeError):
        return None
    return commit if re.fullmatch("[0-9a-f]{7,64}", str(commit)) else None
