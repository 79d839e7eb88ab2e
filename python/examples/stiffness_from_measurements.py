# %% [markdown]
# # Stiffness from measurements
#
# A measured contact force determines constants of a model. Here the reference of the scene, a
# solution of CalculiX, takes the place of a measurement; `identify` fits the constants of rigid
# gears to it.

# %%
import gearbench as gb

scene = gb.Scene.load("spur_impact")
fit = scene.identify(model="rigid").fits[0]
for parameter in fit.parameters:
    print(parameter)
for data in fit.data:
    print(f"{data.name}: relative L2 error {100 * (data.l2 or 0):.2f} %")
assert fit.evaluations > 0

# %% [markdown]
# The static mesh stiffness of the same pair, by formulas and by the compliance of the teeth.

# %%
stiffness = scene.stiffness(models="rigid", positions=12)
for model in stiffness.stiffness:
    print(f"{model.label:25} {1e-9 * (model.mesh_stiffness_n_per_m2 or 0):.2f} N/(mm um)")
assert len(stiffness.stiffness) >= 2
