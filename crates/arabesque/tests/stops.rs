//! Stopped at any check, from the first byte read to the last one encoded, every job leaves a valid file or a clean error.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use arabesque::{
    Error, Fill, Input, Job, OutputOptions, Recipe, Redo, Region, Resources, Ribbon, Space, StopReason, Stopper,
    Unobserved, in_pool,
};

/// Places at which each job is stopped.
const PLACES: u64 = 64;

fn svg(body: &str) -> Vec<u8> {
    format!("<svg xmlns='http://www.w3.org/2000/svg' width='120' height='80' viewBox='0 0 120 80'>{body}</svg>")
        .into_bytes()
}

fn dots() -> String {
    (0..24).map(|k| format!("<circle cx='{}' cy='{}' r='{}'/>", 10 + k % 6 * 20, 10 + k / 6 * 20, 4 + k % 3)).collect()
}

/// What a job reads, and the job.
fn jobs() -> Vec<(&'static str, Vec<u8>, Job)> {
    let weave: String = (0..6)
        .map(|k| format!("<path d='M{0} 0V80M0 {1}H120' stroke='red' fill='none'/>", 10 + k * 20, 7 + k * 13))
        .collect();
    let strip = "<rect y='36' width='120' height='8'/><circle cx='40' cy='40' r='20'/><circle cx='90' cy='40' r='14'/>";
    let cube: String = (0..64).map(|k| format!("{},{},{}\n", k % 4, k / 4 % 4, k / 16)).collect();
    let along =
        Input::file("along.svg").embedding(&svg("<path d='M5 30C50 0 90 70 115 30' stroke='red' fill='none'/>"));
    vec![
        ("dots.svg", svg(&dots()), Fill::page("90x60".parse().unwrap()).into()),
        ("weave.svg", svg(&weave), Fill::page("90x60".parse().unwrap()).into()),
        ("page.svg", svg(&dots()), Redo::of(Region::parse("30,20,50,40").unwrap()).into()),
        ("cube.csv", format!("x,y,z\n{cube}").into_bytes(), Space::new("4x4x4".parse().unwrap()).into()),
        ("strip.svg", svg(strip), Ribbon { scale: Some(0.3), ..Ribbon::new(along) }.into()),
    ]
}

/// The file of a job that is stopped at a check, and whether its run was; the error where there is none.
fn made(name: &str, bytes: &[u8], job: &Job, stopper: &Stopper) -> Result<(Vec<u8>, StopReason), Error> {
    let resources = Resources { stopper: stopper.clone(), ..Resources::default() }.with_input(name, bytes);
    let prepared = Recipe::new(Input::file(name), job.clone()).prepare(&resources)?;
    let artwork = prepared.run(&prepared.request(), &mut Unobserved)?;
    Ok((artwork.encode(&OutputOptions::default())?.bytes, artwork.stopped()))
}

/// Whether a file is whole, by what begins and ends it.
fn is_whole(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xaeB`\x82")
        || text.starts_with("<?xml") && text.trim_end().ends_with("</svg>")
        || text.starts_with("<svg") && text.trim_end().ends_with("</svg>")
        || text.starts_with("x,y,z") && text.ends_with('\n')
}

#[test]
fn every_job_stops_at_every_check() {
    for (name, bytes, job) in jobs() {
        let all = Stopper::at_check(u64::MAX);
        let (whole, ended) = made(name, &bytes, &job, &all).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(is_whole(&whole) && ended == StopReason::Finished, "{name}");
        let checks = all.checks();
        let mut stopped = 0;
        for k in 0..PLACES {
            let n = 1 + k * checks.saturating_sub(1) / PLACES;
            let run = |threads| in_pool(Some(threads), || made(name, &bytes, &job, &Stopper::at_check(n))).unwrap();
            let (one, three) = (run(1), run(3));
            match (&one, &three) {
                (Ok(one), Ok(three)) => assert!(one == three && is_whole(&one.0), "{name}: check {n} of {checks}"),
                (Err(Error::Stopped { stage: one, .. }), Err(Error::Stopped { stage: three, .. })) if one == three => {
                    stopped += 1;
                }
                _ => panic!("{name}: check {n} of {checks}: {:?}, {:?}", one.map(|m| m.1), three.map(|m| m.1)),
            }
        }
        assert!(stopped > 0, "{name}: the first check is before there is anything");
    }
}
