"""The figures of the paper that the law comes from, and numbers for its explanations: figures and tables of docs/paper.md.

    python3 docs/paper.py [PROGRAM]

runs the cases, draws the figures into docs/figures, and prints the tables (docs/tables.py writes them into the page). PROGRAM is
target/release/fecontact by default. Some seconds. Needs numpy, and matplotlib for the figures.
"""

import functools
import math
import sys

import numpy as np

import results
from results import ROOT, committed, text_of

MU_S, MU_K, PRESSURE, ALPHA_T = 0.4, 0.2, 98.1, 1000.0
ANGLE = math.atan(0.15)
# The block on the slope stops there, in closed form.
STOP = 10 / (9.81 * (MU_K * math.cos(ANGLE) - math.sin(ANGLE)))
# More columns than can be told apart in a picture.
COLUMNS = 600


@functools.cache
def history(program, name):
    """Columns of a run of a case of cases/paper; cases 1 and 2 have damped increments as case 3 has them."""
    of_case_3 = name in ("spring_mass_1_damped", "spring_mass_2_damped")
    case = committed(f"cases/paper/{name.removesuffix('_damped') if of_case_3 else name}.json")
    if of_case_3:
        other = committed("cases/paper/spring_mass_3_damped.json")
        case["steps"][0].update({key: other["steps"][0][key] for key in ("scheme", "dt")})
    return results.Run(program, {**case, "output": {"fields": False}}).history


@functools.cache
def springs(program):
    """Histories of cases 1 to 5."""
    return {k: history(program, f"spring_mass_{k}_damped") for k in range(1, 6)}


@functools.cache
def driven(program, alpha_t=ALPHA_T, dt=0.005, **friction):
    """Columns of a law test: u = sin t, as the paper's figure 11."""
    law = {"law": "super_subloading", "mu_s": MU_S, "mu_k": MU_K, "r": 100, "kappa": 10, "xi": 0.002, "structure": 1, "alpha_t": alpha_t, **friction}
    initial = {"pressure": PRESSURE, "traction": MU_K * PRESSURE}
    return results.law(program, {"friction": law, "initial": initial, "dt": dt, "path": [{"duration": 20, "slip": "sin(t)"}]})


def onsets(run):
    """Times of the fastest slip of every event: where the slip of an increment is faster than ten times the driver."""
    time, slip = run["time"], run["base.mean_slip"]
    rate = np.gradient(slip, time)
    fast = rate > 0.01
    begins = np.flatnonzero(fast[1:] & ~fast[:-1]) + 1
    ends = np.flatnonzero(~fast[1:] & fast[:-1]) + 1
    if len(ends) and len(begins) and ends[0] < begins[0]:
        ends = ends[1:]
    events = []
    for begin, end in zip(begins, ends):
        if events and begin - events[-1][1] < 5:
            events[-1][1] = end
        else:
            events.append([begin, end])
    return [(time[begin], slip[end] - slip[begin]) for begin, end in events if slip[end] - slip[begin] > 0.1]


def slips(program):
    """Slip events of cases 3 to 5."""
    forces, rows = {3: "constant", 4: "+0.01 t", 5: "−0.01 t"}, [["case", "normal force", "slips", "begin at", "slip"]]
    for k, force in forces.items():
        run = springs(program)[k]
        found = onsets(run)
        count = f"{len(found)} in {run['time'][-1]:.0f}"
        rows.append([str(k), force, count, ", ".join(f"{time:.0f}" for time, _ in found[:4]), ", ".join(f"{way:.2f}" for _, way in found[:4])])
    return rows


def peaks(program):
    """Friction of the cases without recovery."""
    rows = [["case", "largest friction", "at the end", "μ_s p", "μ_k p"]]
    for k in (1, 2):
        force = springs(program)[k]["base.tangential_force"]
        rows.append([str(k), f"{force.max():.4f}", f"{force[-1]:.4f}", f"{MU_S * PRESSURE:.2f}", f"{MU_K * PRESSURE:.2f}"])
    return rows


def stop(program):
    """The block that stops on a slope."""
    rows = [["scheme", "friction falls at", "least after", "largest after", "mean of the last 2"]]
    for name, said in (("slope", "trapezoidal rule"), ("slope_damped", "damped"), ("slope_wilson", "Wilson-θ")):
        run = history(program, name)
        time, force = run["time"], run["base.tangential_force"]
        after, falls = time > STOP, time[np.flatnonzero(force < 0.99 * force[10])[0]]
        rows.append([said, f"{falls:.2f}", f"{force[after].min():.2f}", f"{force[after].max():.2f}", f"{force[time > time[-1] - 2].mean():.2f}"])
    return rows


