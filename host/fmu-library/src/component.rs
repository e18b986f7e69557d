//! What a component pointer points to, and the way into it.

use std::any::Any;
use std::ffi::{CString, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};

use lashloop_fmu_export::{ExportError, Instance, Kind, Snapshot, Value, folder};

use crate::texts::{self, Text, array, array_mut, to_c};

pub(crate) type Pointer = *mut c_void;
/// `fmi2Status` and `fmi3Status`, which have the same numbers.
pub(crate) type Status = c_int;

pub(crate) const OK: Status = 0;
pub(crate) const ERROR: Status = 3;
/// The category of every message.
const CATEGORY: &str = "logStatusError";

/// The importer's log of a version of FMI.
pub(crate) trait Log {
    /// Passes a message on.
    fn write(&self, status: Status, category: &CString, message: &CString);
}

/// An instance with its log, and the texts that the importer was given.
pub(crate) struct Component {
    pub(crate) instance: Instance,
    log: Box<dyn Log>,
    /// They live until the next texts are asked for, as FMI promises.
    given: Vec<CString>,
}

/// Makes an instance, or returns NULL with the reason in the log.
///
/// # Safety
/// As the texts of an importer.
pub(crate) unsafe fn instantiate(token: Text, resources: Text, log: Box<dyn Log>) -> Pointer {
    // SAFETY: as the caller promises.
    let (token, resources) = unsafe { (texts::of_c(token), texts::of_c(resources)) };
    match guarded(|| Instance::new(&folder(&resources), &token)) {
        Ok(instance) => Box::into_raw(Box::new(Component { instance, log, given: Vec::new() })).cast(),
        Err(error) => {
            log.write(ERROR, &to_c(CATEGORY), &to_c(&error));
            std::ptr::null_mut()
        }
    }
}

/// Frees an instance.
///
/// # Safety
/// The pointer is NULL, or one of [`instantiate`] that wasn't freed.
pub(crate) unsafe fn free(component: Pointer) {
    if !component.is_null() {
        // SAFETY: as the caller promises, it is the box of `instantiate`.
        let component = unsafe { Box::from_raw(component.cast::<Component>()) };
        let _ = catch_unwind(AssertUnwindSafe(|| drop(component)));
    }
}

/// Calls into a component. An error or a panic is logged and answered as the status error.
///
/// # Safety
/// The pointer is NULL or one of [`instantiate`], and no other call uses it meanwhile.
pub(crate) unsafe fn call(
    component: Pointer,
    work: impl FnOnce(&mut Component) -> Result<(), ExportError>,
) -> Status {
    // SAFETY: as the caller promises.
    let Some(component) = (unsafe { component.cast::<Component>().as_mut() }) else { return ERROR };
    match guarded(|| work(component)) {
        Ok(()) => OK,
        Err(error) => {
            component.log.write(ERROR, &to_c(CATEGORY), &to_c(&error));
            ERROR
        }
    }
}

/// Does the work of a function of C, which no panic may leave.
fn guarded<T>(work: impl FnOnce() -> Result<T, ExportError>) -> Result<T, String> {
    let done = catch_unwind(AssertUnwindSafe(work));
    done.map_or_else(|panic| Err(panic_text(&*panic)), |result| result.map_err(|error| error.to_string()))
}

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref().copied());
    format!("a defect of Lashloop: {}", text.unwrap_or("a panic"))
}

/// A type of C that stands for a value.
pub(crate) trait OfC: Copy {
    const KIND: Kind;
    fn to_value(self) -> Value;
    fn of_value(value: &Value) -> Option<Self>;
}

impl OfC for f64 {
    const KIND: Kind = Kind::Real;

    fn to_value(self) -> Value {
        Value::Real(self)
    }

    fn of_value(value: &Value) -> Option<Self> {
        if let Value::Real(number) = value { Some(*number) } else { None }
    }
}

/// An integer; in FMI 2.0 a boolean has this type too, and its functions are others.
impl OfC for c_int {
    const KIND: Kind = Kind::Integer;

    fn to_value(self) -> Value {
        Value::Integer(self)
    }

