//! Copies of the state as bytes: a host may store them, and an instance of the same FMU continues from them bit for bit.
//!
//! The bytes begin with the hash of the variables and the kind of the instance, so that a copy of another FMU is refused.

use crate::instance::{CallResult, Failure, Instance, Memory, Phase, PortInput, Snapshot};
use gearbench_integrators::system::Events;
use gearbench_integrators::{Archive, ArchiveError};
use gearbench_models::spec::Profile;
use gearbench_reference::hash::Hash;

/// Version of the layout of the bytes.
const LAYOUT: u64 = 1;

impl From<ArchiveError> for Failure {
    fn from(e: ArchiveError) -> Self {
        Failure(e.to_string())
    }
}

impl Instance {
    /// Identifies the FMU and the kind of the instance.
    fn mark(&self) -> u64 {
        let mut hash = Hash::START;
        hash.text(&self.coupled.interface.key());
        hash.text(&format!("{:?} {LAYOUT} {}", self.kind(), self.scheme));
        // The first half of the hash.
        let digits = hash.to_string();
        u64::from_str_radix(digits.get(..16).unwrap_or_default(), 16).unwrap_or_default()
    }

    /// Writes a copy of the state as bytes.
    ///
    /// # Errors
    /// The method refuses the scene.
    pub fn serialise(&mut self, snapshot: &Snapshot) -> CallResult<Vec<u8>> {
        let mut archive = Archive::writing();
        let mut mark = self.mark();
        archive.whole(&mut mark)?;
        let mut copy = Snapshot {
            memory: snapshot.memory.clone(),
            method: snapshot.method.duplicate(),
        };
        self.traverse(&mut copy, &mut archive)?;
        Ok(archive.into_bytes())
    }

    /// Makes a copy of the state from bytes.
    ///
    /// # Errors
    /// The bytes are not those of a state of this FMU.
    pub fn deserialise(&mut self, bytes: &[u8]) -> CallResult<Snapshot> {
        let mut archive = Archive::reading(bytes);
        let mut mark = 0;
        archive.whole(&mut mark)?;
        if mark != self.mark() {
            return Err(Failure(
                "the stored state is that of another FMU, method or kind of instance".into(),
            ));
        }
        let mut copy = Snapshot {
            memory: self.memory.clone(),
            method: self.scheme.method.build(),
        };
        let sizes = Sizes::of(&copy.memory);
        // A run that continues does not begin, so that an instance that has not run yet begins here: the scene stores
        // whether events are located.
        let mut begun = self.memory.state.clone();
        self.coupled.scene.begin(&mut begun, self.events);
        self.traverse(&mut copy, &mut archive)?;
        archive.finish()?;
        if sizes != Sizes::of(&copy.memory) {
            return Err(Failure(
                "the stored state has another number of coordinates".into(),
            ));
        }
        Ok(copy)
    }

    fn traverse(&mut self, copy: &mut Snapshot, archive: &mut Archive<'_>) -> CallResult {
        copy.memory.archive(archive)?;
        let scene = &mut self.coupled.scene;
        (copy.method)
            .archive(scene, self.scheme.resolution, archive)
            .map_err(|e| Failure(e.to_string()))
    }
}

/// Lengths of the lists of a state.
#[derive(PartialEq)]
struct Sizes([usize; 5]);

impl Sizes {
    fn of(memory: &Memory) -> Self {
        let state = &memory.state;
        Sizes([
            state.q.len(),
            state.v.len(),
            state.discrete.len(),
            memory.given.len(),
            memory.applied.len(),
        ])
    }
}

impl Memory {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        const PHASES: [Phase; 4] = [
            Phase::Instantiated,
            Phase::Initialising,
            Phase::Running,
            Phase::Terminated,
        ];
        let mut phase = PHASES.iter().position(|p| *p == self.phase).unwrap_or(0);
        archive.count(&mut phase, PHASES.len() - 1)?;
        self.phase = PHASES[phase];
        archive.number(&mut self.state.t)?;
        archive.numbers(&mut self.state.q)?;
        archive.numbers(&mut self.state.v)?;
        archive.numbers(&mut self.state.discrete)?;
        archive.number(&mut self.shift)?;
        let mut stops = self.stop.is_some();
        archive.flag(&mut stops)?;
        let mut stop = self.stop.unwrap_or(0.0);
        archive.number(&mut stop)?;
        self.stop = stops.then_some(stop);
        self.given.iter_mut().try_for_each(|x| x.archive(archive))?;
        for profile in &mut self.applied {
            archive_profile(profile, archive)?;
        }
        for flag in [
            &mut self.interpolate,
            &mut self.stale,
            &mut self.extrapolates,
            &mut self.extrapolated,
            &mut self.changed,
            &mut self.begun,
            &mut self.ran,
        ] {
            archive.flag(flag)?;
        }
        Ok(())
    }
}

impl PortInput {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let all = self.now.iter_mut().chain(&mut self.end);
        let mut all = all.chain(self.derivatives.iter_mut().flatten());
        all.try_for_each(|x| archive.number(x))
    }
}

/// Traverses a profile that an input of a host has: a constant or a cubic.
fn archive_profile(profile: &mut Profile, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
    let (mut cubic, mut x) = match profile {
        Profile::Constant(value) => (false, [*value, 0.0, 0.0, 0.0, 0.0]),
        Profile::Polynomial { from, integral } => {
            let [a, b, c, d] = *integral;
            (true, [*from, a, b, c, d])
        }
        _ => return Err(ArchiveError::Value("profile of an input")),
    };
    archive.flag(&mut cubic)?;
    x.iter_mut().try_for_each(|x| archive.number(x))?;
    let [from, integral @ ..] = x;
    *profile = match cubic {
        true => Profile::Polynomial { from, integral },
        false => Profile::Constant(from),
    };
    Ok(())
}
