/// Says so where a file ends within its last number ([`Decimals`](crate::Decimals)). `line` counts from 1.
pub fn lost_digits(line: u64) -> String {
    format!(
        "line {line} has no end, and its last number fewer decimals than all above it: it counts as missing"
    )
}

/// Says so where positions lack one or two of their coordinates; `None` if there are none such.
pub fn half_positions(n: usize) -> Option<String> {
    (n > 0)
        .then(|| format!("{n} positions have one or two of their three coordinates; they count as missing"))
}
