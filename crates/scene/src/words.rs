//! What a parser says, in words of the file rather than of the program's types.

use digits::rounded;

/// Beginnings of the parser's messages, and what they become.
const OPENINGS: [(&str, &str); 8] = [
    ("unknown field", "unknown key"),
    ("missing field", "missing key"),
    ("duplicate field", "the key is given twice:"),
    ("unknown variant", "unknown word"),
    ("wanted string or table", "expected a text"),
    ("invalid type: ", "got "),
    ("invalid value: ", "got "),
    ("invalid length ", "got a list of "),
];

/// What was found, and its word.
const FOUND: [(&str, &str); 12] = [
    ("floating point ", ""),
    ("integer ", ""),
    ("boolean ", ""),
    ("string ", "the text "),
    ("character ", "the text "),
    ("sequence", "a list"),
    ("map", "a table"),
    ("unit value", "nothing"),
    ("unit variant", "a word"),
    ("newtype variant", "a table"),
    ("tuple variant", "a list"),
    ("struct variant", "a table"),
];

/// What was expected, and its word.
const EXPECTED: [(&str, &str); 15] = [
    ("f64", "a number"),
    ("f32", "a number"),
    ("usize", "a whole number of at least 0"),
    ("u8", "a whole number of at least 0"),
    ("u32", "a whole number of at least 0"),
    ("u64", "a whole number of at least 0"),
    ("i32", "a whole number"),
    ("i64", "a whole number"),
    ("a boolean", "true or false"),
    ("a sequence", "a list"),
    ("a map", "a table"),
    ("a string", "a text"),
    ("path string", "a path"),
    ("any valid TOML value", "a value"),
    ("variant identifier", "a word"),
];

/// The same message without words of the parser's own.
pub fn plain(message: &str) -> String {
    let Some((opening, word)) = OPENINGS.iter().find(|(opening, _)| message.starts_with(opening)) else {
        return rounded(message);
    };
    let rest = &message[opening.len()..];
    let Some((found, expected)) = rest.split_once(", expected ").filter(|_| opening.starts_with("invalid")) else {
        return rounded(&format!("{word}{rest}"));
    };
    let found = FOUND.iter().find_map(|(from, to)| Some(format!("{to}{}", found.strip_prefix(from)?)));
    let found = found.unwrap_or_else(|| rest.split(", expected ").next().unwrap_or_default().to_string());
    rounded(&format!("{word}{}, expected {}", found.replace('`', ""), kind(expected)))
}

/// What was expected.
fn kind(expected: &str) -> String {
    if let Some((_, word)) = EXPECTED.iter().find(|(known, _)| *known == expected) {
        return (*word).to_string();
    }
    if let Some(count) = expected.strip_prefix("an array of length ").or(expected.strip_prefix("a tuple of size ")) {
        return format!("a list of {count}");
    }
    match expected.split(' ').next() {
        Some("struct") => "a table".to_string(),
        Some("enum") => "a word".to_string(),
        _ => expected.to_string(),
    }
}

/// The known name nearest to `name`, if any comes near.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(score, _)| *score > 0.6)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_of_the_program_become_words_of_the_file() {
        let cases = [
            ("invalid type: string \"wide\", expected f64", "got the text \"wide\", expected a number"),
            ("invalid value: integer `-1`, expected usize", "got -1, expected a whole number of at least 0"),
            ("invalid type: floating point `1.50000000001`, expected a boolean", "got 1.5, expected true or false"),
            ("invalid type: integer `3`, expected struct Fluid", "got 3, expected a table"),
            ("invalid length 1, expected an array of length 2", "got a list of 1, expected a list of 2"),
            ("invalid type: map, expected a sequence", "got a table, expected a list"),
            ("missing field `run`", "missing key `run`"),
            ("unknown field `ende`, expected `end` or `from`", "unknown key `ende`, expected `end` or `from`"),
            ("unexpected end of input", "unexpected end of input"),
        ];
        for (message, expected) in cases {
            assert_eq!(plain(message), expected);
        }
    }
}
