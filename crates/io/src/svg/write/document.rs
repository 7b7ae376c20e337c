//! The frame of an SVG document: the start tag of its root, and the recipe that it carries.

use arabesque_core::Decimals;

use crate::svg::{
    drawing::Page,
    namespace::{INKSCAPE, NAMESPACE, SVG, XLINK},
};

/// What files start with.
pub(crate) const DECLARATION: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// Prefixes of the namespaces that a result uses, beside that of SVG.
pub(crate) const PREFIXES: [(&str, &str); 3] = [("xlink", XLINK), ("inkscape", INKSCAPE), ("arabesque", NAMESPACE)];

/// The root of a document.
pub(crate) struct Root<'a> {
    /// What it shows, and in which unit it states its size.
    pub(crate) page: Page,
    /// Digits of the view box.
    pub(crate) decimals: Decimals,
    /// Digits of width and height.
    pub(crate) lengths: Decimals,
    /// Prefixes of namespaces beside that of SVG.
    pub(crate) prefixes: &'a [(&'a str, &'a str)],
    /// Attributes after the namespaces, each with a blank before it.
    pub(crate) attributes: &'a str,
}

impl Root<'_> {
    /// Its start tag.
    pub(crate) fn start_tag(&self) -> String {
        let (view, size, d) = (self.page.view, self.page.view.size(), self.decimals);
        let declared: String = self.prefixes.iter().map(|(prefix, uri)| format!(" xmlns:{prefix}=\"{uri}\"")).collect();
        let unit = self.page.unit.suffix();
        let [width, height] = [0, 1].map(|k| self.lengths.format(size[k] * self.page.unit_per_user));
        let [x, y, w, h] = [view.min[0], view.min[1], size[0], size[1]].map(|v| d.format(v));
        format!(
            "<svg xmlns=\"{SVG}\"{declared}{} width=\"{width}{unit}\" height=\"{height}{unit}\" viewBox=\"{x} {y} {w} \
             {h}\">\n",
            self.attributes
        )
    }
}

/// Digits for the width and height of a page.
pub(crate) fn length_decimals(page: &Page) -> Decimals {
    let size = page.view.size();
    Decimals::for_extent(size[0].max(size[1]) * page.unit_per_user)
}

/// The element that holds a recipe; `attributes` stand in its start tag, each with a blank before it.
pub(crate) fn recipe_element(recipe: &str, attributes: &str) -> String {
    // "]]>" would end the section: it is cut in two.
    let safe = recipe.replace("]]>", "]]]]><![CDATA[>");
    format!("<arabesque:recipe{attributes}><![CDATA[{safe}]]></arabesque:recipe>")
}

/// The recipe in an SVG text that [`crate::svg::write_svg`] wrote.
pub fn recipe_of(text: &str) -> Option<String> {
    let document = roxmltree::Document::parse(text).ok()?;
    let node = document.descendants().find(|n| n.has_tag_name((NAMESPACE, "recipe")))?;
    Some(node.children().filter_map(|n| n.text()).collect())
}
