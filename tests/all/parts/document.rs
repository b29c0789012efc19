//! `docs/parts.md`: every line of every sheet, measured.
//!
//! No figure in it is a random one: it says what the sheet has, what the part's file has, between which bounds, that
//! follow from how much was measured, the measurement must lie, and whether it does.

use super::bench::{self, NOISE_SAMPLES, SPECIMENS, Specimen};
use super::sheet::{Axes, Sheet};
use ratetable::scene;
use ratetable::sensor::SensorKind;
use ratetable::sensor::parts::{self, Part};

/// A row of the document.
#[derive(Clone, Debug)]
pub struct Line {
    /// Of which sensor.
    pub kind: SensorKind,
    /// What is measured.
    pub what: String,
    /// As the sheet has it.
    pub sheet: String,
    /// As the part's file has it.
    pub file: String,
    /// Where the sheet has it.
    pub source: String,
    /// Between which bounds it must be measured.
    pub bound: String,
    /// What was measured, where it is not within them.
    pub wrong: Option<String>,
}

/// What sheets call a line, its key in `sheets.toml`, and the part's key for it.
const DRAWN: [(&str, &str, &str); 7] = [
    ("zero offset", "zero", "bias"),
    ("zero offset by temperature", "zero_temperature", "bias_temperature"),
    ("scale error", "scale", "scale_error"),
    ("scale error by temperature", "scale_temperature", "scale_temperature"),
    ("cross-axis sensitivity", "cross_axis", "misalignment"),
    ("non-linearity", "nonlinearity", "nonlinearity"),
    ("g-sensitivity", "g", "g_sensitivity"),
];

/// The bounds of what is measured once are so many standard errors wide.
const SIGMAS: f64 = 5.0;
/// How much a file's decimal may be off a sheet's fraction: ±20 °/s over 65 K is 0.308 °/s/K.
const ROUNDED: f64 = 0.003;

/// Every line of a sensor of a part. `doctored` multiplies the sheet's figures, `more` are keys beside the part's.
pub fn lines(part: &Part, kind: SensorKind, doctored: f64, more: &str) -> Vec<Line> {
    let Some(sheet) = Sheet::of(part.names[0], kind, doctored) else { return Vec::new() };
    let sourced = scene::parts::sources(part).expect("sources");
    let file = |key: &str| {
        let found = sourced.iter().find(|value| value.sensor == kind && value.key == key);
        found.map_or((String::new(), String::new()), |value| (value.value.clone(), value.source.clone()))
    };
    let mut lines = Vec::new();
    let mut add = |what: &str, sheet: String, (file, source): (String, String), bound, wrong| {
        lines.push(Line { kind, what: what.into(), sheet, file, source, bound, wrong });
    };
    let name = part.names[0];
    if let Some((density, shown)) = sheet.figure("noise") {
        let error = SIGMAS / (2.0 * NOISE_SAMPLES as f64).sqrt();
        let sigma = bench::noise(name, kind, more);
        // One-sided: half the rate is the bandwidth.
        let ratio = [0, 1, 2].map(|axis| sigma[axis] / (density[axis] * 500f64.sqrt()));
        let bound =
            format!("±{:.1} % of it on each axis, σ of {NOISE_SAMPLES} samples at 1 kHz", 100.0 * error);
        let off = ratio.iter().any(|ratio| (ratio - 1.0).abs() > error);
        add("noise density", shown, file("noise_density"), bound, off.then(|| format!("{ratio:?} of it")));
    }
    let range = sheet.counts().last().expect("a range").0;
    let specimens: Vec<Specimen> =
        (0..SPECIMENS).map(|seed| Specimen::new(name, kind, range, seed, more)).collect();
    for (what, line, key) in DRAWN {
        let Some((limit, shown)) = sheet.figure(line) else { continue };
        let measure = |specimen: &Specimen| match line {
            "zero" => specimen.zero(),
            "zero_temperature" => specimen.zero_temperature(),
            "scale" => specimen.scale_and_cross_axis().0,
            "scale_temperature" => specimen.scale_temperature(),
            "cross_axis" => specimen.scale_and_cross_axis().1,
            "nonlinearity" => specimen.nonlinearity(),
            _ => specimen.g_sensitivity(),
        };
        let found: Vec<Axes> = specimens.iter().map(measure).collect();
        let (bound, wrong) = tolerance(&found, limit);
        add(what, shown, file(key), bound, wrong);
    }
    if let Some((least, shown)) = sheet.figure("stability") {
        let (deviation, count) = bench::stability(name, kind, more);
        let ratio = deviation / least[0];
        // Neighbours share a mean, and what wanders is akin: thrice the error of independent differences.
        let error = SIGMAS * 3.0 / (2.0 * count as f64).sqrt();
        let bound = format!("±{:.1} % of it, Allan deviation at 1 s of {count} differences", 100.0 * error);
        let off = (ratio - 1.0).abs() > error;
        add(
            "in-run bias stability",
            shown,
            file("bias_instability"),
            bound,
            off.then(|| format!("{ratio} of it")),
        );
    }
    let settings = scene::parts::settings(part, kind).expect("settings");
    let source_of = |table: &str| {
        let found = settings.sources.iter().find(|(name, _)| *name == table);
        found.map_or(String::new(), |(_, source)| source.clone())
    };
    for (range, lsb, shown) in sheet.counts() {
        let (bound, wrong) = scale(name, kind, range, lsb, more);
        let key = scene_range(&settings, kind, range);
        add("full scale and counts", shown, (key, source_of("scales")), bound, wrong);
    }
    let mut names: Vec<&str> = settings.filters.iter().map(|filter| filter.name.as_str()).collect();
    names.dedup();
    names.sort_unstable();
    names.dedup();
    for filter in names {
        let (shown, wrong) = low_pass(name, kind, filter, &settings);
        let bound = "gain 0.7071 ± 0.0001 at each".to_string();
        add(&format!("filter `{filter}`"), "–".into(), (shown, source_of("filters")), bound, wrong);
    }
    lines
}

