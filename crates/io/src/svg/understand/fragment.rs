//! How an item looks, as markup that stands by itself.

use kurbo::Affine;

use crate::{
    svg::{
        drawing::Fragment,
        parse::{
            definitions::Definitions,
            markup::{push_node, push_transform},
            scene::Node,
        },
        understand::item::Item,
    },
    text::xml::{number, push_attribute},
};

/// Markup of an item, with what it refers to queued in the definitions.
pub(crate) fn fragment(item: &Item, definitions: &mut Definitions<'_, '_>) -> Fragment {
    let mut markup = String::new();
    let wrap = item.parts.len() > 1 || item.opacity < 1.0;
    if wrap {
        markup.push_str("<g");
        if item.opacity < 1.0 {
            push_attribute(&mut markup, "opacity", &number(item.opacity));
        }
        markup.push('>');
    }
    for (parent, node) in &item.parts {
        push_placed(&mut markup, *parent, node, definitions);
    }
    if wrap {
        markup.push_str("</g>");
    }
    let label = item.meta.label.clone().or_else(|| item.meta.id.clone());
    // What was put together of several things is no copy of one.
    let source = item.meta.source.filter(|_| item.parts.len() == 1);
    Fragment { markup, layer: item.layer.as_deref().map(str::to_owned), label, source }
}

/// Appends a node under the transform of its parent.
pub(crate) fn push_placed(out: &mut String, parent: Affine, node: &Node, definitions: &mut Definitions<'_, '_>) {
    if parent == Affine::IDENTITY {
        return push_node(out, node, definitions);
    }
    out.push_str("<g");
    push_transform(out, "transform", parent);
    out.push('>');
    push_node(out, node, definitions);
    out.push_str("</g>");
}
