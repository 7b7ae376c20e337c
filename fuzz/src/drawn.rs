//! Small drawings made of bytes: shapes, strokes, groups, copies, clips and transforms, with odd numbers among them.

use std::fmt::Write as _;

use libfuzzer_sys::arbitrary::{Result, Unstructured};

/// Numbers that ask for trouble.
const ODD: [&str; 14] =
    ["0", "-0", "-1", "1e-9", "1e-30", "1e9", "-1e9", "1e30", "1e300", "0.333333333333", "1e-4", "99999", "-5", "50"];
/// Groups deeper than this hold shapes alone.
const DEEP: usize = 4;

/// A number: mostly one that fits the page, at times an odd one.
pub fn number(u: &mut Unstructured<'_>) -> Result<String> {
    Ok(match u.int_in_range(0..=40u8)? {
        40 => (*u.choose(&ODD)?).to_owned(),
        37..=39 => format!("{}", f64::from(u.arbitrary::<i16>()?) / 256.0),
        _ => format!("{}", f64::from(u.arbitrary::<u8>()?) / 2.5),
    })
}

/// A length that is mostly small and positive.
pub fn length(u: &mut Unstructured<'_>) -> Result<String> {
    if u.ratio(1, 30u8)? { number(u) } else { Ok(format!("{}", f64::from(u.int_in_range(1..=80u8)?) / 8.0)) }
}

/// A whole drawing of 100 x 100, with a layer `Domain` at times.
pub fn drawing(u: &mut Unstructured<'_>) -> Result<String> {
    let mut svg =
        String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"");
    match u.int_in_range(0..=9u8)? {
        0 => {}
        1 => write_or_die(&mut svg, format_args!(" width=\"{}mm\" height=\"{}\"", length(u)?, length(u)?)),
        2 => write_or_die(
            &mut svg,
            format_args!(" viewBox=\"{} {} {} {}\"", number(u)?, number(u)?, number(u)?, number(u)?),
        ),
        _ => svg.push_str(" viewBox=\"0 0 100 100\""),
    }
    svg.push_str("><defs><linearGradient id=\"paint\"><stop offset=\"0\"/><stop offset=\"1\" stop-color=\"red\"/></linearGradient>");
    svg.push_str("<clipPath id=\"clip\">");
    shape(u, &mut svg)?;
    svg.push_str("</clipPath><symbol id=\"used\" overflow=\"visible\">");
    shape(u, &mut svg)?;
    svg.push_str("</symbol></defs>");
    if u.ratio(1, 3u8)? {
        grid(u, &mut svg)?;
    }
    for _ in 0..u.int_in_range(1..=9u8)? {
        item(u, &mut svg, 0)?;
    }
    if u.ratio(1, 10u8)? {
        svg.push_str("<g id=\"Domain\">");
        shape(u, &mut svg)?;
        svg.push_str("</g>");
    }
    svg.push_str("</svg>");
    Ok(svg)
}

/// A shape again and again, in rows, a little out of place.
fn grid(u: &mut Unstructured<'_>, svg: &mut String) -> Result<()> {
    let mut one = String::new();
    item(u, &mut one, DEEP)?;
    let [columns, rows] = [u.int_in_range(1..=5u8)?, u.int_in_range(1..=5u8)?];
    let [dx, dy] = [u.int_in_range(0..=30u8)?, u.int_in_range(0..=30u8)?];
    for k in 0..columns * rows {
        let [x, y] = [k % columns * dx, k / columns * dy].map(f64::from);
        let off = f64::from(u.arbitrary::<u8>()?) / 64.0;
        write_or_die(svg, format_args!("<g transform=\"translate({} {y})\">{one}</g>", x + off));
    }
    Ok(())
}

fn item(u: &mut Unstructured<'_>, svg: &mut String, depth: usize) -> Result<()> {
    match u.int_in_range(0..=9u8)? {
        0..=1 if depth < DEEP => {
            svg.push_str("<g");
            look(u, svg)?;
            svg.push('>');
            for _ in 0..u.int_in_range(0..=3u8)? {
                item(u, svg, depth + 1)?;
            }
            svg.push_str("</g>");
        }
        2 => {
            write_or_die(svg, format_args!("<use xlink:href=\"#used\" x=\"{}\" y=\"{}\"", number(u)?, number(u)?));
            look(u, svg)?;
            svg.push_str("/>");
        }
        _ => shape(u, svg)?,
    }
    Ok(())
}

