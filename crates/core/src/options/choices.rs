//! Enumerations whose variants have names.

/// Declares an enumeration whose variants have names, as the value of a parameter. One with the names `off` and `on` is a switch.
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
/// ```
#[macro_export]
macro_rules! choices {
    ($(#[$meta:meta])* pub enum $name:ident { $($(#[$doc:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$doc])* $variant,)+ }

        impl $name {
            /// Names of the variants.
            pub const NAMES: &'static [&'static str] = &[$($text,)+];

            /// Name of this variant.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
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
