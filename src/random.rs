//! Streams of random numbers, one a (sensor, error term, axis), each from the scene's seed and its own name.
//!
//! The generator is xoshiro256++ (Blackman & Vigna, ACM TOMS 47(4), 2021), named rather than left to a library's
//! default so that the same scene gives the same bytes for ever. A stream depends on nothing but seed and name:
//! adding a sensor or a term changes no other's noise.

use rand::SeedableRng;
pub use rand_xoshiro::Xoshiro256PlusPlus as Stream;

/// The stream called `name` of a scene with this `seed`.
pub fn stream(seed: u64, name: &str) -> Stream {
    Stream::seed_from_u64(mix(seed) ^ fnv1a(name))
}

/// The streams `name/x`, `name/y` and `name/z`.
pub fn axes(seed: u64, name: &str) -> [Stream; 3] {
    ["x", "y", "z"].map(|axis| stream(seed, &format!("{name}/{axis}")))
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
    use rand_distr::{Distribution, StandardNormal};

    fn normals(seed: u64, name: &str) -> Vec<f64> {
        let mut stream = stream(seed, name);
        (0..20_000).map(|_| StandardNormal.sample(&mut stream)).collect()
    }

    #[test]
    fn the_same_seed_and_name_repeat_and_any_other_does_not() {
        assert_eq!(normals(7, "gyro/white_noise/x"), normals(7, "gyro/white_noise/x"));
        let n = 20_000f64;
        for (seed, name) in [
            (8, "gyro/white_noise/x"),
            (7, "gyro/white_noise/y"),
            (7, "accel/white_noise/x"),
            (7, "gyro/bias_walk/x"),
        ] {
            let (a, b) = (normals(7, "gyro/white_noise/x"), normals(seed, name));
            let correlation = a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / n;
            assert!(correlation.abs() < 4.0 / n.sqrt(), "{seed} {name}: {correlation}");
        }
    }
}
