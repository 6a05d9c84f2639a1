# %% [markdown]
# # A kernel of your own: where its cycles go, and what a chip with other memories would do
# The kernel is C++, since its operations are counted as they run. The project that lies beside the installed library
# has one, the mean grey level of an image. It is compiled once; its recorded work is timed here, without it.

# %%
import os
import pathlib
import subprocess
import sys

import leviosim

data = sys.argv[1] if len(sys.argv) > 1 else "synthetic"
project = os.environ.get("PROJECT", "/usr/share/doc/libleviosim-dev/examples/outside")
program = pathlib.Path("own-kernel/exposure").absolute()
for words in (
    ["cmake", "-S", project, "-B", program.parent],
    ["cmake", "--build", program.parent],
    [program, "run", "--data", data, "--platform", "gap9", "--record", "--out", "own-kernel/recorded", "--force", "--quiet"],
):
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)

# %% [markdown]
# The stage on GAP9: a row of the table as the command prints it, and where its cycles went, the largest part first.

# %%
gap9 = leviosim.Platform("gap9")
run = leviosim.replay("own-kernel/recorded", gap9)
print(f"exposure: {run['stages.exposure.cycles.parallel.mean']:.0f} cycles of a frame on {gap9['cluster.workers']:.0f} cores")
cycles = run.table("cycles")
largest = cycles["cycles"].argsort()[::-1][:5]
for k in largest:
    print(" ", *(f"{column[k]}" for column in cycles.values()))

# %% [markdown]
# Transfers from L2 or computing: which of the two is the limit? The kernel reads every byte once.

# %%
over = {"cluster.l1.banks": [8, 16, 32], "cluster.dma.bytes_per_cycle": [4, 8, 16]}
times = {}
for settings, point in leviosim.sweep(over, lambda s: leviosim.replay("own-kernel/recorded", gap9.with_(s))):
    times[tuple(settings.values())] = point["stages.exposure.cycles.parallel.mean"]
print("banks " + "".join(f"{width:8} B/cycle" for width in over["cluster.dma.bytes_per_cycle"]))
for banks in over["cluster.l1.banks"]:
    print(f"{banks:5} " + "".join(f"{times[banks, width]:16.0f}" for width in over["cluster.dma.bytes_per_cycle"]))
