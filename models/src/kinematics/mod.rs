//! Kinematics of gears: teeth and points, poses, hubs, and rows over the coordinates.

mod freedom;
mod hub;
mod point;
mod pose;
mod row;
mod view;

pub use crate::geometry::Frame as HubFrame;
pub use freedom::{BodyMass, Motion, OutOfPlane, listed};
pub use hub::{BodyMotion, Direction, Hub, HubPose, PointWrench, Wrench};
pub use point::{Locus, Point, Tooth};
pub use pose::{Placement, Pose};
pub use row::Row;
pub use view::MeshView;
