"""Values of cases fitted through their runs: what was put in comes out of blocks whose interface slips unevenly."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import squares
from scipy import stats
from scipy.optimize import least_squares

import fecontact as fc
from fecontact.calibration import DisplacementField, Interface, Run

FRICTION = "contacts.base.friction."
TRUTH = {FRICTION + "mu_s": 0.4, FRICTION + "mu_k": 0.2, FRICTION + "kappa": 20.0}
START = {FRICTION + "mu_s": 0.7, FRICTION + "mu_k": 0.3, FRICTION + "kappa": 8.0}
FORCE = "base.tangential_force"
# Share of the largest force.
NOISE = 0.005


def pushed(**newton: Any) -> fc.Case:
    """A soft block pressed on ground and pushed at its left side: slip spreads from there over a third of the push."""
    ground = squares("ground", (0.0, -0.3), (2.8, 0.0), (14, 2), 0)
    block = squares("block", (0.2, 0.0), (2.2, 0.4), (8, 2), len(ground[0]))
    lists = lambda part: {name: array.tolist() for name, array in part.items()}  # noqa: E731
    nodes = np.concatenate([ground[0], block[0]]).tolist()
    mesh = {"nodes": nodes, "elements": lists({**ground[1], **block[1]}), "edges": lists({**ground[2], **block[2]})}
    material = {"model": "neo_hookean", "nu": 0.3}
    friction = {"law": "super_subloading", "mu_s": 0.4, "mu_k": 0.2, "alpha_t": 200.0, "r": 100, "kappa": 20, "xi": 0.002}
    held = [{"on": "ground_bottom", "ux": 0, "uy": 0}, {"on": "block_top", "uy": -0.02}, {"on": "block_left", "ux": 0}]
    return fc.Case(
        mesh=mesh,
        bodies={"ground": {"material": {**material, "E": 100}}, "block": {"material": {**material, "E": 10}}},
        contacts={"base": {"slave": "block_bottom", "master": "ground_top", "friction": friction}},
        steps=[
            {"name": "press", "duration": 1, "dt": {"initial": 0.5, "min": 1e-4}, "supports": held},
            {
                "name": "push",
                "duration": 5,
                "dt": {"initial": 0.2, "max": 0.2, "min": 1e-4},
                "supports": [{"on": "block_left", "ux": {"rate": 0.04}}],
            },
        ],
        newton=newton or {"tolerance": 1e-9},
    )


@lru_cache
def history(pressed: float = -0.02) -> pd.DataFrame:
    return pushed().replace({"steps[0].supports[1].uy": pressed}).run(progress=False).history


def record(seed: int | None, pressed: float = -0.02, **options: Any) -> Run:
    """A record with noise, or without."""
    true = history(pressed)[FORCE].to_numpy()
    noise = 0.0 if seed is None else NOISE * abs(true).max() * np.random.default_rng(seed).normal(size=true.size)
    case = pushed().replace({"steps[0].supports[1].uy": pressed})
    return Run(case, {FORCE: (history(pressed)["time"], true + noise)}, **options)


def covered(found: fc.Fit) -> dict[str, bool]:
    return {name: found.table["low"][name] <= value <= found.table["high"][name] for name, value in TRUTH.items()}


def test_the_interface_slips_unevenly() -> None:
    shares = history()["base.slip_fraction"]
    assert ((shares > 0) & (shares < 1)).sum() >= 3 and shares.iloc[-1] == 1.0


@pytest.mark.parametrize("seed", [0, 1])
def test_hidden_truth(seed: int) -> None:
    measured = record(seed)
    found = fc.fit(measured, free=list(TRUTH), start=START)
    assert all(covered(found).values()) and found.words == [] and found.runs <= 12
    # s of 27 − 3 degrees of freedom has a standard deviation of 14 %.
    assert found.noise == pytest.approx(NOISE * history()[FORCE].abs().max(), rel=0.45)
    # The band holds the curve without noise where that bends most and where it is steady.
    band, true = found.band(measured), history()[FORCE].to_numpy()
    inside = (band["low"] <= true) & (true <= band["high"])
    assert inside.mean() > 0.8 and (band["high"] - band["low"]).max() < 0.05
    np.testing.assert_allclose(found.predicted(measured) - measured.measured, found.residuals[0], atol=1e-12)
    np.testing.assert_array_equal(found.cases[0].run(progress=False).history[FORCE], found.predicted(measured))


@pytest.mark.slow
def test_intervals_are_those_of_the_draws() -> None:
    """Errors in standard deviations are, draw by draw, those of the linear theory with differences of complete runs at the truth; in many
    draws its intervals hold the truth in 95 %."""
    size = NOISE * history()[FORCE].abs().max()

    def force(name: str, share: float) -> np.ndarray:
        return pushed().replace({name: TRUTH[name] * (1 + share)}).run(progress=False).history[FORCE].to_numpy()

    slopes = np.stack([(force(name, 1e-4) - force(name, -1e-4)) / 2e-4 for name in TRUTH], axis=1)
    deviations = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))

    def of_theory(seed: int) -> np.ndarray:
        noise = size * np.random.default_rng(seed).normal(size=len(slopes))
        errors = np.linalg.lstsq(slopes, noise, rcond=None)[0]
        return errors / deviations / np.sqrt(np.sum((noise - slopes @ errors) ** 2) / (len(slopes) - len(TRUTH)))

    many = np.array([of_theory(seed) for seed in range(4000)])
    np.testing.assert_allclose((abs(many) <= stats.t.ppf(0.975, len(slopes) - len(TRUTH))).mean(axis=0), 0.95, atol=0.01)
    found = [fc.fit(record(seed), free=list(TRUTH), start=START) for seed in range(20)]
    assert max(one.runs for one in found) <= 12
    logarithms = np.log([one.table["value"] / list(TRUTH.values()) for one in found])
    ours, theirs = logarithms / np.array([one.table["std"] for one in found]), many[:20]
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=0.25)
    # Mean width of the intervals against the scatter of the fits.
    widths = np.mean([np.log(one.table["high"] / one.table["low"]) for one in found], axis=0)
    assert (widths < 1.5 * 3.92 * logarithms.std(axis=0, ddof=1)).all()


def test_same_as_scipy_with_differences_of_runs() -> None:
    """Values, and standard deviations by JᵀJ of complete runs."""
    measured, names = record(0), list(TRUTH)
    case, target = measured.case, measured.measured

    def residuals(logarithms: np.ndarray) -> np.ndarray:
        values = dict(zip(names, np.exp(logarithms)))
        return case.replace(values).run(progress=False).history[FORCE].to_numpy() - target

    # From the truth, which is not the minimum: its steps are longer, and lead from the other start to what the case refuses.
    theirs = least_squares(residuals, np.log(list(TRUTH.values())), "3-point", diff_step=1e-4, xtol=1e-7, ftol=1e-8)
    found = fc.fit(measured, free=names, start=START)
    assert found.ends["S"][0] == pytest.approx(2 * theirs.cost, rel=1e-6)
    deviations = found.noise * np.sqrt(np.diag(np.linalg.inv(theirs.jac.T @ theirs.jac)))
    np.testing.assert_allclose(found.table["std"], deviations, rtol=0.01)
    assert (abs(np.log(found.table["value"]) - theirs.x) < 0.01 * deviations).all()


def test_what_a_record_does_not_tell_is_said() -> None:
    found = fc.fit(record(0), free=[FRICTION + "mu_k", FRICTION + "xi"])
    assert any(f"these data do not determine {FRICTION}xi" in text for text in found.words)
    assert found.table["high"][FRICTION + "xi"] == np.inf
    assert found.table["low"][FRICTION + "mu_k"] <= 0.2 <= found.table["high"][FRICTION + "mu_k"]


def test_several_runs_tell_more() -> None:
    free = [FRICTION + "mu_k", "bodies.block.material.E"]
    one, both = (fc.fit(records, free=free) for records in (record(0), [record(0), record(1, -0.03, weight=2.0)]))
    assert (both.table["std"] < one.table["std"]).all() and len(both.residuals) == len(both.cases) == 2
    for name, value in zip(free, (0.2, 10.0)):
        assert both.table["low"][name] <= value <= both.table["high"][name]
    # Weights are no part of the residuals, and are of what they are compared with.
    for run, residuals, scaled, weight in zip((record(0), record(1, -0.03)), both.residuals, both.standardized, (1.0, 2.0)):
        np.testing.assert_allclose(both.predicted(run) - run.measured, residuals, atol=1e-12)
        np.testing.assert_allclose(scaled, residuals * weight / both.noise)
    ax = fc.plot.residuals(both)
    np.testing.assert_array_equal(ax.get_lines()[1].get_ydata(), both.standardized[1])


def test_columns_of_other_units_steps_by_name_and_bounds() -> None:
    columns = {FORCE: 0.002, "base.mean_slip": 2e-4}
    measured = Run(pushed(), {name: (history()["time"], history()[name]) for name in columns}, sigma=columns)
    # 0.04 of the case is outside of the first range, whose middle is where the search begins.
    place = "steps.push.supports.0.ux.rate"
    found = fc.fit(measured, free={place: (0.02, 0.039), FRICTION + "mu_k": (0.1, 0.3)})
    assert found.table["value"]["steps[1].supports[0].ux.rate"] == pytest.approx(0.039, rel=1e-3)
    assert any("ends at the border of its range" in text for text in found.words)
    assert any("this case does not follow these data" in text for text in found.words)
    found = fc.fit(measured, free={place: (0.02, 0.06), FRICTION + "mu_k": (0.1, 0.3)}, start={place: 0.03})
    np.testing.assert_allclose(found.table["value"], [0.04, 0.2], rtol=1e-4)


def test_between_increments_the_history_is_linear() -> None:
    rows = history()[["time", FORCE]].to_numpy()
    between = (0.75 * rows[:-1] + 0.25 * rows[1:]).T
    found = fc.fit(Run(pushed(), {FORCE: (between[0], between[1])}), free=[FRICTION + "mu_k"], start={FRICTION + "mu_k": 0.25})
    assert found.table["value"].item() == pytest.approx(0.2, rel=1e-6)


def test_trials_that_a_case_refuses_are_avoided() -> None:
    # From mu_s above mu_k by little, the first step leads to mu_s below.
    start = {FRICTION + "mu_s": 0.23, FRICTION + "mu_k": 0.22}
    found = fc.fit(record(None), free={name: (0.05, 1.0) for name in start}, start=start)
    np.testing.assert_allclose(found.table["value"], [0.4, 0.2], rtol=1e-3)


def test_a_profile_agrees_with_the_interval() -> None:
    name = FRICTION + "mu_k"
    found = fc.fit(record(0), free=[name])
    profile = found.profile(name)
    np.testing.assert_allclose([profile.attrs["low"], profile.attrs["high"]], found.table.loc[name, ["low", "high"]].astype(float), rtol=1e-3)


@pytest.mark.parametrize(
    ("free", "options", "message"),
    [
        ([FRICTION + "kapa"], {}, "kapa.*did you mean `kappa`"),
        (["mu_k"], {}, "free: mu_k: runs are fitted by places"),
        ([FRICTION + "law"], {}, "friction.law: is 'super_subloading': only a number can be fitted"),
        (["steps[0].supports[0].ux"], {}, "ux: is 0, and values are varied by a fraction"),
        (["steps.pusch.duration"], {}, "there is no `pusch` in steps; there is 0 to 1, press, push"),
        (["steps.push.duration"], {}, "`duration` determines the increments"),
        ([FRICTION + "mu_k", FRICTION + "mu_k"], {}, "given twice"),
        ({FRICTION + "mu_k": (0.5, 0.8)}, {}, "mu_s.*not less than"),
        ({FRICTION + "mu_k": 0.5}, {}, "the range is 0.5: give two numbers"),
        ({FRICTION + "mu_k": (0.1, 0.3)}, {"start": {FRICTION + "mu_k": 0.5}}, "start: .*mu_k: 0.5 is not within its range, 0.1 to 0.3"),
        ([FRICTION + "mu_k"], {"start": {FRICTION + "xi": 0.5}}, "start: .*xi is not free"),
        ([FRICTION + "mu_k"], {"mu_s": 0.3}, "mu_s: a fit through runs has none"),
        ([FRICTION + "mu_k"], {"law": "coulomb"}, "law: a fit through runs has none"),
        ([FRICTION + "mu_k"], {"starts": 2}, "starts: a fit through runs has none"),
        ([], {}, "free: is empty"),
    ],
)
def test_what_cannot_be_fitted(free: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fc.fit(record(None), free=free, **options)


def test_records_that_are_none() -> None:
    case, time, force = pushed(), history()["time"], history()[FORCE]
    free = [FRICTION + "mu_k"]
    for measured, message in [
        ({"base.tangental_force": (time, force)}, "no such column; did you mean `base.tangential_force`"),
        ({FORCE: (time + 1, force)}, "measured at time 7, but increments end at 0.5 to 6"),
        ({FORCE: (time - 1, force)}, "measured at time -0.5, but"),
        ({"iterations": (time, force)}, "has no derivatives"),
    ]:
        with pytest.raises(fc.CaseError, match=message):
            fc.fit(Run(case, measured), free=free)
    for arguments, message in [
        ((case.document, {FORCE: (time, force)}), "case: is a dict: give a Case"),
        ((case, {}), "measured: give times and values"),
        ((case, {FORCE: force}), "give two arrays"),
        ((case, {FORCE: (time, force[1:])}), r"values: has the shape \(26,\): must be \(27,\)"),
        ((case, {FORCE: (-time, force)}), "time: must be ascending"),
        ((case, {FORCE: (time, force * np.nan)}), "values: is not a finite number at 0"),
        ((case, {FORCE: (time, force), "base.mean_slip": (time, force)}), "sigma: several columns need it"),
    ]:
        with pytest.raises(ValueError, match=message):
            Run(*arguments)
    with pytest.raises(ValueError, match="sigma: there is none for base.tangential_force"):
        record(None, sigma={"base.mean_slip": 1.0})
    with pytest.raises(ValueError, match="weight: is 0"):
        record(None, weight=0)
    with pytest.raises(ValueError, match="there are runs and records of a point"):
        fc.fit([record(None), Interface([0.0, 1.0], [0.0, 1.0], 1.0, [0.0, 1.0])], free=free)
    with pytest.raises(ValueError, match="law: cases were fitted"):
        _ = fc.fit(record(None), free=free).law


def test_a_run_that_stops_says_so() -> None:
    case = pushed(max_iterations=1, tolerance=1e-12)
    with pytest.raises(fc.Stopped) as stopped:
        fc.fit(Run(case, {FORCE: (history()["time"], history()[FORCE])}), free=[FRICTION + "mu_k"])
    assert stopped.value.result is not None and stopped.value.result.status == "stopped"


# Places and times of a camera that looks at the block, away from its sides.
X, Y = (part.ravel() for part in np.meshgrid(np.linspace(0.3, 2.1, 5), np.linspace(0.1, 0.3, 2)))
TIMES = (2.0, 3.5, 5.0)


@lru_cache
def seen() -> fc.Result:
    """The true run, with a gauge and the points that the camera sees."""
    points = {f"p{k}": {"at": [x, y], "body": "block"} for k, (x, y) in enumerate(zip(X, Y))}
    return pushed().replace({"probes": {"gauge": {"at": [0.6, 0.1]}, **points}}).run(progress=False)


def photograph(time: float, seed: int, noise: float) -> DisplacementField:
    """Displacements at the time of an increment, with noise; some points are lost."""
    probes = seen().probes
    row = int(np.argmin(abs(probes["time"] - time)))
    random = np.random.default_rng([seed, row])
    ux, uy = (np.array([probes[f"p{k}.{part}"][row] for k in range(X.size)]) + noise * random.normal(size=X.size) for part in ("ux", "uy"))
    ux[3] = uy[3] = np.nan
    return DisplacementField(probes["time"][row], X, Y, ux, uy, sigma=noise, body="block")


def test_displacement_fields_alone_tell_the_friction_over_the_stiffness() -> None:
    noise = 1e-4
    found = [fc.fit(Run(pushed(), fields=[photograph(time, seed, noise) for time in TIMES]), free=[*TRUTH], start=START) for seed in range(2)]
    inside = [covered(one)[name] for one in found for name in TRUTH]
    assert sum(inside) >= 5, [one.table for one in found]
    for one in found:
        assert one.parameters[FRICTION + "mu_k"] == pytest.approx(0.2, rel=0.1) and len(one._problem.records[0].measured) == 3 * 2 * (X.size - 1)


def test_a_force_a_gauge_and_fields_are_fitted_together_and_tell_more_than_the_force() -> None:
    true, gauge, free = history()[FORCE].to_numpy(), seen().probes["gauge.strain_xx"].to_numpy(), [*TRUTH, "bodies.block.material.E"]
    time, random = history()["time"], np.random.default_rng(5)
    noises = {FORCE: NOISE * abs(true).max(), "gauge.strain_xx": 0.01 * abs(gauge).max()}
    measured = {FORCE: (time, true + noises[FORCE] * random.normal(size=true.size))}
    force = fc.fit(Run(pushed(), measured, sigma=noises[FORCE]), free=free, start=START)
    measured["gauge.strain_xx"] = (time, gauge + noises["gauge.strain_xx"] * random.normal(size=gauge.size))
    case = pushed().replace({"probes": {"gauge": {"at": [0.6, 0.1]}}})
    record = Run(case, measured, fields=[photograph(time, 0, 1e-4) for time in TIMES], sigma=noises)
    both = fc.fit(record, free=free, start=START)
    truth = {**TRUTH, "bodies.block.material.E": 10.0}
    inside = [both.table["low"][name] <= value <= both.table["high"][name] for name, value in truth.items()]
    assert sum(inside) >= 3, both.table
    width = lambda found: found.table["high"] - found.table["low"]  # noqa: E731
    assert (width(both) < width(force)).all(), (both.table, force.table)
    assert both.predicted(record).size == record.measured.size and "displacements" in record.kind


def test_derivatives_of_fields_are_those_of_differences() -> None:
    record = Run(pushed(tolerance=1e-12), fields=[photograph(time, 0, 1e-4) for time in TIMES])
    values = {FRICTION + "mu_k": 0.2, "bodies.block.material.E": 10.0}
    slopes = record.solved(values, [*values], None)[1]
    for k, (name, value) in enumerate(values.items()):
        high, low = (record.solved({**values, name: value * (1 + step)}, [], None)[0] for step in (1e-4, -1e-4))
        difference = (high - low) / (2e-4 * value)
        assert abs(slopes[:, k] - difference).max() < 1e-6 * abs(difference).max()


def test_fields_that_are_none_are_refused() -> None:
    field = lambda **changed: DisplacementField(**{"time": 2.0, "x": X, "y": Y, "ux": X, "uy": Y, **changed})  # noqa: E731
    for changed, why in [({"ux": X[1:]}, "give one for each"), ({"ux": np.nan * X, "uy": np.nan * X}, "no finite value"), ({"sigma": X[1:]}, "broadcast|sigma")]:
        with pytest.raises(ValueError, match=why):
            field(**changed)
    with pytest.raises(ValueError, match="some of what was measured"):
        Run(pushed(), {FORCE: ([2.0], [1.0])}, fields=[field()], sigma=0.1)
    with pytest.raises(fc.CaseError, match="lies in no body"):
        fc.fit(Run(pushed(), fields=[field(x=X + 50.0)]), free=[*TRUTH])
