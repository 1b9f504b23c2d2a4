"""Parts of a case as Python objects: each is a dict, made from keyword arguments, that the reader of cases judges.

Written by tools/model_from_schema.py from the JSON Schema (``fecontact schema``); not to be edited.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final, Literal, TypedDict, Union

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .mesh import Mesh

    Pairs = Union[Sequence[Sequence[float]], NDArray[Any]]
    Vector = Union[Sequence[float], NDArray[Any]]


class Given:
    """Stands for what is not given."""

    def __repr__(self) -> str:
        return "..."


NOT_GIVEN: Final = Given()


def _given(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key.rstrip("_"): value for key, value in values.items() if not isinstance(value, Given)}


class Bar(dict[str, Any]):
    """A bar along straight lines: a truss, or a beam where `ei` is given. In plane strain all values are per unit of
    thickness, otherwise they are those of the whole bar. A bar has a group of its nodes under its name, for
    supports, loads and `watch`, and its ends are the groups `NAME_start` and `NAME_end`.

    Args:
        ea: EA: axial stiffness, above 0 [F]
        damping: Damping in dynamic steps, as that of bodies: of EA and EI by `stiffness`, in implicit steps,
            and not of its bond
        ei: EI: bending stiffness; default: 0, a truss [F L²]
        embedded: Body that it lies in, with bond along its whole length; default: none, it is joined to others
            by its ends and shared nodes alone
        end: How it ends; default: free
        limit: N_p: force at which it yields in tension and compression, at constant force; default: none [F]
        mass: Mass per length; needed in dynamic steps, and for the weight of the bar by a load `gravity` on its
            name [M/L]
        on: Group of edges of a body whose nodes it shares, or of lines of the mesh that are sides of no element
        points: Points [x, y] of its axis, joined by straight lines. Either these or `on`
        segments: Number of segments that it is divided into; default: with `embedded` about one to an element
            of the body, 20 for a beam, and one from point to point for a truss
        start: How it begins; default: free
    """

    def __init__(
        self,
        *,
        ea: float,
        damping: Damping | Given = NOT_GIVEN,
        ei: float | Given = NOT_GIVEN,
        embedded: Embedding | None | Given = NOT_GIVEN,
        end: BarEnd | None | Given = NOT_GIVEN,
        limit: float | None | Given = NOT_GIVEN,
        mass: float | Given = NOT_GIVEN,
        on: str | None | Given = NOT_GIVEN,
        points: Pairs | Given = NOT_GIVEN,
        segments: int | None | Given = NOT_GIVEN,
        start: BarEnd | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"ea": ea, "damping": damping, "ei": ei, "embedded": embedded, "end": end, "limit": limit, "mass": mass, "on": on, "points": points, "segments": segments, "start": start}))


class Damping(dict[str, Any]):
    """Rayleigh damping. A vibration of angular frequency w decays with the damping ratio (mass/w + stiffness w)/2.

    Args:
        mass: Force per momentum: damps slow motions most, free flight included [1/T]
        stiffness: Kelvin-Voigt damping: retardation time by which the elastic stress of the strain rate is
            multiplied to give the viscous stress; damps high frequencies most, and shortens explicit increments
            [T]
    """

    def __init__(
        self,
        *,
        mass: float | Given = NOT_GIVEN,
        stiffness: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"mass": mass, "stiffness": stiffness}))


class Embedding(dict[str, Any]):
    """Bond of a bar with the bodies in which it lies.

    Args:
        in_: Bodies in which it lies from end to end
        bond: Bond along it; default: it moves with the bodies, without slip
    """

    def __init__(
        self,
        *,
        in_: Sequence[str],
        bond: BarBond | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"in_": in_, "bond": bond}))


class BarBond(dict[str, Any]):
    """Bond along a bar: shear per length of the bar against slip, as in a bond of a contact. Across, the bar is tied
    by a penalty.

    Args:
        mu: μ: what the strength grows by per pressure of the body across the bar (times the thickness of the
            body), that at the start of an increment; twice a coefficient of friction where both faces rub.
            Default: 0 [-]
        normal: k_n: force across the bar per length and distance; default: 100 (λ + 2G)/(length of a segment)
            of the body times its thickness [F/L²]
        residual: c_r: what is left of it after the slip `slip`, 0 ≤ c_r ≤ c; default: c, and 0 where `slip` is
            given [F/L]
        slip: D: slip over which the strength falls from c to c_r; default: it does not fall [L]
        stiffness: k: shear per length and slip before any slips for good; default: 100 (λ + 2G)/(length of a
            segment) of the body times its thickness, a penalty [F/L²]
        strength: c: shear strength per length; default: 0 with `mu`, otherwise none: it never slips for good
            [F/L]
    """

    def __init__(
        self,
        *,
        mu: float | Given = NOT_GIVEN,
        normal: float | None | Given = NOT_GIVEN,
        residual: float | None | Given = NOT_GIVEN,
        slip: float | None | Given = NOT_GIVEN,
        stiffness: float | None | Given = NOT_GIVEN,
        strength: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"mu": mu, "normal": normal, "residual": residual, "slip": slip, "stiffness": stiffness, "strength": strength}))


class BarEnd(dict[str, Any]):
    """An end of a bar.

    Args:
        clamped: Whether a beam keeps its angle there: to the body or bar that it is joined to, otherwise in
            space. Default: a hinge
        on: Body in which the end lies, another bar with a point there, or a group of points of the mesh: it is
            joined to that point
    """

    def __init__(
        self,
        *,
        clamped: bool | Given = NOT_GIVEN,
        on: str | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"clamped": clamped, "on": on}))


class Body(dict[str, Any]):
    """A body.

    Args:
        material: Bulk law. Text is the name of a law in `materials`
        damping: Damping of the body in dynamic steps; default: none
        element: Element formulation
        initial_stress: Stress of the undeformed body at the start; default: none
        pore_fluid: Fluid in the pores, which is trapped in an undrained body, or flows; default: none
        pore_pressure: Pressure given in the pores, by place and time; default: none
        thermal: Thermal expansion; default: none
    """

    def __init__(
        self,
        *,
        material: Material | str,
        damping: Damping | Given = NOT_GIVEN,
        element: Formulation | Given = NOT_GIVEN,
        initial_stress: InitialStress | None | Given = NOT_GIVEN,
        pore_fluid: PoreFluid | None | Given = NOT_GIVEN,
        pore_pressure: PorePressure | None | Given = NOT_GIVEN,
        thermal: Thermal | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"material": material, "damping": damping, "element": element, "initial_stress": initial_stress, "pore_fluid": pore_fluid, "pore_pressure": pore_pressure, "thermal": thermal}))


class Linear(dict[str, Any]):
    """Linear elasticity: small strains and rotations only.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        density: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "linear", **_given({"E": E, "nu": nu, "density": density})})


class SaintVenantKirchhoff(dict[str, Any]):
    """Saint Venant–Kirchhoff: linear in the Green strain; large rotations, moderate strains.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        density: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "saint_venant_kirchhoff", **_given({"E": E, "nu": nu, "density": density})})


class NeoHookean(dict[str, Any]):
    """Compressible neo-Hookean: large strains.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        density: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "neo_hookean", **_given({"E": E, "nu": nu, "density": density})})


class Hencky(dict[str, Any]):
    """Hencky: linear in the logarithmic strain; large rotations, moderate strains.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        density: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "hencky", **_given({"E": E, "nu": nu, "density": density})})


class Viscoelastic(dict[str, Any]):
    """Neo-Hookean in parallel with a Maxwell arm: relaxes from E + E_1 to E within some tau.

    Args:
        E: E: Young's modulus that is left when all has relaxed, E > 0 [F/L²]
        nu: ν: Poisson's ratio of both parts, −1 < ν < 0.5 [-]
        E_1: E₁: Young's modulus of the part that relaxes, E₁ > 0; at once the body has E + E₁ [F/L²]
        tau: τ: relaxation time, τ > 0 [T]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        E_1: float,
        tau: float,
        density: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "viscoelastic", **_given({"E": E, "nu": nu, "E_1": E_1, "tau": tau, "density": density})})


class BackStress(dict[str, Any]):
    """A back stress: kinematic hardening, dα = ⅔ C dε_p − γ α dε̄.

    Args:
        C: C: its modulus in tension at the start, C > 0 [F/L²]
        gamma: γ: how it forgets, γ ≥ 0: it saturates at C/γ, and grows without end (Prager) where γ = 0 [-]
    """

    def __init__(
        self,
        *,
        C: float,
        gamma: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"C": C, "gamma": gamma}))


class VonMises(dict[str, Any]):
    """Von Mises: metals, and clay that is sheared undrained; isotropic and kinematic hardening, large strains.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        sigma_y: σ_y: stress in tension at which it begins to yield, σ_y > 0; of clay that is sheared undrained
            √3 s_u in plane strain [F/L²]
        H: H: linear isotropic hardening, H ≥ 0: Y = σ_y + H ε̄ + Q (1 − exp(−b ε̄)) [F/L²]
        Q: Q: isotropic hardening that saturates (Voce); below 0 the material softens, Q > −σ_y and −Q b < 3 G
            [F/L²]
        b: b: how fast it saturates, b > 0 where Q is not 0 [-]
        back_stresses: Back stresses by Armstrong and Frederick, at most 4; none unless given
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
        viscosity: τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        sigma_y: float,
        H: float | Given = NOT_GIVEN,
        Q: float | Given = NOT_GIVEN,
        b: float | Given = NOT_GIVEN,
        back_stresses: Sequence[BackStress] | Given = NOT_GIVEN,
        density: float | Given = NOT_GIVEN,
        viscosity: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "von_mises", **_given({"E": E, "nu": nu, "sigma_y": sigma_y, "H": H, "Q": Q, "b": b, "back_stresses": back_stresses, "density": density, "viscosity": viscosity})})


class DruckerPrager(dict[str, Any]):
    """Drucker–Prager: a cone that stands for friction and cohesion of soil, perfectly plastic, large strains.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        c: c: cohesion, c ≥ 0, above 0 where phi is 0 [F/L²]
        phi: φ: angle of friction, 0 ≤ φ < 90 [degrees]
        psi: ψ: angle of dilation, 0 ≤ ψ ≤ φ [degrees]
        matching: Which tests c and φ are those of
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
        tension: Largest mean stress tr τ/3, tension positive; that of the tip of the cone, c cot φ, unless
            given [F/L²]
        viscosity: τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        c: float,
        phi: float,
        psi: float,
        matching: Matching,
        density: float | Given = NOT_GIVEN,
        tension: float | None | Given = NOT_GIVEN,
        viscosity: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "drucker_prager", **_given({"E": E, "nu": nu, "c": c, "phi": phi, "psi": psi, "matching": matching, "density": density, "tension": tension, "viscosity": viscosity})})


class Softening(dict[str, Any]):
    """Softening: c, φ and ψ fall linearly with the plastic shear strain to what is left of them.

    Args:
        c: c that is left, 0 to c [F/L²]
        phi: φ that is left, 0 to phi [degrees]
        psi: ψ that is left, 0 to the smaller of psi and the phi that is left [degrees]
        strain: Plastic shear strain γ_p = ∫ Σ |dε_p,i| at which nothing else is left, above 0 [-]
    """

    def __init__(
        self,
        *,
        c: float,
        phi: float,
        psi: float,
        strain: float,
    ) -> None:
        super().__init__(_given({"c": c, "phi": phi, "psi": psi, "strain": strain}))


