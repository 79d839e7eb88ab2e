//! A host of FMUs for tests: declarations of `fmi3Functions.h`, and an instance used through them.

use gearbench::fmu::package::Package;
use gearbench_fmu as _;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use tempfile::TempDir;

type Log = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

unsafe extern "C" {
    fn fmi3GetVersion() -> *const c_char;
    fn fmi3InstantiateCoSimulation(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: bool,
        logging: bool,
        event_mode: bool,
        early_return: bool,
        required: *const u32,
        required_count: usize,
        environment: *mut c_void,
        log: Option<Log>,
        intermediate: *const c_void,
    ) -> *mut c_void;
    fn fmi3InstantiateModelExchange(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: bool,
        logging: bool,
        environment: *mut c_void,
        log: Option<Log>,
    ) -> *mut c_void;
    fn fmi3FreeInstance(instance: *mut c_void);
    fn fmi3EnterInitializationMode(
        instance: *mut c_void,
        tolerance_defined: bool,
        tolerance: f64,
        start: f64,
        stop_defined: bool,
        stop: f64,
    ) -> c_int;
    fn fmi3ExitInitializationMode(instance: *mut c_void) -> c_int;
    fn fmi3Terminate(instance: *mut c_void) -> c_int;
    fn fmi3Reset(instance: *mut c_void) -> c_int;
    fn fmi3GetFloat64(i: *mut c_void, r: *const u32, n: usize, v: *mut f64, m: usize) -> c_int;
    fn fmi3SetFloat64(i: *mut c_void, r: *const u32, n: usize, v: *const f64, m: usize) -> c_int;
    fn fmi3GetInt32(i: *mut c_void, r: *const u32, n: usize, v: *mut i32, m: usize) -> c_int;
    fn fmi3SetBoolean(i: *mut c_void, r: *const u32, n: usize, v: *const bool, m: usize) -> c_int;
    fn fmi3GetFMUState(i: *mut c_void, state: *mut *mut c_void) -> c_int;
    fn fmi3SetFMUState(i: *mut c_void, state: *mut c_void) -> c_int;
    fn fmi3FreeFMUState(i: *mut c_void, state: *mut *mut c_void) -> c_int;
    fn fmi3SerializedFMUStateSize(i: *mut c_void, state: *mut c_void, n: *mut usize) -> c_int;
    fn fmi3SerializeFMUState(i: *mut c_void, state: *mut c_void, b: *mut u8, n: usize) -> c_int;
    fn fmi3DeserializeFMUState(
        i: *mut c_void,
        b: *const u8,
        n: usize,
        state: *mut *mut c_void,
    ) -> c_int;
    fn fmi3DoStep(
        instance: *mut c_void,
        from: f64,
        size: f64,
        no_earlier_state: bool,
        event_handling: *mut bool,
        terminate: *mut bool,
        early_return: *mut bool,
        last: *mut f64,
    ) -> c_int;
    fn fmi3GetOutputDerivatives(
        instance: *mut c_void,
        references: *const u32,
        count: usize,
        orders: *const c_int,
        values: *mut f64,
        value_count: usize,
    ) -> c_int;
    fn fmi3SetTime(instance: *mut c_void, time: f64) -> c_int;
    fn fmi3SetContinuousStates(instance: *mut c_void, x: *const f64, n: usize) -> c_int;
    fn fmi3GetContinuousStates(instance: *mut c_void, x: *mut f64, n: usize) -> c_int;
    fn fmi3GetContinuousStateDerivatives(instance: *mut c_void, x: *mut f64, n: usize) -> c_int;
    fn fmi3GetNominalsOfContinuousStates(instance: *mut c_void, x: *mut f64, n: usize) -> c_int;
    fn fmi3GetEventIndicators(instance: *mut c_void, z: *mut f64, n: usize) -> c_int;
    fn fmi3GetNumberOfContinuousStates(instance: *mut c_void, n: *mut usize) -> c_int;
    fn fmi3GetNumberOfEventIndicators(instance: *mut c_void, n: *mut usize) -> c_int;
    fn fmi3EnterEventMode(instance: *mut c_void) -> c_int;
    fn fmi3EnterContinuousTimeMode(instance: *mut c_void) -> c_int;
    fn fmi3UpdateDiscreteStates(
        instance: *mut c_void,
        again: *mut bool,
        terminate: *mut bool,
        nominals_changed: *mut bool,
        states_changed: *mut bool,
        next_defined: *mut bool,
        next: *mut f64,
    ) -> c_int;
    fn fmi3CompletedIntegratorStep(
        instance: *mut c_void,
        no_earlier_state: bool,
        enter_event: *mut bool,
        terminate: *mut bool,
    ) -> c_int;
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
        fmi3GetVersion fmi3SetDebugLogging fmi3InstantiateModelExchange fmi3InstantiateCoSimulation
        fmi3InstantiateScheduledExecution fmi3FreeInstance fmi3EnterInitializationMode fmi3ExitInitializationMode
        fmi3EnterEventMode fmi3Terminate fmi3Reset fmi3GetFloat32 fmi3GetFloat64 fmi3GetInt8 fmi3GetUInt8 fmi3GetInt16
        fmi3GetUInt16 fmi3GetInt32 fmi3GetUInt32 fmi3GetInt64 fmi3GetUInt64 fmi3GetBoolean fmi3GetString fmi3GetBinary
        fmi3GetClock fmi3SetFloat32 fmi3SetFloat64 fmi3SetInt8 fmi3SetUInt8 fmi3SetInt16 fmi3SetUInt16 fmi3SetInt32
        fmi3SetUInt32 fmi3SetInt64 fmi3SetUInt64 fmi3SetBoolean fmi3SetString fmi3SetBinary fmi3SetClock
        fmi3GetNumberOfVariableDependencies fmi3GetVariableDependencies fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
        fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState fmi3GetDirectionalDerivative
        fmi3GetAdjointDerivative fmi3EnterConfigurationMode fmi3ExitConfigurationMode fmi3GetIntervalDecimal
        fmi3GetIntervalFraction fmi3GetShiftDecimal fmi3GetShiftFraction fmi3SetIntervalDecimal fmi3SetIntervalFraction
        fmi3SetShiftDecimal fmi3SetShiftFraction fmi3EvaluateDiscreteStates fmi3UpdateDiscreteStates
        fmi3EnterContinuousTimeMode fmi3CompletedIntegratorStep fmi3SetTime fmi3SetContinuousStates
        fmi3GetContinuousStateDerivatives fmi3GetEventIndicators fmi3GetContinuousStates fmi3GetNominalsOfContinuousStates
        fmi3GetNumberOfEventIndicators fmi3GetNumberOfContinuousStates fmi3EnterStepMode fmi3GetOutputDerivatives fmi3DoStep
        fmi3ActivateModelPartition
    }
}
pub use all_functions::all;