    fn of_value(value: &Value) -> Option<Self> {
        if let Value::Integer(number) = value { Some(*number) } else { None }
    }
}

/// A boolean of FMI 3.0. Any other byte than 0 and 1 would be undefined, so we take it as a byte.
impl OfC for u8 {
    const KIND: Kind = Kind::Boolean;

    fn to_value(self) -> Value {
        Value::Boolean(self != 0)
    }

    fn of_value(value: &Value) -> Option<Self> {
        if let Value::Boolean(is_on) = value { Some((*is_on).into()) } else { None }
    }
}

/// A boolean of FMI 2.0.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Boolean2(c_int);

impl OfC for Boolean2 {
    const KIND: Kind = Kind::Boolean;

    fn to_value(self) -> Value {
        Value::Boolean(self.0 != 0)
    }

    fn of_value(value: &Value) -> Option<Self> {
        if let Value::Boolean(is_on) = value { Some(Self((*is_on).into())) } else { None }
    }
}

/// Reads variables.
///
/// # Safety
/// As [`call`]; the arrays have `count` elements.
pub(crate) unsafe fn get<T: OfC>(
    component: Pointer,
    references: *const u32,
    count: usize,
    values: *mut T,
) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        let (references, values) = (array(references, count), array_mut(values, count));
        call(component, |it| {
            complete(&[references.len(), values.len()], count)?;
            for (reference, value) in references.iter().zip(values) {
                if let Some(read) = T::of_value(it.instance.get(*reference, T::KIND)?) {
                    *value = read;
                }
            }
            Ok(())
        })
    }
}

/// Refuses a call of FMI 3 with another number of values than of variables.
///
/// # Safety
/// As [`call`].
pub(crate) unsafe fn miscounted(component: Pointer, references: usize, values: usize) -> Status {
    // SAFETY: as the caller promises.
    unsafe { call(component, |_| Err(ExportError::Count { references, values })) }
}

/// Sets variables.
///
/// # Safety
/// As [`get`].
pub(crate) unsafe fn set<T: OfC>(
    component: Pointer,
    references: *const u32,
    count: usize,
    values: *const T,
) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        let (references, values) = (array(references, count), array(values, count));
        call(component, |it| {
            complete(&[references.len(), values.len()], count)?;
            references
                .iter()
                .zip(values)
                .try_for_each(|(reference, value)| it.instance.set(*reference, value.to_value()))
        })
    }
}

/// Reads texts, which live until the next call.
///
/// # Safety
/// As [`get`].
pub(crate) unsafe fn get_texts(
    component: Pointer,
    references: *const u32,
    count: usize,
    values: *mut Text,
) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        let (references, values) = (array(references, count), array_mut(values, count));
        call(component, |it| {
            complete(&[references.len(), values.len()], count)?;
            it.given.clear();
            for (reference, value) in references.iter().zip(values) {
                let Value::Text(text) = it.instance.get(*reference, Kind::Text)? else { continue };
                let text = to_c(text);
                *value = text.as_ptr();
                it.given.push(text);
            }
            Ok(())
        })
    }
}

/// Sets texts.
///
/// # Safety
/// As [`get`], and each text ends with a NUL.
pub(crate) unsafe fn set_texts(
    component: Pointer,
    references: *const u32,
    count: usize,
    values: *const Text,
) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        let (references, values) = (array(references, count), array(values, count));
        call(component, |it| {
            complete(&[references.len(), values.len()], count)?;
            references.iter().zip(values).try_for_each(|(reference, text)| {
                it.instance.set(*reference, Value::Text(texts::of_c(*text)))
            })
        })
    }
}

/// Saves the state into `state`, instead of one that is there.
///
/// # Safety
/// As [`call`]; `state` points to NULL or to a state of this function.
pub(crate) unsafe fn save(component: Pointer, state: *mut Pointer) -> Status {
    // SAFETY: as the caller promises.
    unsafe { call(component, |it| keep(it.instance.save()?, state)) }
}

