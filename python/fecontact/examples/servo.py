"""A servo-controlled machine: the block is dragged with a given force, which the machine finds from what it feels.

``python -m fecontact.examples.servo`` prints wanted and measured forces.
"""

from __future__ import annotations

import fecontact as fc

from .block_on_ground import case


def servo(wanted: float = 1.5, dt: float = 0.1) -> list[tuple[float, float]]:
    """Time and force of the piston at the block's top, once it is controlled."""
    machine = fc.Simulation(case())
    machine_stiffness, felt = 200.0, []
    for increment in machine:
        if machine.step == "drag" and not machine.is_complete:
            force, at = machine.reaction("block_top")[0], machine.displacement("block_top")[0]
            machine.prescribe("block_top", ux=at + (wanted - force) / machine_stiffness, by=increment.time + dt)
            felt.append((increment.time, float(force)))
    return felt


if __name__ == "__main__":
    for time, force in servo():
        print(f"t = {time:6.3f}   force = {force:.6f}")
