//! OBJ: networks of curves in space, read from polylines.
//!
//! Read: vertices (`v`) and polylines (`l`); `o` and `g` name the style of the polylines that follow. Polylines that
//! share a vertex, or end at the same place, meet there. `# box x0 y0 z0 x1 y1 z1` gives the frame, else it is the box
//! around the vertices in use. Written: the same, and the recipe in comment lines at the end.

use std::collections::{BTreeMap, BTreeSet};

use arabesque_core::{Bounds, Budget, Class, Contents, Cubic, Curve, Error, Exemplar, Path, Result, Vector, Warning};

use crate::{
    mesh::obj::lexer::{Lexer, logical_lines},
    text::short::{list, short},
};

/// Work for each byte.
const PER_BYTE: u64 = 10;

/// The style of polylines that no `o` or `g` precedes.
const ONLY_STYLE: &str = "curve";

/// An exemplar of curves in space.
#[derive(Clone, Debug)]
pub struct Net {
    /// The curves in their frame.
    pub exemplar: Exemplar<3>,
    /// What was left out.
    pub warnings: Vec<Warning>,
}

/// Reads polylines.
///
/// # Errors
/// [`Error::Input`] with the line: a coordinate that is not a finite number within the limits, a polyline to a vertex
/// that does not exist, a broken box comment, no polyline at all, or curves that lie in one plane and no box;
/// [`Error::Limit`] for too many vertices or lines.
pub fn read_curves(name: &str, text: &str, budget: &Budget) -> Result<Net> {
    let mut reader = Reader::new(name, budget);
    for (line, content) in logical_lines(text) {
        reader.statement(line, &content)?;
    }
    reader.finish()
}

/// Reads polylines as lines to lay a pattern along, each with the name that messages call it by. They may lie in one
/// plane.
///
/// # Errors
/// As [`read_curves`], except for the box.
pub fn read_lines(name: &str, text: &str, budget: &Budget) -> Result<Vec<(String, Path<3>)>> {
    let mut reader = Reader::new(name, budget);
    for (line, content) in logical_lines(text) {
        reader.statement(line, &content)?;
    }
    let mut paths = Vec::new();
    for (line, polyline) in &reader.lines {
        let path = reader.path(*line, polyline)?;
        if !path.is_empty() {
            paths.push((format!("{name}: line {line}"), path));
        }
    }
    if paths.is_empty() {
        return Err(Error::input(name, "no line of any length found", "draw the curve as a line, such as l 1 2 3"));
    }
    Ok(paths)
}

#[derive(Debug)]
struct Polyline {
    style: usize,
    vertices: Vec<usize>,
}

#[derive(Debug)]
struct Reader<'a> {
    lexer: Lexer<'a>,
    vertices: Vec<Vector<3>>,
    /// Line, style and vertices counted from one; resolved at the end, for vertices may follow.
    lines: Vec<(usize, Polyline)>,
    references: usize,
    styles: Vec<String>,
    style_of: BTreeMap<String, usize>,
    style: Option<String>,
    frame: Option<Bounds<3>>,
    ignored: BTreeMap<String, usize>,
}

impl<'a> Reader<'a> {
    fn new(name: &'a str, budget: &'a Budget) -> Self {
        Self {
            lexer: Lexer { name, budget, advice: "keep a smaller part of the network as the exemplar" },
            vertices: Vec::new(),
            lines: Vec::new(),
            references: 0,
            styles: Vec::new(),
            style_of: BTreeMap::new(),
            style: None,
            frame: None,
            ignored: BTreeMap::new(),
        }
    }

