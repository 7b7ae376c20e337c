//! SVG texts as pixels, drawn as a whole, or in bands where layers would take too much memory.
//!
//! A whole picture and one that is put together from bands differ in a few pixels along the bands, because the renderer cuts curves at
//! the border of what it draws. So bands are for pictures that could not be drawn otherwise, and which these are depends on the drawing
//! and the size alone.

use std::sync::{Mutex, PoisonError};

use arabesque_core::{Budget, Error, Held, Result};
use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{ImageHrefResolver, Options, Tree, roxmltree},
};

use crate::raster::{
    demand::{Demand, LAYER},
    expansion::expanded,
    palette,
};

/// Bytes of a pixel.
const PIXEL: f64 = 4.0;
/// Most bytes of a picture that is drawn as a whole, its layers with it.
const WHOLE: f64 = (640_u32 << 20) as f64;
/// Bytes of a band, its layers with it.
const BAND: f64 = (64_u32 << 20) as f64;
/// Bytes in memory for each byte of the text, references resolved.
const PER_BYTE: usize = 5;
/// Work for each byte of the text, references resolved.
const READING: u64 = 30;
/// Bytes in memory for each pixel of a picture inside the text: as decoded, and as drawn.
const DECODED: usize = 8;
/// Work of one pixel that is handed over.
const HANDING: u64 = 4;

/// An SVG text, ready to be drawn.
pub(crate) struct Drawn<'a> {
    name: &'a str,
    budget: &'a Budget,
    tree: Tree,
    _held: Held,
}

impl<'a> Drawn<'a> {
    /// Reads `text`; errors call it `name`.
    ///
    /// # Errors
    /// [`Error::Input`] when it cannot be drawn, [`Error::Limit`] when the work or the memory is used up: an element that is placed often
    /// counts as often.
    pub(crate) fn read(name: &'a str, text: &str, budget: &'a Budget) -> Result<Self> {
        let fail = |problem: String| Error::input(name, problem, "write it as SVG, or open that in a drawing program");
        let document = parsed(text).map_err(|e| fail(format!("SVG data parsing failed cause {e}")))?;
        let bytes = expanded(&document, budget)?;
        budget.spend(READING.saturating_mul(bytes as u64))?;
        let held =
            budget.hold("elements of the drawing, each as often as it is shown", bytes.saturating_mul(PER_BYTE))?;
        let refused = Mutex::new(None);
        let tree = Tree::from_xmltree(&document, &options(name, budget, &refused)).map_err(|e| fail(e.to_string()))?;
        if let Some(error) = refused.into_inner().unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        Ok(Self { name, budget, tree, _held: held })
    }

    /// Width and height of the page, in pixels of 96 to the inch.
    pub(crate) fn page(&self) -> [f64; 2] {
        [f64::from(self.tree.size().width()), f64::from(self.tree.size().height())]
    }

    /// Draws the page, stretched over a picture of `width` x `height` whole pixels, and shows each row to `visit` from the top: with
    /// straight alpha, and its number.
    ///
    /// # Errors
    /// [`Error::Limit`] when the work or the memory is used up, [`Error::Stopped`] when somebody asked to stop, and those of `visit`.
    pub(crate) fn rows(&self, size: [f64; 2], visit: impl FnMut(usize, &[[u8; 4]]) -> Result<()>) -> Result<()> {
        self.rows_within([WHOLE, BAND], size, visit)
    }