/// Puts the instance into a state.
///
/// # Safety
/// As [`call`]; `state` is NULL or a state of [`save`].
pub(crate) unsafe fn restore(component: Pointer, state: Pointer) -> Status {
    // SAFETY: as the caller promises.
    unsafe { call(component, |it| of_pointer(state).and_then(|state| it.instance.restore(state))) }
}

/// Frees a state and sets its pointer to NULL.
///
/// # Safety
/// `state` is NULL, or points to NULL or to a state of [`save`].
pub(crate) unsafe fn free_state(state: *mut Pointer) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        if let Some(state) = state.as_mut().filter(|state| !state.is_null()) {
            drop(Box::from_raw(state.cast::<Snapshot>()));
            *state = std::ptr::null_mut();
        }
    }
    OK
}

/// The number of bytes of a state.
///
/// # Safety
/// As [`restore`]; `size` is for a number.
pub(crate) unsafe fn serialized_size(component: Pointer, state: Pointer, size: *mut usize) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        call(component, |_| {
            let len = of_pointer(state)?.to_bytes()?.len();
            size.as_mut().map(|size| *size = len).ok_or(ExportError::Null("the size"))
        })
    }
}

/// Writes a state as bytes.
///
/// # Safety
/// As [`restore`]; `bytes` is for `size` bytes.
pub(crate) unsafe fn serialize(component: Pointer, state: Pointer, bytes: *mut u8, size: usize) -> Status {
    // SAFETY: as the caller promises.
    unsafe {
        call(component, |_| {
            let written = of_pointer(state)?.to_bytes()?;
            let place = array_mut(bytes, size);
            let place = place
                .get_mut(..written.len())
                .ok_or(ExportError::ShortBuffer { needed: written.len(), given: size })?;
            place.copy_from_slice(&written);
            Ok(())
        })
    }
}

/// Makes a state of bytes.
///
/// # Safety
/// As [`save`]; `bytes` is to `size` bytes.
pub(crate) unsafe fn deserialize(
    component: Pointer,
    bytes: *const u8,
    size: usize,
    state: *mut Pointer,
) -> Status {
    // SAFETY: as the caller promises.
    unsafe { call(component, |_| keep(Snapshot::from_bytes(array(bytes, size))?, state)) }
}

/// Keeps a state at `place`, instead of one that is there.
///
/// # Safety
/// As [`save`].
unsafe fn keep(state: Snapshot, place: *mut Pointer) -> Result<(), ExportError> {
    // SAFETY: as the caller promises.
    unsafe {
        let place = place.as_mut().ok_or(ExportError::Null("the place of a state"))?;
        match place.cast::<Snapshot>().as_mut() {
            Some(old) => *old = state,
            None => *place = Box::into_raw(Box::new(state)).cast(),
        }
    }
    Ok(())
}

/// Whether every array of a call has as many values as the call says. Those behind NULL have none.
fn complete(lengths: &[usize], count: usize) -> Result<(), ExportError> {
    if lengths.iter().all(|len| *len == count) { Ok(()) } else { Err(ExportError::Null("an array")) }
}

/// # Safety
/// As [`restore`].
unsafe fn of_pointer<'a>(state: Pointer) -> Result<&'a Snapshot, ExportError> {
    // SAFETY: as the caller promises.
    unsafe { state.cast::<Snapshot>().as_ref() }.ok_or(ExportError::Null("the state"))
}

#[cfg(test)]
mod tests {
    use super::{ExportError, guarded};

    #[test]
    fn a_panic_is_an_error_with_its_text_and_leaves_no_function_of_c() {
        let limit = 3;
        let panics: [fn(i32) -> Result<(), ExportError>; 2] =
            [|_| panic!("no step"), |limit| panic!("no step beyond {limit}")];
        let texts = panics.map(|work| guarded(|| work(limit)).expect_err("a panic"));
        assert_eq!(texts, ["a defect of Lashloop: no step", "a defect of Lashloop: no step beyond 3"]);
        let refused = guarded::<()>(|| Err(ExportError::Null("the size"))).expect_err("an error");
        assert_eq!(refused, ExportError::Null("the size").to_string());
    }
}
