"""Grains in a row of columns: what they give to the water at an exchange, and what they are told of it.

As `coupling` for one column: the slices of the grains, their weights along x and the water stay as they are
during an interval, and what a grain received is taken from the stations with the same weights, so that
momentum is conserved to round-off over the row (design/0027).
"""

from dataclasses import dataclass, field, replace

import numpy as np

from ryusa.laws.families import BedKind, Fluctuations
from ryusa.model import Scene
from ryusa.model.arrays import Floats
from ryusa.model.column import STIFF
from ryusa.model.eddies import Eddies
from ryusa.model.fluid import N_SAMPLED, SHEAR
from ryusa.model.row import ColumnRow, PorousSolid, RowGrainState, RowState
from ryusa.water import eddies
from ryusa.water.at_grains import sample
from ryusa.water.drive import imposed_gradient
from ryusa.water.exchange import slices, with_those_away
from ryusa.water.exchange_arrays import GrainNumbers, SliceArrays, WaterLaws, cells_of
from ryusa.water.fixed_grains import steady_start
from ryusa.water.row import GrainAction, RowArrays, advance_row, row_at_rest
from ryusa.water.row_energy import N_ROW_TERM
from ryusa.water.row_exchange import (
    DRIFT,
    SLOW,
    U_TAU_SQUARE,
    RowTold,
    StationForces,
    act_on_stations,
    concentration_in_row,
    continue_ends,
    fastest_in_row,
    leave_dry_ends,
    means_at_grains,
    meet_within_step,
    rates_at_stations,
    split_budgets,
    table_of,
    tell,
    turbulence_at_stations,
)
from ryusa.water.row_grain_sums import MetByGrains, sum_grains_in_row
from ryusa.water.row_layout import RowEnds, RowWater
from ryusa.water.row_nappe import closed, hang, open_state, open_values
from ryusa.water.row_pressure import find_rises
from ryusa.water.row_pressure_grains import set_grains
from ryusa.water.row_pressure_told import accelerate_with_grains, press_grains
from ryusa.water.row_station import largest_residual
from ryusa.water.row_sums import (
    N_ROW_SUM,
    GrainPlaces,
    RowBed,
    add_to_segments,
    place_grains,
    sum_fixed_in_row,
)
from ryusa.water.row_threads import RowThreads, equal_parts, rows_of, sum_grains_shared
from ryusa.water.slice_sums import (
    BAD_GRAIN,
    DRAG_NOW,
    N_SUM_FIXED,
    RATE,
    ROW_DU_DT,
    SOLID,
)


