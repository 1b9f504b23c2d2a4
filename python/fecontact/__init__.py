"""2D finite-element contact with the time-dependent super/subloading-surface friction law.

A first run::

    import fecontact as fc

    case = fc.Case("cases/block_on_ground.json")
    print(case.check())
    result = case.run()
    result.history.plot(x="time", y="base.tangential_force")

Units are any consistent set; docstrings name dimensions: [L] length, [F] force, [T] time. The plane is a slice of depth 1.
"""

from . import model, plot
from ._native import __version__
from .calibration import Fit, fit
from .case import Case, schema
from .convergence import Convergence, converge
from .errors import CaseError, Defect, Interrupted, RunWarning, Stopped
from .law import Drive, Law, friction_law, law
from .mesh import Mesh
from .result import Result, report
from .simulation import Simulation
from .stability import Safety, safety
from .studies import study

__all__ = [
    "Case",
    "CaseError",
    "Convergence",
    "Defect",
    "Drive",
    "Fit",
    "Interrupted",
    "Law",
    "Mesh",
    "Result",
    "RunWarning",
    "Safety",
    "Simulation",
    "Stopped",
    "__version__",
    "converge",
    "fit",
    "friction_law",
    "law",
    "model",
    "plot",
    "report",
    "safety",
    "schema",
    "study",
]
