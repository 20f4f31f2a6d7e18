"""Arrays and numbers with which the compiled exchange works."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ryusa.laws.families import BedKind
from ryusa.model import Scene
from ryusa.model.column import Column
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, parameters_of
from ryusa.water.exchange import Cells, Ints, Slices, concentration, slices
from ryusa.water.free_surface import submerged_part
from ryusa.water.processes import SharingProcesses


class SliceArrays(NamedTuple):
    """Arrays of `exchange.Slices`, which an exchange overwrites."""

    first: Ints
    n_cells: Ints  # `Slices.count`
    volume: Floats
    whole: Floats
    submerged: Floats
    below: Floats
    above: Floats

    @staticmethod
    def of(cut: Slices) -> "SliceArrays":
        """Arrays of these slices, not copied."""
        return SliceArrays(cut.first, cut.count, cut.volume, cut.whole, cut.submerged, cut.below, cut.above)

    def copy(self) -> "SliceArrays":
        """Arrays of the same values."""
        ints = self.first.copy(), self.n_cells.copy()
        parts = self.whole.copy(), self.submerged.copy(), self.below.copy(), self.above.copy()
        return SliceArrays(*ints, self.volume.copy(), *parts)


class GrainNumbers(NamedTuple):
    """Numbers of the free grains in this process, constant during a run, each of shape (n_grain,)."""

    order: Ints  # rows in the order of the grains' ids
    d: Floats  # diameter [m]
    solid: Floats  # volume A_3 d**3 [m3]
    archimedes: Floats  # buoyancy of still water along the bed [N]
    inertia: Floats  # mass and added mass [kg]

    @staticmethod
    def of(scene: Scene, ids: Ints | None) -> "GrainNumbers":
        """Numbers of the grains with these ids; None: all grains."""
        if ids is None:
            ids = order = np.arange(scene.n_grain)
        else:
            order = np.argsort(ids)
        d, m, m_weight, m_added = (one[ids] for one in (scene.d, scene.m, scene.m_weight, scene.m_added))
        solid = (m - m_weight) / scene.water.rho_w
        return GrainNumbers(order, d, solid, (m_weight - m) * scene.gravity[0], m + m_added)


class BedNumbers(NamedTuple):
    """Fixed grains for which this process sums; none where the law of a rough wall stands for them."""

    order: Ints  # 0 .. n_bed - 1
    z: Floats  # heights of the centres [m], shape (n_bed,)
    d: Floats  # diameters [m], shape (n_bed,)
    phi: Floats  # concentration of all fixed grains, those of other processes too, in the cells [-], (n,)
    taken: bool  # the wall law takes their drag and buoyancy


class WaterLaws(NamedTuple):
    """Choices and constants of the forces of water on grains."""

    drag: int
    hindrance: int
    buoyancy: int
    exponent: float
    nu: float
    rho_w: float
    a_2: float
    c_d: float
    g_x: float
    g_z: float

    @staticmethod
    def of(scene: Scene) -> "WaterLaws":
        """Those of a scene."""
        water = scene.water
        return WaterLaws(
            int(water.drag), int(water.hindrance), int(water.buoyancy), float(water.hindrance_exponent),
            float(water.nu), float(water.rho_w), float(water.a_2), float(water.c_d),
            float(scene.gravity[0]), float(scene.gravity[2]),
        )  # fmt: skip


@dataclass
class ExchangeArrays:
    """What the compiled exchange works with; constant but for the slices, z, force_z and `reaches`."""

    p: ColumnParameters
    area: float
    laws: WaterLaws
    grains: GrainNumbers
    bed: BedNumbers
    cut: SliceArrays  # of whole grains: volume in the cells
    wet: SliceArrays  # of the parts below the surface, where a grain reaches it: exchange of forces
    bed_cut: SliceArrays
    bed_wet: SliceArrays
    z: Floats  # heights at which the grains are cut [m]
    force_z: Floats  # of the water on grains along z, per volume of cells [N/m3]
    reaches: bool = field(default=False)  # whether a grain of this process reaches the surface

    @staticmethod
    def of(
        scene: Scene, column: Column, z: Floats, surface: float, phi_bed: Floats, ids: Ints | None = None,
        processes: SharingProcesses | None = None,
    ) -> "ExchangeArrays":  # fmt: skip
        """For grains cut at the heights z [m], and at the surface [m]."""
        grains, cells = GrainNumbers.of(scene, ids), cells_of(column)
        cut = slices(z, grains.d, cells)
        wet = submerged_part(cut, z, grains.d, surface)
        whole, reaches = SliceArrays.of(cut), wet is not cut
        share = slice(None) if processes is None else slice(processes.rank, None, processes.n)
        there = np.flatnonzero(scene.fixed_active)[share]
        z_bed, d_bed = scene.x_fixed[there, 2], scene.d_fixed[there]
        bed_cut = SliceArrays.of(slices(z_bed, d_bed, cells))
        return ExchangeArrays(
            parameters_of(column), float(column.area), WaterLaws.of(scene), grains,
            BedNumbers(np.arange(len(z_bed)), z_bed, d_bed, phi_bed, column.bed is BedKind.ROUGH),
            whole, SliceArrays.of(wet) if reaches else whole.copy(), bed_cut, bed_cut.copy(),
            np.array(z), np.zeros(column.n), reaches,
        )  # fmt: skip

    def slices(self, column: Column, arrays: SliceArrays) -> Slices:
        """The arrays as slices of grains."""
        return Slices(cells_of(column), *arrays, self.grains.order)


def cells_of(column: Column) -> Cells:
    """Cells of a column."""
    return Cells(column.z_low, column.dz, column.n, column.area)


def concentration_of_bed(scene: Scene, column: Column) -> Floats:
    """Concentration of the fixed grains that are still there [-], shape (n,)."""
    there = scene.fixed_active
    return concentration(slices(scene.x_fixed[there, 2], scene.d_fixed[there], cells_of(column)))
