"""Tests of samples: what the element answers is that of closed forms, and what was put in comes out of fits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fecontact as fc
from fecontact.calibration import Interface, Oedometer, Run, Triaxial

# λ̂ = 0.10 and κ̂ = 0.02 of the Kirchhoff stress.
LAMBDA, KAPPA, M, G = 0.10, 0.02, 1.2, 3000.0
CLAY = {"model": "cam_clay", "lambda": LAMBDA / (1 + LAMBDA), "kappa": KAPPA / (1 + KAPPA), "M": M, "G": G, "OCR": 1, "p_min": 1}
SAND = {"model": "mohr_coulomb", "E": 5e4, "nu": 0.3, "c": 10, "phi": 30, "psi": 5}


def triaxial(strain: Any, made_by: dict[str, Any] | None = None, *, seed: int | None = None, sigma: Any = None, **options: Any) -> Triaxial:
    """A record without values, or one made by a law, with noise."""
    strain = np.asarray(strain, dtype=float)
    names = sigma or {"deviator": 1.0}
    empty = {name: np.zeros(strain.size) for name in names}
    test = Triaxial(strain, **empty, sigma=names, **options)
    if made_by is None:
        return test
    return Triaxial(strain, **made(test, made_by, names, seed), sigma=sigma, **options)


def made(test: Triaxial | Oedometer, law: dict[str, Any], noise: dict[str, float], seed: int | None) -> dict[str, np.ndarray]:
    """What a law gives for every quantity, with noise but at the start."""
    parts = np.split(test.of(law).predicted({})[0], len(noise))
    random = np.random.default_rng(seed)
    size = {name: 0.0 if seed is None else one for name, one in noise.items()}
    return {name: np.append(0.0, part + size[name] * random.normal(size=part.size)) for name, part in zip(noise, parts)}


def answers(test: Triaxial | Oedometer, law: dict[str, Any], quantities: int = 1) -> list[np.ndarray]:
    return np.split(test.of(law).predicted({})[0], quantities)


@pytest.mark.parametrize("ocr", [1.0, 1.6])
def test_undrained_clay_follows_the_closed_form(ocr: float) -> None:
    """p = p₀ [OCR/(1 + (η/M)²)]^Λ and ε_s = q/3G + (2κ̂Λ/M)[atanh(η/M) − atan(η/M)], counted from the yield point."""
    share, p_0 = 1 - KAPPA / LAMBDA, 100.0
    first = M * np.sqrt(ocr - 1)
    plastic = lambda eta: 2 * KAPPA * share / M * (np.arctanh(eta / M) - np.arctan(eta / M))  # noqa: E731
    pressure = lambda eta: p_0 * (ocr / (1 + (eta / M) ** 2)) ** share  # noqa: E731
    strain = lambda eta: plastic(eta) - plastic(first) + eta * pressure(eta) / (3 * G)  # noqa: E731
    at = np.array([0.004, 0.01, 0.03, 0.05, 0.15])
    at = at[at > strain(first)]
    eta = np.array([brentq(lambda eta: strain(eta) - one, first, M * (1 - 1e-15)) for one in at])
    q, p = eta * pressure(eta), pressure(eta)
    if ocr == 1:
        # The same, from an integration of the rates by others.
        np.testing.assert_allclose(p[1:], [78.849, 61.242, 58.244, 57.435], rtol=1e-4)
    # Strains of the closed form are logarithmic.
    names = {"deviator": 1.0, "pore_pressure": 1.0}
    test = triaxial([0.0, *(1 - np.exp(-at))], sigma=names, cell_pressure=p_0, drained=False, increment=5e-5)
    deviator, pore = answers(test, {**CLAY, "OCR": ocr}, 2)
    np.testing.assert_allclose(deviator, q, rtol=2e-3)
    np.testing.assert_allclose(p_0 + deviator / 3 - pore, p, rtol=2e-3)
    # Constants fitted to the closed form, with the increments that a record has unless it gives others.
    exact = {"deviator": np.append(0, q), "pore_pressure": np.append(0, p_0 + q / 3 - p)}
    record = Triaxial([0.0, *(1 - np.exp(-at))], **exact, cell_pressure=p_0, drained=False, sigma=names)
    found = fc.fit(record, {**CLAY, "OCR": ocr, "M": 1.0, "lambda": 0.2}, ["M", "lambda"])
    np.testing.assert_allclose(found.table["value"], [M, CLAY["lambda"]], rtol=0.015)


def test_elastic_and_cohesive_samples_follow_closed_forms() -> None:
    """Unconfined Hencky: σ = E ε/J, J = exp(−(1 − 2ν) ε), ε logarithmic; von Mises: σ = σ_y/J. Extension has the other sign."""
    strain = np.array([0.0, 0.02, 0.1, -0.05])
    logarithmic = -np.log(1 - strain[1:])
    names = {"deviator": 1.0, "volumetric_strain": 1.0}
    test = triaxial(strain, sigma=names, cell_pressure=0)
    q, volume = answers(test, {"model": "hencky", "E": 1e4, "nu": 0.2}, 2)
    np.testing.assert_allclose(q, 1e4 * logarithmic * np.exp(0.6 * logarithmic), rtol=1e-7)
    np.testing.assert_allclose(volume, 1 - np.exp(-0.6 * logarithmic), rtol=1e-7)
    q, volume = answers(test, {"model": "von_mises", "E": 1e4, "nu": 0.2, "sigma_y": 50}, 2)
    np.testing.assert_allclose(q, np.array([50, 50, -50]) / (1 - volume), rtol=1e-7)


@pytest.mark.parametrize("model", ["mohr_coulomb", "drucker_prager"])
def test_sand_fails_at_its_strength_and_dilates(model: str) -> None:
    """q = (N − 1) σ_r + 2 c √N/J, as the law takes the Kirchhoff stress, and dε_v/dε_a = −2 sin ψ/(1 − sin ψ) of logarithmic strains; the cone of
    triaxial compression has the same strength, and its own dilation."""
    law = {**SAND, "model": model, **({"matching": "compression"} if model == "drucker_prager" else {})}
    names = {"deviator": 1.0, "volumetric_strain": 1.0}
    strain = np.linspace(0, 0.1, 21)
    q, volume = answers(triaxial(strain, sigma=names, cell_pressure=100), law, 2)
    n = (1 + np.sin(np.radians(30))) / (1 - np.sin(np.radians(30)))
    peak = (n - 1) * 100 + 2 * 10 * np.sqrt(n) / (1 - volume)
    np.testing.assert_allclose(q[5:], peak[5:], rtol=1e-6)
    if model == "mohr_coulomb":
        sin = np.sin(np.radians(5))
        slope = (np.log(1 - volume[-1]) - np.log(1 - volume[5])) / (np.log(1 - strain[-1]) - np.log(1 - strain[6]))
        assert slope == pytest.approx(-2 * sin / (1 - sin), rel=0.01)


def test_a_softening_sample_stays_even() -> None:
    law = {**SAND, "softening": {"strain": 0.05, "c": 1, "phi": 25, "psi": 1}}
    run = triaxial(np.linspace(0, 0.15, 16), cell_pressure=100).case(law).run(progress=False)
    # The upper corner of the face by the mean of the top, whose other node is on the axis.
    np.testing.assert_allclose(2 * run.history["top.ux"], run.history["right.ux"], rtol=1e-6)
    q = answers(triaxial(np.linspace(0, 0.15, 16), cell_pressure=100), law)[0]
    assert q[-1] < 0.9 * q.max()


@pytest.mark.parametrize("drained", [True, False])
def test_units_do_not_matter_and_rows_may_repeat(drained: bool) -> None:
    strain = np.array([0, 0.01, 0.01, 0.03, 0.02, 0.05])
    in_kpa = answers(triaxial(strain, cell_pressure=100, drained=drained), {**CLAY, "OCR": 1.3})[0]
    in_pa = answers(triaxial(strain, cell_pressure=1e5, drained=drained), {**CLAY, "OCR": 1.3, "G": 1e3 * G, "p_min": 1e3})[0]
    np.testing.assert_allclose(in_pa, 1e3 * in_kpa, rtol=1e-8)
    assert in_kpa[0] == pytest.approx(in_kpa[1], rel=1e-9) and in_kpa[3] < in_kpa[2] < in_kpa[4]


def test_samples_consolidated_with_a_deviator_begin_there() -> None:
    q = answers(triaxial([0, 1e-6, 0.2], cell_pressure=60, initial_deviator=40, drained=False), {**CLAY, "OCR": 1.5})[0]
    assert q[0] == pytest.approx(40 + 3 * G * 1e-6, rel=1e-4)
    p_0 = 60 + 40 / 3
    p_c = 1.5 * (p_0 + 40**2 / (M**2 * p_0))
    # Critical state: M p_f, p_f = p₀ (p_c/2p₀)^Λ.
    assert q[1] == pytest.approx(M * p_0 * (p_c / 2 / p_0) ** (1 - KAPPA / LAMBDA), rel=1e-4)


def rates(strains: np.ndarray, p_0: float, q_0: float, p_c: float) -> np.ndarray:
    """σ_v of Cam-clay strained along one axis, by its rates in logarithmic strains and the Kirchhoff stress, at strains that only grow."""

    def slopes(_: float, state: np.ndarray) -> list[float]:
        p, q, p_c = state
        f_p, f_q = 2 * p - p_c, 2 * q / M**2
        elastic_p, elastic_q = p / KAPPA, 3 * G * 2 / 3
        flow = 0.0
        if q**2 / M**2 + p * (p - p_c) >= -1e-9 * p_c**2:
            hardening = p * p_c / (LAMBDA - KAPPA) * f_p
            flow = max(0.0, (f_p * elastic_p + f_q * elastic_q) / (f_p**2 * p / KAPPA + f_q**2 * 3 * G + hardening))
        return [p / KAPPA * (1 - flow * f_p), 3 * G * (2 / 3 - flow * f_q), p_c * flow * f_p / (LAMBDA - KAPPA)]

    found = solve_ivp(slopes, (0, strains[-1]), [p_0, q_0, p_c], t_eval=strains, rtol=1e-9, atol=1e-9, max_step=1e-3)
    return np.asarray(found.y[0] + 2 / 3 * found.y[1])


def test_an_oedometer_loads_clay_as_its_rates_say_and_unloads_by_the_closed_form() -> None:
    """Loading against an integration of the rates; unloading until it yields again: p = p_u e^(ε/κ̂), q = q_u + 2 G ε."""
    strains = np.linspace(0, 0.25, 11)[1:]
    kirchhoff = rates(strains, 50.0, 0.0, 50.0)
    pressure = np.append(50.0, kirchhoff * np.exp(strains))
    test = Oedometer(pressure, np.zeros(11), K0=1, increment=2e-3)
    np.testing.assert_allclose(answers(test, CLAY)[0], 1 - np.exp(-strains), rtol=2e-3)
    # By a tenth less, from the ends of which the closed form gives the stress there.
    back = np.concatenate([pressure, pressure[-1] * np.array([0.95, 0.9])])
    strain = -np.log(1 - answers(Oedometer(back, np.zeros(13), K0=1), CLAY)[0][-3:])
    down = lambda p, by: p * np.exp(by / KAPPA) - p + 4 / 3 * G * by  # noqa: E731
    total = back[-3:] * np.exp(-strain)
    p = brentq(lambda p: down(p, strain[1] - strain[0]) - (total[1] - total[0]), 1.0, 1e4)
    assert down(p, strain[2] - strain[0]) == pytest.approx(total[2] - total[0], rel=1e-4)
    # p is that at the turn: with 0.6 of the vertical stress beside.
    assert 0.6 < (3 * p / total[0] - 1) / 2 < 0.75


def test_an_oedometer_gives_the_void_ratio_of_its_strain() -> None:
    pressure = np.array([0.0, 10.0, 20.0])
    law = {"model": "hencky", "E": 1e3, "nu": 0.25}
    strain = answers(Oedometer(pressure, np.zeros(3)), law)[0]
    modulus = 1e3 * 0.75 / (1.25 * 0.5)
    logarithmic = -np.log(1 - strain)
    np.testing.assert_allclose(modulus * logarithmic * np.exp(logarithmic), pressure[1:], rtol=1e-7)
    void_ratio = answers(Oedometer(pressure, void_ratio=np.array([0.9, 0.8, 0.7])), law)[0]
    np.testing.assert_allclose(void_ratio, 0.9 - 1.9 * strain, rtol=1e-12)


# M of 5e8, c_v = k M/γ_w: the water, which is nearly incompressible, and readings under two pressures in the order of a laboratory.
MODULUS, WAY, WATER = 5e8, 0.01, {"permeability": 1e-11, "unit_weight": 9810, "bulk_modulus": 1e14, "porosity": 0.5}
STIFF = {"model": "hencky", "E": MODULUS * 1.3 * 0.4 / 0.7, "nu": 0.3}
READ = np.array([6, 15, 30, 60, 120, 240, 480, 900, 1800, 3600, 14400, 86400.0])


def consolidated(seed: int | None = None, **water: float) -> Oedometer:
    """Two pressures, 1e4 and 2e4: Terzaghi's degrees of consolidation one after the other, with noise of half a per cent of the strain under each."""
    m = 0.5 * np.pi * (2 * np.arange(2000)[:, None] + 1)
    degree = lambda t: np.where(t > 0, 1 - (2 / m**2 * np.exp(-(m**2) * np.maximum(t, 0))).sum(axis=0), 0)  # noqa: E731
    time = np.concatenate([[0], READ, 86400 + READ])
    rate = WATER["permeability"] * MODULUS / WATER["unit_weight"] / WAY**2
    strain = 1e4 / MODULUS * (degree(rate * time) + degree(rate * (time - 86400)))
    if seed is not None:
        strain[1:] += 1e-7 * np.random.default_rng(seed).normal(size=time.size - 1)
    pressure = np.repeat([0, 1e4, 2e4], [1, READ.size, READ.size])
    return Oedometer(pressure, strain, time=time, drainage=WAY, pore_fluid={**WATER, **water})


