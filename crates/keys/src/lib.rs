//! Keys of scenes. One declaration gives the field of a parameter struct, its default, its range, its text, and with them
//! what reads it from a file, what checks it, and its place in the schema.
//!
//! ```
//! keys::keys! {
//!     /// Parameters of a spring.
//!     pub struct Spring {
//!         /// Name: a key without a default must be given.
//!         name: String;
//!         /// Diameter of the wire \[m\].
//!         wire: f64, above 0;
//!         /// Stiffness \[N/m\].
//!         stiffness: f64 = 100.0, in 0.0 to 1e6;
//!         /// Number of coils.
//!         coils: usize = 7, in 1 to 100;
//!         /// Length at rest \[m\]; not given, that of the scene.
//!         length: Option<f64> = None, at least 0.0;
//!         /// Places of its ends \[m\].
//!         ends: [f64; 2] = [0.0, 1.0], each in -10.0 to 10.0;
//!         /// Whether it is preloaded.
//!         preloaded: bool = false;
//!     }
//! }
//! let spring: Spring = serde_json::from_str(r#"{ "name": "left", "wire": 0.01, "coils": 0 }"#).unwrap();
//! assert_eq!(spring.check().unwrap_err().to_string(), "coils = 0, expected a number from 1 to 100");
//! let spring = Spring { coils: 3, ends: [0.0, 12.0], ..spring };
//! assert_eq!(spring.check().unwrap_err().to_string(), "ends[1] = 12, expected a number from -10 to 10");
//! assert!(serde_json::from_str::<Spring>("{}").unwrap_err().to_string().contains("missing field `name`"));
//! ```

use std::fmt;

#[doc(hidden)]
pub use {schemars, serde, serde_json};

/// Bounds of a number above 0 in SI units: its squares and products are numbers too.
pub const ABOVE_ZERO: [f64; 2] = [1e-15, 1e15];

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
#[derive(Debug, Clone, PartialEq)]
pub struct OutOfRange {
    /// The key.
    pub key: Key,
    /// Where the value stands in a list, `[1]` or `[1][0]`; empty where there is none.
    pub place: String,
    /// The value.
    pub got: f64,
}

impl OutOfRange {
    /// The key, with the place in its list.
    pub fn path(&self) -> String {
        format!("{}{}", self.key.name, self.place)
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let Key { low, high, .. } = self.key;
        write!(formatter, "{} = {}, expected a number from {low} to {high}", self.path(), self.got)
    }
}

/// What a key with a range can have: a number, one that may be absent, a list of numbers or of lists.
pub trait Numbers {
    /// Each number with its place in a list.
    fn numbers(&self) -> Vec<(String, f64)>;
}

impl Numbers for f64 {
    fn numbers(&self) -> Vec<(String, f64)> {
        vec![(String::new(), *self)]
    }
}

impl Numbers for usize {
    fn numbers(&self) -> Vec<(String, f64)> {
        (*self as f64).numbers()
    }
}

impl<N: Numbers> Numbers for Option<N> {
    fn numbers(&self) -> Vec<(String, f64)> {
        self.iter().flat_map(N::numbers).collect()
    }
}

impl<N: Numbers> Numbers for [N] {
    fn numbers(&self) -> Vec<(String, f64)> {
        let inner = |(index, entry): (usize, &N)| {
            let numbers = entry.numbers().into_iter();
            numbers.map(|(place, value)| (format!("[{index}]{place}"), value)).collect::<Vec<_>>()
        };
        self.iter().enumerate().flat_map(inner).collect()
    }
}

impl<N: Numbers> Numbers for Vec<N> {
    fn numbers(&self) -> Vec<(String, f64)> {
        self.as_slice().numbers()
    }
}

impl<N: Numbers, const LENGTH: usize> Numbers for [N; LENGTH] {
    fn numbers(&self) -> Vec<(String, f64)> {
        self.as_slice().numbers()
    }
}

impl Key {
    /// Refuses a value out of the range, or one that is no number; one that is not given is as good as its default.
    ///
    /// # Errors
    /// The value and the range.
    pub fn check(self, value: &impl Numbers) -> Result<(), OutOfRange> {
        let mut numbers = value.numbers().into_iter();
        match numbers.find(|(_, got)| !(*got >= self.low && *got <= self.high)) {
            Some((place, got)) => Err(OutOfRange { key: self, place, got }),
            None => Ok(()),
        }
    }
}

