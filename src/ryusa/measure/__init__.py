"""Numbers from a run folder: every function reads results and returns a frozen record; none steps a grain."""

from ryusa.measure.collisions import Collisions, ContactTimes, collisions, contact_times, turned_time
from ryusa.measure.energy import Energy, energy
from ryusa.measure.saltation import Saltation, grouping, saltation
from ryusa.measure.spin import Spin, spin
from ryusa.measure.statistics import Average, average, block_error, ratio
from ryusa.measure.table import Averages, rows_of, write_csv
from ryusa.measure.tracks import Tracks, tracks

__all__ = [
    "Average",
    "Averages",
    "Collisions",
    "ContactTimes",
    "Energy",
    "Saltation",
    "Spin",
    "Tracks",
    "average",
    "block_error",
    "collisions",
    "contact_times",
    "energy",
    "grouping",
    "ratio",
    "rows_of",
    "saltation",
    "spin",
    "tracks",
    "turned_time",
    "write_csv",
]