def test_an_oedometer_in_time_consolidates_as_terzaghi_says() -> None:
    test = consolidated()
    np.testing.assert_allclose(answers(test, STIFF)[0], test.of(STIFF).measured, atol=2.5e-3 * 1e4 / MODULUS)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hidden_truth_of_consolidation(seed: int) -> None:
    found = fc.fit(consolidated(seed, permeability=4e-12), {**STIFF, "E": 2 * STIFF["E"]}, ["E", "pore_fluid.permeability"])
    holds(found, {"E": STIFF["E"], "pore_fluid.permeability": WATER["permeability"]})
    assert found.table["std"]["pore_fluid.permeability"] < 0.01 and found.runs <= 10 and found.words == []
    assert found.noise == pytest.approx(1e-7, rel=0.4)


STRAIN = np.concatenate([[0], np.linspace(0.0025, 0.12, 30)])


def holds(found: fc.Fit, truth: dict[str, float]) -> None:
    """Whether the errors are within 3.5 standard deviations."""
    for name in found.table.index:
        error = np.log(found.table["value"][name] / truth[name]) / found.table["std"][name]
        assert abs(error) < 3.5, f"{name}: {found}"


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hidden_truth_of_undrained_clay(seed: int) -> None:
    sigma = {"deviator": 0.5, "pore_pressure": 0.5}
    truth = {**CLAY, "OCR": 1.4}
    record = triaxial(STRAIN, truth, seed=seed, sigma=sigma, cell_pressure=100, drained=False)
    found = fc.fit(record, {**truth, "M": 1.0, "lambda": 0.15, "G": 5000.0}, ["M", "lambda", "G"])
    holds(found, truth)
    assert found.noise == pytest.approx(1, abs=0.3) and found.runs <= 15 and found.words == []
    assert found.table["std"].max() < 0.15
    # What is fitted, whole.
    assert found.material == {**truth, **found.parameters} and found.cases[0].document["bodies"]["sample"]["material"] == found.material
    band = found.band(record)
    exact = record.of(truth).predicted({})[0]
    assert ((band["low"] <= exact) & (exact <= band["high"])).mean() > 0.5 and len(band) == 60
    np.testing.assert_allclose(found.predicted(record) - record.of(truth).measured, found.residuals[0], atol=1e-9)


