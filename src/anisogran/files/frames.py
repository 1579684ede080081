"""Text files of other codes: frames one after the other, each some header lines and a table of numbers.

Every complaint is one InputError that names file and line. One frame is held at a time, and nothing is allocated on the word of a header.
"""

from itertools import islice
from pathlib import Path

import numpy as np

from anisogran.outcome import InputError

BLOCK = 20_000  # lines turned into numbers at a time
LARGEST = 1e30  # no length, mass or force in any unit; below it no square, cube or quotient overflows


class Lines:
    """The lines of a text file, counted. Raises InputError naming the file if it cannot be opened."""

    def __init__(self, path):
        self.path, self.number, self._held = path, 0, None
        try:
            # latin-1 gives every byte a character: what is no text fails as a number
            self._file = Path(path).open(encoding="latin-1")  # noqa: SIM115 (closed by __exit__)
        except TypeError:
            raise InputError(f"{path!r}: is no path") from None
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot be read ({getattr(error, 'strerror', None) or error})") from None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._file.close()

    def refuse(self, message, line=None):
        """Raises InputError at a line, by default the one read last."""
        raise InputError(f"{self.path}, line {self.number if line is None else line}: {message}")

    def next(self):
        """The next line without its end; None after the last."""
        line, self._held = (self._file.readline(BLOCK) if self._held is None else self._held), None
        if not line:
            return None
        self.number += 1
        if not line.endswith("\n"):
            self.refuse("the file breaks off within this line" if len(line) < BLOCK else "the line is too long for a header")
        return line.strip()

    def next_filled(self):
        """The next line that is not blank; None after the last."""
        while (line := self.next()) == "":
            pass
        return line

    def numbers(self, line, counts, what):
        """The numbers in the line read last, as many as one of `counts`; `what` names them in the message."""
        words = (line or "").split()
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            numbers = []
        if len(numbers) not in counts or not all(abs(number) < LARGEST for number in numbers):
            self.refuse(f"expected {what}, found {' '.join(words)[:60]!r}")
        return numbers

    def count(self, number, what):
        """A number of the line read last as a whole number, not below 0."""
        if not (number == int(number) and 0 <= number < 1e15):
            self.refuse(f"{what} = {number:g} must be a whole number, not below 0")
        return int(number)

    def _blocks(self, rows):
        """Lists of lines: `rows` of them in all, or for None those before the next line that begins with #."""
        if rows is not None:
            while rows and (block := list(islice(self._file, min(rows, BLOCK)))):
                rows -= len(block)
                yield block
            return
        block = []
        for line in self._file:
            if line.startswith("#"):
                self._held = line
                break
            block.append(line)
            if len(block) == BLOCK:
                yield block
                block = []
        if block:
            yield block

    def skip(self, rows):
        """Passes over the lines of a table."""
        passed = 0
        for block in self._blocks(rows):
            passed += len(block)
            self._advance(block)
        self._check_count(passed, rows)

    def table(self, rows, width, columns):
        """The Table of the next `rows` lines of `width` entries each; `columns` maps a name to the place of its numbers."""
        first, found = self.number + 1, [np.empty((0, len(columns)))]
        for block in self._blocks(rows):
            start = self.number + 1
            self._advance(block)
            for offset, line in enumerate(block):
                if (count := len(line.split())) != width:
                    self.refuse(f"{count} entries instead of {width}", start + offset)
            found.append(self._numbers(block, start, list(columns.values())))
        values = np.concatenate(found)
        self._check_count(len(values), rows)
        table = Table(self.path, first + np.arange(len(values)), dict(zip(columns, values.T, strict=True)))
        for name in columns:
            table.refuse(~(np.abs(table[name]) < LARGEST), f"{name} = {{{name}:g}} must be a finite number below {LARGEST:g}")
        return table

    def _advance(self, block):
        self.number += len(block)
        if not block[-1].endswith("\n"):
            self.refuse("the file breaks off within this line")

    def _check_count(self, found, rows):
        if rows is not None and found < rows:
            self.refuse(f"the file ends after {found} of {rows} lines of this frame")

    def _numbers(self, block, start, places):
        try:
            return np.loadtxt(block, usecols=places, comments=None, ndmin=2)
        except ValueError:
            for offset, line in enumerate(block):
                try:
                    np.loadtxt([line], usecols=places, comments=None, ndmin=2)
                except ValueError:
                    self.refuse(f"not a number in {line.strip()[:60]!r}", start + offset)
            raise