/// n values uniform in ±1 are never beyond, their greatest size is below 1 − ln(10⁶)/n once in a million times, and
/// their mean is 0 within 1/√(3n).
fn tolerance(found: &[Axes], limit: Axes) -> (String, Option<String>) {
    let values: Vec<f64> =
        found.iter().flat_map(|axes| [0, 1, 2].map(|axis: usize| axes[axis] / limit[axis])).collect();
    let n = values.len() as f64;
    let (least, mean_error) = (1.0 - 1e6f64.ln() / n, SIGMAS / (3.0 * n).sqrt());
    let greatest = values.iter().fold(0.0, |greatest: f64, x| greatest.max(x.abs()));
    let mean = values.iter().sum::<f64>() / n;
    let bound = format!(
        "of {} values none beyond, the greatest above {:.0} % of it, the mean within {:.0} %",
        values.len(),
        100.0 * least,
        100.0 * mean_error
    );
    let fine = greatest < 1.0 + ROUNDED && greatest > least && mean.abs() < mean_error;
    (bound, (!fine).then(|| format!("greatest {greatest}, mean {mean} of it")))
}

/// Half as much again as full scale clips, flagged, at full scale or where 16 bits end; readings are whole counts and
/// neighbouring ones occur.
fn scale(part: &str, kind: SensorKind, range: f64, lsb: f64, more: &str) -> (String, Option<String>) {
    let nominal = (range / lsb).round();
    // A sheet's round numbers: 2000 °/s at 16.4 LSB/(°/s) are 32 800 counts of a 16-bit converter.
    let is_16_bit = (nominal / 32768.0 - 1.0).abs() < 0.01;
    let high = if is_16_bit { nominal.min(32767.0) } else { nominal };
    let low = if is_16_bit { -nominal.min(32768.0) } else { -nominal };
    let ends = bench::ends(part, kind, range, more);
    let counts: Vec<f64> = ends.between.iter().map(|reading| reading / lsb).collect();
    let whole = |x: f64| (x - x.round()).abs() < 1e-6 * x.abs().max(1.0);
    let mut codes: Vec<i64> = counts.iter().map(|count| count.round() as i64).collect();
    codes.sort_unstable();
    let neighbours = codes.windows(2).any(|pair| pair[1] - pair[0] == 1);
    let at_end = |reading: f64, count: f64| whole(reading / lsb) && (reading / lsb).round() == count;
    let fine = at_end(ends.high, high)
        && at_end(ends.low, low)
        && ends.flagged
        && neighbours
        && counts.iter().all(|&count| whole(count));
    let bound = format!("clips and flags at {high} and {low} counts; whole counts, none left out");
    let found = || format!("{} and {} counts at the ends", ends.high / lsb, ends.low / lsb);
    (bound, (!fine).then(found))
}