class MohrCoulomb(dict[str, Any]):
    """Mohr–Coulomb: friction, cohesion, dilation and tension cut-off of soil and rock, which may soften; large
    strains.

    Args:
        E: E: Young's modulus, E > 0 [F/L²]
        nu: ν: Poisson's ratio, −1 < ν < 0.5 [-]
        c: c: cohesion, c ≥ 0, above 0 where phi is 0 (Tresca, c = s_u) [F/L²]
        phi: φ: angle of friction, 0 ≤ φ < 90 [degrees]
        psi: ψ: angle of dilation, 0 ≤ ψ ≤ φ [degrees]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
        softening: How it softens; c, phi and psi stay as they are unless given
        tension: Largest principal stress, tension positive; that of the tip, c cot φ, unless given [F/L²]
        viscosity: τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    """

    def __init__(
        self,
        *,
        E: float,
        nu: float,
        c: float,
        phi: float,
        psi: float,
        density: float | Given = NOT_GIVEN,
        softening: Softening | None | Given = NOT_GIVEN,
        tension: float | None | Given = NOT_GIVEN,
        viscosity: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "mohr_coulomb", **_given({"E": E, "nu": nu, "c": c, "phi": phi, "psi": psi, "density": density, "softening": softening, "tension": tension, "viscosity": viscosity})})


class CamClay(dict[str, Any]):
    """Modified Cam-clay: clay, whose stiffness and strength grow with its pressure, and which hardens and softens with
    its volume; needs an initial_stress, large strains.

    Args:
        lambda_: λ: slope of the line of normal compression, ln v over ln p, or e over ln p where a void ratio e
            is given, λ > κ [-]
        kappa: κ: slope of the lines of swelling, as λ, κ > 0 [-]
        p_min: p_min: pressure below which the stiffness does not fall any more, p_min > 0: far below the
            pressures of interest [F/L²]
        G: G: shear modulus, constant; G or nu, G > 0 [F/L²]
        M: M: q/p at critical state; M or phi, M > 0 [-]
        OCR: Overconsolidation ratio at the start: p_c over p + q²/(M² p), that of a yield surface through the
            initial stress; p_c or OCR, OCR ≥ 1 [-]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
        e: e: void ratio in the middle of the path, which makes slopes of ln v of slopes of e: λ/(1 + e), the
            specific volume v being 1 + e; default: λ and κ are slopes of ln v [-]
        nu: ν: Poisson's ratio under the initial stress, which gives every point its constant G there; G or nu,
            −1 < ν < 0.5 [-]
        p_c: p_c at the start: pressure of isotropic compression at which it yields; p_c or OCR, p_c ≥ p_min
            [F/L²]
        phi: φ: angle of friction at critical state in triaxial compression, M = 6 sin φ/(3 − sin φ), in
            degrees; M or phi
        viscosity: τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
    """

    def __init__(
        self,
        *,
        lambda_: float,
        kappa: float,
        p_min: float,
        G: float | None | Given = NOT_GIVEN,
        M: float | None | Given = NOT_GIVEN,
        OCR: float | None | Given = NOT_GIVEN,
        density: float | Given = NOT_GIVEN,
        e: float | None | Given = NOT_GIVEN,
        nu: float | None | Given = NOT_GIVEN,
        p_c: float | None | Given = NOT_GIVEN,
        phi: float | None | Given = NOT_GIVEN,
        viscosity: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "cam_clay", **_given({"lambda_": lambda_, "kappa": kappa, "p_min": p_min, "G": G, "M": M, "OCR": OCR, "density": density, "e": e, "nu": nu, "p_c": p_c, "phi": phi, "viscosity": viscosity})})


class SysCamClay(dict[str, Any]):
    """SYS Cam-clay, experimental: modified Cam-clay of soil with structure, overconsolidation and anisotropy, which it
    loses as it yields; needs an initial_stress, large strains.

    Args:
        lambda_: λ: slope of the line of normal compression of the remoulded soil, ln v over ln p, or e over ln
            p where a void ratio e is given, λ > κ [-]
        kappa: κ: slope of the lines of swelling, as λ, κ > 0 [-]
        p_min: p_min: pressure below which the stiffness does not fall any more, p_min > 0: far below the
            pressures of interest [F/L²]
        G: G: shear modulus, constant; G or nu, G > 0 [F/L²]
        M: M: q/p at critical state; M or phi, M > 0 [-]
        OCR: Overconsolidation ratio 1/R at the start: size of the yield surface over that of a similar one
            through the initial stress; p_c or OCR, OCR ≥ 1 [-]
        a: a: loss of structure as it yields, a ≥ 0 [-]
        b_r: b_r: rotation of the yield surface as it is sheared, b_r ≥ 0 [-]
        c_s: c_s: share of shear in the loss of structure, the rest being that of compaction, 0 ≤ c_s ≤ 1 [-]
        density: ρ₀: mass per reference volume, ρ₀ ≥ 0 [M/L³]
        e: e: void ratio in the middle of the path, which makes slopes of ln v of slopes of e: λ/(1 + e), the
            specific volume v being 1 + e; default: λ and κ are slopes of ln v [-]
        m: m: loss of overconsolidation as it yields, m > 0; default: it is elastic within the yield surface [-]
        m_b: m_b: limit of the rotation ‖β‖, m_b > 0 where b_r is not 0 [-]
        nu: ν: Poisson's ratio under the initial stress, which gives every point its constant G there; G or nu,
            −1 < ν < 0.5 [-]
        p_c: p_c at the start, that of the remoulded soil: with structure it yields in isotropic compression at
            p_c/R*; p_c or OCR, p_c ≥ p_min [F/L²]
        phi: φ: angle of friction at critical state in triaxial compression, M = 6 sin φ/(3 − sin φ), in
            degrees; M or phi
        structure: 1/R* at the start: degree of structure, 1 for remoulded soil, ≥ 1 [-]
        viscosity: τ_v: relaxation time of the viscosity by Duvaut and Lions, τ_v ≥ 0; 0 for none [T]
        zeta: ζ at the start: rotation √(3/2) ‖β‖ of the yield surface towards the initial stress, 0 ≤ ζ < M [-]
    """

    def __init__(
        self,
        *,
        lambda_: float,
        kappa: float,
        p_min: float,
        G: float | None | Given = NOT_GIVEN,
        M: float | None | Given = NOT_GIVEN,
        OCR: float | None | Given = NOT_GIVEN,
        a: float | Given = NOT_GIVEN,
        b_r: float | Given = NOT_GIVEN,
        c_s: float | Given = NOT_GIVEN,
        density: float | Given = NOT_GIVEN,
        e: float | None | Given = NOT_GIVEN,
        m: float | None | Given = NOT_GIVEN,
        m_b: float | Given = NOT_GIVEN,
        nu: float | None | Given = NOT_GIVEN,
        p_c: float | None | Given = NOT_GIVEN,
        phi: float | None | Given = NOT_GIVEN,
        structure: float | Given = NOT_GIVEN,
        viscosity: float | Given = NOT_GIVEN,
        zeta: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"model": "sys_cam_clay", **_given({"lambda_": lambda_, "kappa": kappa, "p_min": p_min, "G": G, "M": M, "OCR": OCR, "a": a, "b_r": b_r, "c_s": c_s, "density": density, "e": e, "m": m, "m_b": m_b, "nu": nu, "p_c": p_c, "phi": phi, "structure": structure, "viscosity": viscosity, "zeta": zeta})})


class Layer(dict[str, Any]):
    """A layer of the ground.

    Args:
        top: Level y of its top [L]
        weight: γ: weight per volume, above 0 [F/L³]
        K0: K₀: ratio of horizontal to vertical stress, zero or positive [-]
    """

    def __init__(
        self,
        *,
        top: float,
        weight: float,
        K0: float,
    ) -> None:
        super().__init__(_given({"top": top, "weight": weight, "K0": K0}))


class Geostatic(dict[str, Any]):
    """Ground at rest under its weight along -y: σ_yy = −surcharge − weight (surface − y), and σ_xx = σ_zz = K0 σ_yy;
    σ_zz = 0 in a plate.

    Args:
        surface: Level y of the vertical stress `surcharge`, 0 unless given: the top of the body, or above it if
            the body lies deeper [L]
        weight: γ: weight per volume, the density times gravity, above 0 [F/L³]
        K0: K₀: ratio of horizontal to vertical stress, zero or positive; 1 − sin φ for loose soil, ν/(1 − ν)
            for an elastic body without lateral strain [-]
        below: Layers below, from the top down, each with its weight and K₀: the same profile may serve all
            bodies of the ground
        surcharge: Pressure on the surface, of a load on the ground or of what lies above it, zero or positive
            [F/L²]
    """

    def __init__(
        self,
        *,
        surface: float,
        weight: float,
        K0: float,
        below: Sequence[Layer] | Given = NOT_GIVEN,
        surcharge: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"geostatic": _given({"surface": surface, "weight": weight, "K0": K0, "below": below, "surcharge": surcharge})})


class AlongX(dict[str, Any]):
    """Pairs of x and value, x ascending."""

    def __init__(self, x: Pairs) -> None:
        super().__init__({"x": x})


class AlongY(dict[str, Any]):
    """Pairs of y and value, y ascending."""

    def __init__(self, y: Pairs) -> None:
        super().__init__({"y": y})


class Table(dict[str, Any]):
    """Pairs of run time and value, times ascending; linear between, constant outside."""

    def __init__(self, table: Pairs) -> None:
        super().__init__({"table": table})


class VonKarman(dict[str, Any]):
    """Von Kármán: rough at all wavelengths below the correlation length.

    Args:
        hurst: H: Hurst exponent, 0 < H ≤ 1; ½ is a correlation of exp(−d/a), smaller ones are rougher [-]
    """

    def __init__(
        self,
        *,
        hurst: float,
    ) -> None:
        super().__init__({"von_karman": _given({"hurst": hurst})})


class Random(dict[str, Any]):
    """A random field.

    Args:
        seed: Number of the field, 0 to 2^53: another seed gives another field
        mean: m: mean
        deviation: s: standard deviation, s ≥ 0
        correlation: a: correlation length, a > 0. At this distance the correlation of a gaussian spectrum is
            1/e [L]
        marginal: Distribution of the values at a point
        spectrum: Spectrum of the field
    """

    def __init__(
        self,
        *,
        seed: int,
        mean: float,
        deviation: float,
        correlation: float,
        marginal: Marginal | Given = NOT_GIVEN,
        spectrum: Spectrum | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"random": _given({"seed": seed, "mean": mean, "deviation": deviation, "correlation": correlation, "marginal": marginal, "spectrum": spectrum})})


class Components(dict[str, Any]):
    """Components of the stress, tension positive.

    Args:
        xx: σ_xx [F/L²]
        yy: σ_yy [F/L²]
        xy: σ_xy; 0 unless given [F/L²]
        zz: σ_zz: out of plane, the hoop stress in axisymmetry. Required except in plane stress, where it is 0
            [F/L²]
    """

    def __init__(
        self,
        *,
        xx: Profile,
        yy: Profile,
        xy: Profile | Given = NOT_GIVEN,
        zz: Profile | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"components": _given({"xx": xx, "yy": yy, "xy": xy, "zz": zz})})