def along(program):
    """Where friction acts along the motion, and below μ_k p: shares of the time."""
    rows = [["α_t", "friction along the motion", "by √(2 μ_k p/α_t)", "friction below 0.999 μ_k p", "least work of an increment"]]
    for alpha_t in (1e3, 1e4, 1e5, 1e6):
        run = driven(program, alpha_t, 0.001)
        late, q = run["time"] > 2 * math.pi, run["traction"]
        with_it = (np.cos(run["time"]) * q < 0) & late
        below = late & (abs(q) < 0.999 * MU_K * PRESSURE)
        work = (np.diff(run["plastic_slip"]) * q[1:])[late[1:]].min()
        # Four reversals, after each of which the contact spring goes back by q/α_t under u̇ = t − t₀.
        predicted = 4 * math.sqrt(2 * MU_K * PRESSURE / alpha_t) / (20 - 2 * math.pi)
        shares = [f"{with_it.sum() / late.sum():.4f}", f"{predicted:.4f}", f"{below.sum() / late.sum():.3f}"]
        rows.append([f"10^{round(math.log10(alpha_t))}", *shares, "0" if work >= 0.0 else f"{work:.1e}"])
    return rows


def increments(program):
    """Friction at several Δt against that of 0.001 at a tolerance of 1e-9, between its samples linearly."""
    exact = driven(program, dt=0.001, tolerance=1e-9)
    rows = [["Δt", "controlled", "backward Euler", "evaluations, controlled", "backward Euler"]]
    for dt in (0.3, 0.1, 0.01, 0.001):
        runs = [driven(program, dt=dt, integration=integration) for integration in ("controlled", "backward_euler")]
        off = [np.abs(run["traction"] - np.interp(run["time"], exact["time"], exact["traction"])).max() for run in runs]
        rows.append([f"{dt:g}", *(f"{value:.1e}" for value in off), *(f"{run['evaluations'].max():.0f}" for run in runs)])
    return rows


def tensors(_):
    """The rate form in vectors, equations 15 to 19, on an interface that turns, against the scalar form."""
    mu_s, mu_k, r, kappa, xi, alpha = MU_S, MU_K, 100.0, 10.0, 0.002, ALPHA_T

    def slip_rate(time):
        return 0.02 + 0.01 * math.sin(3 * time)

    def closing(time):
        return 0.005 * math.cos(2 * time)

    def parts(ratio, mu, p):
        heals, loses = xi * (1 - mu / mu_s), kappa * (mu / mu_k - 1)
        return heals, loses, alpha + r * -math.log(ratio) * mu * p - ratio * loses * p

    def scalar(time, y):
        q, p, mu = y
        v, dp = slip_rate(time), alpha * closing(time)
        ratio = q / (mu * p)
        heals, loses, den = parts(ratio, mu, p)
        rate = max(alpha * v - ratio * heals * p - ratio * mu * dp, 0.0) / den
        return np.array([alpha * (v - rate), dp, heals - loses * rate])

    spin = 2.0

    def tensor(time, y):
        f, mu = y[:2], y[2]
        angle = spin * time
        n, s = np.array([-math.sin(angle), math.cos(angle)]), np.array([math.cos(angle), math.sin(angle)])
        normal = np.outer(n, n)
        v = slip_rate(time) * s - closing(time) * n
        f_n, f_t = normal @ f, f - normal @ f
        t, p = f_t / np.linalg.norm(f_t), np.linalg.norm(f_n)
        ratio = np.linalg.norm(f_t) / (mu * p)
        heals, loses, den = parts(ratio, mu, p)
        elastic = -alpha * (np.eye(2) - normal) - alpha * normal
        row = alpha * ratio * mu * n - alpha * t
        loading = row @ v - ratio * heals * p
        rate = max(loading, 0.0) / den
        if loading > 0:
            change = (elastic - alpha * np.outer(t, row) / den) @ v + alpha * ratio * heals * p / den * t
        else:
            change = elastic @ v
        turning = spin * np.array([-f[1], f[0]])
        return np.array([*(change + turning), heals - loses * rate])

    def integrated(rates, y, end=2.0, steps=20000):
        h = end / steps
        for k in range(steps):
            time = k * h
            k1 = rates(time, y)
            k2 = rates(time + h / 2, y + h / 2 * k1)
            k3 = rates(time + h / 2, y + h / 2 * k2)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(time + h, y + h * k3))
        return y

    one = integrated(scalar, np.array([4.0, PRESSURE, 0.35]))
    other = integrated(tensor, np.array([-4.0, PRESSURE, 0.35]))
    angle = spin * 2.0
    n, s = np.array([-math.sin(angle), math.cos(angle)]), np.array([math.cos(angle), math.sin(angle)])
    numbers = [[*one], [-other[:2] @ s, other[:2] @ n, other[2]]]
    return [["form", "q", "p", "μ"], *([name, *(f"{value:.7f}" for value in row)] for name, row in zip(("scalar", "tensor"), numbers))]


