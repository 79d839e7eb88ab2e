//! Bodies without teeth, shafts and bearings of a scene for the report, as the motion shows them.

use gearbench_models::spec::{
    Bearing, OutOfPlaneSpec, SceneSpec, Section, SectionKind, ShaftSpec, StationMember,
};
use gearbench_reports::record::{PlainBody, ShaftSection, ShaftShape};

/// Returns the bodies without teeth, in the order of the members behind the gears.
pub(super) fn plain_bodies(spec: &SceneSpec) -> Vec<PlainBody> {
    let of = |b: &gearbench_models::spec::BodySpec| PlainBody {
        name: b.name.clone(),
        inertia_kgm2: b.inertia,
        planets: b.planets.clone(),
    };
    spec.bodies().map(of).collect()
}

/// Returns the shafts with their members and sections. A shaft with a single member and without sections has no length.
pub(super) fn shafts(spec: &SceneSpec) -> Vec<ShaftShape> {
    let section = |s: &Section| ShaftSection {
        length_m: s.length,
        diameter_m: match s.kind {
            SectionKind::Round { diameters, .. } => Some(diameters[0]),
            SectionKind::Coupling { .. } => None,
        },
    };
    let shape = |(shaft, members): (&ShaftSpec, Vec<usize>)| ShaftShape {
        name: shaft.name.clone(),
        members,
        places_m: shaft.stations.iter().map(|s| s.place).collect(),
        sections: shaft.sections.iter().map(section).collect(),
    };
    let all = spec.shafts.iter().zip(spec.members_of_shafts());
    all.map(shape)
        .filter(|s| s.members.len() > 1 || !s.sections.is_empty())
        .collect()
}

/// Returns the members whose hubs are on bearings: those with a stiffness across or along their axis.
pub(super) fn bearings(spec: &SceneSpec) -> Vec<usize> {
    let holds = |lateral: &Option<Box<OutOfPlaneSpec>>| {
        let stiff = |b: &Bearing| (0..3).any(|k| b.stiffness[k][k] > 0.0);
        lateral.as_ref().is_some_and(|l| stiff(&l.bearing))
    };
    let gears = spec.gears.iter().map(|g| holds(&g.lateral));
    let bodies = (spec.shafts.iter())
        .flat_map(|s| &s.stations)
        .filter_map(|s| match &s.carries {
            StationMember::Body(b) => Some(holds(&b.lateral)),
            StationMember::Gear(_) => None,
        });
    let all = gears.chain(bodies).enumerate();
    all.filter(|(_, held)| *held).map(|(i, _)| i).collect()
}
