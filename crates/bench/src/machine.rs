use std::time::{SystemTime, UNIX_EPOCH};

/// When and on what this runs, as far as the system tells: `2026-11-26, AMD EPYC 7763, 2 cores`.
pub fn when_and_where() -> String {
    let secs = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let [year, month, day] = date_of_day(secs / 86_400);
    let cpu = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let cpu = cpu.unwrap_or_else(|| "an unknown processor".to_owned());
    format!("{year}-{month:02}-{day:02}, {cpu}, {cores} cores")
}

/// Year, month and day of a day counted from 1970-01-01 (H. Hinnant, "chrono-compatible low-level date algorithms").
fn date_of_day(day: u64) -> [u64; 3] {
    // Years begin in March, so that the day that leap years have more is their last.
    let day = day + 719_468;
    let (era, of_era) = (day / 146_097, day % 146_097);
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * of_year + 2) / 153;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    [year, month, of_year - (153 * month_from_march + 2) / 5 + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        for (day, date) in [(0, [1970, 1, 1]), (19_782, [2024, 2, 29]), (20_783, [2026, 11, 26])] {
            assert_eq!(date_of_day(day), date);
        }
    }
}
