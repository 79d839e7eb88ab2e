//! Whatever the bytes: a table is read or refused with a place in its text, and what is read ascends in time and is finite.
#![no_main]

use gearbench_reference::data::{
    GearSubject, MeshSubject, Processing, Request, Subjects, decode, read,
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok((text, _)) = decode(data) else { return };
    let gear = |name: &str, slides| GearSubject {
        name: name.into(),
        slides,
    };
    let subjects = Subjects {
        gears: vec![gear("pinion", None), gear("wheel", Some(0.02))],
        meshes: vec![MeshSubject {
            gears: ["pinion", "wheel"].map(Into::into),
            base_helix: 0.3,
            base_radius: Some(0.05),
        }],
    };
    let processed = Request {
        processing: Processing {
            offset: -1e-4,
            moving_average: Some(1e-5),
            from: 0.0,
            to: Some(1.0),
            resample: Some(1e-3),
        },
        ..Request::default()
    };
    for request in [Request::default(), processed] {
        match read(&text, &request, &subjects) {
            Ok(found) => {
                for c in &found.channels {
                    assert!(c.time.len() >= 3 && c.time.len() == c.value.len());
                    assert!(c.time.windows(2).all(|w| w[0] < w[1]));
                    assert!(c.value.iter().all(|x| x.is_finite()));
                }
            }
            Err(e) => assert!(text.get(e.at.clone()).is_some() && !e.to_string().is_empty()),
        }
    }
});