class PoreFluid(dict[str, Any]):
    """A fluid in the pores of a body. Without a permeability it has no time to flow, and elements are nearly
    incompressible from the start: take f_bar, reduced Q8 or T6. With one it flows, in static steps, whose time is
    that of consolidation, and in those of newmark, hht and generalized_alpha, where the density is that of both.
    The material, and the initial stress, are those of the effective stress; stresses and what contacts feel are
    total.

    Args:
        bulk_modulus: K_w: bulk modulus of the fluid, 2.2 GPa of water, K_w > 0; K_w/n of 100 times the
            stiffness of the material is enough [F/L²]
        porosity: n: volume of the pores per volume, 0 < n < 1 [-]
        biot: b of a fluid that flows: Biot's coefficient, porosity ≤ b ≤ 1, 1 − K/K_s with the bulk moduli of
            the body and of its grains; 1 of soil unless given [-]
        capillary: Height that the fluid rises to in the pores, h > 0, of one that weighs: where p_w is below 0
            the permeability falls by exp(p_w/(γ_w h)), to a ten-thousandth at least, as above a free surface.
            Unless given the ground stays saturated, and as permeable, under any suction [L]
        cavitation: Pressure below which the fluid cavitates and p_w does not fall; −100 kPa of water below the
            atmosphere; a fluid that flows is not limited, and a warning is reported. No limit unless given
            [F/L²]
        kozeny_carman: Whether the permeability follows the void ratio e by Kozeny and Carman, k ~ e³/(1 + e),
            from that of the undeformed body at the porosity
        permeability: k: speed at which the fluid seeps under a gradient of head of 1, k > 0; given, the fluid
            flows [L/T]
        permeability_y: k along y; as `permeability` unless given [L/T]
        pressure: p_w at the start, by place; 0 for pressures that count from the start [F/L²]
        unit_weight: γ_w: weight of the fluid per volume, by which k is divided; required with a permeability
            [F/L³]
        weighs: Whether its weight, along −y, drives a fluid that flows: p_w is then the whole pressure, and
            rests where it is hydrostatic. Otherwise p_w is the pressure in excess of that
    """

    def __init__(
        self,
        *,
        bulk_modulus: float,
        porosity: float,
        biot: float | None | Given = NOT_GIVEN,
        capillary: float | None | Given = NOT_GIVEN,
        cavitation: float | None | Given = NOT_GIVEN,
        kozeny_carman: bool | Given = NOT_GIVEN,
        permeability: float | None | Given = NOT_GIVEN,
        permeability_y: float | None | Given = NOT_GIVEN,
        pressure: Profile | Given = NOT_GIVEN,
        unit_weight: float | None | Given = NOT_GIVEN,
        weighs: bool | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"bulk_modulus": bulk_modulus, "porosity": porosity, "biot": biot, "capillary": capillary, "cavitation": cavitation, "kozeny_carman": kozeny_carman, "permeability": permeability, "permeability_y": permeability_y, "pressure": pressure, "unit_weight": unit_weight, "weighs": weighs}))


class PorePressure(dict[str, Any]):
    """Pressure of the fluid in the pores of a body, given by place and time: drained ground whose water changes, or a
    reservoir. The material, and the initial stress, are those of the effective stress; stresses, and what is in
    equilibrium, are total: less biot times the pressure.

    Args:
        pressure: p of the reference position x, y and, in expressions, of the run time t; what it is at t = 0
            acts before anything moves. 0 at t = 0 for pressures that count from the start, which may be
            negative [F/L²]
        biot: b: Biot's coefficient, 0 < b ≤ 1, 1 − K/K_s with the bulk moduli of the body and of its grains; 1
            of soil [-]
    """

    def __init__(
        self,
        *,
        pressure: GivenPressure,
        biot: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"pressure": pressure, "biot": biot}))


class Measured(dict[str, Any]):
    """By time and place.

    Args:
        file: Table of comma-separated numbers, relative to the case file. The first line has the places behind
            a word, such as "t"; each further one has a time of the run, and the pressures at the places. Times
            and places ascend
        along: What the places are: the coordinate "x" or "y" of the reference position (of the slave, in a
            contact), or "nodes", tags of nodes in the mesh (counted from 0 in a mesh given in place); default
            "x"
    """

    def __init__(
        self,
        *,
        file: str,
        along: Coordinate | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"measured": _given({"file": file, "along": along})})


class Thermal(dict[str, Any]):
    """Thermal expansion of a body, whose `temperature` is given by the steps. With F = (1 + α (T − T₀)) F_e the
    material is evaluated at F_e; a `linear` one at the strain minus α (T − T₀).

    Args:
        expansion: α: strain per temperature, relative to the undeformed body [1/Θ]
        reference: T₀: temperature of the undeformed body, in effect until a step specifies another [Θ]
    """

    def __init__(
        self,
        *,
        expansion: float,
        reference: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"expansion": expansion, "reference": reference}))


class Contact(dict[str, Any]):
    """A contact pair.

    Args:
        slave: Edge group whose points are kept out of the master, the finer or softer side; or a point group,
            each point with the `area`
        master: Edge group, or a rigid body. The slave's group again: self-contact of the surface; each point
            then has half its tributary length, because every contact is evaluated from both sides
        along: Friction parameters that vary along the slave and in time
        area: Tributary area of each point of a point group as slave, including the thickness or the full turn;
            it is constant. Edges have lengths of their own [L for thickness 1, or L²]
        bond: Bond of the surfaces in parallel with friction: strength without pressure. With `adhesion`, or
            `cohesion` of slip_weakening, it takes the `opening` over which that fades, and a `limit`
        clearance: Gap of the surfaces at the start, the same at every point that faces the master, instead of
            the gaps of the mesh: positive for a clearance, negative for an interference. All later gaps are
            measured relative to it, so that neither facets nor the accuracy of the mesh change it [L]
        dilatancy: Dilatancy: opening by plastic slip
        fluid_pressure: p_w: pressure of a fluid between the surfaces, zero or positive; expressions may depend
            on the run time t and on the reference position x, y of the slave. It acts on both surfaces wherever
            the slave projects onto the master, closed or open, in addition to the contact pressure p; friction,
            `initial.pressure` and all outputs called pressure use this effective p only. What acts at t = 0 of
            a contact with `initial` is there before anything moves, in addition to `initial.pressure`; what the
            run raises is 0 at t = 0. A pressure that is given does not flow; {"flow": {…}} is that of water
            which flows along the contact. "of_bodies" takes it from the pores of the slave's bodies
            (`pore_fluid`), whose total stress the contact carries: friction goes by what p_w leaves of it.
            {"measured": {"file": …}} takes it from a table of time and place [F/L²]
        friction: Friction law; only surfaces that are tied have none. Text is the name of a law in `frictions`
        initial: Tractions and structure at the start of a contact that starts closed. The gap of every slave
            point is then measured, throughout the run, relative to the gap at which this pressure acts in its
            initial position
        interface: Strength of the interface as a share of that of the adjacent soil, or by cohesion and angle
            of friction: Coulomb friction and a bond, which `check --resolved` shows. In place of `friction`
        massless: Implicit dynamics: the mass of the slave's nodes is moved to the other nodes of their
            elements, so that impact does not excite spurious oscillation of these nodes and of the contact
            force
        method: Contact method. By default mortar against a mesh in a run without explicit increments;
            node_to_segment where a step is quasi_dynamic. Against rigid masters, and in runs with explicit
            increments: mortar where an edge of either side is quadratic or a side curved (its direction turns
            by more than 1° between two corners of more than 45°); node_to_segment where straight linear or
            quadratic edges meet a bent rigid master, or a slave with a corner a rigid plane; gauss_to_segment
            against a polyline or outline with a corner of more than 45°, there with points at the slave's own
            corners and ends; it also otherwise, with a `smooth` master, and where `points` are given
        normal: Normal contact
        open_pressure: p̄: surfaces that part drain to a place of this pressure, 0 for air, and are filled from
            there; unless given, they are filled from the pores. κ of the drain grows with the third power of
            the opening. Of bodies whose water flows (`permeability`) [F/L²]
        points: Gauss points per slave edge (gauss_to_segment), 2 to 4; default 2, and 4 for quadratic edges
            against a rigid master with corners
        radiation_damping: Static steps: radiation damping, a traction η × slip rate that resists slip in
            addition to friction and approximates the inertia that is neglected, by shear waves radiated into
            unbounded bodies. A number is η [F·T/L³]; true takes the impedances of the bodies, 1/η = 1/Z₁ + 1/Z₂
            with Z = ρ c_s of each side: G/(2 c_s) for equal bodies, Z on a rigid master. Dynamic and explicit
            steps have inertia, and omit it
        rigid_body: Moving rigid body to which a rigid master belongs: one of `rigid_bodies`; default: the
            master is fixed
        seal: κ: water flows from one body to the other across the contact, closed or open, by κ times the
            difference of its pressures, κ ≥ 0; default 1000 times what passes through an element adjacent to
            it, so that the pressure has no jump. Of two bodies whose water flows (`permeability`); where water
            flows along the contact, from there into each of the bodies whose water flows [L³/(F T)]
        shrink_fit: Whether the initial overlap of the surfaces, or a negative `clearance`, is applied gradually
            over the first step (shrink fit) instead of at once
        sliding: Sliding range: finite, or small compared with the distance between nodes
        smooth: Whether the master's straight edges are replaced by a smooth curve through their nodes (not with
            mortar), so that forces do not jump where a slave slides from one edge to the next. Corners of more
            than 45° remain
        stick: Largest elastic slip allowed where surfaces stick [L], for laws that know none, whose alpha_t is
            a penalty (coulomb, adhesion, slip_weakening): the traction is adjusted until no elastic slip is
            larger, as `penetration` does it along the normal; default: penalty only
        tied: Whether the surfaces are tied: they neither part nor slide, whatever pulls at them, however large
            the motion. Every slave point keeps the place on the master that it faces in the mesh, across a gap
            as well (the finer side is the slave); points that face nothing stay free. Pressure and traction
            count per initial length. Without `friction`
        wear: k of Archard's law: the surfaces wear by dw = k p × plastic slip, in either direction of slip; k
            is the wear coefficient divided by the hardness. The wear depth w is `wear` in tables and frames
            [L²/F]
    """

    def __init__(
        self,
        *,
        slave: str,
        master: Master,
        along: Mapping[str, Any] | Given = NOT_GIVEN,
        area: float | None | Given = NOT_GIVEN,
        bond: Bond | None | Given = NOT_GIVEN,
        clearance: float | None | Given = NOT_GIVEN,
        dilatancy: Dilatancy | None | Given = NOT_GIVEN,
        fluid_pressure: FluidForms | None | Given = NOT_GIVEN,
        friction: Friction | str | Given = NOT_GIVEN,
        initial: Initial | None | Given = NOT_GIVEN,
        interface: Interface | None | Given = NOT_GIVEN,
        massless: bool | Given = NOT_GIVEN,
        method: Method | None | Given = NOT_GIVEN,
        normal: Normal | Given = NOT_GIVEN,
        open_pressure: float | None | Given = NOT_GIVEN,
        points: int | None | Given = NOT_GIVEN,
        radiation_damping: Radiation | Given = NOT_GIVEN,
        rigid_body: str | None | Given = NOT_GIVEN,
        seal: float | None | Given = NOT_GIVEN,
        shrink_fit: bool | Given = NOT_GIVEN,
        sliding: Sliding | Given = NOT_GIVEN,
        smooth: bool | Given = NOT_GIVEN,
        stick: float | None | Given = NOT_GIVEN,
        tied: bool | Given = NOT_GIVEN,
        wear: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"slave": slave, "master": master, "along": along, "area": area, "bond": bond, "clearance": clearance, "dilatancy": dilatancy, "fluid_pressure": fluid_pressure, "friction": friction, "initial": initial, "interface": interface, "massless": massless, "method": method, "normal": normal, "open_pressure": open_pressure, "points": points, "radiation_damping": radiation_damping, "rigid_body": rigid_body, "seal": seal, "shrink_fit": shrink_fit, "sliding": sliding, "smooth": smooth, "stick": stick, "tied": tied, "wear": wear}))


