# %% [markdown]
# # Tuning: the lowest clock at which no frame is lost
# In a closed loop a frame that finds the front end busy is lost.

# %%
import sys

import leviosim

data = sys.argv[1] if len(sys.argv) > 1 else "synthetic"
gap9 = leviosim.Platform("gap9")


def at_clock(settings):
    clock = f"{settings['MHz']}MHz"
    chip = gap9.with_({"cluster.clock": clock, "controller.clock": clock})
    return leviosim.run(chip, data=data, profile="next", fps=20, deadline="drop")


for settings, run in leviosim.sweep({"MHz": [60, 120, 240, 370]}, at_clock):
    arrived, dropped = run["camera.arrived"], run["camera.dropped"]
    print(f"{settings['MHz']} MHz: {dropped} of {arrived} frames lost, ATE {run['accuracy.ate.rmse']} m")
    if dropped == 0:
        break
