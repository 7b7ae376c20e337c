//! Paints, opacities and references as they are written.

use svgtypes::{Paint, PaintFallback};

use crate::text::xml::number;

/// A number between 0 and 1, or a percentage.
pub(crate) fn fraction(text: &str) -> f64 {
    let text = text.trim();
    let value = match text.strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().map(|p| p / 100.0),
        None => text.parse(),
    };
    value.ok().filter(|v| v.is_finite()).unwrap_or(1.0).clamp(0.0, 1.0)
}

/// A paint in plain form: `none`, `#rrggbb`, `rgba(...)`, or `url(#id)` with its fallback.
pub(crate) fn paint(text: &str, current: &str) -> Option<String> {
    let current = || current.to_owned();
    match Paint::from_str(text).ok()? {
        Paint::None => Some("none".into()),
        Paint::Inherit => None,
        Paint::CurrentColor => Some(current()),
        Paint::Color(c) => Some(colour_text(c)),
        Paint::FuncIRI(id, fallback) => Some(match fallback {
            None => format!("url(#{id})"),
            Some(PaintFallback::None) => format!("url(#{id}) none"),
            Some(PaintFallback::CurrentColor) => format!("url(#{id}) {}", current()),
            Some(PaintFallback::Color(c)) => format!("url(#{id}) {}", colour_text(c)),
        }),
        // A shape outside a marker or <use> has no context to take its paint from.
        Paint::ContextFill | Paint::ContextStroke => Some("none".into()),
    }
}

fn colour_text(c: svgtypes::Color) -> String {
    match c.alpha {
        255 => format!("#{:02x}{:02x}{:02x}", c.red, c.green, c.blue),
        0 => "none".to_owned(),
        a => format!("rgba({},{},{},{})", c.red, c.green, c.blue, number(f64::from(a) / 255.0)),
    }
}

/// The id that `url(#id)` leads to, and what follows it. `Err` holds a reference out of the file.
pub(crate) fn reference(value: &str) -> Option<Result<(&str, &str), &str>> {
    let rest = value.trim().strip_prefix("url(")?;
    let (inside, after) = rest.split_once(')').unwrap_or((rest, ""));
    let target = inside.trim().trim_matches(['"', '\'']).trim();
    Some(target.strip_prefix('#').map(|id| (id, after.trim())).ok_or(target))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_are_taken_apart() {
        assert_eq!(reference("url(#a) red"), Some(Ok(("a", "red"))));
        assert_eq!(reference("url('#a b')"), Some(Ok(("a b", ""))));
        assert_eq!(reference("url(other.svg#a)"), Some(Err("other.svg#a")));
        assert_eq!(reference("none"), None);
    }
}
