//! Streams of random numbers, one per (sensor, error term, axis), each from the scene's seed and its own name.
//!
//! The generator is xoshiro256++ (Blackman & Vigna, ACM TOMS 47(4), 2021), named rather than left to a library's
//! default so that the same scene gives the same bytes in every version. A stream depends on nothing but seed and name:
//! adding a sensor or a term changes no other's noise. Normal numbers, of which most of a sample's cost consists, come
//! from [`Normals`]: sixteen of these generators side by side.

pub(crate) mod box_muller;
pub(crate) mod lanes;
mod normals;

pub use normals::Normals;

use rand::SeedableRng;
pub use rand_xoshiro::Xoshiro256PlusPlus as Stream;

/// The stream called `name` of a scene with this `seed`.
pub fn stream(seed: u64, name: &str) -> Stream {
    Stream::seed_from_u64(seed_of(seed, name))
}

/// The streams `name/x`, `name/y` and `name/z`.
pub fn axes(seed: u64, name: &str) -> [Stream; 3] {
    ["x", "y", "z"].map(|axis| stream(seed, &format!("{name}/{axis}")))
}

/// Normal numbers of the streams `name/x`, `name/y` and `name/z`, for the axes that want any.
pub fn normals(seed: u64, name: &str, wanted: [bool; 3]) -> Normals {
    let seeds = [("x", wanted[0]), ("y", wanted[1]), ("z", wanted[2])];
    Normals::new(seeds.map(|(axis, wanted)| wanted.then(|| seed_of(seed, &format!("{name}/{axis}")))))
}

/// Of the stream called `name`.
fn seed_of(seed: u64, name: &str) -> u64 {
    mix(seed) ^ fnv1a(name)
}

/// FNV-1a, 64 bits (Fowler, Noll & Vo): names a few dozen bytes long spread over all of them.
fn fnv1a(name: &str) -> u64 {
    name.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The finaliser of splitmix64 (Steele, Lea & Flood 2014): neighbouring seeds differ in half their bits.
fn mix(seed: u64) -> u64 {
    let z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;

    #[test]
    fn the_same_seed_and_name_repeat_and_any_other_does_not() {
        let uniform = |seed, name: &str| -> Vec<f64> {
            let mut stream = stream(seed, name);
            (0..20_000).map(|_| stream.random::<f64>() - 0.5).collect()
        };
        let first = uniform(7, "gyro/vibration/x");
        assert_eq!(first, uniform(7, "gyro/vibration/x"));
        let n = 20_000f64;
        for (seed, name) in [(8, "gyro/vibration/x"), (7, "gyro/vibration/y"), (7, "accel/vibration/x")] {
            let sum: f64 = first.iter().zip(uniform(seed, name)).map(|(a, b)| 12.0 * a * b).sum();
            assert!((sum / n).abs() < 4.0 / n.sqrt(), "{seed} {name}: {}", sum / n);
        }
    }
}
