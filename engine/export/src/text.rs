//! Templates that are filled in.

/// A template with `{{NAME}}` in the place of each of these.
pub(crate) fn filled(template: &str, values: &[(&str, &str)]) -> String {
    let mut text = template.to_owned();
    for (name, value) in values {
        text = text.replace(&format!("{{{{{name}}}}}"), value);
    }
    text
}

/// A name of a script as a name of a program: small letters, digits and `_`.
pub(crate) fn identifier(name: &str) -> String {
    let letter = |letter: char| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '_' };
    let text: String = name.chars().map(letter).collect();
    let tight = text.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_");
    if tight.is_empty() { "value".to_owned() } else { tight }
}

/// A text that ends no comment and no text of the other language: letters, digits and plain signs; `"` becomes `'`, others `?`.
pub(crate) fn plain(text: &str) -> String {
    let safe = |sign: char| {
        let plain = sign == ' ' || sign.is_ascii_graphic() && !matches!(sign, '"' | '\\' | '`');
        match sign {
            '"' => '\'',
            _ if plain => sign,
            _ => '?',
        }
    };
    text.chars().map(safe).collect::<String>().replace("*/", "* /").replace("/*", "/ *")
}

/// Numbers in lines of a width that people read, each with a comma.
pub(crate) fn rows_of(numbers: impl Iterator<Item = String>, indent: &str) -> String {
    let (mut text, mut line) = (String::new(), indent.to_owned());
    for number in numbers {
        if line.len() + number.len() + 2 > 110 {
            text.push_str(line.trim_end());
            text.push('\n');
            line = indent.to_owned();
        }
        line.push_str(&number);
        line.push_str(", ");
    }
    text.push_str(line.trim_end());
    text.push('\n');
    text
}
