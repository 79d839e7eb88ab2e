"""Names of Python for the types that read scenes and for the studies."""

from __future__ import annotations

import keyword

# The class of each table that is made by keywords, by the type that reads it.
TABLES = {
    "GearTable": "Gear",
    "RackTable": "Rack",
    "ReliefTable": "Relief",
    "EndReliefTable": "EndRelief",
    "EndTable": "End",
    "SideTable": "Sides",
    "TopographyTable": "Topography",
    "DeviationTable": "Deviations",
    "FlankTable": "FlankDeviations",
    "BearingTable": "Bearing",
    "DirectionTable": "Directions",
    "MisalignmentTable": "Misalignment",
    "MaterialTable": "Material",
    "GearLoad": "Load",
    "RackLoad": "RackLoad",
    "MeshTable": "Mesh",
    "StartTable": "Start",
    "ShaftTable": "Shaft",
    "StationTable": "Station",
    "SectionTable": "Section",
    "StageTable": "Stage",
    "ModelTable": "Model",
    "GearModelTable": "GearModel",
    "ContactTable": "Contact",
    "StiffnessTable": "Stiffness",
    "Damping": "ContactDamping",
    "FrictionTable": "Friction",
    "SharedDampingTable": "Damping",
    "ReferenceTable": "Reference",
    "ToleranceTable": "Tolerance",
    "IntegratorTable": "Integrator",
    "StudyTable": "Study",
}

# The class of the record of each study, by its command.
STUDIES = {
    "compare": "CompareResult",
    "choose": "ChooseResult",
    "precision": "TabularResult",
    "stability": "StabilityResult",
    "truncation": "TabularResult",
    "stiffness": "StiffnessResult",
    "modes": "ModesResult",
    "response": "ResponseResult",
    "sweep": "SweepResult",
    "run-up": "RunUpResult",
    "scan": "ScanResult",
    "identify": "IdentifyResult",
    "coupling": "TabularResult",
    "penalty": "TabularResult",
    "cost": "TabularResult",
    "check": "CheckResult",
}

# Commands that write files, and return what they have found as a dictionary.
COMMANDS = ("mesh", "reference", "fmu", "import", "export")


def key_of(name: str) -> str:
    """Return the key of a scene by its name in Python: `class` of `class_`."""
    return name[:-1] if name.endswith("_") and keyword.iskeyword(name[:-1]) else name


def python_name(name: str) -> str:
    """Return the name of a study or an option in Python; a keyword has `_` at its end."""
    plain = name.replace("-", "_")
    return f"{plain}_" if keyword.iskeyword(plain) else plain
