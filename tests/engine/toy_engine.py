"""An engine of the plainest kind, for tests: every pair in every step, numpy and the laws; dry grains."""

from dataclasses import replace

import numpy as np

from ryusa.engine.protocol import Flags
from ryusa.engine.shared.energy_account import potential_energy
from ryusa.engine.shared.refusals import check_state, refusals
from ryusa.errors import GrainLost, ListUnsafe, NotANumber, OverlapTooLarge
from ryusa.laws.collision import effective_mass, effective_mass_tangential
from ryusa.laws.contact import damping, damping_in_steps, normal_force, shear_strength, slide
from ryusa.laws.families import Cap, Slip
from ryusa.laws.geometry import arm, turn, wrap
from ryusa.model import EVENT, Contacts, Scene, State, Tally, Term
from ryusa.model.state import make_read_only


class ToyEngine:
    name = "toy"

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        law = scene.contact
        has_not = {
            "water": scene.water.profile, "events": scene.events, "rolling friction": scene.rolling.model,
            "plane scenes": scene.plane_case, "planes": scene.n_plane, "Hertz contacts": law.force,
            "tension": law.tension, "other slip rules": law.slip != Slip.TOTAL,
            "caps of the slip force": law.cap != Cap.TOTAL,
            "other damping": law.damping, "contacts that begin within steps": law.timing,
            "locked rotation": not scene.rotation,
        }  # fmt: skip
        odd = [name for name, value in has_not.items() if value]
        return (*refusals(scene), *([f"the toy lacks {', '.join(odd)}"] if odd else []))

    def load(self, scene: Scene, state: State) -> None:
        if reasons := self.refuses(scene):
            raise ValueError("; ".join(reasons))
        check_state(scene, state)
        none = Tally(state.t, *(0.0,) * 6, (0.0,) * len(Term), 0.0, -1, 0, 0.0, 0.0, 0)
        self.scene, self._state = scene, replace(state, engine=None, tally=state.tally or none)
        still, inf = np.zeros((scene.n_fixed, 3)), np.full(scene.n_fixed, np.inf)
        self._x = np.vstack([state.x, scene.x_fixed])
        self._v, self._w = np.vstack([state.v, still]), np.vstack([state.omega, still])
        self._r = 0.5 * np.append(scene.d, scene.d_fixed)
        self._m, self._inertia = np.append(scene.m, inf), np.append(scene.inertia, inf)
        c, self._pairs = state.contacts, {}
        for k, pair in enumerate(zip(c.i.tolist(), c.j.tolist(), strict=True)):
            self._pairs[pair] = c.spring_s[k], c.dash_s[k], c.f_n[k], c.dash_n[k], c.eta_n[k]

    def set_walls(self, motion: np.ndarray) -> None:
        raise ValueError("the scene has no walls")

    def set_fluid(self, sampled: np.ndarray) -> None:
        raise ValueError("the scene has no column of water: water.profile is not COLUMN")

    def advance(self, n_steps: int) -> Flags:
        flags = Flags()
        while n_steps > 0 and not flags:
            flags, n_steps = self._step(), n_steps - 1
        return flags

    def _step(self) -> Flags:
        scene, n, dt, old = self.scene, self.scene.n_grain, self.scene.dt, self._state
        self._work, self._springs, self._partner, was = np.array(old.tally.terms), [0.0, 0.0], -1, self._pairs
        self._worst = old.tally.overlap_max, old.tally.overlap_grain, old.tally.overlap_step
        self._force, self._torque, self._pairs = scene.m_weight[:, None] * scene.gravity, np.zeros((n, 3)), {}
        for i in range(n):
            for j in range(i + 1, len(self._x)):
                if j < n or scene.fixed_active[j - n]:
                    self._contact(i, j, 0.5 * dt if old.step else 0.0, was.get((i, j)))
        potential, v, w = potential_energy(scene, self.grains()), self._v[:n].copy(), self._w[:n].copy()
        self._v[:n] += self._force / scene.m[:, None] * dt
        self._w[:n] += self._torque / scene.inertia[:, None] * dt
        self._x[:n] += self._v[:n] * dt
        moving = 0.5 * float(np.sum(scene.m[:, None] * v * self._v[:n]))
        held = (moving, 0.5 * float(np.sum(scene.inertia[:, None] * w * self._w[:n])), potential)
        if old.step == 0:
            self._work[Term.START] = sum(held) + sum(self._springs)
        speed, spin = (np.linalg.norm(one[:n], axis=1) for one in (self._v, self._w))
        most = float(speed.max()), float(spin.max())
        work, n_pair = tuple(self._work), len(self._pairs)
        tally = Tally(old.t, *held, *self._springs, 0.0, work, *self._worst, *most, n_pair)
        self._state = new = replace(old, step=old.step + 1, t=old.t + dt, tally=tally)
        where = {"step": old.step, "t": old.t, "hint": "It is a toy.", "grain": int(speed.argmax())}
        if self._partner >= 0 and tally.overlap_max > scene.overlap_limit:
            return Flags(OverlapTooLarge("", **where | {"grain": self._worst[1], "partner": self._partner}))
        if not np.isfinite(speed + spin).all():
            return Flags(NotANumber("no number", **where | {"grain": int((speed + spin).argmax())}))
        where |= {"step": new.step, "t": new.t}
        if most[0] * dt > 0.5 * self._r.min():
            return Flags(ListUnsafe("too fast", **where))
        out = ((self._x[:n] < scene.world_low) | (self._x[:n] > scene.world_high)).any(axis=1)
        return Flags(GrainLost("gone", **where | {"grain": int(out.argmax())}) if out.any() else None)

    def _contact(self, i: int, j: int, hdt: float, was: tuple | None) -> None:
        scene, law, dt, r_i, r_j = self.scene, self.scene.contact, self.scene.dt, self._r[i], self._r[j]
        d = self._x[j] - self._x[i]
        d[:2] = wrap(d[0], scene.period[0]), wrap(d[1], scene.period[1])
        distance = float(np.linalg.norm(d))
        overlap, normal = r_i + r_j - distance, d / distance
        if overlap <= 0.0 and was is None:
            return
        m_i, m_j, inertia, w_i, w_j = self._m[i], self._m[j], self._inertia, self._w[i], self._w[j]
        m_n = effective_mass(m_i, m_j)
        m_t = effective_mass_tangential(m_i, r_i, inertia[i], m_j, r_j, inertia[j], True)
        eta_n = damping_in_steps(damping(law.zeta_n, law.k_n, m_n), m_n, dt)
        eta_s = damping_in_steps(damping(law.zeta_s, law.k_s, m_t), m_t, dt)
        u, a_i = self._v[i] - self._v[j], arm(r_i, overlap)
        a_j, closing = distance - a_i, float(u @ normal)
        slip = u - closing * normal + np.cross(a_i * w_i + a_j * w_j, normal)
        touching, e_n, work = overlap > 0.0, law.k_n * max(overlap, 0.0), self._work
        f_n = max(normal_force(overlap, closing, law.k_n, eta_n), 0.0) if touching else 0.0
        spring, dash, f_old, d_old, _ = was or (np.zeros(3), np.zeros(3), 0.0, 0.0, 0.0)
        work[Term.DASH_N if f_n > 0.0 else Term.RELEASED_N] += hdt * closing * (f_n - e_n)
        work[Term.DASH_N if f_old > 0.0 else Term.RELEASED_N] += hdt * closing * d_old
        if touching and was is None and hdt > 0.0:  # the spring began within the step
            work[Term.STEP] -= 0.5 * e_n * (2.0 * hdt * closing - overlap)
        if not touching:
            work[Term.STEP] -= 0.5 * (f_old - d_old) * (2.0 * hdt * closing + (f_old - d_old) / law.k_n)
        old = np.array(turn(*spring, *normal, 0.5 * dt * float((w_i + w_j) @ normal)))
        spring, drag = old - law.k_s * slip * dt, -eta_s * slip * (f_n > 0.0)
        tau_c = shear_strength(f_n, law.cohesion, law.mu)
        share, less, _ = slide(float(np.linalg.norm(spring + drag)), tau_c, False, True)
        share *= f_n > 0.0
        spring = (share * spring + less * drag) * (f_n > 0.0)
        slides = share < 1.0 and f_n > 0.0  # the work of friction is that of spring and dashpot together
        work[Term.SLIDE if slides else Term.DASH_S] -= hdt * float(slip @ (dash + drag))
        if share < 1.0:
            left = 0.5 * float(old @ old - spring @ spring) / law.k_s if hdt > 0.0 else 0.0
            lost = left - hdt * float(slip @ (old + spring))
            work[Term.SLIDE if f_n > 0.0 else Term.RELEASED_S] += lost
        force, torque = spring + drag - f_n * normal, np.cross(normal, spring + drag)
        for grain, sign, lever in ((i, 1.0, a_i), (j, -1.0, a_j))[: 2 if j < scene.n_grain else 1]:
            self._force[grain] += sign * force
            self._torque[grain] += lever * torque
        if touching:
            self._pairs[i, j] = spring, drag, f_n, f_n - e_n, eta_n
            self._springs[0] += 0.5 * e_n * e_n / law.k_n
            self._springs[1] += 0.5 * float(spring @ spring) / law.k_s
            if (ratio := float(overlap / (2.0 * min(r_i, r_j)))) > self._worst[0]:
                self._worst, self._partner = (ratio, i, self._state.step), j

    def kinematics(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self._x[: (n := self.scene.n_grain)].copy(), self._v[:n].copy(), np.zeros((0, 0))

    def grains(self) -> State:
        (x, v, _), now = self.kinematics(), self._state
        return State(x, v, self._w[: len(x)].copy(), now.step, now.t, now.image.copy())

    def state(self) -> State:
        i, j = np.array(sorted(self._pairs), np.int64).reshape(-1, 2).T.copy()
        rows = [np.concatenate(one, axis=None) for _, one in sorted(self._pairs.items())]
        rows, k = np.array(rows).reshape(-1, 9), len(rows)
        parts = rows[:, :3], rows[:, 3:6], rows[:, 7], rows[:, 6], np.zeros((k, 3)), np.zeros((k, 3))
        exact = np.zeros(k), np.ones(k, np.int64), np.zeros(k)
        contacts = Contacts(i, j, *parts, rows[:, 8], *exact, np.zeros((k, EVENT.itemsize // 8)))
        make_read_only(state := replace(self.grains(), contacts=contacts, tally=self._state.tally))
        return state

    def tally(self) -> Tally:
        return self._state.tally

    def events(self) -> np.ndarray:
        return np.zeros(0, EVENT)
