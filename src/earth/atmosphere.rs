//! The U.S. Standard Atmosphere, 1976 (NOAA-S/T 76-1562): pressure against altitude, up to 84.852 km; above that its
//! last layer goes on, below sea level its first.
//!
//! In a layer that begins at geopotential altitude H_b with T_b, P_b and lapse L:
//! `P = P_b·(T_b/(T_b + L·(H − H_b)))^(g₀M/(R*·L))`, or `P_b·e^(−g₀M·(H − H_b)/(R*·T_b))` where L is 0 (its equations
//! 33a and 33b); `H = r₀·Z/(r₀ + Z)` of a geometric altitude Z (equation 18).

/// Pressure at sea level, Pa.
pub const SEA_LEVEL_PRESSURE: f64 = 101_325.0;

/// Effective radius of the Earth, m.
const R0: f64 = 6_356_766.0;
/// Molar mass over the gas constant, M/R*, kg·K/J.
const MR: f64 = 28.9644e-3 / 8.314_32;
/// g₀·M/R*, K/m.
const GMR: f64 = 9.806_65 * 28.9644e-3 / 8.314_32;

/// Geopotential altitude at which a layer begins, m, and its lapse, K/m.
const LAYERS: [(f64, f64); 7] =
    [(0.0, -6.5e-3), (11e3, 0.0), (20e3, 1e-3), (32e3, 2.8e-3), (47e3, 0.0), (51e3, -2.8e-3), (71e3, -2e-3)];
/// Temperature at sea level, K.
const WARM: f64 = 288.15;
/// Above it the last layer would have no temperature left.
const TOP: f64 = 170e3;

/// A layer: where it begins, its lapse, and temperature and pressure there.
#[derive(Clone, Copy)]
struct Layer {
    base: f64,
    lapse: f64,
    temperature: f64,
    pressure: f64,
}

impl Layer {
    fn pressure(&self, h: f64) -> f64 {
        let up = h - self.base;
        self.pressure
            * match self.lapse {
                0.0 => libm::exp(-GMR * up / self.temperature),
                lapse => libm::pow(self.temperature / (self.temperature + lapse * up), GMR / lapse),
            }
    }

    /// The altitude of a pressure.
    fn altitude(&self, pressure: f64) -> f64 {
        let share = pressure / self.pressure;
        self.base
            + match self.lapse {
                0.0 => -libm::log(share) * self.temperature / GMR,
                lapse => self.temperature / lapse * (libm::pow(share, -lapse / GMR) - 1.0),
            }
    }
}

/// The layers from below.
fn layers() -> impl Iterator<Item = Layer> {
    let mut below: Option<Layer> = None;
    LAYERS.into_iter().map(move |(base, lapse)| {
        let (temperature, pressure) = below.map_or((WARM, SEA_LEVEL_PRESSURE), |below| {
            (below.temperature + below.lapse * (base - below.base), below.pressure(base))
        });
        let layer = Layer { base, lapse, temperature, pressure };
        below = Some(layer);
        layer
    })
}

/// The last layer of which `begun` holds, else the first.
fn layer(begun: impl Fn(&Layer) -> bool) -> Layer {
    let first = Layer { base: 0.0, lapse: LAYERS[0].1, temperature: WARM, pressure: SEA_LEVEL_PRESSURE };
    layers().take_while(begun).last().unwrap_or(first)
}

/// Pressure (Pa) at a geometric altitude (m) where it is `sea_level` Pa at altitude 0: the standard's, in proportion.
pub fn pressure(altitude: f64, sea_level: f64) -> f64 {
    let h = (R0 * altitude / (R0 + altitude)).min(TOP);
    layer(|layer| layer.base <= h).pressure(h) * (sea_level / SEA_LEVEL_PRESSURE)
}

/// Density (kg/m³) at a geometric altitude (m) where the pressure is `sea_level` Pa at altitude 0 and the temperature is
/// the standard's: `ρ = P·M/(R*·T)` (equation 42).
pub fn density(altitude: f64, sea_level: f64) -> f64 {
    let h = (R0 * altitude / (R0 + altitude)).min(TOP);
    let layer = layer(|layer| layer.base <= h);
    pressure(altitude, sea_level) * MR / (layer.temperature + layer.lapse * (h - layer.base))
}

