//! A folder of its own for each test, and the program in it.

#![allow(dead_code, reason = "every test file uses another part of it")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use tempfile::TempDir;

/// Sixteen leaves and berries in a 80 x 80 frame, in rows.
pub(crate) fn leaves() -> String {
    let mut body = String::new();
    for k in 0..16 {
        let (x, y) = (10 + 20 * (k % 4), 10 + 20 * (k / 4));
        body += &if k % 2 == 0 {
            format!(
                "<g class=\"leaf\" transform=\"translate({x} {y})\"><path d=\"M-6 0C-3 -4 3 -4 6 0C3 4 -3 4 -6 0Z\" fill=\"#4a7\"/><path d=\"M-6 0L6 0\" stroke=\"#163\" fill=\"none\"/></g>\n"
            )
        } else {
            format!("<circle class=\"berry\" cx=\"{x}\" cy=\"{y}\" r=\"3\" fill=\"#c22\"/>\n")
        };
    }
    svg("80", "80", "0 0 80 80", &format!("<rect width=\"80\" height=\"80\" fill=\"#fffdf8\"/>\n{body}"))
}

/// An SVG document.
pub(crate) fn svg(width: &str, height: &str, view: &str, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" width=\"{width}\" height=\"{height}\" viewBox=\"{view}\">\n{body}</svg>\n"
    )
}

/// A disc with a hole in a 160 x 160 page.
pub(crate) fn ring() -> String {
    svg(
        "160",
        "160",
        "0 0 160 160",
        "<path id=\"ring\" fill-rule=\"evenodd\" d=\"M10 80A70 70 0 1 0 150 80A70 70 0 1 0 10 80ZM55 80A25 25 0 1 0 105 80A25 25 0 1 0 55 80Z\"/>",
    )
}

/// A grid of points of two classes.
pub(crate) fn points() -> String {
    let lines: String = (0..64)
        .map(|k| {
            format!("{},{},{}\n", 0.1 * f64::from(k % 8), 0.1 * f64::from(k / 8), ["a", "b"][(k + k / 8) as usize % 2])
        })
        .collect();
    format!("x,y,class\n{lines}")
}

/// A PNG picture, gray from left to right.
pub(crate) fn ramp() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 16, 2);
    encoder.set_color(png::ColorType::Grayscale);
    let row: Vec<u8> = (0..16_u8).map(|k| k * 17).collect();
    encoder.write_header().unwrap().write_image_data(&[row.clone(), row].concat()).unwrap();
    bytes
}

/// Width, height and RGBA pixels of a PNG file.
pub(crate) fn pixels(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut buffer).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgba);
    (info.width, info.height, buffer)
}

/// A shipped exemplar.
pub(crate) fn example(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name).to_str().unwrap().to_owned()
}

/// A folder with the usual inputs.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("leaves.svg", leaves());
        folder.write("ring.svg", ring());
        folder.write("points.csv", points());
        folder.write("ramp.png", ramp());
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    /// The files in the folder, hidden ones included.
    pub(crate) fn names(&self) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(self.0.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program, about to be run in the folder.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_arabesque"));
        command.args(line.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    pub(crate) fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs and expects success.
    pub(crate) fn ok(&self, line: &str) -> Output {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", stderr(&output));
        output
    }

    /// Runs and expects an exit code and one line on standard error that starts as all errors do; returns it.
    pub(crate) fn fails(&self, code: i32, line: &str) -> String {
        let before = self.names();
        let output = self.run(line);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(code), "{line}: {message}");
        assert_eq!(self.names(), before, "{line} left something behind");
        assert!(output.stdout.is_empty(), "{line} wrote to standard output");
        message
    }
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The values of one attribute, in order.
pub(crate) fn attributes<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    text.split(&start).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

/// The part of a result between its recipe and its end: what is drawn.
pub(crate) fn drawn(text: &str) -> &str {
    text.rsplit_once("</metadata>").map_or(text, |(_, rest)| rest)
}

/// A PNG picture of RGBA pixels.
pub(crate) fn picture(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    let data: Vec<u8> =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y)).collect();
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    bytes
}

/// A strip of 60 x 24 pixels on a transparent background: a band that swings, with spots.
pub(crate) fn strip() -> Vec<u8> {
    picture(60, 24, |x, y| {
        let middle = 12.0 + 3.0 * (f64::from(x) * std::f64::consts::TAU / 30.0).sin();
        let off = (f64::from(y) + 0.5 - middle).abs();
        match off {
            _ if off < 1.5 && x % 12 < 4 => [230, 180, 40, 255],
            _ if off < 3.0 => [40, 110, 90, 255],
            _ if off < 4.0 => [40, 110, 90, (255.0 * (4.0 - off)) as u8],
            _ => [0; 4],
        }
    })
}

/// The same kind of strip as a drawing of 60 x 24 units.
pub(crate) fn drawn_strip() -> String {
    svg(
        "60",
        "24",
        "0 0 60 24",
        "<path d=\"M-5 12C5 6 10 6 15 12S30 18 35 12S50 6 65 12\" fill=\"none\" stroke=\"#2a6e5a\" stroke-width=\"5\"/>\n\
         <circle cx=\"15\" cy=\"12\" r=\"2\" fill=\"#e6b428\"/><circle cx=\"45\" cy=\"10\" r=\"2\" fill=\"#e6b428\"/>\n",
    )
}

/// Curves on a page of 160 x 100: a wave, a ring, and a corner in a layer.
pub(crate) fn curves() -> String {
    svg(
        "160",
        "100",
        "0 0 160 100",
        "<path id=\"wave\" d=\"M12 60C50 5 100 95 148 40\" fill=\"none\" stroke=\"black\"/>\n\
         <circle id=\"round\" cx=\"80\" cy=\"50\" r=\"32\" fill=\"none\" stroke=\"black\"/>\n\
         <g inkscape:groupmode=\"layer\" inkscape:label=\"Corners\"><polyline id=\"bend\" points=\"20,80 80,80 80,20\"/></g>\n",
    )
}