thread_local! {
    /// Messages that instances of this thread logged.
    static SAID: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

unsafe extern "C" fn listen(
    _: *mut c_void,
    status: c_int,
    _: *const c_char,
    message: *const c_char,
) {
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy();
    SAID.with_borrow_mut(|said| said.push(format!("{status}: {text}")));
}

/// Returns the messages logged since the last call.
pub fn said() -> String {
    SAID.with_borrow_mut(std::mem::take).join("\n")
}

/// The version that the library names.
pub fn version() -> String {
    unsafe { CStr::from_ptr(fmi3GetVersion()) }
        .to_string_lossy()
        .into_owned()
}

/// The value of an attribute.
pub fn attribute<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let after = text.split_once(&format!(" {name}=\""))?.1;
    Some(after.split_once('"')?.0)
}

/// A package in a folder, with what a host reads in its description.
pub struct Unpacked {
    pub folder: TempDir,
    pub description: String,
    /// References of variables by their names.
    pub references: BTreeMap<String, u32>,
    /// Names of outputs.
    pub outputs: Vec<String>,
}

impl Unpacked {
    /// Unpacks a package and reads its description.
    pub fn of(package: &Package) -> Unpacked {
        let folder = tempfile::tempdir().unwrap();
        package.unpack(folder.path()).unwrap();
        let path = folder.path().join("modelDescription.xml");
        let description = std::fs::read_to_string(path).unwrap();
        let variables = description.lines().filter(|l| l.contains(" causality=\""));
        let named = |l: &str| {
            let reference = attribute(l, "valueReference")?.parse().ok()?;
            Some((attribute(l, "name")?.to_owned(), reference))
        };
        let references = variables.clone().filter_map(named).collect();
        let outputs = variables.filter(|l| l.contains("causality=\"output\""));
        let outputs = outputs.filter_map(|l| Some(named(l)?.0)).collect();
        Unpacked {
            folder,
            references,
            outputs,
            description,
        }
    }
}

