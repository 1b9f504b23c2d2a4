"""The figures of the paper that the law comes from, and numbers for its explanations: runs the cases, draws, and prints tables.

    python3 docs/paper.py [PROGRAM] [FOLDER]

PROGRAM is target/release/fecontact by default; the runs go to FOLDER, out/paper by default, the figures to docs/figures. Some seconds.
Needs numpy and matplotlib.
"""

import json
import math
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
CASES = HERE.parent / "cases"
PROGRAM = sys.argv[1] if len(sys.argv) > 1 else str(HERE.parent / "target/release/fecontact")
FOLDER = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "out/paper")
plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9, "legend.frameon": False})

MU_S, MU_K, PRESSURE, ALPHA_T = 0.4, 0.2, 98.1, 1000.0
# More columns than can be told apart in a picture.
COLUMNS = 600


def history(name, case=None):
    """Columns of a run of a case of cases/paper, or of a changed one under another name."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = CASES / "paper" / f"{name}.json"
    if case is not None:
        path = FOLDER / f"{name}.json"
        path.write_text(json.dumps(case))
    subprocess.run([PROGRAM, "run", str(path), "--out", str(FOLDER / name), "--quiet"], check=True, stderr=subprocess.DEVNULL)
    return table(FOLDER / name / "history.csv")


def driven(name, alpha_t=ALPHA_T, dt=0.005, **friction):
    """Columns of a law test: u = sin t, as the paper's figure 11."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    case = {
        "friction": {"law": "super_subloading", "mu_s": MU_S, "mu_k": MU_K, "r": 100, "kappa": 10, "xi": 0.002, "structure": 1, "alpha_t": alpha_t, **friction},
        "initial": {"pressure": PRESSURE, "traction": MU_K * PRESSURE},
        "dt": dt,
        "path": [{"duration": 20, "slip": "sin(t)"}],
    }
    path = FOLDER / f"{name}.json"
    path.write_text(json.dumps(case))
    subprocess.run([PROGRAM, "law", str(path), "--out", str(FOLDER / name)], check=True, stderr=subprocess.DEVNULL)
    return table(FOLDER / name / "law.csv")


def table(path):
    with path.open() as file:
        names = file.readline().strip().split(",")
        numbers = [k for k, name in enumerate(names) if name != "step"]
        return dict(zip((names[k] for k in numbers), np.loadtxt(file, delimiter=",", usecols=numbers, unpack=True)))


def damped(number):
    """A case of cases/paper with damped, adaptive increments."""
    case = json.loads((CASES / "paper" / f"spring_mass_{number}.json").read_text())
    other = json.loads((CASES / "paper" / "spring_mass_3_damped.json").read_text())
    case["steps"][0].update({key: other["steps"][0][key] for key in ("scheme", "dt")})
    return case


def thinned(time, *columns):
    """The first, least and largest of every column: the picture stays the same."""
    pieces = np.array_split(np.arange(time.size), min(COLUMNS, time.size))
    rows = sorted({k for piece in pieces for of in columns for k in (piece[0], piece[of[piece].argmin()], piece[of[piece].argmax()])})
    return [column[rows] for column in (time, *columns)]


def figure(name, rows=1, columns=1, height=3.0, **more):
    made, axes = plt.subplots(rows, columns, figsize=(8, height), layout="constrained", **more)
    return made, np.atleast_1d(axes), lambda: made.savefig(HERE / "figures" / f"{name}.svg", metadata={"Date": None})


