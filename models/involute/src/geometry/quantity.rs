//! Names and units of the quantities that define a geometry.

/// A quantity that defines a geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each is what its name says")]
pub enum Quantity {
    Teeth,
    RackTeeth,
    Module,
    PressureAngle,
    HelixAngle,
    Addendum,
    Dedendum,
    TipRadius,
    Thinning,
    FaceWidth,
    ProfileShift,
    ProfileShiftAngle,
    TipConeAngle,
    BoreRadius,
    RimRadius,
    CutterTeeth,
    CutterShift,
    ProfileCrowning,
    LeadCrowning,
    ReliefAmount,
    ReliefStart,
    EndReliefAmount,
    EndReliefLength,
    HelixSlope,
    Twist,
    TopographyRadius,
    TopographyHeight,
    BodyHeight,
    CentreDistance,
    RackDistance,
    Backlash,
    ReferenceCircle,
    TipCircle,
    RootCircle,
}

impl Quantity {
    /// Returns the name of the quantity with its unit.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Teeth => "number of teeth",
            Self::RackTeeth => "number of rack teeth",
            Self::Module => "normal module [m]",
            Self::PressureAngle => "normal pressure angle",
            Self::HelixAngle => "helix angle",
            Self::Addendum => "addendum factor",
            Self::Dedendum => "dedendum factor",
            Self::TipRadius => "tip radius factor",
            Self::Thinning => "thinning [m]",
            Self::FaceWidth => "face width [m]",
            Self::ProfileShift => "profile shift coefficient",
            Self::ProfileShiftAngle => "profile-shift angle",
            Self::TipConeAngle => "angle of the tip cone",
            Self::BoreRadius => "bore radius [m]",
            Self::RimRadius => "rim radius [m]",
            Self::CutterTeeth => "number of cutter teeth",
            Self::CutterShift => "profile shift coefficient of the cutter",
            Self::ProfileCrowning => "profile crowning [m]",
            Self::LeadCrowning => "lead crowning [m]",
            Self::ReliefAmount => "tip relief amount [m]",
            Self::ReliefStart => "tip relief start radius [m]",
            Self::EndReliefAmount => "end relief amount [m]",
            Self::EndReliefLength => "end relief length [m]",
            Self::HelixSlope => "helix slope [m]",
            Self::Twist => "twist [m]",
            Self::TopographyRadius => "radius of a topography [m]",
            Self::TopographyHeight => "height of a topography [m]",
            Self::BodyHeight => "height of the rack body [m]",
            Self::CentreDistance => "centre distance [m]",
            Self::RackDistance => "distance from gear centre to rack reference line [m]",
            Self::Backlash => "backlash [m]",
            Self::ReferenceCircle => "reference radius [m]",
            Self::TipCircle => "tip radius [m]",
            Self::RootCircle => "root radius [m]",
        }
    }
}