@dataclass
class GrainsInRow:
    """The grains of a run in a row of columns, and what they were told last.

    Attributes
    ----------
    scene, row : the scene, and its row; `row.column.area` is the area of bed of the whole row.
    solid : the porous solid of the row, beside the grains.
    told : water that the grains meet in the present interval.
    sampled : the same at the grains, columns of `model.fluid`.
    fastest, fastest_grain : largest rate at which drag brought water and grains to one speed in the last
        interval, and a grain to that of the water [1/s].
    worst : largest residual of the momentum of a station so far, over its largest term [-].
    eddies : present eddies of the grains; None without fluctuations.
    threads : share the loops over grains.
    """

    scene: Scene
    row: ColumnRow
    solid: PorousSolid | None
    told: RowTold
    sampled: Floats
    fastest: float
    fastest_grain: float
    worst: float
    x: Floats  # centres at the last exchange [m], shape (n_grain, 3)
    _arrays: RowArrays
    _area: float  # of bed in a segment [m2]
    _laws: WaterLaws
    _grains: GrainNumbers
    _bed: RowBed
    _cut: SliceArrays
    _bed_cut: SliceArrays
    _places: GrainPlaces
    _bed_places: GrainPlaces
    _met: MetByGrains
    _z: Floats  # heights above the bottom, plus z_low [m]
    eddies: Eddies | None = None
    threads: RowThreads = field(default_factory=RowThreads)

    @staticmethod
    def begin(
        scene: Scene, row: ColumnRow, x: Floats, state: RowState | None = None,
        threads: RowThreads | None = None,
    ) -> "GrainsInRow":  # fmt: skip
        """Cut the grains at x [m], shape (n_grain, 3), in water of a given state.

        Parameters
        ----------
        state : None: only the concentrations are of interest, as for the first state of the water.
        threads : share the loops over grains; the bits do not depend on them.

        Raises
        ------
        ValueError : the row is not valid, or does not carry these grains.
        """
        faults = row.refuses() or row.refuses_grains(scene.water.buoyancy, scene.period[0])
        if faults:
            raise ValueError("; ".join(faults))
        arrays, column = RowArrays.of(row), row.column
        p, shape = arrays.p, arrays.shape
        x, _ = with_those_away(scene, row.bottom_with_ends().min(), x, x, row.x[0])
        stations, segments = len(shape.left), len(shape.bottom)
        there = np.flatnonzero(scene.fixed_active)
        cells, n = cells_of(column), len(x)
        places = GrainPlaces.of(n, row.n_segment)
        bed_places = GrainPlaces.of(len(there), row.n_segment)
        for what, here, into in (("grain", x, places), ("fixed grain", scene.x_fixed[there], bed_places)):
            bad = place_grains(np.ascontiguousarray(here[:, 0]), float(row.x_low), p.z_low, shape, into)
            if bad >= 0:
                raise ValueError(f"the place of {what} {bad} along the row is not finite")
        z, d_bed = x[:, 2] - places.base, np.ascontiguousarray(scene.d_fixed[there])
        z_bed = scene.x_fixed[there, 2] - bed_places.base
        cut, bed_cut = (SliceArrays.of(slices(*one, cells)) for one in ((z, scene.d), (z_bed, d_bed)))
        bed = RowBed(
            np.arange(len(there)), z_bed, d_bed, np.zeros((segments, column.n)), column.bed is BedKind.ROUGH
        )
        told = RowTold(
            np.zeros((stations, 6, column.n)), np.zeros((stations, column.n)), np.zeros((stations, column.n)),
            np.zeros((segments, column.n)), np.zeros(stations), *np.zeros((4, segments, column.n)),
        )  # fmt: skip
        made = GrainsInRow(
            scene, row, row.porous, told, np.zeros((n, N_SAMPLED)), 0.0, 0.0, 0.0, np.array(x), arrays,
            float(column.area) / row.n_segment, WaterLaws.of(scene),
            GrainNumbers.of(scene, None), bed, cut, bed_cut, places, bed_places,
            MetByGrains.of(n), z,
        )  # fmt: skip
        if threads is not None:
            made.threads = threads
        made._concentrate()
        if column.fluctuations is Fluctuations.RANDOM_WALK:
            made.eddies = eddies.begin(column.seed, n)
        if state is not None:
            made.meet(state)
        return made

    def meet(self, state: RowState) -> None:
        """Tell the grains of water of a given state, in which nothing has moved yet."""
        shape = self.told.phi.shape
        state = open_state(self.row, state)
        self._tell(state, np.zeros((N_ROW_SUM, *shape)), np.zeros_like(self.told.u), 0.0)
        self._sample(state)

    @staticmethod
    def resume(
        scene: Scene, row: ColumnRow, state: RowState, found: RowGrainState, sampled: Floats,
        threads: RowThreads | None = None,
    ) -> "GrainsInRow":  # fmt: skip
        """Go on from a snapshot; `sampled` is the water at the grains, columns of `model.fluid`."""
        grains = GrainsInRow.begin(scene, row, np.array(found.x), state, threads)
        told = grains.told
        for into, one in ((told.w, found.w), (told.force_z, found.force_z), (told.u_free, found.u)):
            into[:] = open_values(row, one)
        if found.du_dt is not None and found.moves is not None:
            told.stations[:, ROW_DU_DT] = open_values(row, found.du_dt)
            told.moves[:] = open_values(row, found.moves)
        grains._sample(open_state(row, state))  # which notes what each grain met, for what it gives
        grains.sampled, grains.eddies = np.array(sampled), found.eddies
        return grains

    def snapshot(self) -> RowGrainState:
        """All that `resume` needs, beside the water and the water at the grains."""
        x, told = self.x.copy(), self.told
        w, force_z, u = (np.array(self._closed(one)) for one in (told.w, told.force_z, told.u_free))
        own = () if self.row.hydrostatic else (told.stations[:, ROW_DU_DT], told.moves)
        accelerate = [np.array(self._closed(one)) for one in own]
        for one in (x, w, force_z, u, *accelerate):
            one.flags.writeable = False
        return RowGrainState(x, w, force_z, u, self.eddies, *accelerate)

    def follow(self, ends: RowEnds) -> None:
        """Let other discharges and levels act at the ends from the next exchange on."""
        self._arrays = replace(self._arrays, ends=ends)

    def changed(self, scene: Scene, row: ColumnRow, state: RowState) -> "GrainsInRow":
        """The same grains in a scene that the timeline changed: its slope, or removed fixed grains."""
        found = self.snapshot()
        other = GrainsInRow.resume(scene, row, state, found, self.sampled, self.threads)
        other.worst = self.worst
        return other

    def among(self, x: Floats, state: RowState) -> "GrainsInRow":
        """The same water at a step at which grains have entered or left; parameters as of `Fluid.among`."""
        other = GrainsInRow.begin(self.scene, self.row, x, state, self.threads)
        other.told.w[:], other.told.force_z[:] = self.told.w, self.told.force_z
        other.told.u_free[:] = self.told.u_free
        if not self.row.hydrostatic:  # with what lands behind aerated sills
            other.told.stations[:], other.told.moves[:] = self.told.stations, self.told.moves
        other.worst, other.eddies = self.worst, self.eddies
        other._sample(open_state(self.row, state))
        return other

    def _concentrate(self) -> None:
        """Concentrations of fixed grains, and of all, from the present slices."""
        sums = np.zeros((N_ROW_SUM, *self.told.phi.shape))
        volume, whole_cells = self._area * self._arrays.p.dz, np.ones_like(self.told.phi)
        for cut, places, order, whole in (
            (self._bed_cut, self._bed_places, self._bed.order, self._bed_cut.whole),
            (self._cut, self._places, self._grains.order, self._grains.solid),
        ):
            sums[SOLID] = 0.0
            per, solid = np.ones(len(order)), np.ascontiguousarray((whole / cut.whole)[:, None])
            add_to_segments(cut, places, whole_cells, order, per, solid, sums[SOLID : SOLID + 1])
            continue_ends(self._arrays.shape, sums)
            if places is self._bed_places:
                self._bed.phi[:] = sums[SOLID] / volume
                self._bed.phi[:] += self._porous()
        concentration_in_row(self._arrays.p, self._area, self._bed, sums, self.told.phi)

    def _porous(self) -> Floats:
        """Concentration of the porous solid in the cells of the opened row, ends included [-]."""
        if self.solid is None:
            return np.zeros_like(self.told.phi)
        return open_values(self.row, self.row.with_ends(self.solid.phi))

    def _closed(self, values: Floats) -> Floats:
        """Values of the opened row as those of the row."""
        nappe = self._arrays.nappe
        return values if nappe is None else closed(values, nappe.air)

    @property
    def phi(self) -> Floats:
        """Concentration of grains in the segments, fixed ones included [-], shape (n_segment, n)."""
        return self._closed(self.told.phi)[self.row.inner]

    @property
    def _yields(self) -> float:
        """Density of the water over that of a grain and its added mass, of the lightest [-].

        Too large a mobility lets the pressure come later, too small a one lets it grow.
        """
        return self._laws.rho_w * float((self._grains.solid / self._grains.inertia).max(initial=0.0))

    def at_rest(self, surface: Floats) -> RowState:
        """Water at rest among the grains up to the surface over the x axis [m], shape (n_segment,)."""
        phi = self.phi
        return row_at_rest(self.row, surface, PorousSolid(phi, 0.0 * phi, 0.0 * phi))

    def flowing(self, surface: Floats) -> RowState:
        """The same with the steady flow of one column over the mean bed of the row.

        Raises
        ------
        WaterError : no steady flow was found.
        """
        start, scene, column = self.at_rest(surface), self.scene, self.row.column
        bed = self._closed(self._bed.phi)[self.row.inner].mean(axis=0)
        free = self.phi.mean(axis=0) - bed
        every = np.concatenate([scene.d, scene.d_fixed[scene.fixed_active]])
        flow = steady_start(column, scene.water, bed, free, float((every**3).sum() / (every**2).sum()))
        u, profiles, edges = np.array(start.u), np.array(start.profiles), np.array(start.edges)
        u[:] = flow.u
        profiles[:, 0], profiles[:, 3], profiles[:, 5] = flow.u, flow.shear, flow.dtau_dz
        left, right = self.row.stations_between
        profiles[:, 2] = 0.5 * (start.content[left] + start.content[right])
        edges[:, 0], edges[:, 1] = flow.tau, flow.nu_t
        return replace(start, u=u, profiles=profiles, edges=edges)

    def exchange(self, state: RowState, x: Floats, v: Floats, impulse: Floats, dt: float) -> RowState:
        """Give the water `state` what the grains took in an interval dt [s], move it on, and tell the grains.

        Parameters x, v and impulse are as of `Fluid.exchange`.

        Returns
        -------
        The water now; `sampled` is what the grains are told of it.

        Raises
        ------
        ValueError : a grain is at no finite place.
        WaterError : the water cannot be moved on.
        """
        p, shape, told, row = self._arrays.p, self._arrays.shape, self.told, self.row
        x, v = with_those_away(self.scene, row.bottom_with_ends().min(), x, v, row.x[0])
        segments, stations = len(told.phi), len(told.u)
        sums, fixed = np.zeros((N_ROW_SUM, segments, p.n)), np.zeros((N_SUM_FIXED, segments, p.n))
        through, largest = np.zeros((stations, p.n)), np.array([0.0, -1.0])
        given = (
            p, shape, float(row.x_low), self._grains, self._cut, self._places, x, v, impulse, self.sampled,
            self._met, told.wet, 1.0 / dt, self._z, sums, through, largest,
        )  # fmt: skip
        if self.threads.number_for(len(x)) > 1:
            sum_grains_shared(self.threads, *given)
        else:
            sum_grains_in_row(*given)
        if largest[BAD_GRAIN] >= 0.0:
            raise ValueError(f"the place of grain {int(largest[BAD_GRAIN])} is not finite")
        self.x[:] = x
        continue_ends(shape, sums)
        concentration_in_row(p, self._area, self._bed, sums, told.phi)
        sum_fixed_in_row(
            p, shape, self._laws, self._bed, self._bed_cut, self._bed_places, told.u, told.w, told.wet,
            told.phi, fixed,
        )  # fmt: skip
        continue_ends(shape, fixed)
        for acting in (sums[:SOLID], sums[DRAG_NOW:], fixed):
            leave_dry_ends(shape, told.wet, acting)
        force, slope, phi_w, part = np.zeros((4, stations, p.n))
        free_z = np.zeros((segments, p.n))
        acts = StationForces(force, slope, phi_w, part, told.phi, told.force_z, free_z)
        act_on_stations(p, self._area, shape, told.u, told.u_free, sums, fixed, acts)
        if (pressure := self._arrays.pressure) is not None:
            set_grains(p, shape, self._area, self._yields * dt, sums, fixed, free_z, through, pressure.grains)
        state = advance_row(
            row, state, dt, solid=self._at_rest(), arrays=self._arrays,
            grains=GrainAction(told.phi[slice(*shape.inner)], force, slope, np.zeros_like(force), phi_w),
        )  # fmt: skip
        now = open_state(row, state)
        budgets = np.array(now.budgets)
        split_budgets(p, shape, acts, _water_of(now), budgets)
        budgets = self._closed(budgets)
        self.worst = max(self.worst, largest_residual(budgets))
        budgets.flags.writeable = False
        state = replace(state, budgets=budgets)
        self.fastest_grain = float(largest[RATE])
        slow = SLOW * p.nu / float(self._grains.d.mean()) if len(x) else 0.0
        rates = rates_at_stations(p, self._area, self._laws, shape, sums, told, np.array(now.u), slow)
        water = fastest_in_row(p, self._area, self._laws, sums, told.phi)
        self.fastest = max(water, float(rates.max()), self.fastest_grain)
        if self.eddies is not None:
            self.eddies = eddies.renew(self.eddies, row.column.seed, dt, self.sampled[:, SHEAR])
        before = told.stations[:, ROW_DU_DT].copy()
        self._tell(now, sums, through, dt)
        if pressure is not None:
            accelerate_with_grains(
                shape, 1.0 / (self._area * p.dz), float(self.scene.water.c_m), p.rho_w, self._porous(), sums,
                before, pressure.within, pressure.top, told,
            )  # fmt: skip
        if self.fastest * self.scene.dt > STIFF:  # the next interval is a step
            meet_within_step(shape, self.scene.dt, rates, sums, told)
        self._sample(now)
        return state

    def _at_rest(self) -> PorousSolid | None:
        """All that does not move in the cells; its drag is that of the porous solid alone."""
        phi = self._closed(self._bed.phi)[self.row.inner]
        if self.solid is not None:
            return self.solid if self._bed.taken else replace(self.solid, phi=phi)
        return None if self._bed.taken or not phi.any() else PorousSolid(phi, 0.0 * phi, 0.0 * phi)

    def _tell(self, state: RowState, sums: Floats, through: Floats, dt: float) -> None:
        """Note what the grains meet in the next interval, in water of a state of the opened row."""
        told, arrays, water = self.told, self._arrays, _water_of(state)
        told.stations[:] = state.profiles
        hang(arrays.p, arrays.shape, water, False, arrays.nappe, np.zeros(N_ROW_TERM))
        inner = arrays.shape.inner[0]
        driver = imposed_gradient(arrays.p, water.content[inner], float(water.surface[inner]))
        tell(
            arrays.p, self._area, arrays.shape, arrays.ends, dt, float(driver), sums, through, water,
            np.zeros_like(told.u), np.zeros(len(told.phi)), np.array(state.budgets), told, arrays.nappe,
        )  # fmt: skip
        if (own := arrays.pressure) is not None and state.pressure is not None:
            own.p[:] = state.pressure
            find_rises(arrays.p, arrays.shape, np.array(state.wet), own)

    def _sample(self, state: RowState) -> None:
        """Write the water at every grain, of a state of the opened row."""
        p, shape, told, laws = self._arrays.p, self._arrays.shape, self.told, self._laws
        turbulence = np.zeros((0, *told.u.shape))
        if self.eddies is not None:
            turbulence = turbulence_at_stations(p, shape, told.phi, np.array(state.edges))
        self.sampled, table = np.empty((len(self._z), N_SAMPLED)), table_of(shape, told, turbulence)
        if (own := self._arrays.pressure) is not None and state.pressure is not None:
            press_grains(p, shape, told, own.push, own.within, own.top, table)

        def tell_some(begin: int, end: int) -> None:
            some, these = slice(begin, end), self.eddies
            cut, places = rows_of(begin, end, self._cut), rows_of(begin, end, self._places)
            met = rows_of(begin, end, self._met)
            at, speeds = means_at_grains(p, shape, cut, places, told, table, met), np.zeros((0, 3))
            if these is not None:
                u_tau, drift = np.sqrt(at[:, U_TAU_SQUARE]), at[:, DRIFT]
                these = Eddies(these.r[some], these.spent[some], these.count[some])
                speeds = eddies.speeds(these, self.scene.plane_case, u_tau, drift, at[:, 2])
            sample(
                at, met.submerged / cut.whole, self._grains.solid[some], speeds, laws.buoyancy, 0.0,
                laws.rho_w, laws.g_x, laws.g_z, self.sampled[some],
            )  # fmt: skip

        parts = self.threads.number_for(len(self._z))
        if parts > 1:
            self.threads.share(equal_parts(len(self._z), parts), tell_some)
        else:
            tell_some(0, len(self._z))


def _water_of(state: RowState) -> RowWater:
    """The water of a state in arrays that may be written."""
    return RowWater(*(np.array(getattr(state, name)) for name in RowWater._fields))
