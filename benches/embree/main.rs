//! Rays through meshes beside Embree, on this machine and in one run: one
//! thread, one ray at a time, Embree in its robust mode.
//!
//! `cargo bench --bench embree [-- --quick]`. Needs a C++ compiler and Embree 3
//! (on Debian: `apt install g++ libembree-dev`); without them ours is measured
//! alone. Rounds of the two alternate, and the fastest of each counts.
#![allow(clippy::print_stdout, reason = "a table is what it is for")]

#[path = "../common/knot.rs"]
mod knot;

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    process::Command,
    time::Instant,
};

use glam::DVec3;
use nephroid::geometry::{Aabb, Ray, TriangleMesh, World, bvh::Bvh};

use knot::{bounce, knot, primary, world};

/// A kind of question and its rays.
struct Questions {
    name: &'static str,
    any: bool,
    t_max: f64,
    rays: Vec<Ray>,
}

/// What one side needs for one kind.
#[derive(Clone, Copy, Debug)]
struct Answer {
    nanoseconds: f64,
    hits: u64,
    sum: f64,
}

/// Alternating rounds.
const ROUNDS: usize = 3;

fn main() -> io::Result<()> {
    let quick = std::env::args().any(|a| a == "--quick");
    let folder = tempfile::tempdir()?;
    let rival = compile(folder.path());
    if rival.is_none() {
        println!("no C++ compiler or no Embree 3: nephroid alone");
    }
    let sizes: &[_] = if quick {
        &[(512, 100)]
    } else {
        &[(512, 100), (2048, 256)]
    };
    println!("| triangles | rays | nephroid Mray/s | Embree Mray/s | ratio |");
    println!("|---|---|---|---|---|");
    for &size in sizes {
        compare(size, rival.as_deref(), folder.path())?;
    }
    Ok(())
}

fn compare(size: (u32, u32), rival: Option<&Path>, folder: &Path) -> io::Result<()> {
    let world = world(size);
    let kinds = questions(&world);
    let files = write_files(size, &kinds, folder)?;
    let triangles = 2 * size.0 * size.1;
    let mut best: Vec<[Option<Answer>; 2]> = vec![[None; 2]; kinds.len()];
    let mut build = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        let [tree, mesh] = build_times(size);
        build[0] = build[0].min(tree);
        build[2] = build[2].min(mesh);
        for (kind, best) in kinds.iter().zip(&mut best) {
            better(&mut best[0], answer(&world, kind));
        }
        if let Some(rival) = rival {
            let (time, answers) = ask(rival, &files)?;
            build[1] = build[1].min(time);
            for (answer, best) in answers.into_iter().zip(&mut best) {
                better(&mut best[1], answer);
            }
        }
    }
    let mut ratios = Vec::new();
    for (kind, [ours, theirs]) in kinds.iter().zip(best) {
        let rate = |a: Answer| kind.rays.len() as f64 / a.nanoseconds * 1e3;
        let Some(ours) = ours else { continue };
        let Some(theirs) = theirs else {
            println!("| {triangles} | {} | {:.2} | | |", kind.name, rate(ours));
            continue;
        };
        agree(kind, &ours, &theirs);
        let ratio = rate(ours) / rate(theirs);
        ratios.push(ratio);
        println!(
            "| {triangles} | {} | {:.2} | {:.2} | {ratio:.2} |",
            kind.name,
            rate(ours),
            rate(theirs)
        );
    }
    if !ratios.is_empty() {
        let mean = ratios.iter().map(|r| r.ln()).sum::<f64>() / ratios.len() as f64;
        println!("| {triangles} | geometric mean | | | {:.2} |", mean.exp());
        let [tree, theirs, mesh] = build.map(|t| t * 1e-9);
        for (what, ours) in [("tree", tree), ("mesh with its checks", mesh)] {
            let ratio = ours / theirs;
            println!(
                "| {triangles} | build the {what}, s | {ours:.3} | {theirs:.3} | {ratio:.2} |"
            );
        }
    }
    Ok(())
}

fn questions(world: &World) -> Vec<Questions> {
    let seen = primary(512);
    let bounced = bounce(world, &seen);
    let closest = |name, rays| Questions {
        name,
        any: false,
        t_max: f64::INFINITY,
        rays,
    };
    let any = |name, rays| Questions {
        name,
        any: true,
        t_max: 4.0,
        rays,
    };
    vec![
        closest("primary, closest", seen),
        closest("bounce, closest", bounced.clone()),
        closest("chords, closest", chords(1 << 18)),
        any("bounce, any within 4", bounced),
        any("chords, any within 4", chords(1 << 18)),
    ]
}

/// Chords between scattered points of a sphere around everything.
fn chords(count: usize) -> Vec<Ray> {
    let place = |i: usize| knot::scattered(i) * 4.0;
    let chord = |i: usize| {
        let (from, to) = (place(i), place(i * 7 + 3));
        Ray::new(from, (to - from).try_normalize().unwrap_or(DVec3::X))
    };
    (0..count).map(chord).collect()
}

