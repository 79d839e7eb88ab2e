# %% [markdown]
# # A planetary set with pin errors by Monte Carlo
#
# The position of one pin along its circle is normally distributed, by 2 um. Each sample is a scene
# of its own; the scan runs in threads.

# %%
from concurrent.futures import ThreadPoolExecutor

import gearbench as gb

scene = gb.Scene.load("planetary").changed({"duration_s": 1e-3})
with ThreadPoolExecutor(2) as threads:
    scan = gb.scan(
        scene,
        vary={"meshes.2.direction_deg": "normal(120,0.0014)"},
        samples=8,
        models="rigid",
        integrators="dopri5@1e-4",
        executor=threads,
        shards=2,
    )
columns = scan.to_columns()
peaks = columns["peak_force_n"]
print(f"{len(peaks)} sets, peak force {peaks.mean():.0f} N +- {peaks.std():.0f} N")
assert len(peaks) == 8
