# %% [markdown]
# # A sweep with tooth corrections
#
# Tip relief reduces the transmission error under load. The same pair is run at a few speeds
# without and with it.

# %%
import gearbench as gb

scene = gb.Scene.load("loaded_mesh")
start_radius_m = {"pinion": 40.0e-3, "wheel": 58.0e-3}
relieved = {
    name: gear.replace(
        tip_relief=gb.Relief(amount_m=15e-6, start_radius_m=start_radius_m[name], shape="linear")
    )
    for name, gear in scene.gears.items()
}
scenes = {"standard teeth": scene, "tip relief": scene.replace(gears=relieved)}
errors = {}
for label, own in scenes.items():
    sweep = own.sweep(models="rigid", points=3)
    steady = [run.steady for run in sweep.runs if run.steady is not None]
    errors[label] = [1e6 * s.error_rms_m for s in steady if s.error_rms_m is not None]
    for state, error in zip(steady, errors[label]):
        print(f"{label:15} {state.mesh_frequency_hz:7.0f} Hz {error:.3f} um")
assert len(errors["standard teeth"]) == len(errors["tip relief"]) > 0