class Plane(dict[str, Any]):
    """A rigid half-space.

    Args:
        point: A point of its surface [L]
        normal: Outward normal of the solid, of any length
    """

    def __init__(
        self,
        *,
        point: Vector,
        normal: Vector,
    ) -> None:
        super().__init__({"plane": _given({"point": point, "normal": normal})})


class Circle(dict[str, Any]):
    """A rigid disk, or the rim of a hole.

    Args:
        centre: Centre [L]
        radius: Radius [L]
        hole: Whether the solid is outside the circle
    """

    def __init__(
        self,
        *,
        centre: Vector,
        radius: float,
        hole: bool | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"circle": _given({"centre": centre, "radius": radius, "hole": hole})})


class Polyline(dict[str, Any]):
    """A rigid body bounded by straight lines.

    Args:
        points: Corners, with the solid on the right in their order; repeating the first corner at the end
            closes the line [L]
    """

    def __init__(
        self,
        *,
        points: Pairs,
    ) -> None:
        super().__init__({"polyline": _given({"points": points})})


class Outline(dict[str, Any]):
    """A rigid body bounded by lines of the mesh that are sides of no element, such as a physical curve without a
    surface.

    Args:
        group: Name of their group. The lines form one chain, with the solid on the right in their direction;
            they are replaced by straight ones through their nodes
    """

    def __init__(
        self,
        *,
        group: str,
    ) -> None:
        super().__init__({"outline": _given({"group": group})})


class LawChoice(dict[str, Any]):
    """A law on a part of the slave.

    Args:
        where: The law applies where this expression is positive
        friction: Friction law. Text is the name of a law in `frictions`
        along: Parameters that vary along the slave and in time, by name
    """

    def __init__(
        self,
        *,
        where: Profile,
        friction: Friction | str,
        along: Mapping[str, Profile] | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"where": where, "friction": friction, "along": along}))


class Frictionless(dict[str, Any]):
    """No friction."""

    def __init__(self) -> None:
        super().__init__({"law": "frictionless"})


class Coulomb(dict[str, Any]):
    """Elastic until |q| = μ p, then sliding at constant μ.

    Args:
        mu: μ: friction coefficient, μ > 0 [-]
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
    """

    def __init__(
        self,
        *,
        mu: float,
        alpha_t: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "coulomb", **_given({"mu": mu, "alpha_t": alpha_t})})


class Adhesion(dict[str, Any]):
    """Elastic until |q| = τ_a, then sliding at it whatever the pressure: undrained clay by total stress.

    Args:
        strength: τ_a: strength, α s_u of an undrained clay, τ_a > 0 [F/L²]
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
    """

    def __init__(
        self,
        *,
        strength: float,
        alpha_t: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "adhesion", **_given({"strength": strength, "alpha_t": alpha_t})})


class SuperSubloading(dict[str, Any]):
    """Time-dependent super/subloading-surface friction: slip weakens the interface, stationary contact heals it.

    Args:
        mu_s: μ_s: static friction coefficient, μ_s ≥ μ_k [-]
        mu_k: μ_k: kinetic friction coefficient, μ_k > 0 [-]
        r: r: rate at which R approaches 1 with plastic slip, r > 0 [1/L]
        V_0: V₀: slip rate from which on the direct effect grows, V₀ > 0; needed with `a` alone [L/T]
        a: a: direct effect of the rate of plastic slip λ, by which the strength is multiplied by 1 + a ln(1 +
            λ/V₀), a ≥ 0; none by default. R is then a state of its own, and steady sliding may strengthen with
            the rate [-]
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
        approach: U(R): approach of R to 1
        elastic_core: R_e: elastic core, no plastic slip for R ≤ R_e, 0 ≤ R_e < 1 [-]
        integration: Integration of an increment
        kappa: κ: loss of structure with plastic slip, κ ≥ 0 [1/L]
        m: m: exponent of the loss, m > 0 [-]
        n: n: exponent of the recovery, n > 0 [-]
        structure: 1/R*₀: structure at first contact, from 1 (μ = μ_k) to μ_s/μ_k (μ = μ_s, the default) [-]
        tolerance: Error tolerance of the controlled integration, as a fraction of μ_s p, from 1e-12 to 0.1;
            1e-6 by default [-]
        xi: ξ: recovery of structure with time, ξ ≥ 0 [1/T]
    """

    def __init__(
        self,
        *,
        mu_s: float,
        mu_k: float,
        r: float,
        V_0: float | None | Given = NOT_GIVEN,
        a: float | Given = NOT_GIVEN,
        alpha_t: float | None | Given = NOT_GIVEN,
        approach: Approach | Given = NOT_GIVEN,
        elastic_core: float | Given = NOT_GIVEN,
        integration: Integration | Given = NOT_GIVEN,
        kappa: float | Given = NOT_GIVEN,
        m: float | Given = NOT_GIVEN,
        n: float | Given = NOT_GIVEN,
        structure: float | None | Given = NOT_GIVEN,
        tolerance: float | None | Given = NOT_GIVEN,
        xi: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "super_subloading", **_given({"mu_s": mu_s, "mu_k": mu_k, "r": r, "V_0": V_0, "a": a, "alpha_t": alpha_t, "approach": approach, "elastic_core": elastic_core, "integration": integration, "kappa": kappa, "m": m, "n": n, "structure": structure, "tolerance": tolerance, "xi": xi})})


class SlipWeakening(dict[str, Any]):
    """Friction that decreases linearly with slip from static to dynamic, and does not heal.

    Args:
        mu_s: μ_s: static friction coefficient, μ_s ≥ μ_d [-]
        mu_d: μ_d: friction coefficient after the slip D_c, μ_d > 0 [-]
        D_c: D_c: slip over which friction falls from μ_s to μ_d, D_c > 0 [L]
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
        cohesion: c: cohesion, the strength at zero pressure of surfaces in contact, c ≥ 0 [F/L²]
    """

    def __init__(
        self,
        *,
        mu_s: float,
        mu_d: float,
        D_c: float,
        alpha_t: float | None | Given = NOT_GIVEN,
        cohesion: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "slip_weakening", **_given({"mu_s": mu_s, "mu_d": mu_d, "D_c": D_c, "alpha_t": alpha_t, "cohesion": cohesion})})


class RateAndState(dict[str, Any]):
    """Regularized rate-and-state friction: depends on the slip rate and on a state that ages or slips.

    Args:
        f_0: f₀: friction coefficient in steady sliding at V₀, f₀ > 0 [-]
        V_0: V₀: reference slip rate, V₀ > 0 [L/T]
        a: a: direct effect of the slip rate, a > 0 [-]
        b: b: effect of the state; steady sliding weakens with the rate where b > a, and where b < 0 slip
            strengthens [-]
        D_c: D_c: slip over which the state evolves, D_c > 0 [L]
        D_c2: D_c2: slip over which the second state evolves, D_c2 > 0 [L]
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
        b_2: b₂: effect of a second state, of either sign; with `D_c2` [-]
        evolution: Evolution law of the state
        theta: θ: state at the start, θ > 0; default D_c/V₀, steady sliding at V₀ [T]
        theta_2: θ₂: second state at the start, θ₂ > 0; default D_c2/V₀ [T]
    """

    def __init__(
        self,
        *,
        f_0: float,
        V_0: float,
        a: float,
        b: float,
        D_c: float,
        D_c2: float | None | Given = NOT_GIVEN,
        alpha_t: float | None | Given = NOT_GIVEN,
        b_2: float | None | Given = NOT_GIVEN,
        evolution: StateEvolution | Given = NOT_GIVEN,
        theta: float | None | Given = NOT_GIVEN,
        theta_2: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "rate_and_state", **_given({"f_0": f_0, "V_0": V_0, "a": a, "b": b, "D_c": D_c, "D_c2": D_c2, "alpha_t": alpha_t, "b_2": b_2, "evolution": evolution, "theta": theta, "theta_2": theta_2})})


class Prescribed(dict[str, Any]):
    """Slip at a prescribed rate, whatever the traction.

    Args:
        slip_rate: V: slip rate of the slave along +s, of either sign [L/T]
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
    """

    def __init__(
        self,
        *,
        slip_rate: float,
        alpha_t: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "prescribed", **_given({"slip_rate": slip_rate, "alpha_t": alpha_t})})


class Registered(dict[str, Any]):
    """A law that is not part of the program, registered by a program that uses the library, such as a law written in
    Python.

    Args:
        name: Name under which the calling program has registered it
        alpha_t: α_t: tangential contact stiffness, α_t > 0; by default chosen from the mesh and the bodies
            [F/L³]
        parameters: Parameters by name
    """

    def __init__(
        self,
        *,
        name: str,
        alpha_t: float | None | Given = NOT_GIVEN,
        parameters: Mapping[str, float] | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"law": "registered", **_given({"name": name, "alpha_t": alpha_t, "parameters": parameters})})


class Bond(dict[str, Any]):
    """Bond of a contact, in parallel with its friction: strength without pressure, in shear and in tension.

    Args:
        alpha_t: α_c: stiffness of the bond against slip. Default: α_t of the friction where it is a penalty
            everywhere on the contact, otherwise the α_t that a penalty has by default [F/L³]
        bonded: Whether surfaces that do not touch at the start are bonded as well, within the opening and
            without stress over the gap that they have; otherwise they have c_r alone once they meet
        limit: τ_max: limit of the shear traction of friction and bond together, τ_max ≥ c; default: none [F/L²]
        opening: δ: opening at which nothing is carried any more, neither shear nor tension, δ > 2 t/α_n; a
            length of the interface. Default 4 c h/E of the softer side, with the longest edge h of the slave in
            the mesh as read [L]
        residual: c_r: what is left of it after the slip `slip`, or after an opening, once the surfaces meet
            again, 0 ≤ c_r ≤ c; default c, and 0 where `slip` is given [F/L²]
        slip: D: slip over which the strength falls from c to c_r, and the tension to 0; default: without end
            [L]
        strength: c: shear strength at zero pressure, in addition to that of friction, c > 0. Required, but with
            `adhesion` and with the `cohesion` of slip_weakening, which have it already [F/L²]
        tension: t: tensile strength, 0 ≤ t ≤ c/μ, with the coefficient μ that friction starts with; the
            surfaces open by t/α_n before it is reached; default 0 [F/L²]
    """

    def __init__(
        self,
        *,
        alpha_t: float | None | Given = NOT_GIVEN,
        bonded: bool | Given = NOT_GIVEN,
        limit: float | None | Given = NOT_GIVEN,
        opening: float | None | Given = NOT_GIVEN,
        residual: float | None | Given = NOT_GIVEN,
        slip: float | None | Given = NOT_GIVEN,
        strength: float | None | Given = NOT_GIVEN,
        tension: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"alpha_t": alpha_t, "bonded": bonded, "limit": limit, "opening": opening, "residual": residual, "slip": slip, "strength": strength, "tension": tension}))


