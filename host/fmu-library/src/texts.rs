//! Texts and arrays of C.

use std::ffi::{CStr, CString, c_char};
use std::slice;

pub(crate) type Text = *const c_char;

/// A text of the importer; empty for NULL.
///
/// # Safety
/// The pointer is NULL, or to a text that ends with a NUL.
pub(crate) unsafe fn of_c(text: Text) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: as the caller promises.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// A text for C, cut at a NUL.
pub(crate) fn to_c(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// An array of the importer.
///
/// # Safety
/// The pointer is to `count` values, or `count` is 0.
pub(crate) unsafe fn array<'a, T>(first: *const T, count: usize) -> &'a [T] {
    if count == 0 || first.is_null() {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { slice::from_raw_parts(first, count) }
}

/// An array that the importer wants to be filled.
///
/// # Safety
/// As [`array`], and nobody else uses it meanwhile.
pub(crate) unsafe fn array_mut<'a, T>(first: *mut T, count: usize) -> &'a mut [T] {
    if count == 0 || first.is_null() {
        return &mut [];
    }
    // SAFETY: as the caller promises.
    unsafe { slice::from_raw_parts_mut(first, count) }
}
