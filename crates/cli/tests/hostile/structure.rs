//! Files that are deep, that refer to themselves, or that are not what they seem.

use crate::case::{Case, EITHER, REFUSED, dots, dots_and, page};

const MANY: usize = 50_000;

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = deep();
    cases.extend(repeated());
    cases.extend(clips());
    cases.extend(cycles());
    cases.extend(bombs());
    cases.extend(other_files());
    cases
}

fn deep() -> Vec<Case> {
    let nested =
        |open: &str, close: &str, inner: &str| page(&format!("{}{inner}{}", open.repeat(MANY), close.repeat(MANY)));
    vec![
        Case::fill("nested groups", nested("<g>", "</g>", &dots()), REFUSED),
        Case::fill("nested drawings", nested("<svg>", "</svg>", &dots()), REFUSED),
        Case::fill("nested links", nested("<a>", "</a>", &dots()), REFUSED),
        Case::fill("nested unknown elements", nested("<q>", "</q>", &dots()), REFUSED),
        Case::fill(
            "nested text",
            dots_and(&format!("<text>{}a{}</text>", "<tspan>".repeat(MANY), "</tspan>".repeat(MANY))),
            REFUSED,
        ),
        Case::fill(
            "nested brackets in a style",
            dots_and(&format!("<style>{}</style>", "@media{".repeat(MANY))),
            EITHER,
        ),
        Case::fill(
            "nested transforms",
            dots_and(&format!("<circle r='3' transform='{}'/>", "scale(1)".repeat(MANY))),
            EITHER,
        ),
        Case::fill(
            "open brackets in a transform",
            dots_and(&format!("<circle r='3' transform='{}'/>", "(".repeat(MANY))),
            EITHER,
        ),
    ]
}

/// Dots, and something long.
fn long(name: String, more: &str) -> Case {
    Case::fill(name, dots_and(more), EITHER)
}

fn repeated() -> Vec<Case> {
    let mut cases = Vec::new();
    for n in [7_000, MANY] {
        cases.push(long(format!("a path that closes {n} times"), &format!("<path d='M5 5h3v3{}'/>", "z".repeat(n))));
        cases.push(long(
            format!("a path that closes {n} times after a line"),
            &format!("<path d='M5 5{}'/>", "h3v3z".repeat(n)),
        ));
        cases.push(long(format!("a path that moves {n} times"), &format!("<path d='M5 5{}'/>", "m1 1".repeat(n))));
        cases.push(long(
            format!("a stroke that closes {n} times"),
            &format!("<path fill='none' stroke='red' d='M5 5h3v3{}'/>", "z".repeat(n)),
        ));
        cases.push(long(format!("{n} ids"), &(0..n).map(|k| format!("<g id='i{k}'/>")).collect::<String>()));
        cases.push(long(
            format!("{n} style rules"),
            &format!("<style>{}</style>", (0..n).map(|k| format!(".c{k}{{fill:red}}")).collect::<String>()),
        ));
        cases.push(long(
            format!("{n} attributes of style"),
            &format!("<circle r='3' style='{}'/>", "fill:red;".repeat(n)),
        ));
        cases.push(long(format!("a selector of {n} parts"), &format!("<style>{}{{fill:red}}</style>", "g ".repeat(n))));
        cases.push(long(format!("{n} classes"), &format!("<circle r='3' class='{}'/>", "a ".repeat(n))));
        let chain: String = (0..n).map(|k| format!("<linearGradient id='g{k}' href='#g{}'/>", k + 1)).collect();
        cases.push(long(format!("a chain of {n} gradients"), &format!("{chain}<circle r='4' fill='url(#g0)'/>")));
        let chain: String = (0..n)
            .map(|k| {
                format!("<clipPath id='c{k}' clip-path='url(#c{})'><rect width='99' height='99'/></clipPath>", k + 1)
            })
            .collect();
        cases.push(long(format!("a chain of {n} clips"), &format!("{chain}<circle r='4' clip-path='url(#c0)'/>")));
        let chain: String = (0..n).map(|k| format!("<g id='u{k}'><use href='#u{}'/></g>", k + 1)).collect();
        cases.push(long(format!("a chain of {n} uses"), &format!("<defs>{chain}</defs><use href='#u0'/>")));
    }
    cases
}

fn clips() -> Vec<Case> {
    let mut cases = Vec::new();
    let clip: String =
        (0..5_000).map(|k| format!("<rect x='{}' y='{}' width='1' height='1'/>", k % 60 * 2, k / 60 * 2)).collect();
    cases.push(Case::fill(
        "a clip of 5 000 shapes",
        page(&format!("<clipPath id='c'>{clip}</clipPath><g clip-path='url(#c)'>{}</g>", dots())),
        EITHER,
    ));
    let clip: String = (0..5_000).map(|k| format!("<circle cx='{}' cy='60' r='50'/>", k % 120)).collect();
    cases.push(Case::fill(
        "a clip of 5 000 shapes upon each other",
        page(&format!("<clipPath id='c'>{clip}</clipPath><g clip-path='url(#c)'>{}</g>", dots())),
        EITHER,
    ));
    cases
}

