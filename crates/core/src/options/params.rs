//! Structs of parameters.

/// Declares a struct of parameters, each with its name, type, default, range, unit and one sentence.
///
/// The first line of the documentation of a field is the sentence that `--help` shows; what follows is for readers of the code. A field
/// of an optional type may be `auto`, followed by what is then chosen. `own_option` marks what `--set` does not list, because the program
/// has an option of its own for it.
///
/// ```
/// arabesque_core::params! {
///     /// Parameters of a method.
///     pub struct Params {
///         /// Levels of the hierarchy.
///         levels "levels": usize = 3, in 1..=5;
///         /// Neighbourhood radius.
///         radius "radius": Option<f64> = None, in 1e-9..=1e9, auto "chosen from the exemplar", unit "exemplar units";
///     }
/// }
/// let mut params = Params::default();
/// params.set("radius", "2.5")?;
/// assert_eq!(params, Params { levels: 3, radius: Some(2.5) });
/// assert_eq!(params.values(), [("levels", "3".to_owned()), ("radius", "2.5".to_owned())]);
/// let error = params.set("levels", "9").unwrap_err();
/// assert_eq!(error.to_string(), "levels = 9: expected a whole number from 1 to 5");
/// assert!(params.set("level", "2").unwrap_err().to_string().contains("did you mean levels?"));
/// assert_eq!(Params::specs()[1].values(), "auto, or a positive number of exemplar units");
/// assert_eq!(Params::specs()[1].default_text(), "auto, chosen from the exemplar");
/// # Ok::<(), arabesque_core::Error>(())
/// ```
#[macro_export]
macro_rules! params {
    (
        $(#[$meta:meta])*
        pub struct $struct:ident {
            $(
                #[doc = $help:literal]
                $(#[doc = $more:literal])*
                $field:ident $name:literal: $type:ty = $default:expr
                    $(, in $range:expr)? $(, auto $auto:literal)? $(, unit $unit:literal)? $(, own_option $own:literal)?;
            )+
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $struct {
            $(
                #[doc = $help]
                $(#[doc = $more])*
                #[doc = concat!(
                    "\n\n",
                    $("Range: `", stringify!($range), "`. ",)?
                    $("Unit: ", $unit, ". ",)?
                    "Default: `", stringify!($default), "`" $(, " (", $auto, ")")?, "."
                )]
                pub $field: $type,
            )+
        }

        impl Default for $struct {
            fn default() -> Self {
                Self { $($field: $default,)+ }
            }
        }

        impl $struct {
            /// Every parameter by its name.
            fn registry() -> $crate::options::Registry<Self> {
                $crate::options::Registry::new([$(
                    $crate::options::Param {
                        spec: $crate::options::ParamSpec {
                            name: $name,
                            kind: <$type as $crate::options::ParamValue>::kind($crate::params!(@range $($range)?)),
                            auto: $crate::params!(@option $($auto)?),
                            default: String::new(),
                            unit: $crate::params!(@option $($unit)?),
                            help: $help.trim_ascii(),
                            own_option: $crate::params!(@flag $($own)?),
                        },
                        set: |params: &mut Self, text, kind| {
                            params.$field = $crate::options::ParamValue::parse(text, kind)?;
                            Some(())
                        },
                        get: |params: &Self| $crate::options::ParamValue::show(&params.$field),
                    },
                )+])
            }

            /// What is known of every parameter.
            pub fn specs() -> Vec<$crate::options::ParamSpec> {
                Self::registry().specs()
            }

            /// Sets one parameter by name.
            ///
            /// # Errors
            /// `Error::Parameter` for an unknown name, with the nearest known one, or for a value that is
            /// not allowed.
            pub fn set(&mut self, name: &str, value: &str) -> $crate::Result<()> {
                Self::registry().set(self, name, value)
            }

            /// Name and value of every parameter, such that setting them gives these parameters again.
            pub fn values(&self) -> Vec<(&'static str, String)> {
                Self::registry().values(self)
            }

            /// Checks that every parameter has an allowed value.
            ///
            /// # Errors
            /// `Error::Parameter` for the first one that has not.
            pub fn check(&self) -> $crate::Result<()> {
                Self::registry().check(self)
            }
        }
    };
    (@range) => { None };
    (@range $range:expr) => {{
        let range = $range;
        Some(($crate::options::Bound::real(*range.start()), $crate::options::Bound::real(*range.end())))
    }};
    (@option) => { None };
    (@option $text:literal) => { Some($text) };
    (@flag) => { false };
    (@flag $flag:literal) => { $flag };
}