    /// The same with other sizes, in bytes: the largest picture that is drawn as a whole, and of a band.
    fn rows_within(
        &self,
        [most, band]: [f64; 2],
        [width, height]: [f64; 2],
        mut visit: impl FnMut(usize, &[[u8; 4]]) -> Result<()>,
    ) -> Result<()> {
        let page = self.page();
        let stretch = Transform::from_scale((width / page[0]) as f32, (height / page[1]) as f32);
        let demand = Demand::of(&self.tree, stretch, [width, height], self.budget)?;
        let whole = PIXEL * (width * height + demand.layers + demand.fixed);
        let band = if whole <= most {
            height
        } else {
            // Layers reach beyond a band on all sides.
            (band / (PIXEL * width * (1.0 + LAYER * demand.deepest))).floor().clamp(1.0, height)
        };
        let bands = (height / band).ceil();
        self.budget.foresee((demand.work + bands * demand.again) as u64)?;
        let bytes = whole.min(PIXEL * (band * width * (1.0 + LAYER * demand.deepest) + demand.fixed));
        let _held = self.budget.hold("pixels of the picture and of its layers", bytes as usize)?;
        let (columns, rows, band) = (width as u32, height as u32, band as u32);
        let mut straight = Vec::with_capacity(columns as usize);
        let share = ((demand.work / bands) + demand.again) as u64;
        for top in (0..rows).step_by(band as usize) {
            self.budget.spend(share)?;
            let pixels = self.band(stretch, [columns, top, band.min(rows - top)])?;
            for (k, row) in pixels.pixels().chunks_exact(columns as usize).enumerate() {
                self.budget.spend(HANDING * u64::from(columns))?;
                straight.clear();
                straight.extend(row.iter().map(|p| {
                    let c = p.demultiply();
                    [c.red(), c.green(), c.blue(), c.alpha()]
                }));
                visit(top as usize + k, &straight)?;
            }
        }
        Ok(())
    }

    /// `rows` rows of the picture, from `top` on.
    fn band(&self, stretch: Transform, [columns, top, rows]: [u32; 3]) -> Result<Pixmap> {
        let none = || Error::input(self.name, "no pixels", "ask for a larger picture");
        let mut pixels = Pixmap::new(columns, rows).ok_or_else(none)?;
        let place = if top == 0 { stretch } else { stretch.post_translate(0.0, -(top as f32)) };
        resvg::render(&self.tree, place, &mut pixels.as_mut());
        Ok(pixels)
    }
}

fn is_before_markup(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}'
}

/// With the entities that a document type declares: they are counted with the rest.
fn parsed(text: &str) -> std::result::Result<roxmltree::Document<'_>, roxmltree::Error> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    roxmltree::Document::parse_with_options(text, options)
}

/// Nothing is read beside the text itself. A picture in it that is over a limit is `refused`; one that is broken shows nothing.
fn options<'a>(name: &'a str, budget: &'a Budget, refused: &'a Mutex<Option<Error>>) -> Options<'a> {
    let mut options = Options::default();
    options.image_href_resolver.resolve_string = Box::new(|_, _| None);
    let usual = ImageHrefResolver::default_data_resolver();
    options.image_href_resolver.resolve_data =
        Box::new(move |kind, data, options| match check_inner(name, &data, budget) {
            Ok(()) => usual(kind, data, options),
            Err(Error::Input { .. }) => None,
            Err(error) => {
                refused.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                None
            }
        });
    options
}