    fn statement(&mut self, line: usize, content: &str) -> Result<()> {
        let mut words = content.split_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        self.lexer.budget.spend(PER_BYTE * content.len() as u64)?;
        if !matches!(keyword, "v" | "l" | "o" | "g") && !keyword.starts_with('#') {
            *self.ignored.entry(short(keyword)).or_insert(0) += 1;
            return Ok(());
        }
        // Words are counted before a list of them is made.
        self.lexer.check_limit(
            "line segments",
            words.clone().count(),
            ("segments", self.lexer.budget.limits().segments),
            1,
        )?;
        let words: Vec<&str> = words.collect();
        match keyword {
            "v" => self.vertex(line, &words),
            "l" => self.polyline(line, &words),
            "o" | "g" => {
                self.style = Some(words.join(" ")).filter(|name| !name.is_empty());
                Ok(())
            }
            _ => self.frame(line, content),
        }
    }

    fn vertex(&mut self, line: usize, words: &[&str]) -> Result<()> {
        let vertex = self.lexer.vertex(line, words)?;
        self.lexer.check_limit("vertices", self.vertices.len() + 1, ("nodes", self.lexer.budget.limits().nodes), 1)?;
        self.vertices.push(vertex);
        Ok(())
    }

    fn polyline(&mut self, line: usize, words: &[&str]) -> Result<()> {
        if words.len() < 2 {
            let problem = format!("a line of {} vertices", words.len());
            return self.lexer.fail(line, problem, "write at least two, such as l 1 2");
        }
        self.references += words.len();
        self.lexer.check_limit(
            "line segments",
            self.references,
            ("segments", self.lexer.budget.limits().segments),
            1,
        )?;
        self.lexer.check_limit("lines", self.lines.len() + 1, ("elements", self.lexer.budget.limits().elements), 1)?;
        let vertices =
            words.iter().map(|word| self.lexer.index(line, word, self.vertices.len())).collect::<Result<Vec<_>>>()?;
        let name = self.style.as_deref().unwrap_or(ONLY_STYLE);
        let style = match self.style_of.get(name) {
            Some(known) => *known,
            None => {
                self.style_of.insert(name.to_owned(), self.styles.len());
                self.styles.push(name.to_owned());
                self.styles.len() - 1
            }
        };
        self.lines.push((line, Polyline { style, vertices }));
        Ok(())
    }

    fn frame(&mut self, line: usize, content: &str) -> Result<()> {
        let words: Vec<&str> = content.trim_start_matches('#').split_whitespace().skip(1).collect();
        let expected = "write the lower and the upper corner, as # box 0 0 0 10 10 10";
        if words.len() != 6 {
            return self.lexer.fail(line, format!("a box of {} numbers", words.len()), expected);
        }
        let mut values = [0.0; 6];
        for (value, word) in values.iter_mut().zip(words) {
            *value = self.lexer.coordinate(line, word)?;
        }
        let [a, b, c, d, e, f] = values;
        let frame = Bounds::new(Vector([a, b, c]), Vector([d, e, f]));
        if frame.size().0.iter().any(|s| *s <= 0.0) {
            return self.lexer.fail(line, "a box without volume", expected);
        }
        self.frame = Some(frame);
        Ok(())
    }

    fn finish(self) -> Result<Net> {
        let mut points = 0;
        let mut curves = Vec::new();
        let mut drawn = Drawn::default();
        for (line, polyline) in &self.lines {
            let path = self.path(*line, polyline)?;
            if path.is_empty() {
                points += 1;
            }
            let curve = |path| Curve { path, style: polyline.style, width: 0.0, colour: [0.0; 3] };
            curves.extend(drawn.new_parts(path).into_iter().map(curve));
        }
        if curves.is_empty() {
            let advice = "draw the network as lines, such as l 1 2 3";
            return Err(Error::input(self.lexer.name, "no line of any length found", advice));
        }
        let window = self.window(&curves)?;
        let warnings = self.warnings(points, drawn.again);
        let styles = self.styles.into_iter().map(|name| Class { name }).collect();
        let exemplar =
            Exemplar::with_curves(self.lexer.name, Contents { curves, styles, ..Contents::default() }, window)?;
        Ok(Net { exemplar, warnings })
    }

