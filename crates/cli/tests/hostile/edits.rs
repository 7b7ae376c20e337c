//! Results that are edited, and changes that make no sense.

use crate::case::{Case, DONE, EITHER, REFUSED, USAGE};

/// Refused, as an option that does not suit or as a file that does not.
const TOLD: &[i32] = &[2, 3, 4];

/// A table as `fill` writes it, without its recipe.
fn table(count: usize) -> String {
    let row = |k: usize| format!("{},{},dot\n", k % 20, k / 20);
    "x,y,class\n".to_owned() + &(0..count).map(row).collect::<String>()
}

fn edit(options: &str, codes: &'static [i32]) -> Case {
    let name = format!("an edit with {options}");
    Case::new(name, format!("edit in.csv {options} -o out.csv"), codes).with("in.csv", table(400))
}

fn of_file(name: &str, file: impl Into<Vec<u8>>, codes: &'static [i32]) -> Case {
    Case::new(name, "edit in.csv --item 3 --move 0.1,0 -o out.csv", codes).with("in.csv", file)
}

pub(crate) fn cases() -> Vec<Case> {
    vec![
        edit("--item 3 --move 0.1,0", DONE),
        edit("--item 3 --move 0.1,0 --propagate", DONE),
        edit("--item 3 --move 0.1,0 --propagate=1e9", DONE),
        edit("--item 3 --move nan,0", TOLD),
        edit("--item 3 --move 1e300,0", TOLD),
        edit("--item 3 --move 1", TOLD),
        edit("--item 99999999999999999999 --delete", TOLD),
        edit("--item 400 --delete", TOLD),
        edit("--item 3 --delete --propagate=1e9", TOLD),
        edit("--item 3 --delete --move 1,1", TOLD),
        edit("--item 3 --scale 0", TOLD),
        edit("--item 3 --scale 2", TOLD),
        edit("--item 3 --turn 30", TOLD),
        edit("--item 3 --class nobody", TOLD),
        edit("--item 3 --set fill=red", TOLD),
        edit("--insert dot@1e300,0", TOLD),
        edit("--insert nobody@1,1", TOLD),
        edit("--insert dot@0.5,0.5 --item 3 --propagate=1e9", EITHER),
        edit("--item 3 --move 0.1,0 --radius 1e9 --propagate", EITHER),
        edit("--item 3", TOLD),
        edit("", USAGE),
        of_file("a table of nothing", "", REFUSED),
        of_file("a table of its head alone", "x,y,class\n", REFUSED),
        of_file("a table whose last row has no end", table(20).trim_end(), DONE),
        of_file("a table of one place", "x,y,class\n".to_owned() + &"1,1,dot\n".repeat(3000), EITHER),
        of_file("coordinates of 1e154", table(20) + "1e154,0,dot\n", TOLD),
        of_file("a row that is cut off", table(20) + "3,", TOLD),
        of_file("a class without end", table(20) + "3,4,\"dot\n", TOLD),
        of_file("numbers of elements that are not there", table(20) + "# arabesque ids: 0-99999999999\n", EITHER),
        of_file("zeros", vec![0_u8; 4000], REFUSED),
        of_file("a drawing that is no result", "<svg xmlns='http://www.w3.org/2000/svg'/>", REFUSED),
        of_file("half a result", "{\"elements\":[", REFUSED),
    ]
}