/// An instance as used by a host.
pub struct Fmu {
    instance: *mut c_void,
    folder: TempDir,
    references: BTreeMap<String, u32>,
    pub outputs: Vec<String>,
}

/// A copy of the state to return to; freed when dropped.
pub struct SavedState<'a>(&'a Fmu, *mut c_void);

impl Drop for SavedState<'_> {
    fn drop(&mut self) {
        assert_eq!(unsafe { fmi3FreeFMUState(self.0.instance, &mut self.1) }, 0);
        assert!(self.1.is_null());
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        unsafe { fmi3FreeInstance(self.instance) }
    }
}

impl Fmu {
    /// Unpacks and instantiates; `None` where the library refuses.
    pub fn try_new(package: &Package, exchange: bool, token: Option<&str>) -> Option<Fmu> {
        let Unpacked {
            folder,
            description,
            references,
            outputs,
        } = Unpacked::of(package);
        let token = token.unwrap_or(attribute(&description, "instantiationToken").unwrap());
        let resources = format!("{}/resources/", folder.path().display());
        let [token, resources] = [token, &resources].map(|s| CString::new(s).unwrap());
        let (name, none) = (c"test".as_ptr(), null_mut());
        let (t, r) = (token.as_ptr(), resources.as_ptr());
        let instance = unsafe {
            match exchange {
                true => fmi3InstantiateModelExchange(name, t, r, false, false, none, Some(listen)),
                false => fmi3InstantiateCoSimulation(
                    name,
                    t,
                    r,
                    false,
                    false,
                    false,
                    false,
                    null(),
                    0,
                    none,
                    Some(listen),
                    null(),
                ),
            }
        };
        (!instance.is_null()).then_some(Fmu {
            instance,
            folder,
            references,
            outputs,
        })
    }

    /// True if the library accepts an instance without a name.
    pub fn is_made_without_a_name(package: &Package) -> bool {
        let named = Self::stepping(package);
        let resources = format!("{}/resources/", named.folder.path().display());
        let text = std::fs::read_to_string(named.folder.path().join("modelDescription.xml"));
        let text = text.unwrap();
        let token = attribute(&text, "instantiationToken").unwrap();
        let [token, resources] = [token, &resources].map(|s| CString::new(s).unwrap());
        let instance = unsafe {
            fmi3InstantiateModelExchange(
                null(),
                token.as_ptr(),
                resources.as_ptr(),
                false,
                false,
                null_mut(),
                Some(listen),
            )
        };
        unsafe { fmi3FreeInstance(instance) };
        !instance.is_null()
    }

    fn made(package: &Package, exchange: bool) -> Fmu {
        Self::try_new(package, exchange, None).unwrap_or_else(|| panic!("{}", said()))
    }

    /// An instance for co-simulation.
    pub fn stepping(package: &Package) -> Fmu {
        Self::made(package, false)
    }

