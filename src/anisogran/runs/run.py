"""What an experiment leaves: the scene, time series, fields, snapshots, status and provenance, and the file that holds them."""

from dataclasses import dataclass, field

import xarray as xr

from anisogran.files import save_results, snapshot_dataset
from anisogran.outcome import Status
from anisogran.snapshot import frames


@dataclass(frozen=True, eq=False)
class Run:
    """What an experiment left: the scene, time series, snapshots by name, status and provenance.

    Experiments with a field also have `profiles` (mean and error over the blocks) and `blocks` (dimension "block"); what else an
    experiment measures is in `tables`, {name: Dataset}, each a group of its own in the file.
    """

    scene: object  # the Experiment
    series: xr.Dataset
    profiles: xr.Dataset | None = None
    blocks: xr.Dataset | None = None
    snapshots: dict = field(default_factory=dict)
    status: Status = Status()
    provenance: dict = field(default_factory=dict)
    tables: dict = field(default_factory=dict)

    @property
    def frames(self):
        """The snapshots of the steady state in order of time, for averages afterwards; without any, the last snapshot."""
        return frames(self.snapshots)

    def datasets(self):
        """All of it as datasets by group name; "" holds provenance and status as attributes."""
        groups = {"": xr.Dataset(attrs={**self.provenance, "status": str(self.status)}), "series": self.series}
        groups |= {name: data for name, data in (("profiles", self.profiles), ("blocks", self.blocks)) if data is not None}
        return groups | self.tables | {f"snapshots/{name}": snapshot_dataset(snapshot) for name, snapshot in self.snapshots.items()}

    def save(self, path):
        """Writes one HDF5 file that `anisogran.open` and `xarray.open_datatree(path, engine="h5netcdf")` read."""
        groups = self.datasets()
        save_results(path, groups, groups.pop("").attrs)
