"""Runs made up by hand, with answers known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.model import EVENT, ContactLaw, Scene

D, M, ADDED = 0.002, 1.11e-5, 2.1e-6  # diameter [m], mass and added mass [kg]
G = 5.0  # downward acceleration [m/s2]
T_COL = 1.0e-4  # contact time [s]
N_BED = 20


def scene(n_grain=1):
    """`n_grain` lanes over a line of touching fixed grains, crest at z = d."""
    bed = np.zeros((N_BED * n_grain, 3))
    bed[:, 0] = np.tile((np.arange(N_BED) + 0.5) * D, n_grain)
    bed[:, 1] = np.repeat(np.arange(n_grain) * 4 * D, N_BED)
    bed[:, 2] = 0.5 * D
    one = np.ones(n_grain)
    return Scene(
        d=D * one,
        m=M * one,
        m_added=ADDED * one,
        m_weight=M * one,
        inertia=M * D**2 / 10 * one,
        x_fixed=bed,
        d_fixed=np.full(len(bed), D),
        fixed_active=np.ones(len(bed), dtype=bool),
        plane_normal=np.zeros((0, 3)),
        plane_point=np.zeros((0, 3)),
        plane_active=np.zeros(0, dtype=bool),
        contact=ContactLaw(k_n=1.0e4, k_s=3.0e3, mu=0.6, e_n=0.7, e_s=0.7, zeta_n=0.12221),
        dt=1.0e-6,
        plane_case=True,
        period=(N_BED * D, float("inf")),
    )


def event(grain, j, t, x, v_in, v_out, *, spin=(0.0, 0.0), impulse=(0.0, 0.0), alone=1.0, duration=T_COL):
    """One bed contact; vectors as (x, z)."""
    row = np.zeros((), EVENT)
    row["i"], row["j"] = grain, j
    row["t_begin"], row["t_end"], row["t_part"] = t, t + duration, t + duration
    row["overlap_max"] = 1.0e-5
    row["closing_begin"], row["closing_end"] = -v_in[1], -v_out[1]
    row["slip_begin"], row["slip_end"] = (v_in[0], 0, 0), (v_out[0], 0, 0)
    row["impulse"] = (-impulse[0], 0, impulse[1])
    row["impulse_n"] = impulse[1]
    row["alone"] = alone
    row["x_begin"] = (x[0], 0, x[1])
    row["v_begin"], row["v_end"] = (v_in[0], 0, v_in[1]), (v_out[0], 0, v_out[1])
    row["omega_begin"], row["omega_end"] = (0, spin[0], 0), (0, spin[1], 0)
    return row


def hopping(rises, *, u=0.3, interval=1.0e-3, start=0.0, grain=0, n_grain=1, z_bed=1.9e-3):
    """Ballistic hops of one grain with the given rises [m] at steady speed u [m/s].

    Returns the frames' times, centres and velocities (n_frame, 3), and the contact records.
    """
    t, x = start, 0.0
    events, knots = [], []
    w_in = -np.sqrt(2 * G * rises[0])
    for k, rise in enumerate([*rises, rises[-1]]):
        w_out = float(np.sqrt(2 * G * rise))
        events.append(
            event(
                grain,
                n_grain + k,
                t,
                (x, z_bed),
                (u, float(w_in)),
                (u, w_out),
                spin=(10.0 * k, 10.0 * (k + 1)),
                impulse=(0.3 * M * (w_out - w_in), M * (w_out - w_in)),
            )
        )
        z_off = z_bed + 0.5 * (float(w_in) + w_out) * T_COL
        t_off, x_off = t + T_COL, x + u * T_COL
        flight = (w_out + np.sqrt(w_out**2 + 2 * G * (z_off - z_bed))) / G
        knots.append((t_off, x_off, z_off, w_out))
        t, x, w_in = t_off + flight, x_off + u * flight, w_out - G * flight
    times = np.arange(start, t, interval)
    which = np.clip(np.searchsorted([one[0] for one in knots], times, side="right") - 1, 0, None)
    t_off, x_off, z_off, w_off = (np.array(knots)[which, c] for c in range(4))
    s = times - t_off
    centres = np.stack([x_off + u * s, 4 * D * grain + 0 * s, z_off + w_off * s - 0.5 * G * s**2], axis=1)
    speeds = np.stack([u + 0 * s, 0 * s, w_off - G * s], axis=1)
    return times, centres, speeds, np.array(events, dtype=EVENT)


def run_of(t, x, v, events, omega=None, settle=None):
    """Something that looks like an opened run folder; x, v of shape (n_frame, n_grain, 3)."""
    record = {} if settle is None else {"settle": settle}
    omega = np.zeros_like(x) if omega is None else omega
    return SimpleNamespace(
        case={"record": record},
        frames=SimpleNamespace(t=t, x=x, v=v, omega=omega),
        contacts=events[np.argsort(events["t_part"])],
        scene=scene(x.shape[1]),
        tally={},
    )


@pytest.fixture
def make():
    """The builders above, by name."""
    return SimpleNamespace(
        event=event, hopping=hopping, run_of=run_of, scene=scene, d=D, m=M, added=ADDED, g=G, t_col=T_COL
    )
