//! Days as people write them.

/// Year, month and day of so many days after 1970-01-01, in the calendar of Gregory (Howard Hinnant's algorithm).
#[must_use]
pub fn date(days: u64) -> (u64, u64, u64) {
    // Years that begin in March: then the day that only some have is the last.
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (year + era * 400 + u64::from(month <= 2), month, day)
}