class Dilatancy(dict[str, Any]):
    """Dilatancy of a contact: asperities override each other as the surfaces slip, until the interface has its largest
    opening, or as long as the friction law has structure to lose. Either `rate` or `structure` is given.

    Args:
        limit: d_max: opening after long slip, dδ = tan ψ (1 − δ/d_max) × plastic slip; unlimited by default.
            The opening δ is `dilation` in tables and frames [L]
        rate: tan ψ: initial opening per plastic slip, in either direction of slip, with any law; below its
            lowest friction coefficient (mu, mu_k, mu_d), because friction supplies the work of dilatancy [-]
        structure: d of tan ψ = d (1/R* − 1) = d (μ/μ_k − 1), of super_subloading: the surfaces dilate with the
            structure that is left, keep their opening at residual friction, and dilate again once they have
            healed. At the full structure tan ψ must be below mu_s: d < mu_s mu_k/(mu_s − mu_k) [-]
    """

    def __init__(
        self,
        *,
        limit: float | None | Given = NOT_GIVEN,
        rate: float | None | Given = NOT_GIVEN,
        structure: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"limit": limit, "rate": rate, "structure": structure}))


class FlowLeak(dict[str, Any]):
    """Flow c (p − p̄) through the walls of a contact.

    Args:
        coefficient: c: volume per length, pressure and time, zero or positive [L³/(F T)]
        pressure: p̄ by place; default: `initial` [F/L²]
    """

    def __init__(
        self,
        *,
        coefficient: float,
        pressure: Profile | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"coefficient": coefficient, "pressure": pressure}))


class FlowWell(dict[str, Any]):
    """Well of a contact, which has either a pressure or a rate.

    Args:
        at: Reference position [x, y] on the slave: a pressure is prescribed at the nearest node, a rate is
            shared by the two beside it [L]
        from_: Start; it is shut before. Default: that of the run [T]
        pressure: Pressure that is prescribed, from its start on [F/L²]
        rate: Volume that flows in, out if negative; over the thickness of the section, 1 unless given [L³/T]
        until: End; it is shut from then on. Default: never [T]
    """

    def __init__(
        self,
        *,
        at: Vector,
        from_: float | None | Given = NOT_GIVEN,
        pressure: Schedule | None | Given = NOT_GIVEN,
        rate: Schedule | None | Given = NOT_GIVEN,
        until: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"at": at, "from_": from_, "pressure": pressure, "rate": rate, "until": until}))


class Flow(dict[str, Any]):
    """By flow along the contact.

    Args:
        storage: S: volume per length and pressure that is stored, S > 0 [L³/F]
        viscosity: η: viscosity [F T/L²]
        aperture: w_h: hydraulic aperture of closed surfaces, for T = (w_h + w)³/12 (cubic law) [L]
        closing: σ: T is multiplied by exp(−p′/σ), p′ the effective pressure of the contact; default: it does
            not depend on it [F/L²]
        error: Error of the pressure that is allowed by what the surfaces do within an increment, over its
            largest change in the run so far: it takes part in the choice of static and implicit increments, but
            not beside bodies whose water flows, where `dt.pore_pressure` does; default 0.01
        initial: p_w at the start by place, zero or positive; default 0 [F/L²]
        leak: Flow through the walls into the bodies; default: none
        per_slip: k₁: T grows by k₁ |slip|; default 0 [L²]
        source: Q: what flows in per length, by place and time; default 0 [L/T]
        transmissivity: T: transmissivity, permeability times thickness, zero or positive, by place. Or
            `aperture` [L³]
        wells: Wells
    """

    def __init__(
        self,
        *,
        storage: float,
        viscosity: float,
        aperture: float | None | Given = NOT_GIVEN,
        closing: float | None | Given = NOT_GIVEN,
        error: float | Given = NOT_GIVEN,
        initial: Profile | Given = NOT_GIVEN,
        leak: FlowLeak | None | Given = NOT_GIVEN,
        per_slip: float | Given = NOT_GIVEN,
        source: Profile | None | Given = NOT_GIVEN,
        transmissivity: Profile | None | Given = NOT_GIVEN,
        wells: Sequence[FlowWell] | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"flow": _given({"storage": storage, "viscosity": viscosity, "aperture": aperture, "closing": closing, "error": error, "initial": initial, "leak": leak, "per_slip": per_slip, "source": source, "transmissivity": transmissivity, "wells": wells})})


class Initial(dict[str, Any]):
    """Initial state of a contact that starts closed.

    Args:
        balanced: Whether an initial stress of the bodies is in equilibrium with these tractions. Displacements
            and stresses of the run are then changes from the initial stress
        of_bodies: Instead of pressure and traction: those of the `initial_stress` of the slave's body at the
            contact, p = −n·σn (minus an initial fluid pressure) and q = s·σn, with the normal n and the tangent
            s of the master. Of a contact that comes in a later step: those of the stress in force by then, in
            the body that was there before, with surfaces that fit
        pressure: p: contact pressure, zero or positive [F/L²]. Where it is 0, and no traction acts, the deepest
            overlap and 10⁻⁶ of the slave's edge are taken out of all gaps, and what is left of them stays open
        structure: 1/R*: structure of the super/subloading law, from 1 to μ_s/μ_k; default: that of the law [-]
        traction: q: traction that resists the slip of the slave along +s, the master's normal turned by −90°
            [F/L²]
    """

    def __init__(
        self,
        *,
        balanced: bool | Given = NOT_GIVEN,
        of_bodies: bool | Given = NOT_GIVEN,
        pressure: Profile | None | Given = NOT_GIVEN,
        structure: Profile | None | Given = NOT_GIVEN,
        traction: Profile | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"balanced": balanced, "of_bodies": of_bodies, "pressure": pressure, "structure": structure, "traction": traction}))


class Interface(dict[str, Any]):
    """Strength of an interface, c_i + p tan φ_i: a share of that of the adjacent soil, or by its own numbers. In place
    of `friction`, and of the `strength` of a bond.

    Args:
        cohesion: c_i, c_i ≥ 0; default 0 where `friction_angle` is given [F/L²]
        friction_angle: φ_i, 0 ≤ φ_i < 90; default 0 where `cohesion` is given [degrees]
        of: Name of that body, where bodies adjacent to the interface differ in strength
        reduction: R: share of the cohesion and of tan φ of the body adjacent to the interface that yields by
            mohr_coulomb, drucker_prager or von_mises (c = σ_y/√3, φ = 0), as it is before any softening, 0 ≤ R
            ≤ 1. Without `cohesion` and `friction_angle` [-]
    """

    def __init__(
        self,
        *,
        cohesion: float | None | Given = NOT_GIVEN,
        friction_angle: float | None | Given = NOT_GIVEN,
        of: str | None | Given = NOT_GIVEN,
        reduction: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"cohesion": cohesion, "friction_angle": friction_angle, "of": of, "reduction": reduction}))


class Normal(dict[str, Any]):
    """Normal contact.

    Args:
        alpha_n: α_n: pressure per penetration [F/L³]; default 300 (λ + 2G)/h, with λ + 2G of the softer body
            and the depth h of the slave's elements; 10 (λ + 2G)/h at Gauss points but on planes, and where a
            step has inertia, is quasi_dynamic without `fluid_pressure` or has `rupture`. A slave group of
            points has no elements and needs a number
        penetration: Largest penetration allowed [L]: the pressure is increased until no penetration is larger
            (augmented Lagrangian by Uzawa's method), so that the solution does not depend on alpha_n; default:
            penalty only
    """

    def __init__(
        self,
        *,
        alpha_n: float | None | Given = NOT_GIVEN,
        penetration: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"alpha_n": alpha_n, "penetration": penetration}))


class PlacedGroup(dict[str, Any]):
    """Group of the sides, or nodes, that lie at a place: all conditions given hold for all of their nodes.

    Args:
        angle: Directions between which the outward normal of a side lies, counter-clockwise from the first to
            the second [degrees from x]: [45, 135] are sides that face upwards
        bodies: Bodies whose sides or nodes are meant; those of all bodies unless given
        box: Box around the nodes: its lower left and its upper right corner [L]
        circle: Circle on which the nodes lie
        nodes: Whether it is a group of nodes, also of those inside bodies, instead of free sides
        of: A group of the mesh whose nodes are meant, instead of any
        tolerance: Distance within which a node lies at the place; a millionth of the size of the mesh unless
            given [L]
        without: Groups of the mesh whose nodes are left out: {"of": "left", "without": ["bottom"], "nodes":
            true} is a side without its lower end
        x: x of the nodes [L]
        y: y of the nodes [L]
    """

    def __init__(
        self,
        *,
        angle: Vector | None | Given = NOT_GIVEN,
        bodies: Sequence[str] | None | Given = NOT_GIVEN,
        box: Pairs | None | Given = NOT_GIVEN,
        circle: PlacedCircle | None | Given = NOT_GIVEN,
        nodes: bool | Given = NOT_GIVEN,
        of: str | None | Given = NOT_GIVEN,
        tolerance: float | None | Given = NOT_GIVEN,
        without: Sequence[str] | None | Given = NOT_GIVEN,
        x: float | None | Given = NOT_GIVEN,
        y: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"angle": angle, "bodies": bodies, "box": box, "circle": circle, "nodes": nodes, "of": of, "tolerance": tolerance, "without": without, "x": x, "y": y}))


class PlacedCircle(dict[str, Any]):
    """A circle.

    Args:
        center: Its centre [L]
        radius: Its radius [L]
    """

    def __init__(
        self,
        *,
        center: Vector,
        radius: float,
    ) -> None:
        super().__init__(_given({"center": center, "radius": radius}))


class Blocks(dict[str, Any]):
    """A mesh of blocks: quadrilaterals with straight sides or arcs, each divided into rows and columns of elements.
    Blocks of one body that share a whole side are joined there, with the same nodes; those of different bodies only
    where `joined` says so.

    Args:
        blocks: Blocks; nodes are numbered in their order, row by row
        joined: Lists of bodies that are joined with each other, like blocks of one body, where their blocks
            share a whole side, for example two materials that are bonded
        parameters: Numbers with names of your choice, for the expressions of the blocks; a number, or an
            expression in other parameters
        separated: Names of sides that are not joined to others, such as the two sides of a crack in one body
    """

    def __init__(
        self,
        *,
        blocks: Sequence[Block],
        joined: Sequence[Sequence[str]] | Given = NOT_GIVEN,
        parameters: Mapping[str, Amount] | Given = NOT_GIVEN,
        separated: Sequence[str] | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"blocks": blocks, "joined": joined, "parameters": parameters, "separated": separated}))