    /// An instance for model exchange.
    pub fn exchanging(package: &Package) -> Fmu {
        Self::made(package, true)
    }

    fn ok(&self, status: c_int) {
        assert_eq!(status, 0, "{} ({})", said(), self.folder.path().display());
    }

    pub fn try_enter(&self, start: f64, stop: Option<f64>) -> c_int {
        let (defined, stop) = (stop.is_some(), stop.unwrap_or(0.0));
        unsafe { fmi3EnterInitializationMode(self.instance, false, 0.0, start, defined, stop) }
    }

    pub fn initialise(&self, start: f64) {
        self.initialise_until(start, None);
    }

    pub fn initialise_until(&self, start: f64, stop: Option<f64>) {
        self.ok(self.try_enter(start, stop));
        self.ok(unsafe { fmi3ExitInitializationMode(self.instance) });
    }

    pub fn try_terminate(&self) -> c_int {
        unsafe { fmi3Terminate(self.instance) }
    }

    pub fn try_states(&self, x: &[f64]) -> c_int {
        unsafe { fmi3SetContinuousStates(self.instance, x.as_ptr(), x.len()) }
    }

    /// Reads the derivatives of the continuous states; returns the status and the values.
    pub fn try_rates(&self) -> (c_int, Vec<f64>) {
        let mut x = vec![0.0; self.sizes()[0]];
        let status =
            unsafe { fmi3GetContinuousStateDerivatives(self.instance, x.as_mut_ptr(), x.len()) };
        (status, x)
    }

    pub fn reset(&self) {
        self.ok(unsafe { fmi3Reset(self.instance) });
    }

    pub fn reference(&self, name: &str) -> u32 {
        let found = self.references.get(name);
        *found.unwrap_or_else(|| panic!("{name} among {:?}", self.references.keys()))
    }

    pub fn get(&self, name: &str) -> f64 {
        let mut x = f64::NAN;
        let r = self.reference(name);
        self.ok(unsafe { fmi3GetFloat64(self.instance, &r, 1, &mut x, 1) });
        x
    }

    /// The values of all outputs, read in one call.
    pub fn look(&self) -> Vec<f64> {
        let r: Vec<u32> = self
            .outputs
            .iter()
            .map(|name| self.reference(name))
            .collect();
        let mut x = vec![f64::NAN; r.len()];
        let status =
            unsafe { fmi3GetFloat64(self.instance, r.as_ptr(), r.len(), x.as_mut_ptr(), x.len()) };
        self.ok(status);
        x
    }

    pub fn try_set(&self, name: &str, x: f64) -> c_int {
        let r = self.reference(name);
        unsafe { fmi3SetFloat64(self.instance, &r, 1, &x, 1) }
    }

    pub fn set(&self, name: &str, x: f64) {
        self.ok(self.try_set(name, x));
    }

    pub fn try_get_integer(&self, reference: u32) -> c_int {
        unsafe { fmi3GetInt32(self.instance, &reference, 1, &mut 0, 1) }
    }

    pub fn interpolate(&self) {
        let r = self.reference("interpolate");
        self.ok(unsafe { fmi3SetBoolean(self.instance, &r, 1, &true, 1) });
    }

    pub fn try_step(&self, from: f64, size: f64) -> c_int {
        let mut flags = [true; 3];
        let [a, b, c] = &mut flags;
        let mut last = f64::NAN;
        let status = unsafe { fmi3DoStep(self.instance, from, size, false, a, b, c, &mut last) };
        if status == 0 {
            assert_eq!(flags, [false; 3]);
            assert!((last - from - size).abs() <= 1e-15 * last.abs());
        }
        status
    }

    pub fn step(&self, from: f64, size: f64) {
        self.ok(self.try_step(from, size));
    }

