"""The 4 m fault as a spring-slider: what 46 measured events tell of machine and law, and what they do not.

    python3 cases/laboratory/spring_slider.py docs/figures/laboratory_slider.svg

Needs the Python package. Units: MPa, mm, s.
"""

from __future__ import annotations

import csv
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

import fecontact as fc

# Normal stress, and mass an area: density 2980 kg/m³ times a height of 0.2 m, which is assumed.
PRESSURE, MASS = 2.0, 5.96e-7
# Assumed: weakening within two micrometres of slip, sliding at once, and a stiff contact.
GIVEN = {"kappa": 200.0, "r": 1e6, "alpha_t": 200.0, "mass": MASS}
# Rates of the load point, as shares of the mean one, for cycles of other recurrence; and samples a cycle.
RATES, SAMPLES = (0.4, 1.0, 2.5), 800
FOUND = ("mu_s", "mu_k", "xi")
# Steps of differences: far beyond what sampling leaves of the stress at an event.
STEPS = {"mu_s": 5e-4, "mu_k": 5e-4}


def events() -> dict[str, np.ndarray]:
    """Events 11 to 56, the first ten being those in which the sequence settles."""
    lines = (pathlib.Path(__file__).parent / "fault_4m_events.csv").read_text().splitlines()
    rows = [row for row in csv.DictReader(line for line in lines if line[0] != "#") if int(row["event"]) > 10]
    names = {"time": "t_s", "before": "tau_before_MPa", "after": "tau_after_MPa", "drop": "drop_MPa", "slip": "slip_mean_mm", "interval": "interval_s"}
    return {name: np.array([float(row[column]) for row in rows]) for name, column in names.items()}


def without_trend(data: dict[str, np.ndarray], name: str) -> tuple[np.ndarray, float]:
    """Stresses without what grows with time along the experiment, which no parameter of the law does; and their scatter
    about a line over the logarithm of the interval."""
    time, log = data["time"] - data["time"].mean(), np.log(data["interval"])
    columns = np.stack([np.ones_like(time), time, log], axis=1)
    fitted, squares, *_ = np.linalg.lstsq(columns, data[name], rcond=None)
    return data[name] - fitted[1] * time, float(np.sqrt(squares[0] / (time.size - 3)))


def machine(data: dict[str, np.ndarray]) -> dict[str, tuple[float, float]]:
    """Stiffness, drop over slip, and rate of the load point, slip over time: mean and standard error."""
    stiffness, rate = data["drop"] / data["slip"], data["slip"].sum() / data["interval"].sum()
    residual = data["slip"] - rate * data["interval"]
    error = np.sqrt(np.sum(residual**2)) / data["interval"].sum()
    return {"stiffness": (stiffness.mean(), stiffness.std(ddof=1) / np.sqrt(stiffness.size)), "rate": (rate, error)}


def cycle(parameters: dict[str, Any], rate: float, cycles: int = 4) -> dict[str, np.ndarray]:
    """The mean cycle of a slider that is pulled at a rate, from its second event on: stress before and after, slip and interval;
    not a number where it does not stick and slip. Shape: that of the parameters, of which one at least is an array."""
    sets = np.broadcast_shapes(*(np.shape(value) for value in parameters.values()))
    spread = {name: np.broadcast_to(value, sets) for name, value in parameters.items()}
    machine = {name: spread.pop(name) for name in ("stiffness", "mass")}
    fall = float(np.max(spread["mu_s"] - spread["mu_k"]))
    # The longest cycle there can be, and the stress after the strength has fallen at once.
    longest = 2.0 * PRESSURE * fall / float(np.min(machine["stiffness"])) / rate
    start = PRESSURE * float(np.min(spread["mu_k"]) - fall)
    time = np.linspace(0.0, cycles * longest, cycles * SAMPLES)
    slider = fc.law("super_subloading", **spread).slider(time, rate * time, PRESSURE, **machine, force=start, tolerance=1e-7)
    flat = zip(slider.force.reshape(-1, time.size), slider.slip.reshape(-1, time.size))
    found = [_mean(time, force, slip, rate) for force, slip in flat]
    return {name: np.reshape([one[name] for one in found], sets) for name in ("before", "after", "slip", "interval")}


def _mean(time: np.ndarray, force: np.ndarray, slip: np.ndarray, rate: float) -> dict[str, float]:
    fast = np.diff(slip) > 20.0 * rate * np.diff(time)
    onsets = np.flatnonzero(fast[1:] & ~fast[:-1]) + 1
    onsets = onsets[onsets < time.size - 5]
    if onsets.size < 3:
        return dict.fromkeys(("before", "after", "slip", "interval"), np.nan)
    later = onsets[1:]
    return {
        "before": float(np.mean([force[at - 1 : at + 1].max() for at in later])),
        "after": float(np.mean([force[at : at + 5].min() for at in later])),
        "slip": float(np.mean(slip[later + 4] - slip[later - 1])),
        "interval": float(np.mean(np.diff(time[onsets]))),
    }


