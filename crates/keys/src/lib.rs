//! Keys of scenes. One declaration gives the field of a parameter struct, its default, its range, its text, and with them
//! what reads it from a file, what checks it, and its place in the schema.
//!
//! ```
//! keys::keys! {
//!     /// Parameters of a spring.
//!     pub struct Spring {
//!         /// Stiffness \[N/m\].
//!         stiffness: f64 = 100.0, in 0.0 to 1e6;
//!         /// Number of coils.
//!         coils: usize = 7, in 1 to 100;
//!         /// Length at rest \[m\]; not given, that of the scene.
//!         length: Option<f64> = None, at least 0.0;
//!         /// Whether it is preloaded.
//!         preloaded: bool = false;
//!     }
//! }
//! let spring = Spring { coils: 0, ..Spring::default() };
//! assert_eq!(spring.check().unwrap_err().to_string(), "coils = 0, expected a number from 1 to 100");
//! ```

use std::fmt;

#[doc(hidden)]
pub use {schemars, serde};

/// A key that has a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Its name in the file.
    pub name: &'static str,
    /// Smallest value allowed.
    pub low: f64,
    /// Largest value allowed.
    pub high: f64,
}

/// A value out of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutOfRange {
    /// The key.
    pub key: Key,
    /// Its value.
    pub got: f64,
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let Key { name, low, high } = self.key;
        write!(formatter, "{name} = {}, expected a number from {low} to {high}", self.got)
    }
}

/// A number that a key can be, or may be.
pub trait Number: Copy {
    /// The same as a floating-point number; none where it is not given.
    fn value(self) -> Option<f64>;
}

impl Number for f64 {
    fn value(self) -> Option<f64> {
        Some(self)
    }
}

impl Number for usize {
    fn value(self) -> Option<f64> {
        Some(self as f64)
    }
}

impl<N: Number> Number for Option<N> {
    fn value(self) -> Option<f64> {
        self.and_then(N::value)
    }
}

impl Key {
    /// Refuses a value out of the range, or one that is no number; one that is not given is as good as its default.
    ///
    /// # Errors
    /// The value and the range.
    pub fn check(self, value: impl Number) -> Result<(), OutOfRange> {
        match value.value() {
            Some(got) if !(got >= self.low && got <= self.high) => Err(OutOfRange { key: self, got }),
            _ => Ok(()),
        }
    }
}

/// Declares a struct of keys: see the crate.
#[macro_export]
macro_rules! keys {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $(
                $(#[doc = $text:expr])+
                $key:ident: $type:ty = $default:expr $(, in $low:literal to $high:literal)? $(, at least $least:literal)?;
            )*
        }
    ) => {
        $(#[$meta])*
        #[derive(
            Debug, Clone, PartialEq, $crate::serde::Serialize, $crate::serde::Deserialize, $crate::schemars::JsonSchema,
        )]
        #[serde(crate = "keys::serde", deny_unknown_fields, default)]
        #[schemars(crate = "keys::schemars")]
        pub struct $name {
            $(
                $(#[doc = $text])+
                $(#[schemars(range(min = $low, max = $high))])?
                $(#[schemars(range(min = $least))])?
                pub $key: $type,
            )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($key: $default,)* }
            }
        }

        impl $name {
            /// The keys that have a range.
            pub const RANGES: &'static [$crate::Key] = &[
                $(
                    $($crate::Key { name: stringify!($key), low: $low as f64, high: $high as f64 },)?
                    $($crate::Key { name: stringify!($key), low: $least as f64, high: f64::MAX },)?
                )*
            ];

            /// Checks every number against its range.
            ///
            /// # Errors
            /// The first that is out of it.
            pub fn check(&self) -> Result<(), $crate::OutOfRange> {
                $(
                    $($crate::Key { name: stringify!($key), low: $low as f64, high: $high as f64 }.check(self.$key)?;)?
                    $($crate::Key { name: stringify!($key), low: $least as f64, high: f64::MAX }.check(self.$key)?;)?
                )*
                Ok(())
            }
        }
    };
}

#[cfg(test)]
mod tests {
    extern crate self as keys;

    crate::keys! {
        /// Keys of every kind.
        pub struct Three {
            /// A share.
            share: f64 = 0.5, in 0.0 to 1.0;
            /// A shift.
            shift: f64 = 0.0, in -1e12 to 1e12;
            /// A time, if one is given.
            time: Option<f64> = None, at least 0.0;
            /// A word.
            word: String = "none".to_string();
        }
    }

    #[test]
    fn defaults_are_in_their_ranges_and_others_are_refused() {
        assert!(Three::default().check().is_ok());
        let refused = |share| Three { share, ..Three::default() }.check().unwrap_err();
        assert_eq!(refused(1.5).to_string(), "share = 1.5, expected a number from 0 to 1");
        assert!(refused(f64::NAN).got.is_nan());
        let early = Three { time: Some(-1.0), ..Three::default() };
        assert_eq!((early.check().unwrap_err().key.low, early.check().unwrap_err().key.high), (0.0, f64::MAX));
        assert!(Three { time: Some(1e300), ..Three::default() }.check().is_ok());
        assert_eq!(Three::RANGES.iter().map(|key| key.name).collect::<Vec<_>>(), ["share", "shift", "time"]);
    }

    #[test]
    fn a_file_gives_some_keys_and_no_unknown_ones() {
        let three: Three = serde_json::from_str("{\"share\": 0.25}").unwrap();
        assert_eq!(three, Three { share: 0.25, ..Three::default() });
        let message = serde_json::from_str::<Three>("{\"shore\": 0.25}").unwrap_err().to_string();
        assert!(message.contains("unknown field `shore`"), "{message}");
    }

    #[test]
    fn the_schema_has_texts_defaults_and_ranges() {
        let schema = schemars::schema_for!(Three);
        let share = &schema.as_value()["properties"]["share"];
        assert_eq!(share["description"], "A share.");
        let time = &schema.as_value()["properties"]["time"];
        assert_eq!((&time["minimum"], time.get("maximum")), (&0.0.into(), None));
        assert_eq!((&share["minimum"], &share["maximum"], &share["default"]), (&0.0.into(), &1.0.into(), &0.5.into()));
    }
}
