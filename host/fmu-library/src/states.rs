//! The functions for states, which differ in FMI 2.0 and 3.0 by their names and by the type of a byte.

/// Saves, restores, frees, measures, writes and reads states.
macro_rules! states {
    ($byte:ty, $get:ident, $set:ident, $free:ident, $size:ident, $serialize:ident, $deserialize:ident) => {
        /// Saves the state.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(component: Pointer, state: *mut Pointer) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::save(component, state) }
        }

        /// Puts the instance into a state.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(component: Pointer, state: Pointer) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::restore(component, state) }
        }

        /// Frees a state.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $free(_: Pointer, state: *mut Pointer) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::free_state(state) }
        }

        /// The number of bytes of a state.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $size(component: Pointer, state: Pointer, size: *mut usize) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::serialized_size(component, state, size) }
        }

        /// Writes a state as bytes.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $serialize(
            component: Pointer,
            state: Pointer,
            bytes: *mut $byte,
            size: usize,
        ) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::serialize(component, state, bytes.cast(), size) }
        }

        /// Makes a state of bytes.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $deserialize(
            component: Pointer,
            bytes: *const $byte,
            size: usize,
            state: *mut Pointer,
        ) -> Status {
            // SAFETY: the contract of the standard.
            unsafe { component::deserialize(component, bytes.cast(), size, state) }
        }
    };
}