class Table:
    """Columns of numbers: table[name] is an array, and row k stands in line lines[k] of the file."""

    def __init__(self, path, lines, columns):
        self.path, self.lines, self.columns = path, lines, columns

    def __len__(self):
        return len(self.lines)

    def __getitem__(self, name):
        return self.columns[name]

    def get(self, name, default):
        """The column, or `default` where there is none."""
        return self.columns.get(name, default)

    def __contains__(self, name):
        return name in self.columns

    def rows(self, chosen):
        """The Table of some rows."""
        return Table(self.path, self.lines[chosen], {name: column[chosen] for name, column in self.columns.items()})

    def stacked(self, names):
        """(rows, names): those columns side by side."""
        return np.stack([self.columns[name] for name in names], axis=-1)

    def refuse(self, bad, message):
        """Raises InputError at the first row that is bad; {name} in the message becomes the number there."""
        rows = np.flatnonzero(bad)
        if rows.size:
            numbers = {name: column[rows[0]] for name, column in self.columns.items()}
            raise InputError(f"{self.path}, line {self.lines[rows[0]]}: {message.format(**numbers)}")

    def whole(self, name):
        """A column as int64."""
        column = self.columns[name]
        self.refuse((column != np.rint(column)) | (np.abs(column) > 2**53), f"{name} = {{{name}:g}} must be a whole number")
        return column.astype(np.int64)


class Frame:
    """One frame, its header read and its table still to come: `label` is the time, or the number of the step."""

    def __init__(self, lines, label, what, rows, **header):
        self.lines, self.line, self.label, self.what, self.rows = lines, lines.number, label, what, rows
        self.header, self._taken = header, False

    def table(self, width, columns):
        """The Table of this frame, to be asked for once."""
        self._taken = True
        return self.lines.table(self.rows, width, columns)

    def refuse(self, message):
        """Raises InputError at the header."""
        self.lines.refuse(message, self.line)

    def leave(self):
        """Passes over the table, if it was not read."""
        if not self._taken:
            self.lines.skip(self.rows)


def frames(path, next_frame):
    """The frames of a file, by next_frame(lines) -> Frame or None. Raises InputError if there is none, or if they do not ascend."""
    label = None
    with Lines(path) as lines:
        while (frame := next_frame(lines)) is not None:
            if label is not None and not frame.label > label:
                frame.refuse(f"{frame.what} {frame.label:.12g} follows {frame.what} {label:.12g}; it must be later")
            label = frame.label
            yield frame
            frame.leave()
    if label is None:
        raise InputError(f"{path}: holds no frame")


def matched(grains, contacts, every):
    """Each `every`-th frame of grains with the frame of contacts of the same label (None for contacts=None).

    Raises InputError for a frame of contacts without grains, and for a wanted frame of grains without contacts.
    """
    contact = None if contacts is None else next(contacts)
    for count, frame in enumerate(grains):
        if contact is not None and contact.label < frame.label:
            contact.refuse(f"no grains at {contact.what} {contact.label:.12g}")
        found = contact is not None and contact.label == frame.label
        if count % every == 0:
            if contacts is not None and not found:
                frame.refuse(f"no contacts at {frame.what} {frame.label:.12g}")
            yield frame, contact
        if found:
            contact = next(contacts, None)
    if contact is not None:
        contact.refuse(f"no grains at {contact.what} {contact.label:.12g}")
