# %% [markdown]
# # What if: one recorded run on other chips
# A flight is run once on GAP9 and its work recorded. Other chips time the same work, without running it again.

# %%
import sys

import leviosim

data = sys.argv[1] if len(sys.argv) > 1 else "synthetic"
gap9 = leviosim.Platform("gap9")
run = leviosim.run(gap9, data=data, record=True)
latency = run.statistics["frame.latency.p50"]
print(f"{gap9.name}: {latency.value} {latency.unit}, {latency.description}")

# %% [markdown]
# Half the floating-point units, and all numbers between: each row says what became of a frame.

# %%
table = run.whatif("cluster.fpu.units=1,2,8", "cluster.l1.banks=8,32")
for variant, mean in zip(table["variant"], table["frame_mean_ms"]):
    print(f"{variant:28} {mean:8.2f} ms")

# %% [markdown]
# The same as a sweep, point by point, with every statistic of each.

# %%
for settings, point in leviosim.sweep({"cluster.fpu.units": [1, 2, 4, 8]}, lambda s: run.replay(gap9.with_(s))):
    print(settings, f"{point['frame.latency.p50'] * 1e-6:.2f} ms")
