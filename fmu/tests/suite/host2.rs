//! A host of FMUs of FMI 2 for tests: declarations of `fmi2Functions.h`, and an instance used through them.

use crate::host::{Unpacked, attribute};
use gearbench::fmu::package::Package;
use gearbench_fmu::c::fmi2::common::{Callbacks, fmi2Instantiate};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use tempfile::TempDir;

unsafe extern "C" {
    fn fmi2GetVersion() -> *const c_char;
    fn fmi2GetTypesPlatform() -> *const c_char;
    fn fmi2FreeInstance(i: *mut c_void);
    fn fmi2SetupExperiment(
        i: *mut c_void,
        tolerance_defined: c_int,
        tolerance: f64,
        start: f64,
        stop_defined: c_int,
        stop: f64,
    ) -> c_int;
    fn fmi2EnterInitializationMode(i: *mut c_void) -> c_int;
    fn fmi2ExitInitializationMode(i: *mut c_void) -> c_int;
    fn fmi2Terminate(i: *mut c_void) -> c_int;
    fn fmi2Reset(i: *mut c_void) -> c_int;
    fn fmi2GetReal(i: *mut c_void, r: *const u32, n: usize, v: *mut f64) -> c_int;
    fn fmi2SetReal(i: *mut c_void, r: *const u32, n: usize, v: *const f64) -> c_int;
    fn fmi2GetBoolean(i: *mut c_void, r: *const u32, n: usize, v: *mut c_int) -> c_int;
    fn fmi2SetBoolean(i: *mut c_void, r: *const u32, n: usize, v: *const c_int) -> c_int;
    fn fmi2GetInteger(i: *mut c_void, r: *const u32, n: usize, v: *mut c_int) -> c_int;
    fn fmi2GetFMUstate(i: *mut c_void, state: *mut *mut c_void) -> c_int;
    fn fmi2SetFMUstate(i: *mut c_void, state: *mut c_void) -> c_int;
    fn fmi2FreeFMUstate(i: *mut c_void, state: *mut *mut c_void) -> c_int;
    fn fmi2SerializedFMUstateSize(i: *mut c_void, state: *mut c_void, n: *mut usize) -> c_int;
    fn fmi2SerializeFMUstate(i: *mut c_void, state: *mut c_void, b: *mut u8, n: usize) -> c_int;
    fn fmi2DeSerializeFMUstate(
        i: *mut c_void,
        b: *const u8,
        n: usize,
        state: *mut *mut c_void,
    ) -> c_int;
    fn fmi2SetRealInputDerivatives(
        i: *mut c_void,
        r: *const u32,
        n: usize,
        order: *const c_int,
        v: *const f64,
    ) -> c_int;
    fn fmi2GetRealOutputDerivatives(
        i: *mut c_void,
        r: *const u32,
        n: usize,
        order: *const c_int,
        v: *mut f64,
    ) -> c_int;
    fn fmi2DoStep(i: *mut c_void, from: f64, size: f64, no_earlier_state: c_int) -> c_int;
    fn fmi2CancelStep(i: *mut c_void) -> c_int;
    fn fmi2GetStatus(i: *mut c_void, kind: c_int, v: *mut c_int) -> c_int;
    fn fmi2GetRealStatus(i: *mut c_void, kind: c_int, v: *mut f64) -> c_int;
    fn fmi2GetBooleanStatus(i: *mut c_void, kind: c_int, v: *mut c_int) -> c_int;
    fn fmi2GetDerivatives(i: *mut c_void, x: *mut f64, n: usize) -> c_int;
    fn fmi2GetContinuousStates(i: *mut c_void, x: *mut f64, n: usize) -> c_int;
}

/// Declares the functions of the standard without their signatures: only the addresses are compared.
macro_rules! exported {
    ($($name:ident)*) => {
        mod addresses {
            unsafe extern "C" { $(pub safe fn $name();)* }
        }

        /// Names and addresses of all functions of the standard.
        pub fn all() -> Vec<(&'static str, usize)> {
            vec![$((stringify!($name), addresses::$name as *const () as usize)),*]
        }
    };
}

#[allow(non_snake_case, clashing_extern_declarations)]
mod all_functions {
    exported! {
        fmi2GetTypesPlatform fmi2GetVersion fmi2SetDebugLogging fmi2Instantiate fmi2FreeInstance fmi2SetupExperiment
        fmi2EnterInitializationMode fmi2ExitInitializationMode fmi2Terminate fmi2Reset fmi2GetReal fmi2GetInteger
        fmi2GetBoolean fmi2GetString fmi2SetReal fmi2SetInteger fmi2SetBoolean fmi2SetString fmi2GetFMUstate
        fmi2SetFMUstate fmi2FreeFMUstate fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate
        fmi2GetDirectionalDerivative fmi2EnterEventMode fmi2NewDiscreteStates fmi2EnterContinuousTimeMode
        fmi2CompletedIntegratorStep fmi2SetTime fmi2SetContinuousStates fmi2GetDerivatives fmi2GetEventIndicators
        fmi2GetContinuousStates fmi2GetNominalsOfContinuousStates fmi2SetRealInputDerivatives fmi2GetRealOutputDerivatives
        fmi2DoStep fmi2CancelStep fmi2GetStatus fmi2GetRealStatus fmi2GetIntegerStatus fmi2GetBooleanStatus
        fmi2GetStringStatus
    }
}
pub use all_functions::all;