class Block(dict[str, Any]):
    """A quadrilateral divided into elements. Side k runs from corner k to the next one, in the given order of the
    corners.

    Args:
        body: Name of the body that its elements belong to
        corners: The four corners [x, y] in order around the block, clockwise or counterclockwise [L]
        elements: Number of elements along side 0, from corner 0 to corner 1, and along side 1, from corner 1 to
            corner 2
        arcs: For each side null if it is straight, or the centre [x, y] of the circle through its two corners,
            of which the shorter arc is used
        grading: Grading of their sizes along side 0 and along side 1, as a geometric series; default: uniform
        kind: Kind of the elements
        points: Points [x, y] by a name of your choice: the node of this block nearest to each belongs to the
            node group of that name, which points of other blocks may share. The nearest node must be unique,
            and no farther away than the length of the elements there [L]
        sides: For each side its name, or null: edges with the same name form a group for contacts, supports and
            loads
    """

    def __init__(
        self,
        *,
        body: str,
        corners: Sequence[Sequence[Amount]],
        elements: Sequence[Amount],
        arcs: Sequence[Sequence[Amount] | None] | Given = NOT_GIVEN,
        grading: Sequence[Grading] | Given = NOT_GIVEN,
        kind: BlockKind | Given = NOT_GIVEN,
        points: Mapping[str, Sequence[Amount]] | Given = NOT_GIVEN,
        sides: Sequence[str | None] | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"body": body, "corners": corners, "elements": elements, "arcs": arcs, "grading": grading, "kind": kind, "points": points, "sides": sides}))


class Middle(dict[str, Any]):
    """Equal sizes at both ends, with a different one in the middle.

    Args:
        middle: Size in the middle divided by that at both ends
    """

    def __init__(
        self,
        *,
        middle: Amount,
    ) -> None:
        super().__init__(_given({"middle": middle}))


class Newton(dict[str, Any]):
    """Stopping criteria of Newton's method.

    Args:
        max_iterations: Linear solves per increment before it is rejected
        tolerance: Residual force relative to the acting forces
    """

    def __init__(
        self,
        *,
        max_iterations: int | Given = NOT_GIVEN,
        tolerance: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"max_iterations": max_iterations, "tolerance": tolerance}))


class Output(dict[str, Any]):
    """Output of a run.

    Args:
        checkpoint: Minutes of wall time between checkpoints (checkpoint.bin), from which `run --resume`
            continues with bitwise identical results, however the run ended; the last one is written at the end.
            Default 5; null or 0 for none
        derived: Whether the fields also have what follows from stress and logarithmic strain:
            `principal_stress`, `principal_strain` and `stretch_zz`, for ParaView. The page and Python compute
            these themselves
        displacement_gradients: Whether `gradients.zarr`, at every row of the history, and the fields also have
            the derivatives of the displacements of all nodes by the places of `gradients`
        every: Fields are written with every n-th row of the history, and at the end of each step; default:
            about 30 times in the run, equally often in each step at equal parts of its duration, or only at
            `times` and ends of steps where `times` are given
        exact: Whether fields are written as 64-bit numbers, as they are computed; default: as 32-bit numbers
            (relative error at most 6e-8), in half the space. Undeformed coordinates are always 64-bit numbers
        fields: Whether fields are written at all
        fronts: Slip fronts along contacts with friction (fronts.csv), and their slip events (events.csv)
        interval: Explicit steps write a row of the history (and fields, every n-th time) at multiples of this
            since the start of the step [T]; default: a hundredth of the step. Implicit steps write every
            increment or, if this is given, rows at least that far apart in time; the increments before and
            after a contact point opens, closes, begins to slip or stops are always written, and so are the ends
            of steps
        points: Whether stresses at the integration points are written with the fields (points.pvd)
        report: Whether a run ends with report.html, one page to look at its results in a browser; `fecontact
            report` writes it at any time
        times: Times at which fields are written, ascending; increments end at them [T]
    """

    def __init__(
        self,
        *,
        checkpoint: float | None | Given = NOT_GIVEN,
        derived: bool | Given = NOT_GIVEN,
        displacement_gradients: bool | Given = NOT_GIVEN,
        every: int | None | Given = NOT_GIVEN,
        exact: bool | Given = NOT_GIVEN,
        fields: bool | Given = NOT_GIVEN,
        fronts: Fronts | None | Given = NOT_GIVEN,
        interval: float | None | Given = NOT_GIVEN,
        points: bool | Given = NOT_GIVEN,
        report: bool | Given = NOT_GIVEN,
        times: Vector | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"checkpoint": checkpoint, "derived": derived, "displacement_gradients": displacement_gradients, "every": every, "exact": exact, "fields": fields, "fronts": fronts, "interval": interval, "points": points, "report": report, "times": times}))


class Fronts(dict[str, Any]):
    """Definition of fronts.

    Args:
        slip_rate: Slip rate that marks the arrival of a front when it is exceeded; a slip event lasts while any
            point of the contact slips faster [L/T]
        arrival: Criterion for arrivals instead of the slip rate
        seismic_rate: Slip rate from which slip counts as seismic, above `slip_rate`: `events.csv` then says
            when an event became seismic, and which share of its slip was [L/T]
    """

    def __init__(
        self,
        *,
        slip_rate: float,
        arrival: Arrival | None | Given = NOT_GIVEN,
        seismic_rate: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"slip_rate": slip_rate, "arrival": arrival, "seismic_rate": seismic_rate}))


class ArrivalR(dict[str, Any]):
    """R exceeds this value [-]."""

    def __init__(self, R: float) -> None:
        super().__init__({"R": R})


class ArrivalMu(dict[str, Any]):
    """μ falls below this value [-]."""

    def __init__(self, mu: float) -> None:
        super().__init__({"mu": mu})


class MovingPlate(dict[str, Any]):
    """A loading plate with another kind of motion.

    Args:
        on: Group of its nodes
        moves: Kind of motion
    """

    def __init__(
        self,
        *,
        on: str,
        moves: PlateMotion,
    ) -> None:
        super().__init__(_given({"on": on, "moves": moves}))


class PointMass(dict[str, Any]):
    """A point mass at every node of a group.

    Args:
        mass: Mass of each node, added to that of a body there [M]
        velocity: Initial velocity [x, y] of the nodes [L/T]
    """

    def __init__(
        self,
        *,
        mass: float,
        velocity: Vector | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"mass": mass, "velocity": velocity}))


class Probe(dict[str, Any]):
    """A gauge: a point given by `at`, or a line of points given by `from`, `to` and `number`; positions are undeformed
    ones.

    Args:
        at: The point [x, y]
        body: Body of the point, required where two bodies touch
        from_: Start of a line [x, y]
        number: Number of points of a line, including both ends; the k-th is called NAME.k, from 1
        to: End of a line [x, y]
    """

    def __init__(
        self,
        *,
        at: Vector | None | Given = NOT_GIVEN,
        body: str | None | Given = NOT_GIVEN,
        from_: Vector | None | Given = NOT_GIVEN,
        number: int | None | Given = NOT_GIVEN,
        to: Vector | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"at": at, "body": body, "from_": from_, "number": number, "to": to}))


class RigidBody(dict[str, Any]):
    """A moving rigid body: contacts with a rigid master refer to it; supports, forces and a moment `on` its name act
    on it. Its mass is given as a point mass with its name, located at the reference point.

    Args:
        reference: Reference point [x, y]: `ux` and `uy` of a support are its displacement, `angle` is the
            rotation about it, and the moment in the history refers to it [L]
        inertia: Moment of inertia about the reference point, which is then the centre of mass; required in
            dynamic steps unless supports prescribe the `angle` [M L²]
    """

    def __init__(
        self,
        *,
        reference: Vector,
        inertia: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"reference": reference, "inertia": inertia}))


class PlaneStress(dict[str, Any]):
    """A plate without out-of-plane stress: forces, masses and energies refer to the whole thickness. Pressures and
    tractions, including those of contact, refer to the undeformed thickness.

    Args:
        thickness: Undeformed thickness, above 0 [L]
    """

    def __init__(
        self,
        *,
        thickness: float,
    ) -> None:
        super().__init__({"plane_stress": _given({"thickness": thickness})})


class Sections(dict[str, Any]):
    """Sections across a body along an axis, such as the depth of a wall: its normal force N, shear force Q and bending
    moment M at stations from one end of the axis to the other.

    Args:
        body: The body that is cut
        from_: Start of the axis [x, y], in the body of the mesh or on its outline [L]
        to: End of the axis [x, y] [L]
        number: Number of stations, including both ends; the k-th is called NAME.k, from 1. By default there is
            one at every line of the mesh across the axis, or 51 where there are more than 200
    """

    def __init__(
        self,
        *,
        body: str,
        from_: Vector,
        to: Vector,
        number: int | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"body": body, "from_": from_, "to": to, "number": number}))


class Step(dict[str, Any]):
    """A step: a time span with its scheme and increments, supports and loads.

    Args:
        name: Name in messages and results
        duration: Length of the step [T]
        add: Bodies and bars that come at the start of this step and are absent before, such as a wall or an
            anchor. Bodies come without strain in the place that their nodes have then, at rest under their
            `initial_stress`, if any; that and their weight grow in linearly over the step. A bar comes without
            force between its points as they are then
        damping: Damping of bodies from this step on, replacing that of the body or of an earlier step;
            inherited. No effect in static steps
        drainage: Where water flows out of bodies whose pore_fluid has a permeability, or into them; inherited,
            and replaced where the same place is named again
        dt: Increments; by default inherited from the previous step, a tenth of the first step
        loads: Loads; inherited, and replaced where the same group and kind is named again. In any scheme null
            reduces a pressure, traction, force or gravity linearly to zero over the step, as the value 0 would,
            and ends springs, dashpots and absorbing sides at once. For a sudden end, use a table or expression
        prestress: Bars that are stressed in this step, by name: the force N to which a jack brings the whole
            bar linearly over the step; with the end of the step its length is locked [F]
        remove: Bodies and bars taken away at the start of this step, as in an excavation. The forces that they
            exerted on the rest remain as loads that fade linearly to zero over the step
        rupture: Static and implicit steps: automatic switch to explicit integration while a contact slips fast.
            Not inherited
        scheme: Time scheme; by default inherited from the previous step, static in the first step
        stabilize: Static steps only, for bodies that are unconstrained until contact closes: dashpots at all
            nodes of every body resist motion, at the start of the step with this fraction of the body's
            stiffness lambda + 2G for a motion over the duration of the step; they fade linearly to zero at its
            end, which takes at least two increments. 1e-3 is a good start. Not inherited
        supports: Supports; inherited, and replaced where the same group and direction is named again. A support
            released by null ends at once in dynamic and explicit steps; in a static step, also while `rupture`
            makes it explicit, its reaction remains as a force that fades linearly over the step
        temperature: Temperature of bodies that have `thermal` [Θ]; inherited, and replaced where the same body
            is named again. A number is reached linearly at the end of the step, from the temperature at its
            start; expressions may depend on the reference position x, y and the run time t
        until: Static and implicit steps: the step ends early when a reaction reaches a value, and later steps
            begin then. If the step ends before the reaction reaches it, the run stops. Not inherited
        velocity: Velocity [x, y] given to whole bodies or point masses at the start of this step, which is
            dynamic or explicit: settle under gravity, then launch. The change of kinetic energy counts as
            external work. Supported nodes follow their supports [L/T]
    """

    def __init__(
        self,
        *,
        name: str,
        duration: float,
        add: Sequence[str] | Given = NOT_GIVEN,
        damping: Mapping[str, Damping] | Given = NOT_GIVEN,
        drainage: Sequence[Drainage] | Given = NOT_GIVEN,
        dt: Increments | None | Given = NOT_GIVEN,
        loads: Sequence[Load] | Given = NOT_GIVEN,
        prestress: Mapping[str, float] | Given = NOT_GIVEN,
        remove: Sequence[str] | Given = NOT_GIVEN,
        rupture: Rupture | None | Given = NOT_GIVEN,
        scheme: Scheme | None | Given = NOT_GIVEN,
        stabilize: float | None | Given = NOT_GIVEN,
        supports: Sequence[Support] | Given = NOT_GIVEN,
        temperature: Mapping[str, Temperature] | Given = NOT_GIVEN,
        until: Until | None | Given = NOT_GIVEN,
        velocity: Mapping[str, Vector] | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"name": name, "duration": duration, "add": add, "damping": damping, "drainage": drainage, "dt": dt, "loads": loads, "prestress": prestress, "remove": remove, "rupture": rupture, "scheme": scheme, "stabilize": stabilize, "supports": supports, "temperature": temperature, "until": until, "velocity": velocity}))