    fn window(&self, curves: &[Curve<3>]) -> Result<Bounds<3>> {
        let tight = curves.iter().fold(Bounds::EMPTY, |b, c| b.union(&c.path.bounds()));
        let window = self.frame.unwrap_or(tight);
        let size = window.size();
        let largest = size.0.into_iter().fold(0.0, f64::max);
        if size.0.iter().any(|s| *s <= 1e-9 * largest || *s < self.lexer.budget.limits().extent) {
            let advice = "add a comment line that says how thick the layer is, as # box x0 y0 z0 x1 y1 z1";
            return Err(Error::input(self.lexer.name, "the network lies in one plane, which fills no volume", advice));
        }
        if !window.intersects(&tight) {
            let advice = "correct the comment line # box x0 y0 z0 x1 y1 z1";
            return Err(Error::input(self.lexer.name, "the network lies outside its box", advice));
        }
        Ok(window)
    }

    fn path(&self, line: usize, polyline: &Polyline) -> Result<Path<3>> {
        let mut points = Vec::with_capacity(polyline.vertices.len());
        for &k in &polyline.vertices {
            let Some(p) = self.vertices.get(k) else {
                let problem = format!("vertex {} where the file has {}", k + 1, self.vertices.len());
                return self.lexer.fail(line, problem, "correct the number of the vertex");
            };
            points.push(*p);
        }
        let mut path = Path::polyline(&points);
        path.closed = path.cubics.len() > 2 && points.first() == points.last();
        Ok(path)
    }

    fn warnings(&self, points: usize, again: usize) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if again > 0 {
            let message = format!("{}: {again} segments that are drawn already are left out", self.lexer.name);
            warnings.push(Warning::new(message, "draw every line once"));
        }
        if points > 0 {
            let message = format!("{}: {points} lines without length are left out", self.lexer.name);
            warnings.push(Warning::new(message, "remove them, or move their vertices apart"));
        }
        if !self.ignored.is_empty() {
            let words = list(self.ignored.iter().map(|(word, n)| format!("{word} ({n})")));
            let message = format!("{}: statements other than v, l, o and g are ignored: {words}", self.lexer.name);
            warnings.push(Warning::new(message, "draw what should be repeated as lines"));
        }
        warnings
    }
}

/// Segments by the bits of their ends, either way round.
#[derive(Debug, Default)]
struct Drawn {
    known: BTreeSet<[[u64; 3]; 2]>,
    /// Segments that were drawn before.
    again: usize,
}

impl Drawn {
    /// The parts of a line that were not drawn before; the whole line where it is new.
    fn new_parts(&mut self, path: Path<3>) -> Vec<Path<3>> {
        let ends = |c: &Cubic<3>| {
            let mut ends = [c[0], c[3]].map(|p| p.0.map(|v| (v + 0.0).to_bits()));
            ends.sort_unstable();
            ends
        };
        let is_new: Vec<bool> = path.cubics.iter().map(|c| self.known.insert(ends(c))).collect();
        let again = is_new.iter().filter(|new| !**new).count();
        if again == 0 {
            return if path.is_empty() { Vec::new() } else { vec![path] };
        }
        self.again += again;
        let numbered: Vec<usize> = (0..is_new.len()).collect();
        let runs = numbered.chunk_by(|a, b| is_new[*a] == is_new[*b]).filter(|run| is_new[run[0]]);
        runs.map(|run| Path { cubics: path.cubics[run[0]..=run[run.len() - 1]].to_vec(), closed: false }).collect()
    }
}

/// Number of places where three or more pieces of the polylines of an exemplar end or pass.
pub fn junctions(exemplar: &Exemplar<3>) -> usize {
    let mut arms: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    for c in exemplar.curves.iter().flat_map(|curve| &curve.path.cubics) {
        for p in [c[0], c[3]] {
            // Adding zero makes one of the two zeros.
            *arms.entry(p.0.map(|v| (v + 0.0).to_bits())).or_insert(0) += 1;
        }
    }
    arms.values().filter(|n| **n >= 3).count()
}

#[cfg(test)]
mod tests {
    use arabesque_core::{Drawn, Measured};

