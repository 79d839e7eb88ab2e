"""Checks the record that the main job wrote: keys, references, runs, figures. Usage: check_record.py FILE"""

import json
import sys

RUN_KEYS = """model integrator status wall_s setup_s simulated_s steps rejected force_evaluations
newton_iterations factorisations dofs metrics""".split()
METRIC_KEYS = """force_l2 force_l2_aligned peak_force_n peak_force_rel impulse_ns impulse_rel duration_s
speeds_end energy_drift_rel against""".split()


def main(path):
    with open(path, encoding="utf-8") as file:
        record = json.load(file)
    assert record["schema"] == 2, record["schema"]
    for key in "scene machine commit runs".split():
        assert record.get(key), f"no {key}"
    runs = record["runs"]
    for model in "rigid", "movable-teeth":
        for implicit in False, True:
            found = {r["integrator"] for r in runs if r["model"] == model and r["implicit"] == implicit}
            assert len(found) >= 4, f"{model}, implicit {implicit}: only {sorted(found)}"
    for run in runs:
        name = f"{run['model']} {run['integrator']}"
        for key in RUN_KEYS:
            assert key in run, f"{name}: no {key}"
        assert ("step" in run) != ("rtol" in run), f"{name}: step or rtol"
        # Plain truncation shows how far off it is. The own error of the reference decides about elastic gears of their own
        # mesh alone: fits, and models on the mesh of the second reference, are too far from the first one.
        truncated = run["model"] == "elastic" and not run["residual"]
        decided = run.get("variant") == "own-mesh"
        expected = "inaccurate" if truncated else "converged" if decided else "unchecked"
        assert run["status"] == expected, f"{name}: {run['status']}: {run.get('message')}"
        against = {m["against"]: m for m in run["metrics"]}
        wanted = {"calculix", "calculix-one-mesh"} | (set() if run["model"] == "fe" else {"self"})
        assert wanted <= set(against), f"{name}: compared with {sorted(against)}"
        for key in METRIC_KEYS:
            assert key in against["calculix"], f"{name}: no {key}"
        speeds = list(against["calculix"]["speeds_end"])
        assert speeds == ["pinion", "wheel"], f"{name}: speeds of {speeds}"
        limit = {"rigid": 0.05, "movable-teeth": 0.035, "elastic": 0.02, "fe": 0.02}[run["model"]]
        # Models on the mesh of the second reference are compared with it, like with like.
        of_its_mesh = run["model"] in ("elastic", "fe") and not decided
        error = against["calculix-one-mesh" if of_its_mesh else "calculix"]["force_l2_aligned"]
        if truncated:
            assert 0.1 < error < 0.3, f"{name}: aligned force error {error:.4f} of plain truncation"
        else:
            assert error <= limit, f"{name}: aligned force error {error:.4f} beyond {limit}"
        # Deflected teeth touch off the lines of action, where there is no such invariant.
        if run["model"] in ("elastic", "fe"):
            continue
        drift = run["ledger"]["invariant_drift_rel"]
        assert abs(drift) <= 1e-10, f"{name}: momentum invariant drifts by {drift:.1e}"
    print(f"{len(runs)} runs checked, all within their limits")


if __name__ == "__main__":
    main(sys.argv[1])