class Drainage(dict[str, Any]):
    """Where water flows out of bodies, or into them: exactly one of `pressure`, `head`, `seepage`, `flux` and
    `impervious`. Values count from the first increment of the step on, and may jump there. What no entry names is
    impervious.

    Args:
        on: Group of edges or nodes, or a single node, of bodies whose water flows
        filter: κ of a filter before a `pressure` or `head`: the flow out is κ times what p_w exceeds it by, κ >
            0; unless given so large that p_w is held [L³/(F T)]
        flux: Flow out of the body, per reference area of edges, or per node [L/T], [L³/T]
        head: Level of free water that stands there: p_w = γ_w (head − y) of the reference position, of water
            that `weighs` [L]
        impervious: true: ends what an earlier step has said of this place
        pressure: p_w that is prescribed there, by the reference position x, y or the run time t; 0 where water
            drains freely [F/L²]
        seepage: true: water leaves where its pressure is above 0, and none enters
    """

    def __init__(
        self,
        *,
        on: Place,
        filter: float | None | Given = NOT_GIVEN,
        flux: Profile | None | Given = NOT_GIVEN,
        head: Profile | None | Given = NOT_GIVEN,
        impervious: bool | None | Given = NOT_GIVEN,
        pressure: Profile | None | Given = NOT_GIVEN,
        seepage: bool | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"on": on, "filter": filter, "flux": flux, "head": head, "impervious": impervious, "pressure": pressure, "seepage": seepage}))


class Node(dict[str, Any]):
    """Single node: its tag in the mesh file (its number from 0 in a mesh given in place)."""

    def __init__(self, node: int) -> None:
        super().__init__({"node": node})


class Near(dict[str, Any]):
    """Single node of the undeformed mesh nearest to this point [x, y]. It must be unique, and no farther away than the
    length of the elements there [L].
    """

    def __init__(self, near: Vector) -> None:
        super().__init__({"near": near})


class Increments(dict[str, Any]):
    """Increments of a step.

    Args:
        initial: First increment [T]
        error: Error control: the longest increments whose estimated error stays below this [L]. In dynamic
            steps it is the error of a displacement, and contact events (onset, arrest and reversal of slip) are
            located to ten times this; in static steps it is the error of the slip of a contact point, half the
            difference of its plastic slip from that at the last rate. With rate-and-state friction, this error
            of its slip is also at most 1e-4 D_c in static steps that give no `error`, and in all implicit ones.
            null: no control at all
        max: Longest increment [T]; default initial, with a given `error` and in quasi_dynamic steps a tenth of
            the step
        min: Shortest increment [T]; default initial/1000, with `error` initial/10⁶. With rate-and-state
            friction under error control and in quasi_dynamic steps it is the shortest that round-off of the
            time allows, since slip may take any rate
        pore_pressure: Error control of water that flows: the longest increments in which the pressure of no
            corner changes by more than twice this beside what it would at the last rate. Not controlled unless
            given [F/L²]
    """

    def __init__(
        self,
        *,
        initial: float,
        error: float | None | Given = NOT_GIVEN,
        max: float | None | Given = NOT_GIVEN,
        min: float | None | Given = NOT_GIVEN,
        pore_pressure: float | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"initial": initial, "error": error, "max": max, "min": min, "pore_pressure": pore_pressure}))


class Load(dict[str, Any]):
    """A load: exactly one kind per entry. It replaces the load of the same kind and place of an earlier step.

    Args:
        on: Group, or single node, on which it acts
        absorbing: true: an absorbing side, as if the body were unbounded there (Lysmer-Kuhlemeyer: dashpots rho
            c_p along the normal and rho c_s along the side, of the undeformed body); false or null ends it
        dashpot: Dashpot at every node of the group, to the ground or to a moving driver
        dead_pressure: Pressure on edges with the force and direction that it has on the undeformed edges,
            positive toward the body [F/L²]
        force: Force on every node of the group [F]
        gravity: Acceleration of gravity on a body or on point masses [L/T²]
        moment: Moment on a rigid body, or on a loading plate that moves as one, with which it rotates; counter-
            clockwise [F L]
        pressure: Pressure on edges that follows the surface, positive toward the body [F/L²]
        spring: Spring at every node of the group, to the ground or to a moving driver; its work on the node
            counts as external work
        total_force: Resultant force on edges, applied as a uniform traction: per unit of depth in plane strain,
            for the thickness in plane stress, per full turn in axisymmetry. Its expressions depend on t only
            [F]
        traction: Traction on reference edges with constant direction [F/L²]
    """

    def __init__(
        self,
        *,
        on: Place,
        absorbing: bool | None | Given = NOT_GIVEN,
        dashpot: Dashpot | None | Given = NOT_GIVEN,
        dead_pressure: Drive | None | Given = NOT_GIVEN,
        force: Components | None | Given = NOT_GIVEN,
        gravity: Components | None | Given = NOT_GIVEN,
        moment: Drive | None | Given = NOT_GIVEN,
        pressure: Drive | None | Given = NOT_GIVEN,
        spring: Spring | None | Given = NOT_GIVEN,
        total_force: Components | None | Given = NOT_GIVEN,
        traction: Components | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"on": on, "absorbing": absorbing, "dashpot": dashpot, "dead_pressure": dead_pressure, "force": force, "gravity": gravity, "moment": moment, "pressure": pressure, "spring": spring, "total_force": total_force, "traction": traction}))


class Dashpot(dict[str, Any]):
    """A dashpot: force c (v_driver − v). In statics v is the mean velocity of the increment.

    Args:
        cx: Coefficient in x [F T/L]
        cy: Coefficient in y [F T/L]
        driver: Velocity of the far end; default: the ground [L/T]
    """

    def __init__(
        self,
        *,
        cx: float | Given = NOT_GIVEN,
        cy: float | Given = NOT_GIVEN,
        driver: Components | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"cx": cx, "cy": cy, "driver": driver}))


class Rate(dict[str, Any]):
    """Value at the start of the step plus rate × time since [1/T]."""

    def __init__(self, rate: float) -> None:
        super().__init__({"rate": rate})


class Spring(dict[str, Any]):
    """A spring.

    Args:
        driver: Displacement of the far end; default: the ground [L]
        kx: Stiffness in x [F/L]
        ky: Stiffness in y [F/L]
    """

    def __init__(
        self,
        *,
        driver: Components | None | Given = NOT_GIVEN,
        kx: float | Given = NOT_GIVEN,
        ky: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"driver": driver, "kx": kx, "ky": ky}))


class Rupture(dict[str, Any]):
    """Automatic switch of a step to explicit integration and back. An increment in which a contact point slips faster
    than `slip_rate`, or that cannot be solved, is halved down to `dt.min` and, if that does not help, integrated
    explicitly. The step returns to its own scheme when no point has slipped that fast, on average over the time
    that a shear wave takes across the bodies that touch. Frictionless contacts do not count. To be detected, an
    event must slip more than `slip_rate` times `dt.max`. Remaining waves are removed on return to a static step,
    and their energy counts as damping dissipation.

    Args:
        slip_rate: Slip rate above which increments are explicit [L/T]
        safety: Explicit increments as a fraction of the longest stable one, above 0 and at most 1; default 0.9
            [-]
    """

    def __init__(
        self,
        *,
        slip_rate: float,
        safety: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"slip_rate": slip_rate, "safety": safety}))


class Newmark(dict[str, Any]):
    """Newmark; default β = 1/4, γ = 1/2 (the trapezoidal rule).

    Args:
        beta: β > 0 [-]
        gamma: γ ≥ 1/2 [-]
    """

    def __init__(
        self,
        *,
        beta: float | Given = NOT_GIVEN,
        gamma: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"newmark": _given({"beta": beta, "gamma": gamma})})


class Hht(dict[str, Any]):
    """Hilber–Hughes–Taylor: second order, with damping of frequencies that the increments do not resolve.

    Args:
        alpha: −1/3 ≤ α ≤ 0; the nearer to −1/3, the more damping [-]
    """

    def __init__(
        self,
        *,
        alpha: float,
    ) -> None:
        super().__init__({"hht": _given({"alpha": alpha})})


class GeneralizedAlpha(dict[str, Any]):
    """Generalized-α: second order, with the least damping of resolved frequencies among such schemes.

    Args:
        rho_infinity: 0 ≤ ρ∞ ≤ 1: spectral radius at infinite frequency; default 0.8, 1 does not damp [-]
    """

    def __init__(
        self,
        *,
        rho_infinity: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"generalized_alpha": _given({"rho_infinity": rho_infinity})})


class Explicit(dict[str, Any]):
    """Central differences: no equations to solve, but increments are limited by the highest frequency of a single
    element or contact point.

    Args:
        safety: 0 < safety ≤ 1: increment as a fraction of the longest stable one; default 0.9 [-]
    """

    def __init__(
        self,
        *,
        safety: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"explicit": _given({"safety": safety})})


class QuasiDynamic(dict[str, Any]):
    """Quasi-dynamic: no inertia, linear bodies and contacts in small sliding with radiation damping; slip and state of
    the interface are integrated with error control, explicitly if all friction laws define a slip rate by traction
    and state (rate_and_state, prescribed), else implicitly. For matching nodes, and loads and supports that vary
    linearly within the step.

    Args:
        every: Steps per row of results, at least 1; default 10
        tolerance: Error of one step in the friction coefficient, 0 < tolerance < 0.1; default 1e-5 [-]
    """

    def __init__(
        self,
        *,
        every: int | Given = NOT_GIVEN,
        tolerance: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"quasi_dynamic": _given({"every": every, "tolerance": tolerance})})


