//! Numbers in messages: six significant digits at most, for nobody reads the sixteen that tell two doubles apart, nor
//! the 300 zeros of 1e300.

use std::fmt::{self, Display, Formatter};

/// Significant digits of a number in a message.
const DIGITS: usize = 6;
/// Digits of a whole number up to which it may be a count, an index or a year and stays as it is.
const LONGEST_COUNT: usize = 15;

/// A number as messages show it: at most six significant digits, a power of ten where it is below 1e-4 or from 1e6 on.
pub fn six(value: f64) -> Six {
    Six(value)
}

/// See [`six`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Six(f64);

impl Display for Six {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        let text = format!("{:.*e}", DIGITS - 1, self.0);
        let Ok(rounded) = text.parse::<f64>() else { return formatter.write_str(&text) };
        let size = rounded.abs();
        if size == 0.0 {
            return formatter.write_str("0");
        }
        if !size.is_finite() || (1e-4..1e6).contains(&size) {
            return write!(formatter, "{rounded}");
        }
        write!(formatter, "{rounded:e}")
    }
}

/// Several numbers as messages show them, in square brackets.
pub fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|value| six(*value).to_string()).collect::<Vec<_>>().join(", "))
}

/// A text whose numbers have six significant digits at most: for what comes from elsewhere, as from another program or
/// a parser. Whole numbers of up to 15 digits stay, and so does what belongs to a name or a path.
pub fn rounded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|letter: char| letter.is_ascii_digit()) {
        let (before, from) = rest.split_at(start);
        let length = from.len() - from.trim_start_matches(part_of_word).len();
        let (word, after) = from.split_at(length);
        out.push_str(before);
        let mut written = out.chars().rev();
        let (last, second) = (written.next(), written.next());
        let within = |letter: Option<char>| letter.is_some_and(|letter| part_of_word(letter) || letter == '/');
        // A hyphen joins words, as those of a GUID.
        let joined = within(last) || last == Some('-') && within(second);
        match if joined || after.starts_with('/') { None } else { number(word, after) } {
            Some((number, used)) => {
                out.push_str(&number);
                rest = &from[used..];
            }
            None => {
                out.push_str(word);
                rest = after;
            }
        }
    }
    out + rest
}

fn part_of_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || letter == '.'
}

/// The number that a word is, rounded, and how many bytes of the text it takes; none where nothing is to be done.
fn number(word: &str, after: &str) -> Option<(String, usize)> {
    let trimmed = word.trim_end_matches('.');
    let (mut whole, mut used) = (trimmed.to_string(), trimmed.len());
    if let (true, Some(exponent)) = (word.ends_with(['e', 'E']), after.strip_prefix(['-', '+'])) {
        let digits = exponent.len() - exponent.trim_start_matches(|letter: char| letter.is_ascii_digit()).len();
        whole = format!("{word}{}{}", &after[..1], &exponent[..digits]);
        used = whole.len();
        if exponent[digits..].starts_with('-') {
            return None;
        }
    }
    let mantissa = whole.split(['e', 'E']).next()?;
    let digits = mantissa.trim_start_matches(['0', '.']).chars().filter(char::is_ascii_digit).count();
    let most = if whole.contains(['.', 'e', 'E']) { DIGITS } else { LONGEST_COUNT };
    if digits <= most {
        return None;
    }
    Some((six(whole.parse().ok()?).to_string(), used))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits_at_most() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (0.019_999_999_999_999_962, "0.02"),
            (1e300, "1e300"),
            (-9_417.612_345, "-9417.61"),
            (999_999.7, "1e6"),
            (123_456.0, "123456"),
            (1_234_567.0, "1.23457e6"),
            (0.000_1, "0.0001"),
            (1.234_567_8e-5, "1.23457e-5"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::NAN, "NaN"),
            (f64::MAX, "1.79769e308"),
            (f64::from_bits(1), "5e-324"),
        ];
        for (value, text) in cases {
            assert_eq!(six(value).to_string(), text);
        }
        assert_eq!(list(&[1.0 / 3.0, -9.81]), "[0.333333, -9.81]");
    }

    #[test]
    fn numbers_in_a_text_are_rounded_and_names_stay() {
        let cases = [
            ("at 0.019999999999999962 m", "at 0.02 m"),
            ("(0.6900000000000001, 1.7976931348623157e308)", "(0.69, 1.79769e308)"),
            ("-1.2345678e-05, done", "-1.23457e-5, done"),
            ("ends with 3.141592653589793.", "ends with 3.14159."),
            ("12345678 bytes, checksum 1234567a", "12345678 bytes, checksum 1234567a"),
            ("/tmp/1.23456789/run_1.23456789.toml", "/tmp/1.23456789/run_1.23456789.toml"),
            ("version 1.2.345678901", "version 1.2.345678901"),
            ("q[1] = 2.5e3, ä1.23456789", "q[1] = 2.5e3, ä1.23456789"),
            (
                "6194f1a7-b217-5011-93c8-988e12345678 and 1234567e-5011-4",
                "6194f1a7-b217-5011-93c8-988e12345678 and 1234567e-5011-4",
            ),
            ("-1.23456789 - 1.23456789", "-1.23457 - 1.23457"),
            ("", ""),
        ];
        for (text, expected) in cases {
            assert_eq!(rounded(text), expected);
        }
        let zeros = format!("1{}", "0".repeat(300));
        assert_eq!(rounded(&zeros), "1e300");
    }
}
