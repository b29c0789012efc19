//! Whole tables, from their header to the last row.

use super::*;
use proptest::prelude::*;

fn attitudes(text: &str, choice: &Choice) -> Result<Series<[f64; 4]>, TableError> {
    let table = Table::open("x.csv", text.as_bytes())?;
    let clock = table.clock(choice)?.expect("a time");
    let Some(Attitudes::Quaternion(set)) = table.attitude(choice)? else { panic!("no quaternion") };
    table.read(&Wanted::new(clock, set.columns), |q| match q {
        [0.0, 0.0, 0.0, 0.0] => Err(Flaw::Zero),
        q => Ok(*q),
    })
}

fn read(text: &str) -> Series<[f64; 4]> {
    attitudes(text, &Choice::default()).unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn bad_rows_are_left_out_counted_and_told_with_their_first_line() {
    let series = read(
        "t_s,qw,qx,qy,qz\n0,1,0,0,0\n0.01,nan,nan,nan,nan\n0.01,0,0,0,0\n0.02,1,0,0,0\n0.02,0,1,0,0\n0.04,1,0,0,0\n0.03,1,0,0,0\n0.05,1,0,0,0\n,1,0,0,0\n0.06,1,,0,0\n",
    );
    let left_out = LeftOut { duplicate: 1, overtaken: 1, ahead: 0, not_finite: 3, zero: 1 };
    assert_eq!((series.rows.read, series.rows.left_out, series.values.len()), (10, left_out, 4));
    assert_eq!(series.lines, [2, 5, 7, 9]);
    assert_eq!(series.values[1], [1.0, 0.0, 0.0, 0.0], "the first of two with one time is kept");
    let told = series.rows.told().unwrap();
    assert!(
        told.starts_with("6 of 10 rows are left out: 1 with the time of the previous row (line 6)"),
        "{told}"
    );
    assert!(told.contains("3 without a finite value (first in line 3)"), "{told}");
    assert_eq!(read("t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n").rows.told(), None, "of a clean table nothing");
}

#[test]
fn a_word_is_a_mistake_with_its_place_and_of_many_the_first_few_are_listed() {
    let rows: String = (0..9).map(|k| format!("{k},1,what,0,0\n")).collect();
    let error = attitudes(&format!("t_s,qw,qx,qy,qz\n{rows}"), &Choice::default()).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("x.csv:2: column qx: `what` is not a number\nx.csv:3: "), "{message}");
    assert!(message.lines().count() == 6 && message.ends_with("and 4 more rows"), "{message}");
    assert_eq!(error.in_short(), "x.csv:2: column qx: `what` is not a number (and 8 more rows like it)");
}

#[test]
fn a_last_row_that_breaks_off_is_left_out_and_any_other_short_row_is_a_mistake() {
    let text = "t_s,qw,qx,qy,qz\n0,1,0,0,0\n1,1,0,0,0\n2,1,0";
    let series = read(text);
    assert_eq!((series.values.len(), series.rows.read), (2, 2));
    assert_eq!(series.remarks, ["the last row, line 4, is truncated and is left out"]);
    for bad in [format!("{text}\n"), format!("{text}\n3,1,0,0,0"), format!("{text},0,0,0")] {
        let error = attitudes(&bad, &Choice::default()).unwrap_err().to_string();
        assert!(error.starts_with("x.csv:4: the row has "), "{bad}: {error}");
    }
}

#[test]
fn a_restart_is_a_break_and_a_wrap_is_none() {
    let row = |t: i64| format!("{t},1,0,0,0\n");
    let of = |times: &mut dyn Iterator<Item = i64>| times.map(row).collect::<String>();
    let restart = of(&mut (0..20).map(|k| 5000 + 10 * k).chain((0..20).map(|k| 10 * k)));
    let series = read(&format!("t_ms,qw,qx,qy,qz\n{restart}"));
    assert_eq!((series.times.breaks, series.rows.left_out.count()), (vec![20], 0));
    let wraps = of(&mut (-20..20i64).map(|k| (10 * k).rem_euclid(1 << 32)));
    let series = read(&format!("time_boot_ms,qw,qx,qy,qz\n{wraps}"));
    assert_eq!((series.times.breaks.len(), series.rows.left_out.count()), (0, 0));
    let ns = series.times.in_ns(TimeUnit::Ms).unwrap();
    assert!(ns.windows(2).all(|pair| pair[1] - pair[0] == 10_000_000), "{ns:?}");
    assert!(series.remarks[0].contains("wraps at 2^32 at line 22"), "{:?}", series.remarks);
    // Newest first: that is no table of times.
    let backwards = of(&mut (0..40).rev());
    let error = attitudes(&format!("t_s,qw,qx,qy,qz\n{backwards}"), &Choice::default()).unwrap_err();
    assert!(error.to_string().starts_with("x.csv:3: its times are not in order"), "{error}");
}

