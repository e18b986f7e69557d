//! The image of the board with Lashloop's own laws, see [`image!`](lashloop_firmware::image).

#![no_std]
#![no_main]

lashloop_firmware::image!(lashloop_firmware::Laws);
