//! The schema of recipes that is shipped is the schema of the code. `ARABESQUE_BLESS=1` writes it anew.

use std::path::Path;

use arabesque::Recipe;

#[test]
fn the_shipped_schema_is_current() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/recipe.schema.json");
    let schema = Recipe::schema();
    if std::env::var_os("ARABESQUE_BLESS").is_some() {
        std::fs::write(&path, &schema).unwrap();
    }
    let shipped = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(shipped == schema, "docs/recipe.schema.json is out of date; write it anew with ARABESQUE_BLESS=1");
}
