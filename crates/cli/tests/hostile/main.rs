//! Hostile and unlucky input of every kind, made by generators: each run ends by itself, within the memory limit, with the exit code
//! that it should have and one line that says why.
//!
//! What a run used is counted by the program itself, not timed: a run that is not bounded would not end.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

mod case;
mod drawings;
mod edits;
mod numbers;
mod options;
mod outlines;
mod pictures;
mod points;
mod recipes;
mod reliefs;
mod ribbons;
mod scenes;
mod structure;
mod tables;

use case::{Case, check_all};

/// All families, by name.
fn corpus() -> Vec<(&'static str, Vec<Case>)> {
    vec![
        ("drawings", drawings::cases()),
        ("edits", edits::cases()),
        ("numbers", numbers::cases()),
        ("options", options::cases()),
        ("outlines", outlines::cases()),
        ("pictures", pictures::cases()),
        ("points", points::cases()),
        ("recipes", recipes::cases()),
        ("reliefs", reliefs::cases()),
        ("ribbons", ribbons::cases()),
        ("scenes", scenes::cases()),
        ("structure", structure::cases()),
        ("tables", tables::cases()),
    ]
}

#[test]
fn there_are_at_least_four_hundred_cases() {
    let counts: Vec<_> = corpus().iter().map(|(name, cases)| (*name, cases.len())).collect();
    let total: usize = counts.iter().map(|(_, n)| n).sum();
    assert!(total >= 520, "{total}: {counts:?}");
}

#[test]
fn drawings_of_elements() {
    check_all(drawings::cases());
}

#[test]
fn edits_of_results() {
    check_all(edits::cases());
}

#[test]
fn numbers_in_drawings() {
    check_all(numbers::cases());
}

#[test]
fn options_of_the_program() {
    check_all(options::cases());
}

#[test]
fn outlines_of_domains_and_areas() {
    check_all(outlines::cases());
}

#[test]
fn pictures_as_fields_and_areas() {
    check_all(pictures::cases());
}

#[test]
fn points_as_structures_and_surfaces() {
    check_all(points::cases());
}

#[test]
fn recipes_and_results() {
    check_all(recipes::cases());
}

#[test]
fn reliefs() {
    check_all(reliefs::cases());
}

#[test]
fn scenes_in_space() {
    check_all(scenes::cases());
}

#[test]
fn ribbons_along_curves() {
    check_all(ribbons::cases());
}

#[test]
fn structure_of_files() {
    check_all(structure::cases());
}

#[test]
fn tables_and_meshes() {
    check_all(tables::cases());
}
