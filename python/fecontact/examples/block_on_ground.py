"""An elastic block pressed on elastic ground and dragged: ``python -m fecontact.examples.block_on_ground [figure]``.

The mesh comes from blocks, the case from objects. The figure is shown where there is a screen, and else written to
``block_on_ground.png``; with a name it is written there.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import fecontact as fc
from fecontact import model

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def block(name: str, low: tuple[float, float], high: tuple[float, float], elements: tuple[int, int]) -> model.Block:
    """A rectangle that is the body ``name``, with the sides ``name_bottom``, ``name_right``, ``name_top`` and ``name_left``."""
    (x, y), (right, top) = low, high
    corners = [[x, y], [right, y], [right, top], [x, top]]
    sides = [f"{name}_{side}" for side in ("bottom", "right", "top", "left")]
    return model.Block(body=name, corners=corners, elements=elements, sides=sides)


def mesh(divisions: int = 12) -> model.Blocks:
    """A block of 2 × 1 on ground of 4 × 1."""
    ground = block("ground", (0.0, -1.0), (4.0, 0.0), (2 * divisions, divisions // 2))
    return model.Blocks(blocks=[ground, block("block", (0.6, 0.0), (2.6, 1.0), (divisions, divisions // 2))])


def case(mu_s: float = 0.4, mu_k: float = 0.2, divisions: int = 12) -> fc.Case:
    """The block on its ground, pressed and dragged."""
    rubber = model.NeoHookean(E=1000.0, nu=0.3)
    friction = model.SuperSubloading(mu_s=mu_s, mu_k=mu_k, r=1000.0, kappa=10.0, xi=0.002)
    press = model.Step(
        name="press",
        duration=1.0,
        dt=model.Increments(initial=0.25),
        supports=[model.Support(on="ground_bottom", ux=0.0, uy=0.0), model.Support(on="block_top", ux=0.0, uy=-0.01)],
    )
    drag = model.Step(
        name="drag",
        duration=10.0,
        dt=model.Increments(initial=0.1, max=0.2),
        supports=[model.Support(on="block_top", ux=model.Rate(0.01))],
    )
    return fc.Case(
        title="Elastic block dragged over elastic ground",
        units={"length": "mm", "force": "N", "time": "s"},
        mesh=mesh(divisions),
        bodies={"block": model.Body(material=rubber), "ground": model.Body(material=rubber)},
        contacts={"base": model.Contact(slave="block_bottom", master="ground_top", friction=friction)},
        steps=[press, drag],
        watch=["block_top"],
    )


def figure(result: fc.Result) -> Figure:
    """Friction, slip fraction, and slip over place and time."""
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(3, 1, figsize=(7.0, 8.0), layout="constrained")
    fc.plot.friction(result, ax=axes[0])
    fc.plot.slip_fraction(result, ax=axes[1])
    fc.plot.interface(result, "base", "slip", ax=axes[2])
    figure.suptitle(result.summary["title"])
    return figure


def main(arguments: list[str]) -> None:
    """Run the case and draw the figure."""
    import matplotlib

    result = case().run()
    drawn = figure(result)
    if arguments or matplotlib.get_backend().lower() == "agg":
        file = arguments[0] if arguments else "block_on_ground.png"
        drawn.savefig(file, dpi=150)
        print(file)
    else:
        from matplotlib import pyplot as plt

        plt.show()


if __name__ == "__main__":
    main(sys.argv[1:])
