//! What holds for every table and every sequence of bytes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/exercise.rs"]
mod exercise;

use exercise::exercise;
use proptest::prelude::*;
use proptest::sample::Index;
use tousle_csv::vicon;

/// Positions by frame and point, a few of them missing; numbers have three decimals, as exports do.
fn positions() -> impl Strategy<Value = Vec<Vec<Option<[f64; 3]>>>> {
    (1_usize..4)
        .prop_flat_map(|n_points| prop::collection::vec(prop::collection::vec(position(), n_points), 1..6))
}

fn position() -> impl Strategy<Value = Option<[f64; 3]>> {
    let coordinate = (-9_999_999_i32..9_999_999).prop_map(|n| f64::from(n) / 1e3);
    prop::option::weighted(0.8, prop::array::uniform3(coordinate))
}

/// How a program may write one and the same table.
#[derive(Clone, Debug)]
struct Clothes {
    separator: char,
    decimal_comma: bool,
    end_of_line: &'static str,
    byte_order_mark: bool,
    trailing_separators: usize,
}

fn clothes() -> impl Strategy<Value = Clothes> {
    let separator = prop_oneof![Just(','), Just(';'), Just('\t')];
    let end_of_line = prop_oneof![Just("\n"), Just("\r\n"), Just("\r\r\n"), Just("\r")];
    (separator, any::<bool>(), end_of_line, any::<bool>(), 0_usize..3).prop_map(
        |(separator, comma, end_of_line, byte_order_mark, trailing_separators)| Clothes {
            separator,
            decimal_comma: comma && separator != ',',
            end_of_line,
            byte_order_mark,
            trailing_separators,
        },
    )
}

fn nexus(rows: &[Vec<Option<[f64; 3]>>], clothes: &Clothes) -> String {
    let n_points = rows[0].len();
    let cell = |x: f64| format!("{x:.3}").replace('.', if clothes.decimal_comma { "," } else { "." });
    let mut lines = vec![vec!["Trajectories".to_owned()], vec!["100".to_owned()]];
    let two = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
    let header = |start: Vec<String>, triple: &dyn Fn(usize) -> [String; 3]| {
        start.into_iter().chain((0..n_points).flat_map(triple)).collect::<Vec<String>>()
    };
    lines.push(header(two("", ""), &|k| [format!("Wig:M{k}"), String::new(), String::new()]));
    lines.push(header(two("Frame", "Sub Frame"), &|_| ["X", "Y", "Z"].map(str::to_owned)));
    lines.push(header(two("", ""), &|_| ["mm"; 3].map(str::to_owned)));
    for (frame, row) in rows.iter().enumerate() {
        let mut line = two(&(frame + 7).to_string(), "0");
        for position in row {
            line.extend(position.map_or([const { String::new() }; 3], |p| p.map(cell)));
        }
        lines.push(line);
    }
    let mut text = String::from(if clothes.byte_order_mark { "\u{feff}" } else { "" });
    for line in lines {
        text += &line.join(&clothes.separator.to_string());
        text.extend(std::iter::repeat_n(clothes.separator, clothes.trailing_separators));
        text += clothes.end_of_line;
    }
    text
}

proptest! {
    /// Whatever its clothes, a table reads as what was written.
    #[test]
    fn a_table_reads_as_written(rows in positions(), clothes in clothes()) {
        let text = nexus(&rows, &clothes);
        prop_assert!(vicon::detect(text.as_bytes()));
        let file = vicon::read(text.as_bytes()).unwrap();
        let table = &file.sections[0].table;
        prop_assert_eq!(&table.frames, &(7..7 + rows.len() as i64).collect::<Vec<_>>());
        for (k, point) in table.points.iter().enumerate() {
            prop_assert_eq!(&point.label, &format!("Wig:M{k}"));
            let written: Vec<_> = rows.iter().map(|row| row[k]).collect();
            prop_assert_eq!(&point.positions, &written);
        }
    }

    /// A table with decimal commas between commas is refused, wherever samples are missing.
    #[test]
    fn decimal_commas_between_commas_are_never_read(rows in positions()) {
        if rows.iter().flatten().all(Option::is_none) {
            return Ok(());
        }
        let clothes = Clothes {
            separator: ',', decimal_comma: true, end_of_line: "\n", byte_order_mark: false, trailing_separators: 0,
        };
        prop_assert!(vicon::read(nexus(&rows, &clothes).as_bytes()).is_err());
    }

    /// No damage to a file makes a reader panic.
    #[test]
    fn damaged_files_are_read_or_refused(
        rows in positions(),
        clothes in clothes(),
        damage in prop::collection::vec((any::<Index>(), any::<Option<u8>>()), 1..8),
    ) {
        let bytes = damaged(nexus(&rows, &clothes).into_bytes(), &damage);
        exercise(&bytes);
        exercise(&damaged(MOTIVE.as_bytes().to_vec(), &damage));
    }

    /// No bytes make a reader panic.
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        exercise(&bytes);
    }
}

const MOTIVE: &str = "Format Version,1.23,Export Frame Rate,60.0,Total Exported Frames,2,Length Units,Meters\r\n\r\n\
    ,Type,Marker,Marker,Marker\r\n,Name,A,A,A\r\n,ID,\"1\",\"1\",\"1\"\r\n,,Position,Position,Position\r\n\
    Frame,Time (Seconds),X,Y,Z\r\n0,0.000000,0.1,0.2,0.3\r\n1,0.016667,0.4,0.5,0.6\r\n";

/// Replaces a byte at each place, or cuts it out.
fn damaged(mut bytes: Vec<u8>, damage: &[(Index, Option<u8>)]) -> Vec<u8> {
    for (place, with) in damage {
        let idx = place.index(bytes.len());
        match with {
            Some(byte) => bytes[idx] = *byte,
            None => drop(bytes.remove(idx)),
        }
    }
    bytes
}

/// The seeds of the fuzz target, and inputs that once failed.
#[test]
fn every_seed() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/csv");
    let seeds: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(!seeds.is_empty());
    for seed in seeds {
        exercise(&std::fs::read(seed).unwrap());
    }
}
