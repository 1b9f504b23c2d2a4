"""Spring-slider of rate-and-state friction below its critical stiffness: the numbers of `slip_control.rs`.

    python3 tests/time/slip_control.py

q = alpha (w - s),  s' = V = 2 V0 exp(-psi/a) sinh(q/(a p)),  psi = f0 + b x,  x = ln(V0 theta/D),  x' = (V0 exp(-x) - V)/D,
with the way w of the block from eta w' = tau0 + k (Vp t - w) - q (radiation damping, which acts on the whole rate of the
surface) or M w'' = tau0 + k (Vp t - w) - q (inertia), by Radau. Up to V = 1e-7 w is in equilibrium, by LSODA.
"""

import numpy as np
from scipy.integrate import solve_ivp

a, b, f0, V0, D = 0.010, 0.015, 0.6, 1e-6, 1e-5
p, Vp, k, alpha, tau0 = 50.0, 1e-9, 12500.0, 3e5, 30.0
eta, M = 4.41, 5.4e-6
K = k * alpha / (k + alpha)
x0 = np.log(V0 * 10.0 / D)


def rate(q, x):
    return 2 * V0 * np.exp(-(f0 + b * x) / a) * np.sinh(q / (a * p))


def states(V, x):
    return (V0 * np.exp(-x) - abs(V)) / D


def at_rest():
    """In equilibrium, until V = 1e-7."""

    def of(t, y):
        V = rate(tau0 + K * (Vp * t - y[0]), y[1])
        return [V, states(V, y[1])]

    def fast(t, y):
        return np.log(rate(tau0 + K * (Vp * t - y[0]), y[1]) / 1e-7)

    fast.direction, fast.terminal = 1, True
    s = solve_ivp(of, [0, 4e5], [0, x0], method="LSODA", rtol=1e-11, atol=[1e-16, 1e-12], events=fast)
    return s.t[-1], *s.y[:, -1]


t0, slip, x = at_rest()
way = slip + K * (Vp * t0 - slip) / alpha


def passes(i):
    def fast(t, y):
        return np.log(max(rate(tau0 + alpha * (y[0] - y[i]), y[i + 1]), 1e-300) / 1e-3)

    fast.direction = 1
    return fast


def radiating(t, y):
    w, s, x = y
    q = tau0 + alpha * (w - s)
    V = rate(q, x)
    return [(tau0 + k * (Vp * (t0 + t) - w) - q) / eta, V, states(V, x)]


s = solve_ivp(radiating, [0, 1.5e6 - t0], [way, slip, x], method="Radau", rtol=1e-9, atol=[1e-14, 1e-14, 1e-9], events=passes(1))
V = max(rate(tau0 + alpha * (w - s), x) for w, s, x in s.y.T)
print("radiation: V passes 1e-3 at", t0 + s.t_events[0], "s; slip at 1.5e6 s", s.y[1, -1], "m; largest V", V)
print("  largest w'", max(radiating(t, y)[0] for t, y in zip(s.t, s.y.T)))


def moving(t, y):
    w, v, s, x = y
    q = tau0 + alpha * (w - s)
    V = rate(q, x)
    return [v, (tau0 + k * (Vp * (t0 + t) - w) - q) / M, V, states(V, x)]


def back(t, y):
    return y[1] + 1e-2


def of_motion(t, y):
    return passes(2)(t, y)


back.terminal, back.direction = True, -1
s = solve_ivp(moving, [0, 1e3], [way, 1e-7, slip, x], method="Radau", rtol=1e-9, atol=[1e-14, 1e-9, 1e-14, 1e-9], events=[of_motion, back])
V = max(rate(tau0 + alpha * (w - s), x) for w, _, s, x in s.y.T)
print("inertia: V passes 1e-3 at", t0 + s.t_events[0], "s; slip at reversal", s.y[2, -1], "m; largest V", V)
