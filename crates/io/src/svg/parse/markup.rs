//! Self-contained markup of scene nodes.

use std::fmt::Write as _;

use kurbo::Affine;

use crate::{
    svg::parse::{
        definitions::Definitions,
        paint::reference,
        scene::{Content, Node},
        style::ComputedStyle,
    },
    text::xml::{number, push_attribute},
};

/// Appends a transform attribute unless it changes nothing.
pub(crate) fn push_transform(out: &mut String, name: &str, transform: Affine) {
    if transform == Affine::IDENTITY {
        return;
    }
    let c = transform.as_coeffs();
    if c[..4] == [1.0, 0.0, 0.0, 1.0] {
        let _ = write!(out, " {name}=\"translate({} {})\"", number(c[4]), number(c[5]));
    } else {
        let _ = write!(out, " {name}=\"matrix({})\"", c.map(number).join(" "));
    }
}

/// Appends the properties that a node sets on itself, references led to the definitions.
fn push_own(out: &mut String, node: &Node, definitions: &mut Definitions<'_, '_>) {
    let mut style = String::new();
    for (name, value) in node.own.iter() {
        match name {
            // What is no opacity would be read by whatever comes later as something else.
            "opacity" if !is_share(value) => {}
            "opacity" | "vector-effect" => push_attribute(out, name, value),
            "clip-path" | "mask" | "filter" => {
                if let Some(value) = definitions.effect(name, value, node.viewport) {
                    push_attribute(out, name, &value);
                }
            }
            "mix-blend-mode" | "isolation" => {
                let _ = write!(style, "{name}:{value};");
            }
            _ => {}
        }
    }
    if let Some(clip) = &node.viewport_clip {
        push_attribute(out, "clip-path", &definitions.rectangle(clip));
    }
    if !style.is_empty() {
        push_attribute(out, "style", style.trim_end_matches(';'));
    }
}

/// Whether an opacity is a number or a percentage.
fn is_share(text: &str) -> bool {
    let text = text.trim();
    text.strip_suffix('%').unwrap_or(text).trim_end().parse::<f64>().is_ok_and(f64::is_finite)
}

/// Appends the inherited properties that are not initial.
fn push_style(out: &mut String, style: &ComputedStyle, node: &Node, definitions: &mut Definitions<'_, '_>) {
    for (name, value) in style.attributes() {
        match reference(value) {
            Some(_) => push_attribute(out, name, &definitions.paint(value, node.viewport)),
            None => push_attribute(out, name, value),
        }
    }
}

/// Appends the markup that draws a node in the coordinates of its parent.
pub(crate) fn push_node(out: &mut String, node: &Node, definitions: &mut Definitions<'_, '_>) {
    match &node.content {
        Content::Group(children) => {
            out.push_str("<g");
            push_class(out, node);
            push_transform(out, "transform", node.transform);
            push_own(out, node, definitions);
            out.push('>');
            for child in children {
                push_node(out, child, definitions);
            }
            out.push_str("</g>");
        }
        Content::Shape(geometry) => {
            let _ = write!(out, "<{}", geometry.markup);
            push_class(out, node);
            push_transform(out, "transform", node.transform);
            push_own(out, node, definitions);
            push_style(out, &node.style, node, definitions);
            out.push_str("/>");
        }
    }
}

fn push_class(out: &mut String, node: &Node) {
    if let Some(class) = &node.meta.class {
        push_attribute(out, "class", class);
    }
}