    use arabesque_core::Limits;

    use super::*;
    use crate::mesh::obj::write::{Sheet, recipe_of, write_curves};

    const CORNER: &str = "# a corner\r\no frame of wood\r\nv 0 0 0\r\nv 1 0 0 1.0\r\nv 1 1 0 0.5 0.5 0.5\r\nv 0 1 \
         1\r\nl 1 2 \\\r\n 3\r\ng strut\r\nl -1/4 1\r\nl 1 3\r\nf 1 2 3\r\nvn 0 0 1\r\n";

    fn read(text: &str) -> Result<Net> {
        read_curves("t.obj", text, &Budget::default())
    }

    fn names(exemplar: &Exemplar<3>) -> Vec<&str> {
        exemplar.styles.iter().map(|s| s.name.as_str()).collect()
    }

    #[test]
    fn polylines_vertices_and_names_are_understood() {
        let net = read(CORNER).unwrap();
        let e = &net.exemplar;
        assert_eq!(e.curves.len(), 3);
        assert_eq!(e.curves[0].path.cubics.len(), 2);
        assert_eq!(names(e), ["frame of wood", "strut"]);
        assert_eq!((e.curves[1].style, e.curves[1].path.start()), (1, Some(Vector([0.0, 1.0, 1.0]))));
        assert_eq!(e.window, Bounds::new(Vector::ZERO, Vector::splat(1.0)));
        assert_eq!(junctions(e), 1);
        assert_eq!(net.warnings.len(), 1);
        assert!(net.warnings[0].message.contains("f (1), vn (1)"), "{}", net.warnings[0].message);
    }

    #[test]
    fn a_line_that_comes_back_is_closed() {
        let net = read("v 0 0 0\nv 1 0 0\nv 0 1 1\nl 1 2 3 1\n").unwrap();
        assert!(net.exemplar.curves[0].path.closed);
        assert_eq!(junctions(&net.exemplar), 0);
    }

