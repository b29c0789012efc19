//! Sensor packets for flight controllers, encoders and decoders, `no_std` and without a heap.
#![no_std]
