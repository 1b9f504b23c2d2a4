"""Spring-slider of rate-and-state friction with radiation damping: the numbers of `quasi_dynamic.rs` and `fluid_pressure.rs`.

    python3 tests/time/spring_slider.py

q = a p arsinh(V/(2 V0) exp(psi/a)),  tau = q + eta V = tau0 + k (Vp t - s),  theta' = 1 - V theta/D or the slip law, by
LSODA at 1e-10 on (s, ln theta), with V found to the last digits by Newton's method in arsinh's argument.
"""

import numpy as np
from scipy.integrate import solve_ivp

a, b, f0, V0, D = 0.010, 0.015, 0.6, 1e-6, 0.008
p, eta, Vp = 50.0, 4.62, 1e-9
k = 1.0 / (1.0 / 10.0 + 1.0 / 1e6)  # of the spring and the contact's
year = 365 * 86400.0
tau0 = 30.0


def rate(tau, x, p=p):
    psi = f0 + b * x
    z = min(np.arcsinh(tau / (2 * V0 * eta) * np.exp(psi / a)), tau / (a * p))
    scale = 2 * V0 * np.exp(-psi / a)
    for _ in range(100):
        step = (a * p * z + eta * scale * np.sinh(z) - tau) / (a * p + eta * scale * np.cosh(z))
        z -= step
        if abs(step) < 1e-15 * z:
            break
    return scale * np.sinh(z)


def run(law, years):
    # State x = ln(V0 theta/D), half of that of steady sliding at Vp
    x0 = np.log(V0 * 0.5 * D / Vp / D)

    def of(t, z):
        V = rate(tau0 + k * (Vp * t - z[0]), z[1])
        if law == "ageing":
            return [V, (V0 * np.exp(-z[1]) - V) / D]
        return [V, -V / D * (z[1] + np.log(V / V0))]

    def fast(t, z):
        return np.log(rate(tau0 + k * (Vp * t - z[0]), z[1]) / 1e-3)

    solution = solve_ivp(of, [0, years * year], [0, x0], method="LSODA", rtol=1e-10, atol=[1e-12, 1e-10], events=fast)
    V = np.array([rate(tau0 + k * (Vp * t - s), x) for t, s, x in zip(solution.t, *solution.y)])
    print(law, solution.message)
    print("  s, x, V at the end:", *(f"{v:.9e}" for v in (*solution.y[:, -1], V[-1])))
    for t, z in zip(solution.t_events[0], solution.y_events[0]):
        print(f"  V passes 1e-3 at {t / year:.6f} yr, s = {z[0]:.8f}")
    for begin, end in zip(solution.t_events[0][::2], solution.t_events[0][1::2]):
        inside = (solution.t >= begin) & (solution.t <= end)
        print(f"  largest V {V[inside].max():.6f} in {end - begin:.4f} s")


run("ageing", 100)
run("slip", 100)


# Two states, psi = f0 + b x + b2 x2: the second one strengthens over ten times the slip.
def two_states(law, years, b2=-0.004, D2=0.08):
    x0 = np.log(V0 * 0.5 / Vp)

    def speed(z, t):
        return rate(tau0 + k * (Vp * t - z[0]), z[1] + b2 / b * z[2])

    def of(t, z):
        V = speed(z, t)
        if law == "ageing":
            return [V, (V0 * np.exp(-z[1]) - V) / D, (V0 * np.exp(-z[2]) - V) / D2]
        return [V, -V / D * (z[1] + np.log(V / V0)), -V / D2 * (z[2] + np.log(V / V0))]

    def fast(t, z):
        return np.log(speed(z, t) / 1e-3)

    solution = solve_ivp(of, [0, years * year], [0, x0, x0], method="LSODA", rtol=1e-10, atol=[1e-12, 1e-10, 1e-10], events=fast)
    z = solution.y[:, -1]
    print("two states,", law, "s, x, x2, V at the end:", *(f"{v:.9e}" for v in (*z, speed(z, solution.t[-1]))))
    print("  V passes 1e-3 at", *(f"{t / year:.6f}" for t in solution.t_events[0]), "yr")


two_states("ageing", 60)
two_states("slip", 60)


# Water: the pressure p - pw(t) is that of a block under a constant weight.
def under_water(years):
    water = lambda t: 12 * (1 - np.exp(-t / (2 * year))) * (1 + 0.2 * np.sin(t / year))

    def of(t, z):
        V = rate(tau0 + k * (Vp * t - z[0]), z[1], p - water(t))
        return [V, (V0 * np.exp(-z[1]) - V) / D]

    def fast(t, z):
        return np.log(rate(tau0 + k * (Vp * t - z[0]), z[1], p - water(t)) / 1e-3)

    x0 = np.log(V0 * 0.5 * D / Vp / D)
    solution = solve_ivp(of, [0, years * year], [0, x0], method="LSODA", rtol=1e-10, atol=[1e-12, 1e-10], max_step=0.02 * year, events=fast)
    s, x = solution.y[:, -1]
    V = rate(tau0 + k * (Vp * solution.t[-1] - s), x, p - water(solution.t[-1]))
    print("water: s, x, V at the end:", *(f"{v:.9e}" for v in (s, x, V)))
    print("  V passes 1e-3 at", *(f"{t / year:.6f}" for t in solution.t_events[0]), "yr")


under_water(40)