/// What the part's file has for a range.
fn scene_range(settings: &scene::parts::Settings, kind: SensorKind, range: f64) -> String {
    let si = |text: &str| kind.units().reading.scalar(text).expect("a range").to_f64();
    let found = settings.scales.iter().find(|scale| (si(&scale.range) / range - 1.0).abs() < 1e-9);
    found.map_or(String::new(), |scale| scale.resolution.clone())
}

/// The bandwidths of a filter, each measured.
fn low_pass(
    part: &str,
    kind: SensorKind,
    name: &str,
    settings: &scene::parts::Settings,
) -> (String, Option<String>) {
    let (mut shown, mut wrong) = (Vec::new(), None);
    for filter in settings.filters.iter().filter(|filter| filter.name == name) {
        let fastest = settings.rates[0].rate;
        let at = filter.at.first().copied().unwrap_or(fastest);
        let gain = bench::gain(part, kind, name, &at, filter.low_pass);
        let fine = (gain - 0.5f64.sqrt()).abs() <= 1e-4;
        if !fine {
            wrong = Some(format!("a gain of {gain} at {} Hz", filter.low_pass));
        }
        shown.push(filter.to_string().replacen(&format!("{name} "), "", 1));
    }
    (shown.join("; "), wrong)
}

/// Every line of every part.
pub fn all() -> Vec<(&'static Part, Vec<Line>)> {
    let of = |part: &'static Part| {
        (part, SensorKind::ALL.into_iter().flat_map(|kind| lines(part, kind, 1.0, "")).collect())
    };
    parts::all().iter().map(of).collect()
}

const HEAD: &str = "# Parts, line by line

What the datasheets say, what the emulator is set to, and whether it does it. Made by

    RATETABLE_WRITE=1 cargo test --test all parts::

and checked by the same test without the variable: every line is measured again, and this page is what comes of it. The figures of the sheets are a copy of their own ([tests/all/parts/sheets.toml](../tests/all/parts/sheets.toml)), apart from the parts' files ([src/sensor/parts](../src/sensor/parts)); a sheet or a file that is a fifth off fails on its line. Of the filters there is the one copy in the parts' files; that each of them has the bandwidth it says is measured here, at the rate it belongs to. Only readings are looked at: SPECIMENS specimens of each part, each with a seed of its own, in free fall, at rest, turned and pushed along each axis at half of full scale, and warmed by 40 K; each line with its own error term alone. `ratetable list parts` has the same sources, and the output data rates.

Tolerances are taken as the ends of a uniform distribution. A value whose source begins with *assumed* has no line: the sheet does not have it.

";

/// The page.
pub fn page(all: &[(&Part, Vec<Line>)]) -> String {
    let mut page = HEAD.replace("SPECIMENS", &SPECIMENS.to_string());
    for (part, lines) in all {
        page += &format!("## {}\n\n{}\n\n", part.names.join(", "), part.about);
        page += "| sensor | what | sheet | in the part's file | must be measured | agrees | source |\n|---|---|---|---|---|---|---|\n";
        for line in lines {
            let agrees = line.wrong.as_ref().map_or("yes".into(), |wrong| format!("**no**: {wrong}"));
            let file = if line.file == line.sheet { "the same" } else { &line.file };
            page += &format!(
                "| {} | {} | {} | {file} | {} | {agrees} | {} |\n",
                line.kind, line.what, line.sheet, line.bound, line.source
            );
        }
        let sourced = scene::parts::sources(part).expect("sources");
        let assumed: Vec<_> = sourced.iter().filter(|value| value.source.starts_with("assumed")).collect();
        for value in &assumed {
            let reason = value.source.trim_start_matches("assumed: ");
            page += &format!("\nAssumed: {} `{}` = {} ({reason}).\n", value.sensor, value.key, value.value);
        }
        page += "\n";
    }
    page.trim_end().to_string() + "\n"
}

/// Keys of a part's file that have neither a line nor are assumed.
pub fn unmeasured(part: &Part, lines: &[Line]) -> Vec<String> {
    let sourced = scene::parts::sources(part).expect("sources");
    let has_line = |value: &&parts::Sourced| {
        value.key == "range"
            || lines.iter().any(|line| line.kind == value.sensor && line.source == value.source)
    };
    let left = sourced.iter().filter(|value| !value.source.starts_with("assumed") && !has_line(value));
    left.map(|value| format!("{} {}.{}", part.names[0], value.sensor, value.key)).collect()
}