/// Looks at a picture or a drawing inside a drawing, before those who decode it do.
///
/// # Errors
/// [`Error::Input`] when it is broken in a way that a decoder does not expect, [`Error::Limit`] when it is too large.
fn check_inner(name: &str, data: &[u8], budget: &Budget) -> Result<()> {
    let what = format!("{name}: a picture inside it");
    let text = std::str::from_utf8(data).ok().filter(|text| text.trim_start_matches(is_before_markup).starts_with('<'));
    let Some(text) = text else {
        // A drawing that is compressed, which may become as large as it likes, has no size either.
        let size = imagesize::blob_size(data).map_err(|e| Error::input(&what, e.to_string(), "leave it out"))?;
        let pixels = size.width.saturating_mul(size.height);
        budget.within(&what, pixels, ("pixels", budget.limits().pixels))?;
        drop(budget.hold(&what, pixels.saturating_mul(DECODED))?);
        let is_broken = palette::is_broken(data);
        return if is_broken { Err(Error::input(what, "a broken palette", "leave it out")) } else { Ok(()) };
    };
    let document = parsed(text).map_err(|e| Error::input(&what, e.to_string(), "leave it out"))?;
    // The renderer goes as deep as the groups do.
    let most = budget.limits().depth;
    let mut elements = document.descendants().filter(roxmltree::Node::is_element);
    if elements.any(|node| node.ancestors().take(most + 2).count() > most + 1) {
        budget.within(&format!("{what}: nested XML elements"), most + 1, ("depth", most))?;
    }
    let bytes = expanded(&document, budget)?;
    budget.spend(READING.saturating_mul(bytes as u64))?;
    drop(budget.hold(&what, bytes.saturating_mul(PER_BYTE))?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use arabesque_core::Limits;

    use super::*;

    #[test]
    fn pictures_inside_a_drawing_are_looked_at_first() {
        let message = |kind: &str, data: &[u8]| {
            let data = base64(data);
            let text = format!(
                "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><image width='9' height='9' href='data:{kind};base64,{data}'/></svg>"
            );
            let budget = Budget::default();
            let drawn = Drawn::read("d", &text, &budget).and_then(|drawn| rows(&drawn, [9.0, 9.0]));
            drawn.map_or_else(|e| e.to_string(), |_| "fine".into())
        };
        let mut palette = Vec::new();
        let mut encoder = png::Encoder::new(&mut palette, 2, 1);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(vec![7; 14]);
        encoder.write_header().unwrap().write_image_data(&[0, 0]).unwrap();
        assert_eq!(message("image/png", &palette), "fine");
        let gif = b"GIF89a\xff\xff\xff\xff\0\0\0,\0\0\0\0\xff\xff\xff\xff\0\x02\x02\x44\x01\0;";
        assert!(message("image/gif", gif).contains("--limit pixels"));
        let mut bomb = String::from(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><g id='a0'><path d='M0 0h9v9z'/></g>",
        );
        for k in 1..12 {
            let _ = write!(bomb, "<g id='a{k}'>{}</g>", format!("<use href='#a{}'/>", k - 1).repeat(10));
        }
        bomb += "</svg>";
        for kind in ["image/svg+xml", "text/plain"] {
            assert!(message(kind, bomb.as_bytes()).contains("limit"), "{kind}");
        }
        let deep = format!("<svg xmlns='http://www.w3.org/2000/svg'>{}{}</svg>", "<g>".repeat(900), "</g>".repeat(900));
        assert!(message("image/svg+xml", deep.as_bytes()).contains("--limit depth"));
        assert_eq!(message("image/svg+xml", b"<svg xmlns='http://www.w3.org/2000/svg'/>"), "fine");
        assert_eq!(message("image/svg+xml", &[0x1f, 0x8b, 8, 0, 0]), "fine");
    }

    fn base64(data: &[u8]) -> String {
        const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        data.chunks(3)
            .flat_map(|bytes| {
                let whole = bytes.iter().chain([&0, &0]).take(3).fold(0_usize, |all, b| all << 8 | usize::from(*b));
                (0..4).map(move |k| if k > bytes.len() { '=' } else { char::from(LETTERS[whole >> (18 - 6 * k) & 63]) })
            })
            .collect()
    }

    /// Layers, clips, gradients and strokes over a page of 60 x 40.
    fn drawing() -> String {
        let mut body = String::new();
        for k in 0..40 {
            let (x, y) = (k % 8 * 8, k / 8 * 8);
            let _ = write!(
                body,
                "<g opacity='0.7' transform='translate({x} {y})'><use href='#leaf'/>\
                 <g clip-path='url(#c)'><circle cx='4' cy='4' r='3.3' fill='url(#g)'/></g></g>"
            );
        }
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 60 40' width='60' height='40'><defs>\
             <linearGradient id='g'><stop stop-color='red'/><stop offset='1' stop-color='blue'/></linearGradient>\
             <clipPath id='c'><rect x='1' y='1' width='5' height='9'/></clipPath>\
             <path id='leaf' d='M0 0Q5 1 7 7Q1 5 0 0Z' fill='green' stroke='black' stroke-width='.3'/></defs>{body}</svg>"
        )
    }

    fn rows(drawn: &Drawn<'_>, size: [f64; 2]) -> Result<Vec<Vec<[u8; 4]>>> {
        let mut all = Vec::new();
        drawn.rows(size, |y, row| {
            assert_eq!(y, all.len());
            all.push(row.to_vec());
            Ok(())
        })?;
        Ok(all)
    }

    #[test]
    fn a_picture_is_drawn_as_a_whole_where_it_fits() {
        let (text, budget) = (drawing(), Budget::default());
        let drawn = Drawn::read("d", &text, &budget).unwrap();
        let found = rows(&drawn, [240.0, 160.0]).unwrap();
        let mut whole = Pixmap::new(240, 160).unwrap();
        resvg::render(&drawn.tree, Transform::from_scale(4.0, 4.0), &mut whole.as_mut());
        let expected: Vec<[u8; 4]> =
            whole.pixels().iter().map(|p| p.demultiply()).map(|c| [c.red(), c.green(), c.blue(), c.alpha()]).collect();
        assert_eq!(found.concat(), expected);
    }

    #[test]
    fn bands_together_are_almost_the_whole() {
        let (text, budget) = (drawing(), Budget::default());
        let drawn = Drawn::read("d", &text, &budget).unwrap();
        let whole = rows(&drawn, [240.0, 160.0]).unwrap();
        let mut bands = Vec::new();
        let band = PIXEL * 240.0 * 2000.0;
        let put = |_, row: &[[u8; 4]]| {
            bands.push(row.to_vec());
            Ok(())
        };
        drawn.rows_within([0.0, band], [240.0, 160.0], put).unwrap();
        let (whole, bands) = (whole.concat(), bands.concat());
        assert_eq!(whole.len(), bands.len());
        let differing = whole.iter().zip(&bands).filter(|(a, b)| a != b).count();
        assert!(differing * 50 < whole.len(), "{differing} of {}", whole.len());
        assert!(whole.iter().zip(&bands).all(|(a, b)| a[3].abs_diff(b[3]) < 128));
    }

    #[test]
    fn layers_within_layers_are_counted() {
        let depth = 30;
        let (groups, ends) = ("<g opacity='0.9'>".repeat(depth), "</g>".repeat(depth));
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='10' height='10'>{groups}<rect width='10' height='10'/>{ends}</svg>"
        );
        let budget = Budget::default();
        let drawn = Drawn::read("d", &text, &budget).unwrap();
        let demand = Demand::of(&drawn.tree, Transform::from_scale(100.0, 100.0), [1000.0; 2], &budget).unwrap();
        assert_eq!(demand.deepest, 30.0);
        assert!((30e6..31e6).contains(&demand.layers), "{}", demand.layers);
        let small = Budget::new(Limits { memory: 100 << 20, ..Limits::default() });
        let drawn = Drawn::read("d", &text, &small).unwrap();
        assert!(matches!(rows(&drawn, [1000.0; 2]), Err(Error::Limit { .. })));
    }

    #[test]
    fn elements_count_as_often_as_they_are_shown() {
        let wide: String = (0..6000).map(|k| format!("L{k} {}", k % 7)).collect();
        let mut text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'><defs><path id='a0' d='M0 0{wide}'/>"
        );
        for level in 1..8 {
            let uses = format!("<use href='#a{}'/>", level - 1).repeat(10);
            let _ = write!(text, "<g id='a{level}'>{uses}</g>");
        }
        text += "</defs><use href='#a7'/></svg>";
        let error = Drawn::read("d", &text, &Budget::default()).err().unwrap();
        assert!(matches!(error, Error::Limit { .. }), "{error}");
    }

    #[test]
    fn a_request_to_stop_is_heard_between_rows() {
        let text = drawing();
        let budget = Budget::default();
        let drawn = Drawn::read("d", &text, &budget).unwrap();
        let mut seen = 0;
        let error = drawn.rows([240.0, 160.0], |y, _| {
            seen = y;
            if y == 50 {
                budget.stopper().stop(arabesque_core::Cause::Asked);
            }
            Ok(())
        });
        assert!(matches!(error, Err(Error::Stopped { .. })) && seen == 50);
    }
}
