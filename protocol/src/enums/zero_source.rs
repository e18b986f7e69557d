//! The position that becomes the zero of both encoders.

wire_list! {
    /// The position that becomes the zero of both encoders.
    pub enum ZeroSource {
        /// Where motor and load are.
        Present = 1,
        /// Where motor and load are when the home switch next closes.
        Home = 2,
    }
}