thread_local! {
    /// Messages that instances of this thread logged.
    static SAID: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// The logging function of a host that takes no further arguments, as messages have none.
unsafe extern "C" fn listen(
    _: *mut c_void,
    name: *const c_char,
    status: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    let [name, text] = [name, message].map(|p| unsafe { CStr::from_ptr(p) }.to_string_lossy());
    SAID.with_borrow_mut(|said| said.push(format!("{status}: {name}: {text}")));
}

/// Returns the messages logged since the last call.
pub fn said() -> String {
    SAID.with_borrow_mut(std::mem::take).join("\n")
}

/// Version of the standard and platform of its types that the library names.
pub fn version() -> [String; 2] {
    let texts = unsafe { [fmi2GetVersion(), fmi2GetTypesPlatform()] };
    texts.map(|p| unsafe { CStr::from_ptr(p) }.to_string_lossy().into_owned())
}

/// An instance as used by a host of FMI 2.
pub struct Fmu2 {
    instance: *mut c_void,
    _folder: TempDir,
    references: BTreeMap<String, u32>,
    pub outputs: Vec<String>,
}

/// A copy of the state to return to; freed when dropped.
pub struct SavedState<'a>(&'a Fmu2, *mut c_void);

impl Drop for SavedState<'_> {
    fn drop(&mut self) {
        assert_eq!(unsafe { fmi2FreeFMUstate(self.0.instance, &mut self.1) }, 0);
        assert!(self.1.is_null());
    }
}

impl Drop for Fmu2 {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.instance) }
    }
}

impl Fmu2 {
    /// Unpacks and instantiates; `None` where the library refuses.
    pub fn try_new(package: &Package, exchange: bool, guid: Option<&str>) -> Option<Fmu2> {
        let Unpacked {
            folder,
            description,
            references,
            outputs,
        } = Unpacked::of(package);
        let guid = guid.unwrap_or(attribute(&description, "guid").unwrap());
        let resources = format!("file://{}/resources", folder.path().display());
        let [guid, resources] = [guid, &resources].map(|s| CString::new(s).unwrap());
        type Logger = unsafe extern "C" fn(
            *mut c_void,
            *const c_char,
            c_int,
            *const c_char,
            *const c_char,
            ...
        );
        // SAFETY: a C host declares its logger with an ellipsis; one without reads the same five arguments.
        let logger: Logger = unsafe { std::mem::transmute(listen as *const ()) };
        let callbacks = Callbacks {
            logger: Some(logger),
            allocate: null(),
            free: null(),
            step_finished: null(),
            environment: null_mut(),
        };
        let (name, kind) = (c"50 % test".as_ptr(), c_int::from(!exchange));
        let (guid, resources) = (guid.as_ptr(), resources.as_ptr());
        let instance = unsafe { fmi2Instantiate(name, kind, guid, resources, &callbacks, 0, 0) };
        (!instance.is_null()).then_some(Fmu2 {
            instance,
            _folder: folder,
            references,
            outputs,
        })
    }

    pub fn stepping(package: &Package) -> Fmu2 {
        Self::try_new(package, false, None).unwrap_or_else(|| panic!("{}", said()))
    }

    pub fn exchanging(package: &Package) -> Fmu2 {
        Self::try_new(package, true, None).unwrap_or_else(|| panic!("{}", said()))
    }

    fn ok(&self, status: c_int) {
        assert_eq!(status, 0, "{}", said());
    }

    pub fn initialise(&self, start: f64, stop: Option<f64>) {
        let (defined, stop) = (stop.is_some().into(), stop.unwrap_or(0.0));
        self.ok(unsafe { fmi2SetupExperiment(self.instance, 0, 0.0, start, defined, stop) });
        self.ok(unsafe { fmi2EnterInitializationMode(self.instance) });
        self.ok(unsafe { fmi2ExitInitializationMode(self.instance) });
    }

    pub fn reset(&self) {
        self.ok(unsafe { fmi2Reset(self.instance) });
    }

    pub fn terminate(&self) {
        self.ok(unsafe { fmi2Terminate(self.instance) });
    }

    pub fn reference(&self, name: &str) -> u32 {
        self.references[name]
    }

