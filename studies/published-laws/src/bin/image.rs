//! The image of the board with the laws of this crate.
#![no_std]
#![no_main]
lashloop_firmware::image!(published_laws::PublishedLaws);