class Events:
    """Stresses before and after events over the interval before them."""

    def __init__(self, data: dict[str, np.ndarray], rate: float) -> None:
        (before, scatter), (after, other) = without_trend(data, "before"), without_trend(data, "after")
        self.rate, self.log = rate, np.log(data["interval"])
        self.measured = np.concatenate([before, after])
        self.sigma = np.repeat([scatter, other], before.size)

    def predicted(self, parameters: dict[str, Any]) -> np.ndarray:
        """What the slider says instead, shape (sets, 92): a parabola over the logarithm of the interval, through cycles at three
        rates."""
        cycles = [cycle(parameters, share * self.rate) for share in RATES]
        logs = np.log([each["interval"] for each in cycles])
        told = []
        for what in ("before", "after"):
            value = np.zeros((logs.shape[1], self.log.size))
            for k in range(3):
                shares = [(self.log - logs[j][:, None]) / (logs[k] - logs[j])[:, None] for j in range(3) if j != k]
                value += cycles[k][what][:, None] * np.prod(shares, axis=0)
            told.append(value)
        return np.concatenate(told, axis=-1)

    def residuals(self, parameters: dict[str, Any]) -> np.ndarray:
        return (self.predicted(parameters) - self.measured) / self.sigma

    def slopes(self, parameters: dict[str, Any], by: Sequence[str]) -> np.ndarray:
        """Derivatives of the residuals by parameters, by the logarithms of those that are no coefficients of friction."""
        moved = {name: [] for name in parameters}
        for name in by:
            step = STEPS.get(name, 0.1 * parameters[name])
            for other, value in parameters.items():
                moved[other] += [value - step, value + step] if other == name else [value, value]
        residuals = self.residuals({name: np.array(values) for name, values in moved.items()})
        width = np.array([2.0 * STEPS.get(name, 0.1) for name in by])
        return ((residuals[1::2] - residuals[::2]) / width[:, None]).T


def fitted(record: Events, stiffness: float) -> tuple[dict[str, float], np.ndarray, float]:
    """Parameters, the covariance of those found (ln ξ for ξ), and the sum of squares."""
    from scipy.optimize import least_squares

    def parameters(point: np.ndarray) -> dict[str, float]:
        return {"mu_s": point[0], "mu_k": point[1], "xi": float(np.exp(point[2])), **GIVEN, "stiffness": stiffness}

    def residuals(point: np.ndarray) -> np.ndarray:
        return record.residuals({name: np.array([value]) for name, value in parameters(point).items()})[0]

    def slopes(point: np.ndarray) -> np.ndarray:
        return record.slopes(parameters(point), FOUND)

    # From the mean stresses, if the strength falls at once and swings through: μ_k between them, and half the healing in a cycle.
    before, after = np.split(record.measured, 2)
    kinetic = 0.5 * (before.mean() + after.mean()) / PRESSURE
    start = np.array([kinetic + 1.3 * (before.mean() / PRESSURE - kinetic), kinetic, np.log(0.15)])
    end = least_squares(residuals, start, slopes, x_scale="jac", ftol=1e-3, xtol=1e-4, max_nfev=8)
    return parameters(end.x), np.linalg.inv(end.jac.T @ end.jac), 2.0 * end.cost


def main(target: str | None) -> None:
    data = events()
    told = machine(data)
    for name, (value, error) in told.items():
        print(f"{name}: {value:.4g} ± {error:.2g}")
    stiffness, rate = told["stiffness"][0], told["rate"][0]
    record = Events(data, rate)
    found, covariance, squares = fitted(record, stiffness)
    print(f"S = {squares:.1f} of {record.measured.size} stresses\n\n| | value | 95 % |\n|---|---|---|")
    for name, std in zip(FOUND, np.sqrt(np.diag(covariance))):
        low, high = (found[name] + side * 1.96 * std if name in STEPS else found[name] * np.exp(side * 1.96 * std) for side in (-1, 1))
        print(f"| {name} | {found[name]:.4f} | {low:.4f} to {high:.4f} |")
    last = cycle({name: np.array([value]) for name, value in found.items()}, rate)
    rows = {"slider": {name: value[0] for name, value in last.items()}, "46 events": {name: data[name].mean() for name in data}}
    rows["slider"]["drop"] = rows["slider"]["before"] - rows["slider"]["after"]
    rows["± of their mean"] = {name: data[name].std(ddof=1) / np.sqrt(data["time"].size) for name in data}
    print("\n| | before [MPa] | after [MPa] | drop [MPa] | slip [mm] | interval [s] |\n|---|---|---|---|---|---|")
    for name, row in rows.items():
        print(f"| {name} | " + " | ".join(f"{row[what]:.4g}" for what in ("before", "after", "drop", "slip", "interval")) + " |")
    # What one of the given parameters would be found with, were it free as well, and how those found follow it.
    known, others = record.slopes(found, FOUND), record.slopes(found, list(GIVEN))
    print("\n| 10 times the | std of its logarithm, free | mu_s | mu_k | xi times |\n|---|---|---|---|---|")
    for name, column in zip(GIVEN, others.T):
        follow, *_ = np.linalg.lstsq(known, -column, rcond=None)
        std, decade = 1.0 / np.linalg.norm(column + known @ follow), np.log(10.0)
        print(f"| {name} | {std:.2g} | {decade * follow[0]:+.4f} | {decade * follow[1]:+.4f} | {np.exp(decade * follow[2]):.2g} |")
    if target:
        draw(data, record, found, target)


def draw(data: dict[str, np.ndarray], record: Events, found: dict[str, float], target: str) -> None:
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "fecontact", "font.size": 9})
    figure, panel = plt.subplots(figsize=(5, 3.2), layout="constrained")
    half, order = record.log.size, np.argsort(record.log)
    told = record.predicted({name: np.array([value]) for name, value in found.items()})[0]
    for part, name, color in ((slice(0, half), "before", "C3"), (slice(half, None), "after", "C2")):
        panel.semilogx(data["interval"], record.measured[part], ".", color=color, label=f"measured {name} events, trend removed")
        panel.semilogx(data["interval"][order], told[part][order], "-", color=color, label="spring-slider")
    panel.set(xlabel="time since the event before [s]", ylabel="shear stress [MPa]")
    panel.set_xticks([2, 3, 4, 6, 10], ["2", "3", "4", "6", "10"])
    panel.legend(frameon=False, fontsize=7)
    figure.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
