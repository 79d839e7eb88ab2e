# %% [markdown]
# # Which model is enough for it?
#
# The shipped scene `spur_impact` has a reference of finite elements. The models are compared with
# it, then `choose` searches for the cheapest model whose peak force is within 5 %.

# %%
import gearbench as gb

scene = gb.Scene.load("spur_impact")
result = scene.compare(models="rigid,movable-teeth", integrators="dopri5@1e-6", repeats=1)
for run in result.runs:
    error = run.metrics[0].force_l2_aligned
    print(
        f"{run.model:15} {100 * (error or 0):6.2f} % of the force history, {1e3 * run.cpu_s:.2f} ms"
    )
assert {run.model for run in result.runs} == {"rigid", "movable-teeth"}

# %%
choice = scene.choose(metric="peak", tolerance=0.05, runs=1)
assert choice.choice is not None
print(choice.choice.verdict)
for line in choice.choice.reason:
    print("-", line)