#[test]
fn columns_are_chosen_by_name_by_number_and_with_a_rate() {
    let text = "when,a,b,c,d\n0,1,0,0,0\n1,0.5,0.5,0.5,0.5\n";
    let by = |names: [&str; 4], time: Option<&str>, rate: Option<u32>| Choice {
        quaternion: Some(names.map(String::from)),
        time: time.map(String::from),
        rate: rate.map(crate::time::Rate::hz),
        ..Choice::default()
    };
    for choice in [by(["a", "b", "c", "d"], Some("when"), None), by(["2", "3", "4", "5"], Some("1"), None)] {
        let series = attitudes(text, &choice).unwrap();
        assert_eq!(
            (series.values[0], series.times.in_ns(TimeUnit::S)),
            ([1.0, 0.0, 0.0, 0.0], Some(vec![0, 1_000_000_000]))
        );
    }
    // A row that is left out takes its time with it.
    let text = "1 0 0 0\nnan 0 0 0\n0 1 0 0\n";
    let series = attitudes(text, &by(["1", "2", "3", "4"], None, Some(200))).unwrap();
    assert_eq!(
        (series.times.unit, series.times.in_ns(TimeUnit::S)),
        (Some(TimeUnit::S), Some(vec![0, 10_000_000]))
    );
    let error = attitudes("when,a,b,c,d\n0,1,0,0,0\n", &by(["a", "e", "7", "d"], None, Some(1))).unwrap_err();
    assert!(error.to_string().contains("x.csv has no column `e`, `7`; its columns are when, a"), "{error}");
}

#[test]
fn eight_columns_without_names_are_a_trajectory_and_with_names_what_these_say() {
    let row = |text: &str| read(text).values[0];
    assert_eq!(row("0.0 1 2 3 0 0 0.6 0.8\n0.1 1 2 3 0 0 0.6 0.8\n"), [0.8, 0.0, 0.0, 0.6]);
    assert_eq!(
        row("# a run of 5 things\n0.0,1,2,3,0,0,0.6,0.8\n0.1,1,2,3,0,0,0.6,0.8\n"),
        [0.8, 0.0, 0.0, 0.6]
    );
    for header in ["# t [s], px, py, pz, qw [], qx [], qy [], qz []", "t,px,py,pz,qw,qx,qy,qz"] {
        assert_eq!(
            row(&format!("{header}\n0,1,2,3,0.8,0,0,0.6\n0.1,1,2,3,0.8,0,0,0.6\n")),
            [0.8, 0.0, 0.0, 0.6]
        );
    }
    let series = read("# timestamp tx ty tz qx qy qz qw\n0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n");
    assert_eq!(series.times.unit, Some(TimeUnit::S), "a trajectory counts seconds");
    let ns = "#timestamp, p_x [m], p_y [m], p_z [m], q_w [], q_x [], q_y [], q_z []\n1000000000000000000,0,0,0,1,0,0,0\n1000000000005000000,0,0,0,1,0,0,0\n";
    let times = read(ns).times;
    assert_eq!((times.unit, times.guess()), (None, (TimeUnit::Ns, true)));
}

#[test]
fn decimal_commas_are_read_where_a_semicolon_parts_and_told() {
    let series = read("t_s;qw;qx;qy;qz\n0,01;0,8;0;0;0,6\n0,02;0,8;0;0;0,6\n");
    assert_eq!(
        (series.values[0], series.times.in_ns(TimeUnit::S)),
        ([0.8, 0.0, 0.0, 0.6], Some(vec![10_000_000, 20_000_000]))
    );
    assert!(series.remarks[0].contains("comma"), "{:?}", series.remarks);
}

#[test]
fn a_stamp_in_seconds_and_nanoseconds_is_one_time() {
    let series =
        read("stamp.sec,stamp.nanosec,w,x,y,z\n1700000000,999999999,1,0,0,0\n1700000001,4,1,0,0,0\n");
    assert_eq!(
        series.times.in_ns(TimeUnit::S),
        Some(vec![1_700_000_000_999_999_999, 1_700_000_001_000_000_004])
    );
}

#[test]
fn a_position_that_changes_is_seen() {
    let changes = |x: f64| {
        let text = format!("t_s,px_m,py_m,pz_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,{x},0,0,1,0,0,0\n");
        let table = Table::open("x.csv", text.as_bytes()).unwrap();
        let clock = table.clock(&Choice::default()).unwrap().unwrap();
        let watched = table.position().unwrap().to_vec();
        table.read(&Wanted { clock, columns: [4], watched }, |_| Ok(())).unwrap().changes
    };
    assert_eq!((changes(0.0), changes(0.5)), (vec![false; 3], vec![true, false, false]));
}