    /// Derivative of an output.
    pub fn slope(&self, name: &str, order: c_int) -> f64 {
        let (r, mut x) = (self.reference(name), f64::NAN);
        self.ok(unsafe { fmi3GetOutputDerivatives(self.instance, &r, 1, &order, &mut x, 1) });
        x
    }

    pub fn keep(&self) -> SavedState<'_> {
        let mut state = null_mut();
        self.ok(unsafe { fmi3GetFMUState(self.instance, &mut state) });
        SavedState(self, state)
    }

    pub fn go_back(&self, kept: &SavedState<'_>) {
        self.ok(unsafe { fmi3SetFMUState(self.instance, kept.1) });
    }

    /// A copy of the state as bytes.
    pub fn store(&self, kept: &SavedState<'_>) -> Vec<u8> {
        let mut n = 0;
        self.ok(unsafe { fmi3SerializedFMUStateSize(self.instance, kept.1, &mut n) });
        let mut bytes = vec![0; n];
        let to = bytes.as_mut_ptr();
        self.ok(unsafe { fmi3SerializeFMUState(self.instance, kept.1, to, n) });
        bytes
    }

    /// A copy of the state from bytes; the status where the library refuses them.
    pub fn try_unstore(&self, bytes: &[u8]) -> Result<SavedState<'_>, c_int> {
        let mut state = null_mut();
        let (from, n) = (bytes.as_ptr(), bytes.len());
        match unsafe { fmi3DeserializeFMUState(self.instance, from, n, &mut state) } {
            0 => Ok(SavedState(self, state)),
            status => Err(status),
        }
    }

    /// Numbers of continuous states and event indicators.
    pub fn sizes(&self) -> [usize; 2] {
        let mut n = [0; 2];
        self.ok(unsafe { fmi3GetNumberOfContinuousStates(self.instance, &mut n[0]) });
        self.ok(unsafe { fmi3GetNumberOfEventIndicators(self.instance, &mut n[1]) });
        n
    }

    pub fn states(&self) -> Vec<f64> {
        let mut x = vec![f64::NAN; self.sizes()[0]];
        self.ok(unsafe { fmi3GetContinuousStates(self.instance, x.as_mut_ptr(), x.len()) });
        x
    }

    pub fn nominals(&self) -> Vec<f64> {
        let mut x = vec![f64::NAN; self.sizes()[0]];
        self.ok(unsafe {
            fmi3GetNominalsOfContinuousStates(self.instance, x.as_mut_ptr(), x.len())
        });
        x
    }

    pub fn move_to(&self, t: f64, x: &[f64]) {
        self.ok(unsafe { fmi3SetTime(self.instance, t) });
        self.ok(unsafe { fmi3SetContinuousStates(self.instance, x.as_ptr(), x.len()) });
    }

    pub fn rates(&self) -> Vec<f64> {
        let (status, x) = self.try_rates();
        self.ok(status);
        x
    }

    pub fn indicators(&self) -> Vec<f64> {
        let mut z = vec![f64::NAN; self.sizes()[1]];
        self.ok(unsafe { fmi3GetEventIndicators(self.instance, z.as_mut_ptr(), z.len()) });
        z
    }

    /// Handles an event and returns the time of the next one.
    pub fn event(&self) -> Option<f64> {
        self.ok(unsafe { fmi3EnterEventMode(self.instance) });
        let mut flags = [false; 5];
        let [a, b, c, d, e] = &mut flags;
        let mut next = f64::NAN;
        self.ok(unsafe { fmi3UpdateDiscreteStates(self.instance, a, b, c, d, e, &mut next) });
        self.ok(unsafe { fmi3EnterContinuousTimeMode(self.instance) });
        flags[4].then_some(next)
    }

    /// Completes a step; true if the instance requests an event.
    pub fn completed(&self) -> bool {
        let (mut event, mut end) = (false, false);
        self.ok(unsafe { fmi3CompletedIntegratorStep(self.instance, true, &mut event, &mut end) });
        event
    }
}