@pytest.mark.slow
def test_intervals_hold_the_truth_in_many_draws() -> None:
    """Errors over their standard deviations have the variance 1: of 90 numbers (three constants trade off in part) the mean square is 1 ± 0.4."""
    sigma, truth = {"deviator": 0.5, "pore_pressure": 0.5}, {**CLAY, "OCR": 1.4}
    free, errors, inside = ["M", "lambda", "G"], [], []
    for seed in range(30):
        record = triaxial(STRAIN, truth, seed=100 + seed, sigma=sigma, cell_pressure=100, drained=False)
        table = fc.fit(record, truth, free).table
        true = np.array([truth[name] for name in free])
        errors.append(np.log(table["value"] / true) / table["std"])
        inside.append((table["low"] <= true) & (true <= table["high"]))
    assert np.mean(np.square(errors)) == pytest.approx(1, abs=0.4) and np.mean(inside) > 0.88


def test_hidden_truth_of_drained_clay_with_an_oedometer() -> None:
    seed = 0
    truth = {**CLAY, "OCR": 2.0}
    sheared = triaxial(STRAIN * 2, truth, seed=seed, sigma={"deviator": 2.0, "volumetric_strain": 5e-4}, cell_pressure=100)
    pressure = np.array([20.0, 40, 80, 160, 320, 640, 320, 160, 80, 40])
    made_of = made(Oedometer(pressure, np.zeros(10), K0=0.8), truth, {"strain": 5e-4}, seed)
    pressed = Oedometer(pressure, **made_of, K0=0.8, sigma=5e-4)
    free = ["M", "lambda", "kappa", "G"]
    start = {**truth, "M": 0.9, "lambda": 0.05, "kappa": 0.01}
    one, both = (fc.fit(records, start, free) for records in (sheared, [sheared, pressed]))
    for found in (one, both):
        holds(found, truth)
    assert (both.table["std"] < one.table["std"]).all() and both.table["std"]["kappa"] < 0.05 and len(both.residuals) == 2
    assert fc.plot.residuals(both).get_lines()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_hidden_truth_of_sand_under_two_cell_pressures(seed: int) -> None:
    """Elastic first, then at once perfectly plastic: a kink of the curve, not of what it tells."""
    sigma = {"deviator": 3.0, "volumetric_strain": 2e-4}
    strain = np.concatenate([[0], np.linspace(0.0005, 0.03, 25)])
    records = [triaxial(strain, SAND, seed=10 * seed + k, sigma=sigma, cell_pressure=cell) for k, cell in enumerate((50, 200))]
    found = fc.fit(records, {**SAND, "E": 2e4, "c": 4, "phi": 22, "psi": 2}, ["E", "c", "phi", "psi"])
    holds(found, SAND)
    assert found.words == [] and found.table["std"]["phi"] < 0.02 and found.runs <= 60
    assert found.noise == pytest.approx(1, abs=0.3)