fn answer(world: &World, kind: &Questions) -> Answer {
    let start = Instant::now();
    let (mut hits, mut sum) = (0, 0.0);
    for ray in &kind.rays {
        if kind.any {
            hits += u64::from(world.occluded(ray, kind.t_max, |_| false));
        } else if let Some(hit) = world.closest(ray, kind.t_max) {
            hits += 1;
            sum += hit.t;
        }
    }
    Answer {
        nanoseconds: start.elapsed().as_secs_f64() * 1e9,
        hits,
        sum,
    }
}

/// Nanoseconds to build the tree alone, and the whole mesh, in which the
/// triangles are checked and sorted; on one thread.
fn build_times(size: (u32, u32)) -> [f64; 2] {
    let (positions, triangles) = knot(size.0, size.1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("one thread").install(|| {
        let start = Instant::now();
        let corners = |i: usize| Aabb::around(triangles[i].map(|v| positions[v as usize]));
        let (_, order) = Bvh::build(triangles.len(), 4, corners);
        let tree = start.elapsed().as_secs_f64() * 1e9;
        assert_eq!(order.len(), triangles.len());
        let start = Instant::now();
        let mesh = TriangleMesh::new(positions, None, triangles);
        let whole = start.elapsed().as_secs_f64() * 1e9;
        assert!(mesh.is_ok(), "a sound mesh");
        [tree, whole]
    })
}

fn better(best: &mut Option<Answer>, new: Answer) {
    if best.is_none_or(|b| new.nanoseconds < b.nanoseconds) {
        *best = Some(new);
    }
}

/// Single precision moves a few rays past an edge, no more.
fn agree(kind: &Questions, ours: &Answer, theirs: &Answer) {
    let (a, b) = (ours.hits as f64, theirs.hits as f64);
    assert!((a - b).abs() <= 1e-3 * a, "{}: {a} hits, {b}", kind.name);
    let off = (ours.sum - theirs.sum).abs();
    assert!(off <= 1e-3 * ours.sum, "{}: sums {off} apart", kind.name);
}

fn compile(folder: &Path) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/embree/embree.cpp");
    let program = folder.join("embree");
    let status = Command::new("c++")
        .args(["-O3", "-std=c++17"])
        .arg(source)
        .args(["-lembree3", "-o"])
        .arg(&program)
        .status();
    status.ok()?.success().then_some(program)
}

fn write_files(size: (u32, u32), kinds: &[Questions], folder: &Path) -> io::Result<Vec<PathBuf>> {
    let (positions, triangles) = knot(size.0, size.1);
    let mesh = folder.join("mesh");
    let mut out = BufWriter::new(File::create(&mesh)?);
    for count in [positions.len(), triangles.len()] {
        out.write_all(&(count as u32).to_le_bytes())?;
    }
    for x in positions.iter().flat_map(|p| p.as_vec3().to_array()) {
        out.write_all(&x.to_le_bytes())?;
    }
    for i in triangles.iter().flatten() {
        out.write_all(&i.to_le_bytes())?;
    }
    out.flush()?;
    let mut files = vec![mesh];
    for (i, kind) in kinds.iter().enumerate() {
        let path = folder.join(format!("rays{i}"));
        fs::write(&path, ray_bytes(kind))?;
        files.push(path);
    }
    Ok(files)
}

fn ray_bytes(kind: &Questions) -> Vec<u8> {
    let mut bytes = vec![if kind.any { b'a' } else { b'c' }];
    bytes.extend((kind.rays.len() as u32).to_le_bytes());
    for ray in &kind.rays {
        // The rival's only guard against meeting what a ray leaves: a fixed
        // distance.
        let near = if ray.leaving.is_some() { 1e-4 } else { 0.0 };
        let numbers = ray.origin.to_array().into_iter().chain(ray.dir.to_array());
        for x in numbers.chain([near, kind.t_max]) {
            bytes.extend((x as f32).to_le_bytes());
        }
    }
    bytes
}

/// The rival's time to build and its answers.
fn ask(program: &Path, files: &[PathBuf]) -> io::Result<(f64, Vec<Answer>)> {
    let out = Command::new(program).args(files).output()?;
    let text = String::from_utf8_lossy(&out.stdout).into_owned();
    let number = |word: Option<&str>| word.and_then(|w| w.parse::<f64>().ok()).unwrap_or(f64::NAN);
    let mut lines = text.lines();
    let build = number(lines.next());
    let answers = lines.map(|line| {
        let mut words = line.split(' ');
        Answer {
            nanoseconds: number(words.next()),
            hits: number(words.next()) as u64,
            sum: number(words.next()),
        }
    });
    Ok((build, answers.collect()))
}
