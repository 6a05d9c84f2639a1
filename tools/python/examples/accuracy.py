# %% [markdown]
# # Accuracy: two profiles over one flight, with the seeds of their random draws
# Runs are native: without a chip, the poses are the same and nothing is timed.

# %%
import sys

import numpy as np

import leviosim

data = sys.argv[1] if len(sys.argv) > 1 else "synthetic"
for profile in ("levio", "next"):
    errors = [leviosim.run(data=data, profile=profile, seed=seed)["accuracy.ate.rmse"] for seed in (1, 2, 3)]
    print(f"{profile:6} {np.median(errors):.3f} m ({min(errors):.3f} to {max(errors):.3f})")

# %% [markdown]
# Where the error is: the poses of the last run as arrays, beside the truth of errors.csv.

# %%
run = leviosim.run(data=data, profile="next")
t, position, _ = run.trajectory
errors = run.table("errors")
print(f"{len(t)} poses over {t[-1] - t[0]:.1f} s, {np.linalg.norm(np.diff(position, axis=0), axis=1).sum():.1f} m flown")
print({name: column.dtype.kind for name, column in errors.items()})
