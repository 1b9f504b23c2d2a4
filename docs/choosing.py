"""What the numbers of super/subloading friction mean, and how they are read from tests: tables of docs/guide/laws.md. Needs numpy."""

import numpy as np

from problems import digits, row
from results import committed, law

LAW = {"law": "super_subloading"}


def slid(program, mu_s, mu_k, r, kappa):
    """Slip from long rest, so fast that nothing heals: the rows up to where friction is down at μ_k."""
    end = 12.0 * mu_k / kappa
    friction = {**LAW, "mu_s": mu_s, "mu_k": mu_k, "r": r, "kappa": kappa, "alpha_t": 1e5 * r}
    steps = [{"duration": part, "slip": part * end, "dt": part / 4000} for part in (0.01, 0.1, 1)]
    return law(program, {"friction": friction, "initial": {"pressure": 1}, "path": steps})


def peak_and_half(program, mu_s, mu_k, r, kappa):
    """Largest q/p, the plastic slip up to it, and that which takes half of μ_s − μ_k."""
    found = slid(program, mu_s, mu_k, r, kappa)
    at = found["traction"].argmax()
    half = np.interp(-0.5 * (mu_s + mu_k), -found["mu"], found["plastic_slip"])
    return found["traction"][at], found["plastic_slip"][at], half


def half_healed(program, mu_s, mu_k, xi):
    """The rest that brings half of μ_s − μ_k back."""
    friction = {**LAW, "mu_s": mu_s, "mu_k": mu_k, "xi": xi, "r": 1, "alpha_t": 1, "structure": 1}
    found = law(program, {"friction": friction, "initial": {"pressure": 1}, "path": [{"duration": 2 * mu_s / xi, "dt": mu_s / xi / 1000}]})
    return np.interp(0.5 * (mu_s + mu_k), found["mu"], found["time"])


def choosing_peak(program):
    """The peak from long rest over μ_s, by how fast R rises beside how fast μ falls."""
    ratios = (1, 2, 5, 10, 20, 50, 100, 400)
    rows = [["r μ_k/κ", *map(str, ratios)]]
    for mu_s in (0.42, 0.5, 0.6, 0.8):
        peaks = [peak_and_half(program, mu_s, 0.4, ratio, 0.4)[0] for ratio in ratios]
        rows.append([f"μ_s/μ_k = {mu_s / 0.4:.4g}", *(f"{peak / mu_s:.3f}" for peak in peaks)])
    return rows


def short(value):
    return digits(value, 2) if value >= 1e-3 else f"{value:.2g}"


def choosing_cases(program):
    """Committed cases, in the numbers of a test."""
    rows = [["case", "μ_s, μ_k", "r, κ, ξ", "peak q/p", "plastic slip to it", "half of the fall", "half healed"]]
    for path in ("law/monotone", "law/hold_slide_hold", "block_on_ground", "stick_slip", "laboratory/fault_4m"):
        case = committed(f"cases/{path}.json")
        told = case.get("friction") or next(iter(case["contacts"].values()))["friction"]
        mu_s, mu_k, r, kappa, xi = (told[name] for name in ("mu_s", "mu_k", "r", "kappa", "xi"))
        length, time = (case.get("units", {}).get(name, "") for name in ("length", "time"))
        peak, slip, half = peak_and_half(program, mu_s, mu_k, r, kappa)
        rows.append([f"`cases/{path}.json`", f"{mu_s:g}, {mu_k:g}", f"{r:g}, {kappa:g}, {xi:g}", digits(peak, 3), f"{short(slip)} {length}",
                     f"{short(half)} {length}", f"{short(half_healed(program, mu_s, mu_k, xi))} {time}"])
    return rows


def choosing_read(program):
    """κ, ξ and r read from curves as an experiment would read them, against what was put in."""
    case = committed("cases/law/velocity_steps.json")
    told, found = case["friction"], law(program, case)
    rows = [["read from", "closed form", "read", "difference"]]
    friction, start = found["traction"] / found["pressure"], 0.0
    for before, leg in zip(case["path"], case["path"][1:]):
        start += before["duration"]
        rate = leg["slip"]["rate"]
        length = 1.0 / (told["kappa"] / told["mu_k"] + told["xi"] / (told["mu_s"] * rate))
        end = start + leg["duration"]
        part = (found["time"] > start + 0.2 * length / rate) & (found["time"] < start + 3.0 * length / rate)
        rest = friction[part] - friction[np.abs(found["time"] - end).argmin()]
        read = -1.0 / np.polyfit(found["slip"][part], np.log(np.abs(rest)), 1)[0]
        rows.append(row(f"step to {rate:g} mm/s: slip of the decay [mm]", length, read, 4))
    case = committed("cases/law/hold_slide_hold.json")
    told, found = case["friction"], law(program, case)
    friction, holds, peaks, time = found["traction"] / found["pressure"], [], [], 0.0
    for leg in case["path"]:
        during = (found["time"] > time) & (found["time"] <= time + leg["duration"])
        holds, peaks = (holds, [*peaks, friction[during].max()]) if "slip" in leg else ([*holds, leg["duration"]], peaks)
        time += leg["duration"]
    rest, holds = peaks[-1] - np.array(peaks[1:]), np.array(holds)
    some = (holds >= 16) & (holds <= 256)
    rows.append(row("holds of 16 to 256 s: −d ln(last peak − peak)/d hold [1/s]", told["xi"] / told["mu_s"],
                    -np.polyfit(holds[some], np.log(rest[some]), 1)[0], 4))
    return rows


CHOOSING = {"choosing_peak": choosing_peak, "choosing_cases": choosing_cases, "choosing_read": choosing_read}
