//! Values that name others: `var(--x, fallback)` of CSS, and `param(x) default` of SVG parameters, which QGIS writes.

use std::{collections::BTreeMap, rc::Rc};

use super::declarations::find;

/// Custom properties by name, those of the ancestors included.
pub(crate) type Variables = BTreeMap<Rc<str>, Rc<str>>;

/// Custom properties of an element and its ancestors beyond which further ones are not kept.
pub(crate) const MOST: usize = 1000;
/// Bytes of a value, resolved, beyond which it is not understood.
const LONGEST: usize = 4096;
/// References that one value may lead to.
const REFERENCES: usize = 100;

/// The default of a parameter: nobody sets parameters of a drawing here. `None` where there is none; any other value as it is.
pub(crate) fn default_of(value: &str) -> Option<&str> {
    let Some(rest) = value.trim().strip_prefix("param(") else { return Some(value) };
    let default = rest.split_once(')').map_or("", |(_, default)| default.trim());
    (!default.is_empty()).then_some(default)
}

/// The value with what `var()` stands for in its place; `None` where that is nothing.
pub(crate) fn resolved(value: &str, variables: &Variables) -> Option<String> {
    if value.len() > LONGEST {
        return None;
    }
    let mut left = REFERENCES;
    resolve(value, variables, &mut left, 0)
}

fn resolve(value: &str, variables: &Variables, left: &mut usize, depth: usize) -> Option<String> {
    let mut out = String::new();
    let mut rest = value;
    while let Some(start) = rest.find("var(") {
        *left = left.checked_sub(1).filter(|_| depth < 16)?;
        out.push_str(&rest[..start]);
        let inside = &rest[start + "var(".len()..];
        let end = find(inside, 0, b")");
        let (name, fallback) = inside[..end].split_at(find(&inside[..end], 0, b","));
        let fallback = fallback.strip_prefix(',').map(str::trim);
        let known = variables.get(name.trim());
        let of_known = known.and_then(|value| resolve(value, variables, left, depth + 1));
        out.push_str(&match of_known {
            Some(value) => value,
            None => resolve(fallback?, variables, left, depth + 1)?,
        });
        if out.len() > LONGEST {
            return None;
        }
        rest = inside.get(end + 1..).unwrap_or_default();
    }
    out.push_str(rest);
    (out.len() <= LONGEST).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: &str) -> Option<String> {
        let set = [("--a", "red"), ("--b", "var(--a)"), ("--c", "var(--d, var(--c))"), ("--d", "var(--c)")];
        resolved(value, &set.into_iter().map(|(name, value)| (name.into(), value.into())).collect())
    }

    #[test]
    fn variables_are_followed_and_fallbacks_taken() {
        assert_eq!(of("var(--b)").as_deref(), Some("red"));
        assert_eq!(of("var( --x , rgb(1, 2, 3) )").as_deref().map(str::trim), Some("rgb(1, 2, 3)"));
        assert_eq!(of("var(--x, var(--y, var(--a)))").as_deref(), Some("red"));
        assert_eq!(of("1px var(--a) 2").as_deref(), Some("1px red 2"));
        assert_eq!(of("var(--x)"), None);
    }

    #[test]
    fn cycles_and_bombs_end() {
        assert_eq!(of("var(--c)"), None);
        assert_eq!(of("var(--c, blue)").as_deref(), Some("blue"));
        let mut bomb: Variables = [("--v0".into(), "xxxxxxxxxxxxxxxxxxxx".into())].into();
        for k in 1..40 {
            bomb.insert(format!("--v{k}").into(), format!("var(--v{0})var(--v{0})", k - 1).into());
        }
        assert_eq!(resolved("var(--v39)", &bomb), None);
        assert_eq!(of(&"var(".repeat(100_000)), None);
    }

    #[test]
    fn parameters_have_defaults() {
        assert_eq!(default_of("param(fill) #378add"), Some("#378add"));
        assert_eq!(default_of("param(fill-opacity)"), None);
        assert_eq!(default_of(" red "), Some(" red "));
    }
}