def test_what_a_record_does_not_tell_is_said() -> None:
    """One cell pressure gives one strength, of many pairs of c and φ; below the pressure that clay has borne nothing depends on λ."""
    strain = np.concatenate([[0], np.linspace(0.0005, 0.03, 25)])
    found = fc.fit(triaxial(strain, SAND, seed=0, sigma={"deviator": 3.0}, cell_pressure=100), SAND, ["c", "phi"])
    assert any("c and phi" in text and "trade off" in text for text in found.words), found
    pressure = np.geomspace(20, 100, 8)
    law = {**CLAY, "OCR": 20}
    pressed = Oedometer(pressure, **made(Oedometer(pressure, np.zeros(8), K0=0.8), law, {"strain": 1e-3}, 0), K0=0.8)
    found = fc.fit(pressed, law, ["lambda", "kappa"])
    assert any("do not determine lambda" in text for text in found.words) and found.table["high"]["lambda"] == np.inf
    assert found.table["low"]["kappa"] < law["kappa"] < found.table["high"]["kappa"] < np.inf


def test_trials_that_the_law_refuses_are_avoided() -> None:
    """Below p_c of the initial stress there is no answer, and the truth lies at this border."""
    truth = {key: value for key, value in CLAY.items() if key != "OCR"} | {"p_c": 100.0}
    record = triaxial(STRAIN, truth, seed=0, sigma={"deviator": 0.5}, cell_pressure=100, drained=False)
    found = fc.fit(record, {**truth, "p_c": 180.0}, {"p_c": (20.0, 400.0), "M": (0.5, 2.0)})
    assert found.table["value"]["p_c"] == pytest.approx(100, rel=0.03) and found.table["value"]["M"] == pytest.approx(M, rel=0.02)


