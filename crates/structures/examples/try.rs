#![allow(
    missing_docs,
    clippy::all,
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "scratch"
)]
use arabesque_core::*;
use arabesque_structures::*;
use std::{sync::Arc, time::Instant};
fn load<const D: usize>(path: &str) -> PointSet<D> {
    let text = std::fs::read_to_string(path).unwrap();
    let (names, body): (Vec<String>, Vec<&str>) = if path.ends_with("csv") {
        let mut l = text.lines();
        let h = l.next().unwrap();
        (h.split(',').map(str::to_owned).collect(), l.collect())
    } else {
        let mut names = vec![];
        let mut it = text.lines();
        for l in it.by_ref() {
            if let Some(r) = l.strip_prefix("property ") {
                names.push(r.split(' ').last().unwrap().to_owned());
            }
            if l == "end_header" {
                break;
            }
        }
        (names, it.collect())
    };
    let rows: Vec<Vec<f64>> = body
        .iter()
        .filter(|l| !l.trim().is_empty())
        .map(|l| l.split(|c| c == ' ' || c == ',').map(|v| v.parse().unwrap()).collect())
        .collect();
    let col = |n: &str| names.iter().position(|x| x == n);
    let vec = |n: [&str; 3]| -> Option<Vec<Vector<D>>> {
        let c: Option<Vec<usize>> = n[..D].iter().map(|n| col(n)).collect();
        let c = c?;
        Some(rows.iter().map(|r| Vector(std::array::from_fn(|k| r[c[k]]))).collect())
    };
    let mut p = PointSet::at(vec(["x", "y", "z"]).unwrap());
    p.normals = vec(["nx", "ny", "nz"]).map(|n| n.into_iter().map(|n| n.unit()).collect());
    p.radii = col("radius").map(|c| rows.iter().map(|r| r[c]).collect());
    p.groups = col("group").or(None).map(|c| rows.iter().map(|r| r[c] as i32).collect());
    p.elements = col("element").map(|c| rows.iter().map(|r| r[c] as i32).collect());
    if let Some(c) = col("class") {
        p.elements = None;
        p.groups = None;
        p.colours = Some(
            rows.iter()
                .map(|r| {
                    let k = r[c] as usize;
                    [f64::from(u8::from(k == 0)), f64::from(u8::from(k == 1)), f64::from(u8::from(k == 2))]
                })
                .collect(),
        );
    }
    p.colours = p
        .colours
        .or(col("red").map(|c| rows.iter().map(|r| [r[c] / 255.0, r[c + 1] / 255.0, r[c + 2] / 255.0]).collect()));
    p
}
fn save<const D: usize>(path: &str, p: &PointSet<D>, class: bool) {
    let mut s = String::new();
    if path.ends_with("csv") {
        s += if class { "x,y,class\n" } else { "x,y\n" };
        for i in 0..p.len() {
            s += &format!("{},{}", p.positions[i][0], p.positions[i][1]);
            if class {
                let c = p.colours.as_ref().unwrap()[i];
                let k = (0..3).max_by(|&a, &b| c[a].total_cmp(&c[b])).unwrap();
                s += &format!(",{k}");
            }
            s += "\n";
        }
    } else {
        s += &format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
            p.len()
        );
        if p.normals.is_some() {
            s += "property float nx\nproperty float ny\nproperty float nz\n";
        }
        if p.radii.is_some() {
            s += "property float radius\n";
        }
        if p.colours.is_some() {
            s += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
        }
        if p.groups.is_some() {
            s += "property int group\n";
        }
        if p.elements.is_some() {
            s += "property int element\n";
        }
        s += "end_header\n";
        for i in 0..p.len() {
            let v = |v: Vector<D>| (0..D).map(|k| format!("{:.6} ", v[k])).collect::<String>();
            s += &v(p.positions[i]);
            if let Some(n) = &p.normals {
                s += &v(n[i]);
            }
            if let Some(n) = &p.radii {
                s += &format!("{:.6} ", n[i]);
            }
            if let Some(n) = &p.colours {
                s += &n[i].map(|c| format!("{} ", (c * 255.0).round())).concat();
            }
            if let Some(n) = &p.groups {
                s += &format!("{} ", n[i]);
            }
            if let Some(n) = &p.elements {
                s += &format!("{} ", n[i]);
            }
            s += "\n";
        }
    }
    std::fs::write(path, s).unwrap();
}
struct Show(bool);
impl<P> Watch<P> for Show {
    fn step(&mut self, p: &Progress, _: &dyn Fn() -> P) -> std::ops::ControlFlow<()> {
        if self.0 {
            eprintln!("{p}");
        }
        std::ops::ControlFlow::Continue(())
    }
}
fn go<const D: usize>(a: &[String]) {
    let p = Arc::new(load::<D>(&a[1]));
    let class = p.colours.is_some() && a[1].ends_with("csv");
    let mut params = StructureParams::default();
    let mut seed = 0;
    let mut v = false;
    let mut along = None;
    let mut size: Vec<f64> = vec![1.0; D];
    for kv in &a[3..] {
        let (k, x) = kv.split_once('=').unwrap();
        match k {
            "seed" => seed = x.parse().unwrap(),
            "v" => v = true,
            "along" => along = Some(x.to_owned()),
            "size" => size = x.split('x').map(|v| v.parse().unwrap()).collect(),
            _ => params.set(k, x).unwrap(),
        }
    }
    let t = Instant::now();
    let budget = Budget::new(Limits { work: 1 << 30, ..Limits::default() });
    let prep = Prepared::<D>::new(p, &params, &budget).unwrap();
    eprintln!(
        "spacing {:.4} window {:.4} repetition {:?} repeats {} prep {:.2?}",
        prep.spacing(),
        prep.window(),
        (prep.repetition(), prep.regularity()),
        prep.repeats(),
        t.elapsed()
    );
    if std::env::var("PREP").is_ok() { return; }
    let territory: Arc<dyn Territory<D>> = match along {
        Some(f) => {
            let text = std::fs::read_to_string(f).unwrap();
            let vs: Vec<Vector<D>> = text
                .lines()
                .filter(|l| l.starts_with("v "))
                .map(|l| {
                    let c: Vec<f64> = l[2..].split(' ').map(|v| v.parse().unwrap()).collect();
                    Vector(std::array::from_fn(|k| c[k]))
                })
                .collect();
            let ls: Vec<usize> = text.lines().find(|l| l.starts_with("l ")).unwrap()[2..]
                .split(' ')
                .map(|v| v.parse::<usize>().unwrap() - 1)
                .collect();
            Arc::new(Tube::new(vec![Thread::new(ls.iter().map(|&i| vs[i]).collect())], 0.2).unwrap())
        }
        None => Arc::new(Flat::new(
            Domain::Box(Bounds::new(Vector::ZERO, Vector(std::array::from_fn(|k| size[k])))),
            Fields::default(),
        )),
    };
    let mut request = StructureRequest::new(territory);
    request.seed = seed;
    request.budget = budget;
    let out = prep.run(&request, &mut Show(v)).unwrap();
    eprintln!("{} points, {:.2?}, work {}", out.points.len(), t.elapsed(), request.budget.work() / 1_000_000);
    save(&a[2], &out.points, class);
}
fn main() { let a: Vec<String> = std::env::args().collect(); if let Some(f) = a.iter().find_map(|x| x.strip_prefix("on=")) { return meshed(&a, true, f); } if let Some(f) = a.iter().find_map(|x| x.strip_prefix("inside=")) { return meshed(&a, false, f); }
    let a: Vec<String> = std::env::args().collect();
    if a[1].ends_with("csv") { go::<2>(&a) } else { go::<3>(&a) }
}
fn mesh(f: &str, budget: &Budget) -> Arc<arabesque_surface::MeshIndex> {
    let text = std::fs::read_to_string(f).unwrap();
    let mut m = TriangleMesh::default();
    for l in text.lines() {
        let t: Vec<&str> = l.split_whitespace().collect();
        match t.first() {
            Some(&"v") => m.positions.push(Vector(std::array::from_fn(|k| t[k + 1].parse().unwrap()))),
            Some(&"f") => { let q: Vec<u32> = t[1..].iter().map(|x| x.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect(); for i in 1..q.len() - 1 { m.triangles.push([q[0], q[i], q[i + 1]]); } }
            _ => {}
        }
    }
    Arc::new(arabesque_surface::MeshIndex::new(&m, f, budget).unwrap())
}
fn meshed(a: &[String], on: bool, file: &str) {
    use arabesque_surface::*;
    let budget = Budget::new(Limits { work: 1 << 30, ..Limits::default() });
    let index = mesh(file, &budget);
    let mut params = StructureParams::default(); let mut seed = 0;
    for kv in &a[3..] { let (k, x) = kv.split_once('=').unwrap(); match k { "seed" => seed = x.parse().unwrap(), "on" | "inside" => {} _ => params.set(k, x).unwrap() } }
    let prep = Prepared::<3>::new(Arc::new(load::<3>(&a[1])), &params, &budget).unwrap();
    let territory: Arc<dyn Territory<3>> = if on {
        let d = DirectionField::new(&index, &Directions::Curvature(Bend::Least), &budget).unwrap();
        Arc::new(Shell::new(index, Arc::new(d), ScalarField::Constant(1.0)))
    } else { Arc::new(Solid::new(index, 1.0, Fields::default())) };
    let t = Instant::now();
    let mut request = StructureRequest::new(territory);
    request.seed = seed; request.budget = budget;
    let out = prep.run(&request, &mut Show(false)).unwrap();
    eprintln!("{} points, {:.2?}, work {}", out.points.len(), t.elapsed(), request.budget.work() / 1_000_000);
    save(&a[2], &out.points, false);
}