/// Reads whatever can be read, by every way there is.
fn whatever(bytes: &[u8]) {
    let _ = (kind_of(bytes), is_text(bytes));
    let choice = Choice { quaternion: Some(["1", "2", "3", "4"].map(String::from)), ..Choice::default() };
    for choice in [Choice::default(), choice] {
        let Ok(table) = Table::open("x", bytes) else { return };
        let _ = (table.angular_rate(), table.position(), table.kind(), table.told());
        let (Ok(Some(clock)), Ok(Some(attitude))) = (table.clock(&choice), table.attitude(&choice)) else {
            continue;
        };
        let read = match attitude {
            Attitudes::Quaternion(set) => table.read(&Wanted::new(clock, set.columns), |_| Ok(())),
            Attitudes::Euler(set) => table.read(&Wanted::new(clock, set.columns), |_| Ok(())),
        };
        if let Ok(series) = read {
            let counts = (series.values.len(), series.lines.len());
            assert_eq!(counts, (series.times.ticks.len(), series.times.ticks.len()));
            assert_eq!(series.rows.read, series.values.len() + series.rows.left_out.count());
            let _ = (series.times.guess(), series.times.in_ns(TimeUnit::S), series.rows.told());
        }
    }
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        whatever(&bytes);
    }

    #[test]
    fn no_text_that_is_almost_a_table_panics(
        header in "[#%]?(t|time|timestamp|q\\[0\\]|q_w|qw|qx|qy|qz|roll|\\[s\\]|\\(ns\\)|,|;|\t| |\"|µ){0,24}",
        rows in proptest::collection::vec("([-+0-9.eE]{0,6}|nan|inf|,|;|\t| |\"|°){0,20}", 0..12),
    ) {
        whatever(format!("{header}\n{}", rows.join("\n")).as_bytes());
    }

    /// What a table is written with is what is read, whatever parts it.
    #[test]
    fn a_table_is_read_as_it_was_written(
        steps in proptest::collection::vec(1u32..1000, 2..40),
        delimiter in proptest::sample::select(vec![",", ";", "\t", " "]),
        end in proptest::sample::select(vec!["\n", "\r\n"]),
        comment in any::<bool>(),
    ) {
        let header = ["t_us", "qw", "qx", "qy", "qz"].join(delimiter);
        let mut text = format!("{}{header}{end}", if comment { "# " } else { "" });
        let (mut t, mut times) = (0u64, Vec::new());
        for step in steps {
            t += u64::from(step);
            times.push(t as i64 * 1000);
            text += &[t.to_string(), "1".into(), "0".into(), "0".into(), "0".into()].join(delimiter);
            text += end;
        }
        let series = read(&text);
        prop_assert_eq!(series.times.in_ns(TimeUnit::Us), Some(times));
    }
}

#[test]
fn a_table_of_absurdly_many_columns_is_refused_at_once() {
    let wide = |count: usize| (0..count).map(|k| format!("q_{k}_w,")).collect::<String>() + "t_s,qw,qx,qy,qz";
    let row = |count: usize| "0,".repeat(count) + "0,1,0,0,0";
    let text = |count: usize| format!("{}\n{}\n", wide(count), row(count));
    let error = Table::open("x.csv", text(200_000).as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "x.csv:1 has 200005 columns, above the limit of 1024");
    assert_eq!(read(&text(1000)).values, [[1.0, 0.0, 0.0, 0.0]], "and many are no hindrance");
    // A comment may be as long as it likes.
    let comment = format!("# {}\nt_s,qw,qx,qy,qz\n0,1,0,0,0\n", "a, ".repeat(100_000));
    assert_eq!(read(&comment).rows.read, 1);
}

/// Work grows with the bytes: twice the lines, twice the work, counted in rows and not in seconds.
#[test]
fn a_long_table_is_read_once() {
    struct Counting<'a>(&'a [u8], usize);
    impl std::io::Read for Counting<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let count = std::io::Read::read(&mut self.0, into)?;
            self.1 += count;
            Ok(count)
        }
    }
    let text: String = (0..100_000).map(|k| format!("{k},1,0,0,0\n")).collect();
    let text = format!("{}t_ms,qw,qx,qy,qz\n{text}", "# nothing\n".repeat(10_000));
    let mut counting = Counting(text.as_bytes(), 0);
    let table = Table::open("x", std::io::BufReader::new(&mut counting)).unwrap();
    let clock = table.clock(&Choice::default()).unwrap().unwrap();
    let series = table.read(&Wanted::new(clock, [1]), |_| Ok(())).unwrap();
    assert_eq!((series.values.len(), counting.1), (100_000, text.len()));
}
