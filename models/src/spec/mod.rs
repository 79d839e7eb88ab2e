//! Specification of a scene: plain data in SI units, independent of files.

mod layout;
mod load;
mod model;
mod mount;
mod points;
mod profile;
mod scene;
mod shaft;
mod stage;
mod train;

pub use layout::{
    LARGEST_MISALIGNMENT, MeshLayout, base_radius, check_axes, effective_radius, is_internal,
    layout_axes, mesh_layout, pair_of, signed_base_radius, signed_effective_radius,
    stiffness_curve, transmission_error,
};
pub use load::Load;
pub use model::{ModelSpec, Modelling};
pub use mount::{Bearing, Freedom, Guide, Mount, OutOfPlaneSpec, SpinTerms, UPRIGHT, turned_to};
pub use points::{
    CoarseSearch, FlankContact, MAX_POINTS, Passes, PointContact, PointLaw, PointRule, SurfaceKind,
};
pub use profile::{Profile, Table};
pub use scene::{Body, ContactSpec, GearSpec, MeshSpec, SceneSpec, Start};
pub use shaft::{
    BodySpec, Section, SectionKind, ShaftDamping, ShaftSpec, Station, StationMember, initial_speed,
};
pub use stage::StageSpec;
pub use train::Train;