fn shape(u: &mut Unstructured<'_>, svg: &mut String) -> Result<()> {
    match u.int_in_range(0..=6u8)? {
        0 => {
            write_or_die(svg, format_args!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"", number(u)?, number(u)?, length(u)?))
        }
        1 => write_or_die(
            svg,
            format_args!(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"",
                number(u)?,
                number(u)?,
                length(u)?,
                length(u)?
            ),
        ),
        2 => write_or_die(
            svg,
            format_args!(
                "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"blue\"",
                number(u)?,
                number(u)?,
                number(u)?,
                number(u)?
            ),
        ),
        3 => {
            svg.push_str("<polyline points=\"");
            for _ in 0..u.int_in_range(1..=9u8)? {
                write_or_die(svg, format_args!("{} {} ", number(u)?, number(u)?));
            }
            svg.push_str("\" fill=\"none\" stroke=\"black\"");
            look_of_strokes(u, svg)?;
            svg.push_str("/>");
            return Ok(());
        }
        _ => path(u, svg)?,
    }
    look(u, svg)?;
    svg.push_str("/>");
    Ok(())
}

fn path(u: &mut Unstructured<'_>, svg: &mut String) -> Result<()> {
    write_or_die(svg, format_args!("<path d=\"M{} {}", number(u)?, number(u)?));
    for _ in 0..u.int_in_range(0..=9u8)? {
        let (letter, count) = *u.choose(&[
            ('L', 2),
            ('l', 2),
            ('h', 1),
            ('V', 1),
            ('C', 6),
            ('c', 6),
            ('S', 4),
            ('Q', 4),
            ('t', 2),
            ('M', 2),
            ('z', 0),
        ])?;
        svg.push(letter);
        for _ in 0..count {
            write_or_die(svg, format_args!("{} ", number(u)?));
        }
        if u.ratio(1, 9u8)? {
            write_or_die(
                svg,
                format_args!("a{} {} {} 1 0 {} {}", length(u)?, length(u)?, number(u)?, number(u)?, number(u)?),
            );
        }
    }
    svg.push('"');
    Ok(())
}

fn look(u: &mut Unstructured<'_>, svg: &mut String) -> Result<()> {
    match u.int_in_range(0..=19u8)? {
        0 => svg.push_str(" fill=\"none\""),
        1 => svg.push_str(" fill=\"url(#paint)\""),
        2 => svg.push_str(" clip-path=\"url(#clip)\""),
        3 => svg.push_str(" class=\"a\" fill=\"green\""),
        4 => svg.push_str(" opacity=\"0.5\" fill-rule=\"evenodd\""),
        5..=8 => {
            svg.push_str(" fill=\"none\" stroke=\"black\"");
            look_of_strokes(u, svg)?;
        }
        9 => svg.push_str(" data-arabesque=\"curve\" stroke=\"black\""),
        _ => {}
    }
    match u.int_in_range(0..=19u8)? {
        0 => write_or_die(svg, format_args!(" transform=\"scale({})\"", number(u)?)),
        1 => write_or_die(svg, format_args!(" transform=\"rotate({})\"", number(u)?)),
        2 => write_or_die(svg, format_args!(" transform=\"translate({} {})\"", number(u)?, number(u)?)),
        3 => write_or_die(
            svg,
            format_args!(
                " transform=\"matrix({} {} {} {} {} {})\"",
                length(u)?,
                number(u)?,
                number(u)?,
                length(u)?,
                number(u)?,
                number(u)?
            ),
        ),
        _ => {}
    }
    Ok(())
}

fn look_of_strokes(u: &mut Unstructured<'_>, svg: &mut String) -> Result<()> {
    if u.arbitrary()? {
        write_or_die(svg, format_args!(" stroke-width=\"{}\"", length(u)?));
    }
    if u.ratio(1, 8u8)? {
        write_or_die(svg, format_args!(" stroke-dasharray=\"{} {}\"", length(u)?, number(u)?));
    }
    if u.ratio(1, 4u8)? {
        let join = u.choose(&["round", "bevel", "miter"])?;
        write_or_die(svg, format_args!(" stroke-linejoin=\"{join}\" stroke-linecap=\"square\""));
    }
    Ok(())
}

/// Writing to a string cannot fail.
fn write_or_die(svg: &mut String, text: std::fmt::Arguments<'_>) {
    svg.write_fmt(text).unwrap_or_default();
}
