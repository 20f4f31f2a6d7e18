"""The step of a grain is one text: a row of components at once gives what each component gives alone."""

import numpy as np

from ryusa.engine.cpu.simd.vec4 import read4, write4
from ryusa.engine.shared.kernel import FAST, kernel
from ryusa.laws.grain_step import rotation_step, translation_step

STATES = 5000


@kernel(fastmath=FAST)
def move_rows(x, v, f, drag, weight, w, torque, inverse, dt, out):
    """Rows of four through the step: `out` gets positions, velocities and spins."""
    for i in range(len(inverse)):
        x_new, v_new = translation_step(
            read4(x, 4 * i), read4(v, 4 * i), read4(f, 4 * i), read4(drag, 4 * i), read4(weight, 4 * i),
            inverse[i], dt,
        )  # fmt: skip
        write4(out, 12 * i, x_new)
        write4(out, 12 * i + 4, v_new)
        write4(out, 12 * i + 8, rotation_step(read4(w, 4 * i), read4(torque, 4 * i), inverse[i], dt))


def test_vec4_and_single_components_give_the_same_bits():
    rng = np.random.default_rng(11)
    x, v, f, drag, weight, w, torque = rng.normal(size=(7, STATES, 4))
    inverse, dt, out = rng.uniform(0.1, 10.0, STATES), 1.0e-3, np.zeros((STATES, 3, 4))
    move_rows(x, v, f, drag, weight, w, torque, inverse, dt, out)
    for i in range(STATES):
        for k in range(4):
            one = translation_step.entry(x[i, k], v[i, k], f[i, k], drag[i, k], weight[i, k], inverse[i], dt)
            assert (out[i, 0, k], out[i, 1, k]) == one
            assert out[i, 2, k] == rotation_step.entry(w[i, k], torque[i, k], inverse[i], dt)
