//! What makes text and bytes safe to stand in HTML and SVG.

use std::fmt::{self, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use engine::diagnostic::is_hidden;

/// Text that may hold anything, as it stands between tags or in double quotes.
pub(crate) struct Escaped<'a>(pub(crate) &'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for c in self.0.chars() {
            match c {
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '&' => f.write_str("&amp;")?,
                '"' => f.write_str("&quot;")?,
                // XML 1.0 has no way to write control characters; others turn the text around them.
                c if is_hidden(c) || matches!(c, '\u{fffe}' | '\u{ffff}') => f.write_char('\u{fffd}')?,
                c => f.write_char(c)?,
            }
        }
        Ok(())
    }
}

/// Bytes as letters of RFC 4648, for `data:` addresses and columns of numbers.
pub(crate) fn base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

/// The bytes of such letters; nothing if they are none.
pub(crate) fn from_base64(text: &str) -> Option<Vec<u8>> {
    STANDARD.decode(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_ends_an_element_or_an_attribute() {
        assert_eq!(
            Escaped("a < b & \"c\" </title>\u{1}").to_string(),
            "a &lt; b &amp; &quot;c&quot; &lt;/title&gt;\u{fffd}"
        );
        assert_eq!(Escaped("wall in room, 5 µm").to_string(), "wall in room, 5 µm");
    }
}