    pub fn get(&self, name: &str) -> f64 {
        let (r, mut x) = (self.reference(name), f64::NAN);
        self.ok(unsafe { fmi2GetReal(self.instance, &r, 1, &mut x) });
        x
    }

    /// The values of all outputs, read in one call.
    pub fn look(&self) -> Vec<f64> {
        let r: Vec<u32> = self.outputs.iter().map(|n| self.reference(n)).collect();
        let mut x = vec![f64::NAN; r.len()];
        self.ok(unsafe { fmi2GetReal(self.instance, r.as_ptr(), r.len(), x.as_mut_ptr()) });
        x
    }

    pub fn set(&self, name: &str, x: f64) {
        let r = self.reference(name);
        self.ok(unsafe { fmi2SetReal(self.instance, &r, 1, &x) });
    }

    pub fn try_get_integer(&self, reference: u32) -> c_int {
        unsafe { fmi2GetInteger(self.instance, &reference, 1, &mut 0) }
    }

    /// Sets `interpolate`, and reads it again.
    pub fn interpolate(&self) {
        let (r, mut x) = (self.reference("interpolate"), 0);
        self.ok(unsafe { fmi2SetBoolean(self.instance, &r, 1, &7) });
        self.ok(unsafe { fmi2GetBoolean(self.instance, &r, 1, &mut x) });
        assert_eq!(x, 1);
    }

    pub fn try_extrapolate(&self, name: &str, order: c_int, x: f64) -> c_int {
        let r = self.reference(name);
        unsafe { fmi2SetRealInputDerivatives(self.instance, &r, 1, &order, &x) }
    }

    pub fn extrapolate(&self, name: &str, order: c_int, x: f64) {
        self.ok(self.try_extrapolate(name, order, x));
    }

    pub fn slope(&self, name: &str, order: c_int) -> f64 {
        let (r, mut x) = (self.reference(name), f64::NAN);
        self.ok(unsafe { fmi2GetRealOutputDerivatives(self.instance, &r, 1, &order, &mut x) });
        x
    }

    pub fn try_step(&self, from: f64, size: f64) -> c_int {
        unsafe { fmi2DoStep(self.instance, from, size, 0) }
    }

    pub fn step(&self, from: f64, size: f64) {
        self.ok(self.try_step(from, size));
    }

    /// Status of the questions about the last step: pending text, time reached, end requested; and the answers.
    pub fn questions(&self) -> ([c_int; 4], f64, c_int) {
        let (mut time, mut ends, mut status) = (f64::NAN, -1, -1);
        let i = self.instance;
        let all = unsafe {
            [
                fmi2GetStatus(i, 0, &mut status),
                fmi2GetRealStatus(i, 2, &mut time),
                fmi2GetBooleanStatus(i, 3, &mut ends),
                fmi2CancelStep(i),
            ]
        };
        (all, time, ends)
    }

    pub fn keep(&self) -> SavedState<'_> {
        let mut state = null_mut();
        self.ok(unsafe { fmi2GetFMUstate(self.instance, &mut state) });
        SavedState(self, state)
    }

    pub fn go_back(&self, kept: &SavedState<'_>) {
        self.ok(unsafe { fmi2SetFMUstate(self.instance, kept.1) });
    }

    pub fn store(&self, kept: &SavedState<'_>) -> Vec<u8> {
        let mut n = 0;
        self.ok(unsafe { fmi2SerializedFMUstateSize(self.instance, kept.1, &mut n) });
        let mut bytes = vec![0; n];
        let to = bytes.as_mut_ptr();
        let short = unsafe { fmi2SerializeFMUstate(self.instance, kept.1, to, n - 1) };
        assert_eq!(short, 3);
        assert!(said().contains(&format!("needs {n} bytes")));
        self.ok(unsafe { fmi2SerializeFMUstate(self.instance, kept.1, to, n) });
        bytes
    }

    /// Returns to a state that is stored as bytes.
    pub fn try_go_back_to(&self, bytes: &[u8]) -> c_int {
        let mut state = null_mut();
        let (from, n) = (bytes.as_ptr(), bytes.len());
        match unsafe { fmi2DeSerializeFMUstate(self.instance, from, n, &mut state) } {
            0 => {
                self.go_back(&SavedState(self, state));
                0
            }
            status => status,
        }
    }

    /// Continuous states and their derivatives.
    pub fn rates(&self, n: usize) -> [Vec<f64>; 2] {
        let mut all = [vec![f64::NAN; n], vec![f64::NAN; n]];
        let [x, dx] = &mut all;
        self.ok(unsafe { fmi2GetContinuousStates(self.instance, x.as_mut_ptr(), n) });
        self.ok(unsafe { fmi2GetDerivatives(self.instance, dx.as_mut_ptr(), n) });
        all
    }
}
