//! Parameters and presets as text: the lists of `--help` and the tables of the documentation.

use std::fmt::Write as _;

use super::spec::{ParamSpec, Preset};

/// Two lines for each parameter: name and values, then the sentence and the default.
pub fn help_list<'a>(specs: impl IntoIterator<Item = &'a ParamSpec>) -> String {
    let mut out = String::new();
    for spec in specs {
        let (name, values, help) = (spec.name, spec.values(), spec.help);
        let _ = writeln!(out, "  {name} = {values}\n      {help} Default: {}.", spec.default_text());
    }
    out
}

/// A line for each preset.
pub fn preset_list(presets: &[Preset]) -> String {
    presets.iter().map(|preset| format!("  {}: {}\n", preset.name, preset.help)).collect()
}

/// A Markdown table with a row for each parameter.
pub fn markdown_table<'a>(specs: impl IntoIterator<Item = &'a ParamSpec>) -> String {
    let mut out = String::from("| name | values | default | meaning |\n|---|---|---|---|\n");
    for spec in specs {
        let (name, values, help) = (spec.name, spec.values(), spec.help);
        let _ = writeln!(out, "| `{name}` | {values} | {} | {help} |", spec.default_text());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::spec::Kind;

    #[test]
    fn values_defaults_and_units_are_told() {
        let spec = ParamSpec {
            name: "step",
            kind: Kind::Real { min: f64::MIN_POSITIVE, max: f64::MAX },
            auto: Some("0.1 of the height"),
            default: "auto".to_owned(),
            unit: Some("user units"),
            help: "Length of a piece.",
            own_option: false,
        };
        let values = "auto, or a positive number of user units";
        let expected = format!("  step = {values}\n      Length of a piece. Default: auto, 0.1 of the height.\n");
        assert_eq!(help_list([&spec]), expected);
        let row = format!("| `step` | {values} | auto, 0.1 of the height | Length of a piece. |\n");
        assert!(markdown_table([&spec]).ends_with(&row));
        let spec = ParamSpec { kind: Kind::Integer { min: 1, max: 64 }, unit: None, ..spec };
        assert_eq!(spec.expected(), "auto, or a whole number from 1 to 64");
    }
}