fn cycles() -> Vec<Case> {
    let cycle = |name: &str, more: &str| Case::fill(name, dots_and(more), EITHER);
    vec![
        cycle("a use of itself", "<use id='u' href='#u'/>"),
        cycle("a group that uses itself", "<g id='u'><circle r='4'/><use href='#u'/></g>"),
        cycle("two groups that use each other", "<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>"),
        cycle("a symbol in itself", "<symbol id='s'><use href='#s'/></symbol><use href='#s'/>"),
        cycle(
            "a clip that clips itself",
            "<clipPath id='c' clip-path='url(#c)'><rect width='9' height='9'/></clipPath><circle r='9' clip-path='url(#c)'/>",
        ),
        cycle(
            "a clip of what it clips",
            "<clipPath id='c'><use href='#x'/></clipPath><circle id='x' r='9' clip-path='url(#c)'/>",
        ),
        cycle("a gradient of itself", "<linearGradient id='g' href='#g'/><circle r='9' fill='url(#g)'/>"),
        cycle(
            "two gradients of each other",
            "<linearGradient id='g' href='#h'/><radialGradient id='h' href='#g'/><circle r='9' fill='url(#g)'/>",
        ),
        cycle(
            "a pattern of itself",
            "<pattern id='p' width='9' height='9'><rect width='9' height='9' fill='url(#p)'/></pattern><circle r='9' fill='url(#p)'/>",
        ),
        cycle("a mask of itself", "<mask id='m'><circle r='9' mask='url(#m)'/></mask><circle r='9' mask='url(#m)'/>"),
        cycle(
            "a marker in itself",
            "<marker id='k'><path d='M0 0L3 3' marker-end='url(#k)'/></marker><path d='M0 0L9 9' stroke='red' marker-end='url(#k)'/>",
        ),
        cycle(
            "a filter of itself",
            "<filter id='f'><feImage href='#x'/></filter><circle id='x' r='9' filter='url(#f)'/>",
        ),
        cycle("a use of the page", "<use href='#top'/>"),
    ]
}

fn bombs() -> Vec<Case> {
    let mut cases = Vec::new();
    for (levels, each) in [(9, 10), (20, 2), (4, 100)] {
        let mut text = String::from("<defs><circle id='u0' r='1'/>");
        for k in 1..=levels {
            text += &format!("<g id='u{k}'>{}</g>", format!("<use href='#u{}'/>", k - 1).repeat(each));
        }
        cases.push(Case::fill(
            format!("{each} uses on {levels} levels"),
            dots_and(&format!("{text}</defs><use href='#u{levels}'/>")),
            REFUSED,
        ));
        let mut entities = String::from("<!DOCTYPE svg [<!ENTITY e0 'aaaaaaaaaa'>");
        for k in 1..=levels {
            entities += &format!("<!ENTITY e{k} '{}'>", format!("&e{};", k - 1).repeat(each));
        }
        let text = format!("{entities}]>{}", dots_and(&format!("<text>&e{levels};</text>")));
        cases.push(Case::fill(format!("{each} entities on {levels} levels"), text, REFUSED));
    }
    cases.push(Case::fill(
        "an entity of itself",
        format!("<!DOCTYPE svg [<!ENTITY e '&e;'>]>{}", dots_and("<text>&e;</text>")),
        REFUSED,
    ));
    cases.push(Case::fill(
        "an external entity",
        format!("<!DOCTYPE svg [<!ENTITY e SYSTEM 'file:///etc/passwd'>]>{}", dots_and("<text>&e;</text>")),
        REFUSED,
    ));
    cases
}

fn other_files() -> Vec<Case> {
    let whole = dots_and("");
    let mut cases = vec![
        Case::fill("an empty file", "", REFUSED),
        Case::fill("blanks", " \n\t ", REFUSED),
        Case::fill("zeros", vec![0; 1000], REFUSED),
        Case::fill("HTML", "<html><body/></html>", REFUSED),
        Case::fill("another namespace", "<svg><circle r='4'/></svg>", REFUSED),
        Case::fill("gzip", [&[0x1F, 0x8B, 8, 0][..], &[7; 50]].concat(), REFUSED),
        Case::fill("PDF", "%PDF-1.4 ...", REFUSED),
        Case::fill("PNG by another name", "\u{89}PNG\r\n", REFUSED),
        Case::fill("half UTF-16", [&[0xFF, 0xFE][..], &[b'<', 0, b's']].concat(), REFUSED),
        Case::fill("broken UTF-8", [whole.as_bytes(), &[0xC3]].concat(), REFUSED),
        Case::fill("two roots", whole.repeat(2), REFUSED),
        Case::fill("a name of a million letters", page(&format!("<{0}/>", "a".repeat(1_000_000))), REFUSED),
        Case::fill(
            "a colour of a million letters",
            dots_and(&format!("<circle r='3' fill='{}'/>", "a".repeat(1_000_000))),
            EITHER,
        ),
        Case::fill(
            "a number of a million digits",
            dots_and(&format!("<circle r='{}'/>", "1".repeat(1_000_000))),
            REFUSED,
        ),
        Case::fill(
            "an id of a million letters",
            dots_and(&format!("<circle r='3' id='{}'/>", "a".repeat(1_000_000))),
            EITHER,
        ),
        Case::fill(
            "a picture of nothing",
            dots_and("<image width='9' height='9' href='data:image/png;base64,AAAA'/>"),
            EITHER,
        ),
        Case::fill("an external picture", dots_and("<image width='9' height='9' href='file:///etc/passwd'/>"), EITHER),
    ];
    for share in [1, 10, 30, 50, 70, 90, 99] {
        cases.push(Case::fill(
            format!("{share} per cent of a file"),
            &whole.as_bytes()[..whole.len() * share / 100],
            REFUSED,
        ));
    }
    cases
}
