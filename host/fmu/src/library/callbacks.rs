//! What the FMU calls back, and texts on their way from and to C.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr;

use crate::status::log;

pub(super) type Pointer = *mut c_void;
pub(super) type Text = *const c_char;

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub(super) struct Callbacks {
    logger: unsafe extern "C" fn(Pointer, Text, c_int, Text, Text, Text),
    allocate: unsafe extern "C" fn(usize, usize) -> Pointer,
    free: unsafe extern "C" fn(Pointer),
    step_finished: Option<unsafe extern "C" fn(Pointer, c_int)>,
    environment: Pointer,
}

unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> Pointer;
    fn free(memory: Pointer);
}

/// The functions for an FMU of FMI 2.0, which keeps the pointer for as long as it lives.
pub(super) fn callbacks2() -> &'static Callbacks {
    Box::leak(Box::new(Callbacks {
        logger: log2,
        allocate: calloc,
        free,
        step_finished: None,
        environment: ptr::null_mut(),
    }))
}

/// A text for C, cut at a NUL.
pub(super) fn text(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// A text of the FMU; empty if it is NULL.
///
/// # Safety
/// The pointer is NULL, or to a text that ends with a NUL.
unsafe fn of_c(text: Text) -> String {
    // SAFETY: as the caller promises.
    if text.is_null() {
        String::new()
    } else {
        unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
    }
}

/// The logger of FMI 2.0. In C it is variadic, which Rust can't define; on Linux the first arguments of a variadic function lie
/// where those of another one do. We fill in the text of the usual format "%s" and print other formats as they are.
unsafe extern "C" fn log2(_: Pointer, _: Text, _: c_int, _: Text, message: Text, argument: Text) {
    // SAFETY: the message ends with a NUL, and to "%s" belongs a text.
    let message = unsafe {
        let format = of_c(message);
        if format == "%s" { of_c(argument) } else { format }
    };
    log(&message);
}

/// The logger of FMI 3.0.
pub(super) unsafe extern "C" fn log3(_: Pointer, _: c_int, _: Text, message: Text) {
    // SAFETY: the message ends with a NUL.
    log(&unsafe { of_c(message) });
}
