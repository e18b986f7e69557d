//! The severity of a log text.

wire_list! {
    /// Severity of a log text.
    pub enum LogLevel {
        /// Detail for the search of a cause.
        Debug = 1,
        /// Normal operation.
        Info = 2,
        /// Operation continues, degraded.
        Warning = 3,
        /// A function is not available.
        Error = 4,
    }
}