@pytest.mark.parametrize("drained", [True, False])
def test_derivatives_are_those_of_runs(drained: bool) -> None:
    second = "volumetric_strain" if drained else "pore_pressure"
    run = triaxial(STRAIN[:12], sigma={"deviator": 1.0, second: 1.0}, cell_pressure=100, drained=drained).of({**CLAY, "OCR": 1.5})
    names = ["M", "lambda", "kappa", "G", "OCR"]
    values = {name: run._value(name)[1] for name in names}
    _, slopes = run.solved(values, names, None)
    for k, name in enumerate(names):
        sides = [run.solved({**values, name: values[name] * (1 + by)}, [], None)[0] for by in (1e-4, -1e-4)]
        differences = (sides[0] - sides[1]) / (2e-4 * values[name])
        for own, theirs in zip(np.split(slopes[:, k], 2), np.split(differences, 2)):
            np.testing.assert_allclose(own, theirs, atol=2e-4 * abs(theirs).max())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"axial_strain": [0, 2.5, 10]}, "axial_strain: is 10: must be below 1; 10 % is 0.1"),
        ({"axial_strain": [0, 0, 0]}, "axial_strain: does not change"),
        ({"axial_strain": [0.0]}, r"axial_strain: has the shape \(1,\)"),
        ({"deviator": [0, 1]}, r"deviator: has the shape \(2,\): must be \(3,\)"),
        ({"cell_pressure": -100}, "cell_pressure: is -100: must not be negative"),
        ({"cell_pressure": "100"}, "cell_pressure: is '100': must be a number"),
        ({"pore_pressure": [0, 1, 2]}, "pore_pressure: stays as it is in a drained test"),
        ({"volumetric_strain": [0, 1, 2], "drained": False}, "volumetric_strain: stays as it is in an undrained test"),
        ({"volumetric_strain": [0, 1, 2]}, "sigma: deviator and volumetric_strain need it"),
        ({"volumetric_strain": [0, 1, 2], "sigma": 1}, "sigma: deviator and volumetric_strain need it"),
        ({"volumetric_strain": [0, 1, 2], "sigma": {"deviator": 1}}, "sigma: there is none for volumetric_strain"),
        ({"sigma": {"q": 1}}, "sigma: 'q' was not measured; there is deviator"),
        ({"sigma": -1}, "sigma: must be positive"),
        ({"weight": 0}, "weight: is 0"),
        ({"increment": 0}, "increment: is 0: must be positive"),
    ],
)
def test_records_that_are_none(arguments: dict[str, Any], message: str) -> None:
    given = {"axial_strain": [0, 0.01, 0.02], "deviator": [0, 1, 2], "cell_pressure": 100, **arguments}
    with pytest.raises(ValueError, match=message):
        Triaxial(**given).of({**CLAY})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([10, 20], [0, 0.1]), "K0: give the ratio"),
        (([0, -20], [0, 0.1]), "pressure: is -20: must not be negative"),
        (([0, 20],), "strain: give strain or void_ratio"),
        (([0, 20], [0, 0.1], {"drainage": 1}), "time: give it as well"),
        (([0, 20], [0, 0.1], {"time": [0, 0]}), "time: must be ascending"),
        (([0, 20], [0, 0.1], {"time": [0, 1], "drainage": 1}), "pore_fluid: give the water of a record in time"),
        (([0, 20], [0, 0.1], {"time": [0, 1], "pore_fluid": WATER}), "drainage: give the longest way"),
    ],
)
def test_oedometers_that_are_none(arguments: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Oedometer(*arguments[:2], **dict(*arguments[2:]))


@pytest.mark.parametrize(
    ("law", "free", "options", "message"),
    [
        ("super_subloading", ["M"], {}, "law: is 'super_subloading': give the material of a body"),
        ({**CLAY, "model": "linear"}, ["M"], {}, "law: `linear` is for small strains"),
        ({**CLAY, "viscosity": 1}, ["M"], {}, "law: its answer depends on the rate"),
        ({**CLAY, "lambada": 1}, ["M"], {}, "law: .*lambada"),
        ({**CLAY, "M": -1}, ["lambda"], {}, 'law: "M" is -1, but it must be positive'),
        (CLAY, ["kapa"], {}, "law: kapa: .*kapa"),
        (CLAY, ["M"], {"starts": 2}, "starts: a fit through runs has none: values that are not free are those of the law"),
        (CLAY, ["M"], {"kappa": 0.1}, "kappa: a fit through runs has none"),
        (CLAY, {"M": (2.0, 1.0)}, {}, "free: M: the range"),
        (CLAY, [], {}, "free: is empty"),
        ({**CLAY, "OCR": 0.5}, ["M"], {}, 'law: "OCR" is 0.5'),
        ({**{key: value for key, value in CLAY.items() if key != "OCR"}, "p_c": 50}, ["M"], {}, "p_c of 100"),
    ],
)
def test_what_cannot_be_fitted(law: Any, free: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fc.fit(triaxial(STRAIN, CLAY, cell_pressure=100, drained=False), law, free, **options)


def test_water_of_a_sample_is_checked() -> None:
    with pytest.raises(ValueError, match="pore_fluid.permeability.*-1"):
        consolidated(permeability=-1.0).of(STIFF).predicted({})
    with pytest.raises(ValueError, match="pore_fluid.permeabilty"):
        fc.fit(consolidated(), STIFF, ["pore_fluid.permeabilty"])


def test_records_of_other_sorts_are_apart() -> None:
    record = triaxial(STRAIN, CLAY, cell_pressure=100, drained=False)
    point = Interface([0.0, 1.0], [0.0, 1.0], 1.0, [0.0, 1.0])
    with pytest.raises(ValueError, match="or tests of samples: fit them one after another"):
        fc.fit([record, point], CLAY, ["M"])
    with pytest.raises(ValueError, match="need a sigma each"):
        fc.fit([record, Oedometer([10.0, 20.0], [0.0, 0.01], K0=1)], CLAY, ["M"])
    found = fc.fit(record, CLAY, ["M"])
    with pytest.raises(ValueError, match="law: the law of a body is in material"):
        _ = found.law
    case = record.case(CLAY)
    through = fc.fit(Run(case, {"top.fy": ([1.0, 2.0], [-80.0, -120.0])}), free=["bodies.sample.material.M"])
    with pytest.raises(ValueError, match="material: no tests of samples were fitted"):
        _ = through.material
    with pytest.raises(ValueError, match="record: is a test of a sample"):
        through.predicted(record)
