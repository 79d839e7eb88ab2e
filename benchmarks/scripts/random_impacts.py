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

[gears.a]
teeth = {teeth[0]}
module_m = {module}
helix_angle_deg = {helix}
profile_shift = {shifts[0]}
face_width_m = {width:.5f}
bore_radius_m = {bores[0]:.5f}
speed_rad_s = {speed:.4f}

[gears.b]
teeth = {teeth[1]}
module_m = {module}
helix_angle_deg = {opposite_helix}
profile_shift = {shifts[1]}
face_width_m = {width:.5f}
bore_radius_m = {bores[1]:.5f}

[[meshes]]
gears = ["a", "b"]
backlash_m = {backlash:.3g}
start = {{ flank = "{flank}", gap_m = 1e-7 }}
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
    text = PAIR.format(
        number=number,
        duration=0.15e-3 * module / 0.004,
        teeth=teeth,
        module=module,
        helix=helix,
        opposite_helix=-helix,
        shifts=[0.0, 0.0] if helix else shifts,
        width=width,
        bores=[part * (z - 3) * module / 2 for part, z in zip((0.45, 0.5), teeth)],
        speed=speed if flank == "left" else -speed,
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
