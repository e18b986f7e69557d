//! USB devices in software: what the kernel's host controller requests from a device, and devices that answer.
//!
//! | module | is |
//! |---|---|
//! | [`urb`] | a transfer that a host requests, and its completion |
//! | [`bus`] | a bus for `usb-device`: the drive's own class code runs on it |
//! | [`ft232r`] | a serial adapter with a latency timer and a wire |
//! | [`vhci`] | the connection to Linux's virtual host controller |

pub mod bus;
pub mod ft232r;
pub mod urb;
pub mod vhci;