class Wilson(dict[str, Any]):
    """Wilson-θ: linear acceleration, equilibrium at t + θ Δt.

    Args:
        theta: 1.37 ≤ θ ≤ 2; default 1.4 [-]
    """

    def __init__(
        self,
        *,
        theta: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__({"wilson": _given({"theta": theta})})


class Support(dict[str, Any]):
    """A support on a group or a node.

    Args:
        on: Group, or single node, that is supported
        along: Direction [x, y] of the displacement u; it need not be of unit length
        angle: Rotation of a rigid body about its reference point, counter-clockwise; null releases it, see
            `supports` [rad]
        rotation: Rigid rotation about a point, instead of all others; null releases it, see `supports`
        u: Displacement along the direction `along`; the perpendicular component is free, unless another support
            of the node constrains it: two directions at a node constrain both of its components. null releases
            it, see `supports` [L]
        un: Displacement along the normal of a side, positive out of the body; the side can slide. The normal is
            that of the undeformed body, averaged over the edges at a node; where edges of the group meet at 45
            degrees or more, both normals are constrained. null releases it, see `supports` [L]
        ux: Displacement in x [L]; null releases it, see `supports`
        uy: Displacement in y [L]; null releases it, see `supports`
    """

    def __init__(
        self,
        *,
        on: Place,
        along: Vector | None | Given = NOT_GIVEN,
        angle: Drive | None | Given = NOT_GIVEN,
        rotation: Rotation | None | Given = NOT_GIVEN,
        u: Drive | None | Given = NOT_GIVEN,
        un: Drive | None | Given = NOT_GIVEN,
        ux: Drive | None | Given = NOT_GIVEN,
        uy: Drive | None | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"on": on, "along": along, "angle": angle, "rotation": rotation, "u": u, "un": un, "ux": ux, "uy": uy}))


class Rotation(dict[str, Any]):
    """A rigid rotation.

    Args:
        about: Centre [L]
        angle: Angle, counter-clockwise [rad]
    """

    def __init__(
        self,
        *,
        about: Vector,
        angle: Drive,
    ) -> None:
        super().__init__(_given({"about": about, "angle": angle}))


class Until(dict[str, Any]):
    """What ends a step: a reaction, for displacement control up to a force, or a degree of consolidation. The
    increment in which it passes its value is shortened until it has the value. Supports that move to a value stay
    where the step has ended; tables and expressions continue with the time of the run. Exactly one of `fx`, `fy`,
    `force` and `consolidation` is given.

    Args:
        on: Place of the reaction: the forces of the supports on these nodes; of consolidation a body
        consolidation: Degree of consolidation of a body whose water flows, 1 less its mean excess pressure over
            the largest one so far, above 0 and below 1 [-]
        force: Its magnitude [F]
        fx: Its x component [F]
        fy: Its y component [F]
        tolerance: Tolerance relative to the value, or to the reaction at the start of the step if that is
            larger, at most 0.1; default 1e-6 [-]
    """

    def __init__(
        self,
        *,
        on: Place,
        consolidation: float | None | Given = NOT_GIVEN,
        force: float | None | Given = NOT_GIVEN,
        fx: float | None | Given = NOT_GIVEN,
        fy: float | None | Given = NOT_GIVEN,
        tolerance: float | Given = NOT_GIVEN,
    ) -> None:
        super().__init__(_given({"on": on, "consolidation": consolidation, "force": force, "fx": fx, "fy": fy, "tolerance": tolerance}))


# A bulk material: its law and its constants.
Material = Union[Linear, SaintVenantKirchhoff, NeoHookean, Hencky, Viscoelastic, VonMises, DruckerPrager, MohrCoulomb, CamClay, SysCamClay]

# How the cone is fitted to Mohr and Coulomb's hexagon.
Matching = Union[Literal["plane_strain"], Literal["compression"]]

# How the elements of a body are integrated.
Formulation = Union[Literal["displacement"], Literal["f_bar"], Literal["reduced"]]

# Initial stress of a body. Displacements and strains are measured from the initial state; stresses are total. The run
# reports its imbalance with the loads at the start of the first step; loads that act from the start are expressions,
# such as "-9.81" for gravity, because a number increases from zero over the step
InitialStress = Union[Geostatic, Components]

# Quantity that varies along a surface, by reference position. A table is linear between its pairs, constant outside;
# the same coordinate twice is a jump, and the second value holds there and beyond.
Profile = Union[AlongX, AlongY, Table, Random, float, str]

# Distribution of the values of a random field at a point.
Marginal = Union[Literal["normal"], Literal["lognormal"]]

# Spectrum of a random field.
Spectrum = Union[Literal["gaussian"], VonKarman]

# Coordinate along which places are measured.
Coordinate = Union[Literal["x"], Literal["y"], Literal["nodes"]]

# The master side: a group of the mesh, or a rigid master given by a formula or an outline, fixed unless `rigid_body`
# names a moving body.
Master = Union[Plane, Circle, Polyline, Outline, str]

# A friction law and its parameters.
Friction = Union[Frictionless, Coulomb, Adhesion, SuperSubloading, SlipWeakening, RateAndState, Prescribed, Registered]

# U(R): rate of approach of the normal-sliding ratio to 1 with plastic slip. ```text dR/dλ = U(R), y = (R − R_e)/(1 −
# R_e) U = −r ln y logarithmic (the authors' choice) U = r cot(π y/2) cotangent (their earlier subloading-friction
# models) ``` Both are infinite at y = 0 (elastic) and 0 at y = 1 (full sliding). Source: Toyoda, Yasuike & Noda
# (2024), Tribology International 191:109080, eq. 13; Ozaki & Hashiguchi (2010), Tribology International 43:2120.
Approach = Union[Literal["logarithmic"], Literal["cotangent"]]

# Integration of the evolution over an increment.
Integration = Union[Literal["controlled"], Literal["backward_euler"]]

# Evolution of the state θ of rate-and-state friction.
StateEvolution = Union[Literal["ageing"], Literal["slip"]]

# A quantity that varies in time.
Schedule = Union[Table, float, str]

# Contact method: evaluation points of contact.
Method = Union[Literal["node_to_segment"], Literal["gauss_to_segment"], Literal["mortar"]]

# Radiation damping of a contact in static steps.
Radiation = Union[bool, float]

# Sliding range of the surfaces of a contact.
Sliding = Union[Literal["finite"], Literal["small"]]

# A mesh file or a mesh in place.
MeshSource = Union[str, Sequence[str], Blocks, Mapping[str, Any]]

# A number that may depend on the parameters of the mesh.
Amount = Union[float, str]

# Grading of the element sizes along a side.
Grading = Union[float, str, Middle]

# Element kind of a block.
BlockKind = Union[Literal["Q4"], Literal["Q8"], Literal["T6"]]

# Criterion for the arrival of a front at a point.
Arrival = Union[ArrivalR, ArrivalMu]

# A loading plate.
LoadingPlate = Union[str, MovingPlate]

# Motion of the nodes of a loading plate.
PlateMotion = Union[Literal["as_one"], Literal["ux_alike"], Literal["uy_alike"], Literal["rigid"]]

# Kind of plane section represented by the model.
Section = Union[Literal["plane_strain"], PlaneStress, Literal["axisymmetric"]]

# A group or a single node.
Place = Union[Node, Near, str]

# Prescribed quantity as a function of time and position.
Drive = Union[Rate, Table, float, str]

# Time scheme of a step, as the case file names it.
Scheme = Union[Literal["static"], Newmark, Hht, GeneralizedAlpha, Explicit, QuasiDynamic, Wilson]

# Temperature of a body. A table by x or y, of the reference position, is reached at the end of the step, linearly
# from the temperature at its start: linear between, constant outside, the same coordinate twice is a jump.
Temperature = Union[Rate, Table, AlongX, AlongY, float, str]

# Forms of a pressure that is given, for the schema.
GivenPressure = Union[Profile, Measured]

# Forms of a fluid pressure, for the schema.
FluidForms = Union[Profile, Measured, Flow]


class CaseKeys(TypedDict, total=False):
    """The keys of a case."""

    # Trusses, beams, anchors and geogrids by a name of your choice
    bars: Mapping[str, Bar]
    # Folder of results, or checkpoint, of a completed case, relative to this file: this case begins with its final
    # state. Mesh, bodies and contacts must be the same except for the parameters of friction and damping. The steps
    # follow those of that case: supports, loads and time continue; energies start from zero
    begin_with: str | None
    # Bodies by the name of their mesh group
    bodies: Mapping[str, Body]
    # Contacts by a name of your choice
    contacts: Mapping[str, Contact]
    # Laws by names of your choice, which may stand for them wherever the case has a `friction`
    frictions: Mapping[str, Friction]
    # Places of values by which the history is differentiated (gradients.csv): "contacts.base.friction.mu_k",
    # "bodies.block.material.E", "steps.drag.supports[0].uy". The derivatives are those of the run with its
    # increments as they are; not for explicit and quasi-dynamic steps, nor where a step may become explicit
    gradients: Sequence[str]
    # Groups of sides or nodes by place, by a name of your choice, for meshes that lack them: `{"top": {"y": 1.0}}`
    groups: Mapping[str, PlacedGroup]
    # Initial velocity [x, y] of whole bodies; supported nodes follow their supports
    initial_velocity: Mapping[str, Vector]
    # Laws by names of your choice, which may stand for them wherever the case has a `material`
    materials: Mapping[str, Material]
    # Path of a gmsh file (MSH 4.1, or 2.2 ASCII) relative to the case file, a list of such paths, or a mesh given
    # in place: blocks divided into elements, or node by node
    mesh: Mesh | MeshSource
    # Stopping criteria of Newton's method
    newton: Newton
    # Output
    output: Output
    # Periodic sides: pairs of groups with matching nodes. Each node has the displacement of its partner, and forces
    # on one act on both
    periodic: Sequence[Sequence[str]]
    # Loading plates: groups whose nodes all have the same displacement, as if bonded to a rigid platen that does
    # not rotate. A support of a node of it holds the whole plate, and a force, spring or dashpot at a node acts on
    # the whole plate: on its group once for every node, a `total_force` once. Its reaction counts in the watched
    # groups that contain the whole plate. In axisymmetry a plate keeps its radius, ux = 0. Other plates are given
    # by `moves`: only one component equal, or a rigid body that can rotate
    plates: Sequence[LoadingPlate]
    # Point masses by the name of a mesh group: a mass at each of its nodes
    point_masses: Mapping[str, PointMass]
    # Gauges by a name of your choice: displacement, velocity, strain and stress at points of the bodies, at every
    # row of the history (probes.csv)
    probes: Mapping[str, Probe]
    # Moving rigid bodies, by a name of your choice: rigid masters of contacts refer to them. Supports on the name
    # prescribe the path, `ux`, `uy` and `angle`, 0 where it is fixed; free components move under contact and loads
    # on the name
    rigid_bodies: Mapping[str, RigidBody]
    # Kind of plane section: "plane_strain", a plate {"plane_stress": {"thickness": …}}, or "axisymmetric"
    section: Section
    # Sections across bodies by a name of your choice: normal force, shear force and bending moment along an axis,
    # such as the depth of a wall, at every row of the history (sections.csv)
    sections: Mapping[str, Sections]
    # Steps, one after the other
    steps: Sequence[Step]
    # Title of the case, in one line
    title: str
    # Labels of the units used, for readers: `length`, `force`, `time`; any consistent set will do. Those of
    # `stress`, `energy` and whatever else follows may be left out: they are composed ("kN/m²"), and one that
    # contradicts is refused. In plane strain, the label of a force may be one per length of thickness ("kN/m")
    units: Mapping[str, str]
    # Groups, or single nodes {"near": [x, y]} or {"node": tag}, whose mean displacement and reaction are written to
    # the history, under the name of the group, `near_X_Y` or `node_TAG`
    watch: Sequence[Place]
