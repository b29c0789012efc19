//! Proof that the protocols link without the standard library.
//!
//! `cargo build --manifest-path protocols/no_std/Cargo.toml`
//!
//! This crate has a panic handler of its own. As soon as anything that it depends on pulls in
//! `std`, there are two of them, and the build fails.
#![no_std]

use core::panic::PanicInfo;

use ratetable_protocols::mavlink::{self, Header, Message, Version, system_time};
use ratetable_protocols::mpu::{self, Packet, gyro};
use ratetable_protocols::{ilabs, mip, msp, sbg, vectornav};

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}

/// Writes a packet of each format and reads it back: 7 if all came back.
pub extern "C" fn round_trips(count: u32) -> u32 {
    mpu_round_trip(count)
        + mavlink_round_trip(count)
        + msp_round_trip(count)
        + vectornav_round_trip(count)
        + mip_round_trip(count)
        + ilabs_round_trip(count)
        + sbg_round_trip(count)
}

/// Keeps the function in the library without a name of the system's own.
#[used]
static KEEP: extern "C" fn(u32) -> u32 = round_trips;

fn mpu_round_trip(count: u32) -> u32 {
    let mut bytes = [0; mpu::MAX_LEN];
    let packet = Packet::Gyro(gyro::Repr { gyro: [1, -2, 3] });
    let mut back = 0;
    if let Ok(len) = mpu::encode(0, count, &packet, &mut bytes) {
        mpu::Decoder::new().feed(&bytes[..len], |received| {
            back += u32::from(received.is_ok_and(|received| received.packet == packet));
        });
    }
    back
}

fn mavlink_round_trip(count: u32) -> u32 {
    let mut bytes = [0; mavlink::MAX_LEN];
    let header = Header {
        version: Version::V2,
        seq: 0,
        system: 1,
        component: 1,
    };
    let time = system_time::Repr {
        time_unix_usec: 0,
        time_boot_ms: count,
    };
    let message = Message::SystemTime(time);
    let mut back = 0;
    if let Ok(len) = mavlink::encode(&header, &message, &mut bytes) {
        mavlink::Decoder::new().feed(&bytes[..len], |received| {
            back += u32::from(received.is_ok_and(|received| received.message == Some(message)));
        });
    }
    back
}

fn msp_round_trip(count: u32) -> u32 {
    let mut bytes = [0; msp::MAX_LEN];
    let message = msp::Message::question(count as u16);
    let mut back = 0;
    if let Ok(len) = msp::encode(&message, &mut bytes) {
        msp::Decoder::new().feed(&bytes[..len], |received| {
            back += u32::from(received.is_ok_and(|received| received.message == Some(message)));
        });
    }
    back
}

fn vectornav_round_trip(count: u32) -> u32 {
    let mut bytes = [0; vectornav::MAX_LEN];
    let imu = vectornav::imu::Repr { time_ns: u64::from(count), ..Default::default() };
    let packet = vectornav::Packet::Imu(imu);
    let mut back = 0;
    if let Ok(len) = vectornav::encode(&packet, &mut bytes) {
        vectornav::Decoder::new().feed(&bytes[..len], |received| back += u32::from(received == Ok(packet)));
    }
    back
}

fn mip_round_trip(count: u32) -> u32 {
    let mut bytes = [0; mip::MAX_LEN];
    let imu = mip::imu::Repr { pressure: Some(count as f32), ..Default::default() };
    let mut back = 0;
    if let Ok(len) = mip::encode(&imu, &mut bytes) {
        mip::Decoder::new().feed(&bytes[..len], |received| back += u32::from(received == Ok(imu)));
    }
    back
}

fn ilabs_round_trip(count: u32) -> u32 {
    let mut bytes = [0; ilabs::MAX_LEN];
    let told = ilabs::data::Repr { time_ms: Some(count), ..Default::default() };
    let mut back = 0;
    if let Ok(len) = ilabs::encode(&told, &mut bytes) {
        ilabs::Decoder::new().feed(&bytes[..len], |received| back += u32::from(received == Ok(told)));
    }
    back
}

fn sbg_round_trip(count: u32) -> u32 {
    let mut bytes = [0; sbg::MAX_LEN];
    let packet = sbg::Packet::ImuShort(sbg::imu_short::Repr { time_us: count, ..Default::default() });
    let mut back = 0;
    if let Ok(len) = sbg::encode(&packet, &mut bytes) {
        sbg::Decoder::new().feed(&bytes[..len], |received| {
            back += u32::from(received.is_ok_and(|received| received.packet == Some(packet)));
        });
    }
    back
}