    #[test]
    fn a_comment_gives_the_box() {
        let net = read("# box -1 -1 -1 2 2 2\nv 0 0 0\nv 1 0 0\nl 1 2\n").unwrap();
        assert_eq!(net.exemplar.window.size(), Vector::splat(3.0));
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, expected) in [
            ("v 0 0 nan\n", "line 1"),
            ("v 0 0 1e300\n", "where a coordinate"),
            ("v 0 0\n", "a vertex of 2 numbers"),
            ("v 0 zero 0\n", "\"zero\" is not a number"),
            ("v 0 0 0\nl 1 2\n", "line 2: vertex 2 where the file has 1"),
            ("v 0 0 0\nl 0 1\n", "line 2: \"0\" is not a vertex"),
            ("v 0 0 0\nl -2 1\n", "\"-2\" is not a vertex"),
            ("v 0 0 0\nl 99999999999999999999 1\n", "is not a vertex"),
            ("v 0 0 0\nl 1\n", "a line of 1 vertices"),
            ("v 0 0 0\nl 1 1\n", "no line of any length"),
            ("", "no line of any length"),
            ("v 0 0 0\nv 1 0 0\nl 1 2\n", "in one plane"),
            ("# box 0 0 0 1 1\n", "line 1: a box of 5 numbers"),
            ("# box 0 0 0 1 1 0\n", "a box without volume"),
            ("# box 5 5 5 6 6 6\nv 0 0 0\nv 1 0 0\nl 1 2\n", "outside its box"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text:?}: {message}");
        }
    }

    #[test]
    fn limits_hold() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 1\nl 1 2\nl 2 3\n";
        for limits in [
            Limits { nodes: 2, ..Limits::default() },
            Limits { segments: 3, ..Limits::default() },
            Limits { elements: 1, ..Limits::default() },
        ] {
            assert!(matches!(read_curves("t", text, &Budget::new(limits)), Err(Error::Limit { .. })));
        }
    }

    #[test]
    fn written_curves_read_back_with_their_recipe() {
        let exemplar = read(CORNER).unwrap().exemplar;
        let bent = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]].map(Vector);
        let drawn = |path, source| Drawn { path, source, scale: 1.0, frozen: None };
        let curves = [
            drawn(Path { cubics: vec![bent], closed: false }, 1),
            drawn(Path::polyline(&[bent[3], Vector([0.0, 1.0, 1.0])]), 0),
            drawn(Path { closed: true, ..Path::polyline(&[bent[0], bent[1], bent[2], bent[0]]) }, 1),
        ];
        let frame = Bounds::new(Vector::ZERO, Vector::splat(2.0));
        let sheet =
            Sheet { frame, tolerance: 1e-3, recipe: Some("seed = 1\nbox = \"2x2x2\"\n[a]\nx = '''\n# y\n'''\n") };
        let text = write_curves(&exemplar, &curves, &sheet);
        assert_eq!(recipe_of(&text).as_deref(), sheet.recipe);
        let net = read(&text).unwrap();
        assert!(net.warnings.is_empty());
        let back = net.exemplar;
        assert_eq!((back.window, back.curves.len()), (frame, 3));
        assert_eq!(names(&back), ["frame of wood", "strut"]);
        assert!(back.curves[2].path.closed);
        // The curve and the line meet in one vertex.
        assert_eq!(back.curves[0].path.start(), back.curves[1].path.end());
        let length = |path: &Path<3>| Measured::new(path.clone(), 1e-4).length();
        assert!((length(&back.curves[1].path) - length(&curves[0].path)).abs() < 0.02);
    }

    #[test]
    fn what_is_drawn_twice_is_drawn_once() {
        let text = "v 0 0 0\nv 1 1 1\nv 2 0 1\nl 1 2 1 2 1\nl 2 1\nl 1 2 3\nl 3 1 1\n";
        let net = read(text).unwrap();
        let lengths: Vec<_> = net.exemplar.curves.iter().map(|c| c.path.cubics.len()).collect();
        assert_eq!(lengths, [1, 1, 1]);
        assert!(
            net.warnings.iter().any(|w| w.message.contains("5 segments that are drawn already")),
            "{:?}",
            net.warnings
        );
    }

    #[test]
    fn long_lines_long_words_and_many_statements_take_little() {
        let count = 50_000;
        let vertices: String = (0..count).map(|k| format!("v {} {} {}\n", k % 37, k % 41, k % 43)).collect();
        let indices: String = (1..=count).map(|k| format!(" {k}")).collect();
        let budget = Budget::default();
        let net = read_curves("t.obj", &format!("{vertices}l{indices}\n"), &budget).unwrap();
        assert_eq!(net.exemplar.curves[0].path.cubics.len(), count - 1);
        let continued: String = (1..=count).map(|k| format!(" {k} \\\n")).collect();
        assert_eq!(read_curves("t.obj", &format!("{vertices}l{continued}\n"), &budget).unwrap().exemplar, net.exemplar);
        let styles: String = (1..count).map(|k| format!("o s{k}\nl {k} {}\n", k + 1)).collect();
        assert!(read_curves("t.obj", &format!("{vertices}{styles}"), &budget).unwrap().exemplar.styles.len() > 40_000);
        assert!(budget.work() < 200_000_000, "{}", budget.work());
        let words: String = (0..count).map(|k| format!("w{k} 1\n")).collect();
        let warnings = read(&format!("{words}v 0 0 0\nv 1 1 1\nl 1 2\n")).unwrap().warnings;
        assert!(warnings.iter().all(|w| w.message.len() < 200), "{warnings:?}");
        let few = Budget::new(Limits { segments: 1000, ..Limits::default() });
        assert!(matches!(read_curves("t", &format!("l{indices}"), &few), Err(Error::Limit { .. })));
        let message = read(&format!("v 0 0 {}\n", "9".repeat(5000))).unwrap_err().to_string();
        assert!(message.len() < 200, "{message}");
    }
}
