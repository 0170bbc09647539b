//! A page for every code: what it means, why it is refused, what to do. `engine explain CODE` prints it.

mod filters;
mod lint;
mod packs;
mod runs;
mod scripts;
mod watch;
mod worlds;

use super::Kind;

/// The pages, topic by topic: code, kind, page.
const TOPICS: &[&[(&str, Kind, &str)]] =
    &[scripts::PAGES, worlds::PAGES, filters::PAGES, runs::PAGES, lint::PAGES, packs::PAGES, watch::PAGES];

/// The page of a code.
#[must_use]
pub fn code_page(code: &str) -> Option<&'static str> {
    TOPICS.iter().copied().flatten().find(|(known, ..)| *known == code).map(|(.., page)| *page)
}

/// Every code that has a page.
pub fn all_codes() -> impl Iterator<Item = &'static str> {
    TOPICS.iter().copied().flatten().map(|(code, ..)| *code)
}

/// The kind of failure that a code stands for, and so its exit status; a test sees to it that every code has a page.
pub(super) fn kind_of(code: &str) -> Kind {
    TOPICS.iter().copied().flatten().find(|(known, ..)| *known == code).map_or(Kind::Fault, |(_, kind, _)| *kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_stand_in_the_order_of_the_alphabet_and_once() {
        for pages in TOPICS {
            assert!(pages.windows(2).all(|pair| pair[0].0 < pair[1].0));
        }
        let mut all: Vec<_> = all_codes().collect();
        all.sort_unstable();
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn a_page_has_sentences_and_short_lines_of_thought() {
        for (code, _, page) in TOPICS.iter().copied().flatten() {
            assert!(page.ends_with(['.', ';']), "{code}");
            assert!(page.len() > 60 && page.lines().count() <= 4, "{code}");
        }
    }
}
