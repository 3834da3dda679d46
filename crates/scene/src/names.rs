//! Names that a scene gives, as parts of names of variables and of key paths.

/// A name as one word of letters, digits and underscores, which is what FMI allows between the dots of a variable's name:
/// `bulkhead, dry side` is `bulkhead_dry_side`. Empty for a name without any letter or digit.
pub fn identifier(name: &str) -> String {
    let words = name.split(|letter: char| !letter.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    let joined = words.collect::<Vec<_>>().join("_");
    // A digit cannot come first.
    if joined.starts_with(|letter: char| letter.is_ascii_digit()) { format!("_{joined}") } else { joined }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words() {
        let cases = [
            ("P1", "P1"),
            ("bulkhead, dry side", "bulkhead_dry_side"),
            ("line, 3", "line_3"),
            ("0.3 m", "_0_3_m"),
            ("a__b ", "a_b"),
            ("d\u{e9}ck", "d_ck"),
            (" - ", ""),
        ];
        for (name, expected) in cases {
            assert_eq!(identifier(name), expected);
        }
    }
}
