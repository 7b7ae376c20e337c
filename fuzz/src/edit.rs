//! Feeds results to those who edit them: the first bytes say what is edited, the others are the file, whose format its content tells.
#![no_main]

use arabesque::{Edit, EditSession, Format, Insertion, Resources};
use arabesque_fuzz::limits;
use libfuzzer_sys::{
    arbitrary::{Result, Unstructured},
    fuzz_target,
};

/// The name may tell the format.
const NAMES: [&str; 4] = ["fuzz.svg", "fuzz.json", "fuzz.csv", "fuzz.glb"];
/// Bytes that say what is edited.
const HEAD: usize = 16;

fuzz_target!(|data: &[u8]| {
    if data.len() < HEAD {
        return;
    }
    let (head, file) = data.split_at(HEAD);
    let mut u = Unstructured::new(head);
    let resources = Resources { limits: limits(), ..Resources::default() };
    let name = NAMES[usize::from(head[HEAD - 1]) % NAMES.len()];
    let mut session = match EditSession::open(name, file.to_vec(), &resources) {
        Ok(session) => session,
        Err(error) => return assert!(error.to_string().len() < 3000, "a message without end: {error}"),
    };
    let Ok(edit) = edit(&mut u, &session) else { return };
    let before = session.items().len();
    let Ok(proposal) = session.propose(&edit) else { return };
    let (deleted, inserted) = (edit.delete, !edit.insert.is_empty());
    let _ = session.preview(&proposal, None);
    if session.apply(&proposal).is_ok() {
        let changed = proposal.changed.len();
        let expected = if deleted { before - changed } else { before + if inserted { changed } else { 0 } };
        assert_eq!(session.items().len(), expected);
        let again = EditSession::open(name, session.bytes().to_vec(), &resources);
        assert!(again.is_ok_and(|again| again.items().len() == expected), "what was edited is not read again");
    }
    let _ = session.encode(Some(Format::Png));
});

/// A change of one or two of the elements.
fn edit(u: &mut Unstructured<'_>, session: &EditSession) -> Result<Edit> {
    let items = session.items();
    let mut named = Vec::new();
    for _ in 0..u.int_in_range(1..=2u8)? {
        named.push(usize::from(u.arbitrary::<u8>()?) % items.len().max(1));
    }
    let mut edit = Edit::of_items(named);
    let number = |u: &mut Unstructured<'_>| u.arbitrary::<i8>().map(|n| f64::from(n) / 16.0);
    match u.int_in_range(0..=6u8)? {
        0 => edit.shift = vec![number(u)?; session.dimension()],
        1 => edit.turn = Some(20.0 * number(u)?),
        2 => edit.scale = Some(number(u)?),
        3 => edit.delete = true,
        4 => {
            let class = items.first().map(|item| item.class.clone()).unwrap_or_default();
            edit.insert.push(Insertion { class, at: vec![number(u)?; session.dimension()] });
        }
        5 => edit.class = items.last().map(|item| item.class.clone()),
        _ => edit.set = [("fill".to_owned(), "#09f".to_owned())].into(),
    }
    if u.arbitrary()? {
        edit.propagate = Some(f64::from(u.arbitrary::<u8>()?) / 64.0);
    }
    Ok(edit)
}
