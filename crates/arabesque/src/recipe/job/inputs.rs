//! The files that a job reads, each with the option that wants it.

use crate::recipe::{
    field::FieldSource,
    input::Input,
    job::{Direction, Job},
    region::Region,
};

/// A file, and the option that wants it.
type Wanted<'a> = (&'static str, &'a Input);

impl Job {
    /// Every file that the job reads, with the option that wants it.
    pub(crate) fn inputs(&self) -> Vec<Wanted<'_>> {
        let mut wanted = Vec::new();
        match self {
            Self::Fill(job) => {
                wanted.extend(job.domain.iter().map(|input| ("--domain", input)));
                wanted.extend(job.keep.iter().map(|input| ("--keep", input)));
                wanted.extend(field("--orient", job.orient.as_ref()));
                wanted.extend(field("--scale", job.scale.as_ref()));
                wanted.extend(field("--density", job.density.as_ref()));
                wanted.extend(avoided(&job.avoid));
            }
            Self::Redo(job) => {
                let own = if job.from.is_some() { "--to" } else { "--redo" };
                wanted.extend(region(own, Some(&job.region)));
                wanted.extend(region("--from", job.from.as_ref()));
                wanted.extend(field("--orient", job.orient.as_ref()));
                wanted.extend(field("--scale", job.scale.as_ref()));
                wanted.extend(field("--density", job.density.as_ref()));
                wanted.extend(avoided(&job.avoid));
            }
            Self::Space(job) => {
                wanted.extend(job.inside.iter().map(|input| ("--inside", input)));
                wanted.extend(job.on.iter().map(|input| ("--on", input)));
                wanted.extend(job.along.iter().map(|input| ("--along", input)));
                wanted.extend(job.keep.iter().map(|input| ("--keep", input)));
                wanted.extend(avoided(&job.avoid));
                wanted.extend(field("--orient", job.orient.as_ref()));
                if let Some(Direction::Strokes(input)) = &job.direction {
                    wanted.push(("--direction", input));
                }
                wanted.extend(field("--scale", job.scale.as_ref()));
                wanted.extend(field("--density", job.density.as_ref()));
            }
            Self::Ribbon(job) => {
                wanted.push(("--along", &job.along));
                wanted.extend(job.then.iter().map(|input| ("exemplar", input)));
                wanted.extend(avoided(&job.avoid));
            }
            Self::Structures(job) => {
                wanted.extend(job.domain.iter().map(|input| ("--domain", input)));
                wanted.extend(job.along.iter().map(|input| ("--along", input)));
                wanted.extend(job.on.iter().map(|input| ("--on", input)));
                wanted.extend(job.inside.iter().map(|input| ("--inside", input)));
                wanted.extend(job.keep.iter().map(|input| ("--keep", input)));
                wanted.extend(field("--orient", job.orient.as_ref()));
                wanted.extend(field("--scale", job.scale.as_ref()));
                wanted.extend(avoided(&job.avoid));
                if let Some(Direction::Strokes(input)) = &job.direction {
                    wanted.push(("--direction", input));
                }
            }
            Self::Relief(job) => {
                wanted.extend(job.on.iter().map(|input| ("--on", input)));
                if let Some(Direction::Strokes(input)) = &job.direction {
                    wanted.push(("--direction", input));
                }
            }
            Self::Surface(job) => wanted.extend(job.trim.iter().map(|input| ("--trim", input))),
        }
        wanted
    }
}

fn field<'a>(role: &'static str, source: Option<&'a FieldSource>) -> Option<Wanted<'a>> {
    match source? {
        FieldSource::File(field) => Some((role, &field.file)),
        FieldSource::Constant(_) => None,
    }
}

fn region<'a>(role: &'static str, region: Option<&'a Region>) -> Option<Wanted<'a>> {
    match region? {
        Region::Shape(input) => Some((role, input)),
        Region::Box(_) | Region::Own(_) => None,
    }
}

fn avoided(inputs: &[Input]) -> impl Iterator<Item = Wanted<'_>> {
    inputs.iter().map(|input| ("--avoid", input))
}
