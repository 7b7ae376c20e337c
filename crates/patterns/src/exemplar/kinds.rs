//! Kinds: classes divided by colour, where a class clearly comes in several colours.
//!
//! Chips of one name in four colours are four kinds of chip: each keeps its number, and only chips of a colour
//! correspond.

use arabesque_core::Exemplar;

/// Colours of one kind differ by less than this from its first, Euclidean in sRGB.
const DIFFERENCE: f64 = 0.15;

/// A class is only divided when every kind gets this many elements.
const MIN_MEMBERS: usize = 4;

/// And this share of its elements.
const MIN_SHARE: f64 = 0.08;

/// Kind of each element, numbered from 0 without gaps, and how many kinds there are.
pub(crate) fn kinds<const D: usize>(exemplar: &Exemplar<D>) -> (Vec<u32>, usize) {
    let mut kind = vec![0; exemplar.elements.len()];
    let mut count = 0;
    let mut members_of = vec![Vec::new(); exemplar.classes.len()];
    exemplar.elements.iter().enumerate().for_each(|(e, element)| members_of[element.class].push(e));
    for members in members_of {
        let colours: Vec<[f64; 3]> = members.iter().map(|&e| exemplar.elements[e].colour).collect();
        let (label, groups) = group(&colours);
        members.iter().zip(label).for_each(|(&e, l)| kind[e] = (count + l) as u32);
        count += groups.max(usize::from(!members.is_empty()));
    }
    (kind, count)
}

/// Groups of alike colours, or one group where the colours do not fall apart into sizeable ones.
fn group(colours: &[[f64; 3]]) -> (Vec<usize>, usize) {
    let mut first: Vec<[f64; 3]> = Vec::new();
    let mut sizes: Vec<usize> = Vec::new();
    let mut label = Vec::with_capacity(colours.len());
    for colour in colours {
        let known = first.iter().position(|c| distance(c, colour) < DIFFERENCE);
        let l = known.unwrap_or(first.len());
        if known.is_none() {
            first.push(*colour);
            sizes.push(0);
        }
        sizes[l] += 1;
        label.push(l);
        if first.len() > 32 {
            return (vec![0; colours.len()], 1);
        }
    }
    let least = MIN_MEMBERS.max((MIN_SHARE * colours.len() as f64) as usize);
    if sizes.iter().all(|&n| n >= least) { (label, first.len()) } else { (vec![0; colours.len()], 1) }
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_red_and_four_blue_are_two_kinds() {
        let colours: Vec<_> = (0..8).map(|i| if i % 2 == 0 { [0.9, 0.1, 0.1] } else { [0.1, 0.1, 0.9] }).collect();
        assert_eq!(group(&colours), (vec![0, 1, 0, 1, 0, 1, 0, 1], 2));
    }

    #[test]
    fn a_single_odd_one_does_not_divide_a_class() {
        let mut colours = vec![[0.9, 0.1, 0.1]; 8];
        colours[3] = [0.0, 0.0, 0.0];
        assert_eq!(group(&colours), (vec![0; 8], 1));
    }
}
