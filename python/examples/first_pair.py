# %% [markdown]
# # A first pair in ten lines
#
# Two spur gears meet at 60 rad/s. The model has rigid gears; the stiffness of the teeth is that of
# ISO 6336.

# %%
import gearbench as gb

pinion = gb.Gear(teeth=20, module_m=4e-3, face_width_m=10e-3, speed_rad_s=60.0)
wheel = gb.Gear(teeth=30, module_m=4e-3, face_width_m=10e-3)
pair = gb.Pair(pinion, wheel, centre_distance_m=0.1002)
rigid = gb.Model(model="rigid", contact=gb.Contact(stiffness="iso6336"))
scene = gb.Scene(pair, name="first_pair", duration_s=1e-3, models=[rigid])
run = scene.run(method="dopri5@1e-6")
force = run.series["contact_force_pinion_wheel_n"]
print(f"peak force {force.max():.1f} N, {run.steps} steps in {1e3 * run.cpu_s:.2f} ms")
assert force.max() > 1000.0

# %% [markdown]
# Scenes are values: a faster pinion is another scene. In a first approximation the peak force
# grows with the speed.

# %%
for speed in (30.0, 60.0, 120.0):
    faster = scene.changed({"gears.pinion.speed_rad_s": speed})
    peak = faster.run(method="dopri5@1e-6").series["contact_force_pinion_wheel_n"].max()
    print(f"{speed:5.0f} rad/s: {peak:8.1f} N")
