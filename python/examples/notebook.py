# SPDX-License-Identifier: LGPL-2.1-or-later
# %% [markdown]
# A bar that is pulled and released. Editors such as VS Code and Spyder run the cells between the lines `# %%` one by
# one; `jupytext --to ipynb notebook.py` makes a Jupyter notebook of them.

# %%
import numpy as np

import hexaplast


def pulled_bar(yield_stress):
    """Pulled aside for one second, then free for two."""
    positions, hexahedra = hexaplast.grid((3, 3, 10), (-0.15, -0.15, -0.5), (0.15, 0.15, 0.5))
    material = hexaplast.Material(young_modulus=5000, poisson_ratio=0.45, yield_stress=yield_stress, flow_rate=4)
    simulation = hexaplast.Simulation(
        hexaplast.Body(positions, hexahedra, material), rayleigh_mass=0.5, rayleigh_stiffness=0.05
    )
    simulation.fix(positions[:, 2] == -0.5)
    simulation.record()  # so that the viewer shows the motion, and not only its end
    end = positions[:, 2] == 0.5
    forces = np.zeros_like(positions)
    forces[end] = np.array([8, 0, 40]) / end.sum()  # [N]
    simulation.run(100, forces)
    simulation.run(200)
    return simulation


# %% [markdown]
# The last line of a cell is what the notebook shows: here the bar, which can be turned and played.

# %%
plastic = pulled_bar(yield_stress=300)
plastic

# %% [markdown]
# The same bar of a material that never yields, in a frame of another height. `hexaplast.show("out")` shows a run of the
# command in the same way.

# %%
elastic = pulled_bar(yield_stress=float("inf"))
hexaplast.show(elastic, height=450)

# %% [markdown]
# The state for other programs, where meshio is installed.

# %%
plastic.to_meshio()
