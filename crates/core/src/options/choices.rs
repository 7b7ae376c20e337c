//! Enumerations whose variants have names: in recipes, on the command line, and as values of parameters.

use std::str::FromStr;

use crate::error::Error;

/// An enumeration whose variants have names.
pub trait Choice: FromStr<Err = Error> + Copy + 'static {
    /// Each name with one sentence on what it stands for.
    const CHOICES: &'static [(&'static str, &'static str)];
}

/// Declares an enumeration whose variants have names, as the value of a parameter. One with the names `off` and `on` is a switch.
/// The first line of the documentation of a variant is what `--help` and the schema say of it.
///
/// ```
/// arabesque_core::choices! {
///     /// How samples are paired.
///     pub enum Matching {
///         /// Nearest pair first.
///         Hard = "hard",
///         /// Optimal assignment.
///         Robust = "robust",
///     }
/// }
/// assert_eq!(Matching::NAMES, ["hard", "robust"]);
/// assert_eq!(Matching::Robust.name(), "robust");
/// assert_eq!("hard".parse::<Matching>()?, Matching::Hard);
/// assert!("hart".parse::<Matching>().unwrap_err().to_string().contains("did you mean hard?"));
/// # Ok::<(), arabesque_core::Error>(())
/// ```
#[macro_export]
macro_rules! choices {
    (
        $(#[$meta:meta])*
        pub enum $name:ident { $(#[doc = $help:literal] $(#[doc = $more:literal])* $variant:ident = $text:literal,)+ }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $(#[doc = $help] $(#[doc = $more])* $variant,)+ }

        impl $name {
            /// Names of the variants.
            pub const NAMES: &'static [&'static str] = &[$($text,)+];

            /// Name of this variant.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }
        }

        impl $crate::options::Choice for $name {
            const CHOICES: &'static [(&'static str, &'static str)] = &[$(($text, $help.trim_ascii()),)+];
        }

        impl std::str::FromStr for $name {
            type Err = $crate::Error;

            fn from_str(text: &str) -> std::result::Result<Self, $crate::Error> {
                match text {
                    $($text => Ok(Self::$variant),)+
                    _ => {
                        let hint = $crate::suggest::did_you_mean(text, Self::NAMES.iter().copied());
                        let expected = format!("one of {}{hint}", Self::NAMES.join(", "));
                        Err($crate::Error::parameter(stringify!($name).to_lowercase(), text, expected))
                    }
                }
            }
        }

        impl $crate::options::serde::Serialize for $name {
            fn serialize<S: $crate::options::serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }

        impl<'de> $crate::options::serde::Deserialize<'de> for $name {
            fn deserialize<D: $crate::options::serde::Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
                let text = <String as $crate::options::serde::Deserialize>::deserialize(deserializer)?;
                let unknown = || $crate::options::serde::de::Error::unknown_variant(&text, Self::NAMES);
                text.parse().map_err(|_: $crate::Error| unknown())
            }
        }

        impl $crate::options::schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut $crate::options::schemars::SchemaGenerator) -> $crate::options::schemars::Schema {
                $crate::options::schema_of(<Self as $crate::options::Choice>::CHOICES)
            }
        }

        impl $crate::options::ParamValue for $name {
            fn kind(_: Option<(f64, f64)>) -> $crate::options::Kind {
                match Self::NAMES {
                    ["off", "on"] => $crate::options::Kind::Switch,
                    names => $crate::options::Kind::Choice(names),
                }
            }

            fn parse(text: &str, _: &$crate::options::Kind) -> Option<Self> {
                match text {
                    $($text => Some(Self::$variant),)+
                    _ => None,
                }
            }

            fn show(&self) -> String {
                self.name().to_owned()
            }
        }
    };
}

/// The schema of a text that is one of these names.
#[doc(hidden)]
pub fn schema_of(choices: &[(&str, &str)]) -> schemars::Schema {
    let one =
        |(name, help): &(&str, &str)| schemars::json_schema!({ "description": help, "type": "string", "const": name });
    let all: Vec<schemars::Schema> = choices.iter().map(one).collect();
    schemars::json_schema!({ "oneOf": all })
}