/// Says in the schema of a struct which keys have a default, and which.
#[doc(hidden)]
pub fn set_defaults(schema: &mut schemars::Schema, defaults: Vec<(&str, serde_json::Value)>) {
    let Some(object) = schema.as_object_mut() else { return };
    for (key, value) in defaults {
        if let Some(serde_json::Value::Array(required)) = object.get_mut("required") {
            required.retain(|name| name != key);
        }
        if let Some(serde_json::Value::Object(properties)) = object.get_mut("properties")
            && let Some(serde_json::Value::Object(property)) = properties.get_mut(key)
        {
            property.insert("default".to_string(), value);
        }
    }
    if object.get("required").is_some_and(|required| required.as_array().is_some_and(Vec::is_empty)) {
        object.remove("required");
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
                $key:ident: $type:ty $(= $default:expr)? $(, in $low:literal to $high:literal)?
                    $(, each in $first:literal to $last:literal)? $(, at least $least:literal)? $(, above $zero:tt)?;
            )*
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, $crate::serde::Serialize)]
        #[serde(crate = "keys::serde")]
        pub struct $name {
            $(
                $(#[doc = $text])+
                pub $key: $type,
            )*
        }

        const _: () = {
            use $crate::{schemars, serde, serde_json};

            /// What a file gives.
            #[derive(serde::Deserialize)]
            #[serde(crate = "keys::serde", deny_unknown_fields)]
            struct Given {
                $($key: Option<$type>,)*
            }

            /// What a saved state has, all of it.
            #[derive(serde::Deserialize)]
            #[serde(crate = "keys::serde")]
            struct Saved {
                $($key: $type,)*
            }

            impl<'de> serde::Deserialize<'de> for $name {
                fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                    if !from.is_human_readable() {
                        let Saved { $($key),* } = Saved::deserialize(from)?;
                        return Ok(Self { $($key),* });
                    }
                    let given = Given::deserialize(from)?;
                    Ok(Self {
                        $($key: match given.$key {
                            Some(value) => value,
                            None => $crate::keys!(@missing D $key $(= $default)?),
                        },)*
                    })
                }
            }

            $(#[$meta])*
            #[derive(schemars::JsonSchema)]
            #[schemars(crate = "keys::schemars", deny_unknown_fields)]
            #[allow(dead_code, reason = "only its schema is read")]
            struct Shown {
                $(
                    $(#[doc = $text])+
                    $(#[schemars(range(min = $low, max = $high))])?
                    $(#[schemars(inner(range(min = $first, max = $last)))])?
                    $(#[schemars(range(min = $least))])?
                    $(#[schemars(extend("exclusiveMinimum" = $zero))])?
                    $key: $type,
                )*
            }

            impl schemars::JsonSchema for $name {
                fn schema_name() -> std::borrow::Cow<'static, str> {
                    stringify!($name).into()
                }

                fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                    let mut schema = Shown::json_schema(generator);
                    $crate::set_defaults(
                        &mut schema,
                        vec![$($(
                            (stringify!($key), {
                                let default: $type = $default;
                                serde_json::to_value(default).unwrap_or_default()
                            }),
                        )?)*],
                    );
                    schema
                }
            }
        };

        $crate::keys!(@default $name [$($key [$($default)?])*]);

        impl $name {
            /// The keys that have a range.
            pub const RANGES: &'static [$crate::Key] = &[
                $(
                    $($crate::Key { name: stringify!($key), low: $low as f64, high: $high as f64 },)?
                    $($crate::Key { name: stringify!($key), low: $first as f64, high: $last as f64 },)?
                    $($crate::Key { name: stringify!($key), low: $least as f64, high: f64::MAX },)?
                    $($crate::keys!(@above $key $zero),)?
                )*
            ];

            /// Checks every number against its range.
            ///
            /// # Errors
            /// The first that is out of it.
            pub fn check(&self) -> Result<(), $crate::OutOfRange> {
                $(
                    $($crate::Key { name: stringify!($key), low: $low as f64, high: $high as f64 }.check(&self.$key)?;)?
                    $($crate::Key { name: stringify!($key), low: $first as f64, high: $last as f64 }.check(&self.$key)?;)?
                    $($crate::Key { name: stringify!($key), low: $least as f64, high: f64::MAX }.check(&self.$key)?;)?
                    $($crate::keys!(@above $key $zero).check(&self.$key)?;)?
                )*
                Ok(())
            }
        }
    };
    (@missing $from:ident $key:ident = $default:expr) => {
        $default
    };
    (@missing $from:ident $key:ident) => {
        return Err(<$from::Error as serde::de::Error>::missing_field(stringify!($key)))
    };
    (@above $key:ident 0) => {
        $crate::Key { name: stringify!($key), low: $crate::ABOVE_ZERO[0], high: $crate::ABOVE_ZERO[1] }
    };
    (@default $name:ident [$($key:ident [$default:expr])*]) => {
        impl Default for $name {
            fn default() -> Self {
                Self { $($key: $default,)* }
            }
        }
    };
    // A key without a default: the struct has none either.
    (@default $name:ident $keys:tt) => {};
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

    /// Formats without names of their fields, as states are saved in.
    #[test]
    fn what_is_saved_without_names_is_read_again() {
        let three = Three { share: 0.25, time: Some(3.0), ..Three::default() };
        let bytes = postcard::to_stdvec(&three).unwrap();
        assert_eq!(postcard::from_bytes::<Three>(&bytes).unwrap(), three);
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