def show(title, head, rows):
    print(f"\n{title}\n\n| " + " | ".join(head) + " |\n|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(str(value) for value in row) + " |")


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


def springs():
    """Figures 5, 7a and 7b: the driven spring and mass."""
    runs = {1: history("spring_mass_1_damped", damped(1)), 2: history("spring_mass_2_damped", damped(2))}
    runs |= {k: history(f"spring_mass_{k}_damped") for k in (3, 4, 5)}
    made, (slip, friction), save = figure("paper_5", 2, height=5, sharex=True)
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
    made, (slip, friction), save = figure("paper_7", 1, 2, height=3.2)
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
    rows = []
    for k in (3, 4, 5):
        events = onsets(runs[k])
        rows.append([k, len(events), ", ".join(f"{time:.0f}" for time, _ in events[:4]), ", ".join(f"{way:.2f}" for _, way in events[:4]),
                     f"{runs[k]['base.tangential_force'].max() / PRESSURE:.4f}"])
    show("Slips in 12 000 (case 5: 8000)", ["case", "slips", "begin at", "slip", "largest friction over 98.1"], rows)
    one, two = (runs[k]["base.tangential_force"] for k in (1, 2))
    show("Without recovery", ["case", "largest friction", "at the end"],
         [[1, f"{one.max():.4f}", f"{one[-1]:.4f} (μ_s p = {MU_S * PRESSURE:.2f})"], [2, f"{two.max():.4f}", f"{two[-1]:.4f} (μ_k p = {MU_K * PRESSURE:.2f})"]])


def slope():
    """Figure 9: a block that stops on a slope."""
    runs = {name: history(name) for name in ("slope", "slope_damped", "slope_wilson")}
    made, (whole, end), save = figure("paper_9", 1, 2, height=3.2)
    angle = math.atan(0.15)
    weight = 98.1 * math.sin(angle)
    stop = 10 / (9.81 * (MU_K * math.cos(angle) - math.sin(angle)))
    rows = []
    for (name, run), look in zip(runs.items(), ("C0-", "C1--", "C2:")):
        time, force = run["time"], run["base.tangential_force"]
        whole.plot(*thinned(time, force), look, lw=0.8, label=name)
        late = time > 20
        end.plot(*thinned(time[late], force[late]), look, lw=0.8)
        after = time > stop
        speed = np.gradient(run["base.mean_slip"], time)
        rows.append([name, f"{time[np.flatnonzero(force < 0.99 * force[10])[0]]:.3f}", f"{force[after].min():.3f}", f"{force[after].max():.3f}", f"{force[time > time[-1] - 2].mean():.3f}"])
    whole.axhline(weight, color="0.6", lw=0.6)
    whole.set(xlabel="time", ylabel="friction")
    whole.legend(loc="lower left")
    end.axhline(weight, color="0.6", lw=0.6)
    end.set(xlabel="time", xlim=(20, 26))
    save()
    show(f"The stop: m g sin θ = {weight:.3f}, μ_k p = {MU_K * 98.1 * math.cos(angle):.3f}, in closed form at {stop:.4f}",
         ["run", "friction falls at", "least after", "largest after", "mean of the last 2"], rows)


def oscillation():
    """Figure 11: forced oscillation."""
    run = driven("forced")
    made, (way, friction), save = figure("paper_11", 2, height=4.4, sharex=True)
    way.plot(run["time"], run["slip"], "k-", lw=0.8, label="displacement")
    way.plot(run["time"], run["slip"] - run["traction"] / ALPHA_T, "C1--", lw=0.8, label="plastic")
    way.legend(loc="upper right")
    friction.plot(run["time"], run["traction"], "C0-", lw=0.8)
    friction.set(xlabel="time", ylabel="friction")
    save()
    rows = []
    for alpha_t in (1e3, 1e4, 1e5, 1e6):
        run = driven(f"forced_{alpha_t:g}", alpha_t, 0.001)
        late = run["time"] > 2 * math.pi
        rate, q = np.cos(run["time"]), run["traction"]
        along = (rate * q < 0) & late
        plastic = np.diff(run["plastic_slip"])
        against = (plastic * q[1:])[late[1:]]
        below = late & (abs(q) < 0.999 * MU_K * PRESSURE)
        # Four reversals, after each of which the contact spring goes back by q/α_t under u̇ = t − t₀.
        predicted = 4 * math.sqrt(2 * MU_K * PRESSURE / alpha_t) / (20 - 2 * math.pi)
        rows.append([f"{alpha_t:g}", f"{along.sum() / late.sum():.4f}", f"{predicted:.4f}", f"{below.sum() / late.sum():.4f}", f"{max(0.0, -against.min()):.1e}"])
    show("Share of the time", ["α_t", "friction along the motion", "4 √(2 μ_k p/α_t) of the time", "friction below 0.999 μ_k p", "least work of plastic slip"], rows)
    exact = driven("forced_exact", dt=0.001, tolerance=1e-9)
    rows = []
    for dt in (0.3, 0.1, 0.01, 0.001):
        found = []
        for integration in ("controlled", "backward_euler"):
            run = driven(f"forced_{integration}_{dt:g}", dt=dt, integration=integration)
            off = np.abs(run["traction"] - np.interp(run["time"], exact["time"], exact["traction"]))
            found += [f"{off.max():.1e}", f"{int(run['evaluations'].max())}"]
        rows.append([f"{dt:g}", *found])
    show("Largest difference of friction to Δt = 0.001 at a tolerance of 1e-9, between samples linearly",
         ["Δt", "controlled", "most evaluations", "backward Euler", "most evaluations"], rows)


def tensors():
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
    show("Vectors on an interface that turns by 4 radians, and the scalar form",
         ["form", "q", "p", "μ"],
         [["scalar", *(f"{value:.9f}" for value in one)], ["tensor", f"{-other[:2] @ s:.9f}", f"{other[:2] @ n:.9f}", f"{other[2]:.9f}"]])


if __name__ == "__main__":
    tensors()
    springs()
    slope()
    oscillation()
