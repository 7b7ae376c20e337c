//! What is generated from the code and shipped is that of the code. `ARABESQUE_BLESS=1` writes it again.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, its helpers too")]

use std::path::Path;

use arabesque::{
    Limits, Measurements, Recipe,
    core::options::{markdown_table, preset_list},
    patterns::Params,
    reliefs::ReliefParams,
    ribbons::RibbonParams,
    structures::StructureParams,
    surfaces::SurfaceParams,
};

fn is_current(name: &str, generated: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
    if std::env::var_os("ARABESQUE_BLESS").is_some() {
        std::fs::write(&path, generated).unwrap();
    }
    let shipped = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(shipped == generated, "docs/{name} is out of date; write it again with ARABESQUE_BLESS=1");
}

#[test]
fn the_shipped_schema_is_current() {
    is_current("recipe.schema.json", &Recipe::schema());
}

#[test]
fn the_shipped_schema_of_reports_is_current() {
    is_current("measure.schema.json", &Measurements::schema());
}

#[test]
fn the_shipped_table_of_limits_is_current() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/limits.md");
    let shipped = std::fs::read_to_string(path).unwrap();
    let (before, rest) = shipped.split_once("<!-- limits -->\n").unwrap();
    let (_, after) = rest.split_once("<!-- end -->\n").unwrap();
    let table = markdown_table(&Limits::specs());
    is_current("limits.md", &format!("{before}<!-- limits -->\n{table}<!-- end -->\n{after}"));
}

#[test]
fn the_shipped_tables_of_parameters_are_current() {
    let (own, set): (Vec<_>, Vec<_>) = RibbonParams::specs().into_iter().partition(|spec| spec.own_option);
    let presets = preset_list(Params::PRESETS).lines().map(|line| format!("- {}\n", line.trim())).collect::<String>();
    let text = format!(
        "# Parameters\n\nEvery parameter that can be set by name, with `--set NAME=VALUE` or in the table `params` of a job. This page is \
         generated from the code.\n\n## Elements and curves: `arabesque fill`\n\n{}\n### Presets, for `--preset`\n\n{presets}\n\
         ## Ribbons: `arabesque ribbon`\n\n{}\nThese have options of their own, and keys of their own in the table `[ribbon]`:\n\n{}\n\
         ## Structures: `arabesque fill` on points with attributes\n\n{}\n\
         ## Reliefs: `arabesque relief`\n\n{}\n\
         ## Surfaces: `arabesque surface`, `arabesque fill --mesh` and `arabesque relief --mesh` by `--surface NAME=VALUE`\n\n{}",
        markdown_table(&Params::specs()),
        markdown_table(&set),
        markdown_table(&own),
        markdown_table(&StructureParams::specs()),
        markdown_table(&ReliefParams::specs()),
        markdown_table(&SurfaceParams::specs()),
    );
    is_current("parameters.md", &text);
}
