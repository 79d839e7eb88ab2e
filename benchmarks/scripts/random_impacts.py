"""Writes random impacts: scenes of elastic gears with 60 and 100 modes, made by default and eigenmodes, and with 1000.

    python3 random_impacts.py FOLDER SEED
    gearbench compare FOLDER/impact0.toml --yardstick full
"""
import os
import random
import sys

SCENES = 6
PAIR = """schema = 1
name = "impact{number}"
duration_s = {duration:.6g}

{first}
{second}
[[meshes]]
gears = ["a", "b"]
backlash_m = {backlash:.3g}
start = {{ flank = "{flank}", gap_m = 1e-7 }}
"""
GEAR = """[gears.{name}]
teeth = {teeth}
module_m = {module}
helix_angle_deg = {helix}
profile_shift = {shift}
face_width_m = {width:.5f}
bore_radius_m = {bore:.5f}
"""
MODEL = """
[[models]]
label = "{label}"
model = "elastic"
parameters = {{ flank_elements = 8, width_elements = {width_elements}, modes = {modes}{choose} }}
contact = {{ penalty_pa_per_m = {penalty:.3g} }}
"""
STUDY = """
[study]
models = ["d100", "e100", "d60", "e60", "full"]
integrators = [{ method = "trigonometric", step_s = 2.5e-7 }]
samples = 2000
"""
EIGENMODES = ', choose = "flank-compliance"'
MODELS = [("d100", 100, ""), ("e100", 100, EIGENMODES), ("d60", 60, ""), ("e60", 60, EIGENMODES), ("full", 1000, EIGENMODES)]


def scene(number, draw):
    first = draw.randint(15, 28)
    teeth = [first, draw.randint(first, 60)]
    module = draw.choice([2, 3, 4, 5]) * 1e-3
    # One spur and one helical pair are among them for certain.
    helix = draw.choice([0, 0, 8, 12, 16, 20]) if number > 1 else [0, 15][number]
    width = draw.uniform(2.0, 4.0) * module
    shifts = [round(draw.uniform(-0.1, 0.4), 2), round(draw.uniform(-0.2, 0.3), 2)]
    speed = draw.uniform(0.3, 1.0) / (0.5 * first * module)
    flank = draw.choice(["left", "right"])
    speed = speed if flank == "left" else -speed
    gears = [
        GEAR.format(
            name=name,
            teeth=z,
            module=module,
            helix=beta,
            shift=0.0 if helix else shift,
            width=width,
            bore=bore * (z - 3) * module / 2,
        )
        for name, z, beta, shift, bore in zip("ab", teeth, (helix, -helix), shifts, (0.45, 0.5))
    ]
    text = PAIR.format(
        number=number,
        duration=0.15e-3 * module / 0.004,
        first=gears[0] + f"speed_rad_s = {speed:.4f}\n",
        second=gears[1],
        backlash=0.02 * module,
        flank=flank,
    )
    for label, modes, choose in MODELS:
        text += MODEL.format(
            label=label,
            modes=modes,
            choose=choose,
            width_elements=4 if helix else 2,
            penalty=1e15 * 4e-3 / module,
        )
    return text + STUDY


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder, seed = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    draw = random.Random(int(seed))
    for number in range(SCENES):
        with open(os.path.join(folder, f"impact{number}.toml"), "w") as file:
            file.write(scene(number, draw))