PAPER = {
    "paper_peaks": peaks,
    "paper_slips": slips,
    "paper_stop": stop,
    "paper_along": along,
    "paper_increments": increments,
    "paper_tensor": tensors,
}


def thinned(time, *columns):
    """The first, least and largest of every column: the picture stays the same."""
    pieces = np.array_split(np.arange(time.size), min(COLUMNS, time.size))
    rows = sorted({k for piece in pieces for of in columns for k in (piece[0], piece[of[piece].argmin()], piece[of[piece].argmax()])})
    return [column[rows] for column in (time, *columns)]


def figure(name, rows=1, columns=1, height=3.0, **more):
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9, "legend.frameon": False})
    made, axes = plt.subplots(rows, columns, figsize=(8, height), layout="constrained", **more)
    return np.atleast_1d(axes), lambda: made.savefig(ROOT / "docs" / "figures" / f"{name}.svg", metadata={"Date": None})


def draw_springs(program):
    """Figures 5, 7a and 7b: the driven spring and mass."""
    runs = springs(program)
    (slip, friction), save = figure("paper_5", 2, height=5, sharex=True)
    for k, look in ((1, "k:"), (2, "C1--"), (3, "C0-")):
        time, way, force = thinned(runs[k]["time"], runs[k]["block.ux"], runs[k]["base.tangential_force"])
        early = time <= 5000
        slip.plot(time[early], way[early], look, lw=1, label=f"case {k}")
        friction.plot(time[early], force[early], look, lw=1)
    slip.set(ylabel="slip")
    slip.legend()
    for of, name in ((MU_S, "μ_s p"), (MU_K, "μ_k p")):
        friction.axhline(of * PRESSURE, color="0.6", lw=0.6)
        friction.annotate(name, (5000, of * PRESSURE), ha="right", va="bottom", fontsize=8)
    friction.set(ylabel="friction", xlabel="time")
    save()
    (slip, friction), save = figure("paper_7", 1, 2, height=3.2)
    for k, look in ((3, "C0-"), (4, "C1--"), (5, "C2-.")):
        run = runs[k]
        time, way = thinned(run["time"], run["block.ux"])
        slip.plot(time, way, look, lw=1, label=f"case {k}")
        _, normal, force = thinned(run["time"], run["base.normal_force"], run["base.tangential_force"])
        friction.plot(normal, force, look, lw=0.8)
    slip.set(xlabel="time", ylabel="slip")
    slip.legend()
    normal = np.array([20, 220])
    friction.plot(normal, MU_K * normal, "k:", lw=0.8)
    friction.set(xlabel="normal force", ylabel="friction")
    save()


def draw_slope(program):
    """Figure 9: a block that stops on a slope."""
    (whole, end), save = figure("paper_9", 1, 2, height=3.2)
    for name, look in (("slope", "C0-"), ("slope_damped", "C1--"), ("slope_wilson", "C2:")):
        run = history(program, name)
        time, force = run["time"], run["base.tangential_force"]
        whole.plot(*thinned(time, force), look, lw=0.8, label=name)
        late = time > 20
        end.plot(*thinned(time[late], force[late]), look, lw=0.8)
    weight = PRESSURE * math.sin(ANGLE)
    whole.axhline(weight, color="0.6", lw=0.6)
    whole.set(xlabel="time", ylabel="friction")
    whole.legend(loc="lower left")
    end.axhline(weight, color="0.6", lw=0.6)
    end.set(xlabel="time", xlim=(20, 26))
    save()


def draw_oscillation(program):
    """Figure 11: forced oscillation."""
    run = driven(program)
    (way, friction), save = figure("paper_11", 2, height=4.4, sharex=True)
    way.plot(run["time"], run["slip"], "k-", lw=0.8, label="displacement")
    way.plot(run["time"], run["slip"] - run["traction"] / ALPHA_T, "C1--", lw=0.8, label="plastic")
    way.legend(loc="upper right")
    friction.plot(run["time"], run["traction"], "C0-", lw=0.8)
    friction.set(xlabel="time", ylabel="friction")
    save()


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/fecontact")
    for draw in (draw_springs, draw_slope, draw_oscillation):
        draw(program)
    print("\n\n".join(text_of(make(program)) for make in PAPER.values()))


if __name__ == "__main__":
    main()