/// Density at sea level, kg/m³.
const SEA_LEVEL_DENSITY: f64 = 1.225;

/// The airspeed (m/s) that an instrument shows at a dynamic pressure (Pa): `√(2q/ρ₀)`, with the sign of q.
pub fn indicated_airspeed(pressure: f64) -> f64 {
    libm::copysign(libm::sqrt(2.0 * pressure.abs() / SEA_LEVEL_DENSITY), pressure)
}

/// The dynamic pressure (Pa) at which an instrument shows this airspeed (m/s): `½·ρ₀·v²`, with the sign of v.
pub fn dynamic_pressure(airspeed: f64) -> f64 {
    0.5 * SEA_LEVEL_DENSITY * airspeed * airspeed.abs()
}

/// The geopotential altitude (m) at which the standard atmosphere has this pressure (Pa): an altimeter's reading when
/// it is set to 1013.25 hPa. 0 or below 0 Pa is taken for the thinnest air there is.
pub fn pressure_altitude(pressure: f64) -> f64 {
    let thinnest = self::pressure(f64::MAX, SEA_LEVEL_PRESSURE);
    let pressure = pressure.max(thinnest);
    layer(|layer| layer.pressure >= pressure).altitude(pressure)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table I of the standard: geometric altitude, Pa, to the digits printed.
    #[test]
    fn pressure_is_that_of_the_standards_tables() {
        for (altitude, expected, digits) in [
            (-1000.0, 1.1393e5, 5e-5),
            (0.0, 101_325.0, 1e-12),
            (1000.0, 8.98763e4, 1e-5),
            (5000.0, 5.40483e4, 1e-5),
            (10_000.0, 2.64999e4, 1e-5),
            (15_000.0, 1.21118e4, 2e-5),
            (30_000.0, 1.19703e3, 2e-5),
            (50_000.0, 7.97790e1, 2e-5),
            (80_000.0, 1.05247, 3e-5),
        ] {
            let found = pressure(altitude, SEA_LEVEL_PRESSURE);
            assert!((found / expected - 1.0).abs() < digits, "{altitude} m: {found} against {expected}");
        }
    }

    #[test]
    fn the_layers_meet() {
        // Pressures at the layers' bases, Table I.
        let bases = [101_325.0, 22_632.06, 5_474.889, 868.0187, 110.9063, 66.93887, 3.956420];
        for (layer, expected) in layers().zip(bases) {
            assert!((layer.pressure / expected - 1.0).abs() < 1e-6, "{} m: {}", layer.base, layer.pressure);
        }
    }

    #[test]
    fn pressure_altitude_is_its_inverse() {
        for geopotential in [-400.0, 0.0, 123.456, 10_999.0, 11_001.0, 19_000.0, 25_000.0, 48_000.0, 80_000.0]
        {
            let geometric = R0 * geopotential / (R0 - geopotential);
            let found = pressure_altitude(pressure(geometric, SEA_LEVEL_PRESSURE));
            assert!((found - geopotential).abs() < 1e-6, "{geopotential}: {found}");
        }
        for nonsense in [0.0, -5.0, f64::INFINITY, f64::NAN] {
            assert!(!pressure_altitude(nonsense).is_nan(), "{nonsense}");
        }
    }

    /// 8.3 m a hectopascal near sea level: the hydrostatic equation dp = −ρ·g·dh with ρ = 1.225 kg/m³.
    #[test]
    fn near_sea_level_a_metre_is_twelve_pascals() {
        let slope = pressure(0.5, SEA_LEVEL_PRESSURE) - pressure(-0.5, SEA_LEVEL_PRESSURE);
        assert!((slope + 1.2250 * 9.80665).abs() < 1e-3, "{slope}");
        let higher = pressure(300.0, 102_000.0) / pressure(300.0, SEA_LEVEL_PRESSURE);
        assert!((higher - 102_000.0 / 101_325.0).abs() < 1e-12);
    }
}
