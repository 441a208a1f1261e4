//! Reading large mesh files: megabytes and triangles per second of each
//! format, and the peak of memory per triangle. The files are made for the
//! purpose, a bumpy sheet of quads cut in two, in a folder that goes again.
//!
//! `cargo bench --bench meshes -- 2e6` takes 2e6 triangles, the default.

#[path = "common/peak.rs"]
mod peak;

use std::{
    env, fs,
    io::{BufWriter, Write},
    path::Path,
    process::Command,
    time::Instant,
};

use nephroid::{
    geometry::TriangleMesh,
    scene::{Inputs, mesh_file},
};
use peak::peak_mebibytes;

const FORMATS: [&str; 5] = [
    "sheet.obj",
    "text.ply",
    "sheet.ply",
    "sheet.stl",
    "sheet.glb",
];

fn main() {
    if let Ok(path) = env::var("NEPHROID_MESH_BENCH") {
        return one(Path::new(&path));
    }
    let triangles = env::args().skip(1).find_map(|a| a.parse::<f64>().ok());
    let cells = (triangles.unwrap_or(2e6) / 2.0).sqrt().ceil() as u32;
    let folder = tempfile::tempdir().unwrap_or_else(|e| panic!("{e}"));
    let program = env::current_exe().unwrap_or_else(|e| panic!("{e}"));
    report(
        "file         MiB   read s   MiB/s   build s   triangles   peak B/triangle, read and built",
    );
    for name in FORMATS {
        let path = folder.path().join(name);
        let file = fs::File::create(&path).unwrap_or_else(|e| panic!("{e}"));
        let mut out = BufWriter::new(file);
        let written = match name {
            "sheet.obj" => Sheet(cells).obj(&mut out),
            "text.ply" => Sheet(cells).ply(&mut out, true),
            "sheet.ply" => Sheet(cells).ply(&mut out, false),
            "sheet.stl" => Sheet(cells).stl(&mut out),
            _ => Sheet(cells).glb(&mut out),
        };
        written
            .and_then(|()| out.flush())
            .unwrap_or_else(|e| panic!("{e}"));
        let child = Command::new(&program)
            .env("NEPHROID_MESH_BENCH", &path)
            .status();
        assert!(child.is_ok_and(|status| status.success()), "{name} failed");
        fs::remove_file(&path).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Reads one file in a process of its own.
fn one(path: &Path) {
    let size = fs::metadata(path).map_or(0, |m| m.len()) as f64 / f64::from(1 << 20);
    let start = Instant::now();
    let mesh = mesh_file::read(path, &|_| {}, &Inputs::default())
        .unwrap_or_else(|e| panic!("{}", e.render(false)));
    let read = start.elapsed().as_secs_f64();
    let count = mesh.triangles.len() as f64;
    let after_reading = peak_mebibytes();
    let start = Instant::now();
    let built = TriangleMesh::new(mesh.vertices, mesh.normals, mesh.triangles);
    let build = start.elapsed().as_secs_f64();
    let built = built.unwrap_or_else(|e| panic!("{e}"));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let per_triangle = |mebibytes: f64| mebibytes * f64::from(1 << 20) / count;
    report(&format!(
        "{name:<10} {size:>6.0} {read:>8.2} {:>7.0} {build:>9.2} {:>11} {:>10.0} {:>6.0}",
        size / read,
        built.triangle_count(),
        per_triangle(after_reading),
        per_triangle(peak_mebibytes()),
    ));
}

/// So many cells along each side.
struct Sheet(u32);

impl Sheet {
    fn vertices(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        let n = self.0;
        let along = move |i: u32| i as f32 / n as f32;
        (0..=n).flat_map(move |j| {
            (0..=n).map(move |i| [along(i), along(j), 0.01 * ((i * 7 + j * 13) % 17) as f32])
        })
    }

    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        let n = self.0;
        (0..n).flat_map(move |j| {
            (0..n).flat_map(move |i| {
                let a = j * (n + 1) + i;
                [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
            })
        })
    }

    fn obj(&self, out: &mut impl Write) -> std::io::Result<()> {
        for [x, y, z] in self.vertices() {
            writeln!(out, "v {x} {y} {z}")?;
        }
        for [a, b, c] in self.triangles() {
            writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1)?;
        }
        Ok(())
    }

    fn ply(&self, out: &mut impl Write, text: bool) -> std::io::Result<()> {
        let format = if text {
            "ascii"
        } else {
            "binary_little_endian"
        };
        let (v, f) = ((self.0 + 1) * (self.0 + 1), 2 * self.0 * self.0);
        writeln!(
            out,
            "ply\nformat {format} 1.0\nelement vertex {v}\nproperty float x"
        )?;
        writeln!(out, "property float y\nproperty float z\nelement face {f}")?;
        writeln!(out, "property list uchar int vertex_indices\nend_header")?;
        for p in self.vertices() {
            if text {
                writeln!(out, "{} {} {}", p[0], p[1], p[2])?;
            } else {
                put(out, p.map(f32::to_le_bytes))?;
            }
        }
        for t in self.triangles() {
            if text {
                writeln!(out, "3 {} {} {}", t[0], t[1], t[2])?;
            } else {
                out.write_all(&[3])?;
                put(out, t.map(u32::to_le_bytes))?;
            }
        }
        Ok(())
    }

    fn stl(&self, out: &mut impl Write) -> std::io::Result<()> {
        let vertices: Vec<[f32; 3]> = self.vertices().collect();
        out.write_all(&[b' '; 80])?;
        out.write_all(&(2 * self.0 * self.0).to_le_bytes())?;
        for t in self.triangles() {
            out.write_all(&[0; 12])?;
            for i in t {
                put(out, vertices[i as usize].map(f32::to_le_bytes))?;
            }
            out.write_all(&[0; 2])?;
        }
        Ok(())
    }

    fn glb(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (v, f) = ((self.0 + 1) * (self.0 + 1), 2 * self.0 * self.0);
        let (positions, indices) = (12 * v, 12 * f);
        let mut json = format!(
            r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
            "accessors": [
                {{"bufferView": 0, "componentType": 5126, "count": {v}, "type": "VEC3"}},
                {{"bufferView": 1, "componentType": 5125, "count": {}, "type": "SCALAR"}}],
            "bufferViews": [
                {{"buffer": 0, "byteLength": {positions}}},
                {{"buffer": 0, "byteOffset": {positions}, "byteLength": {indices}}}],
            "buffers": [{{"byteLength": {}}}]}}"#,
            3 * f,
            positions + indices
        );
        while json.len() % 4 != 0 {
            json.push(' ');
        }
        let size = 28 + json.len() as u32 + positions + indices;
        out.write_all(b"glTF\x02\0\0\0")?;
        put(out, [size, json.len() as u32].map(u32::to_le_bytes))?;
        out.write_all(b"JSON")?;
        out.write_all(json.as_bytes())?;
        out.write_all(&(positions + indices).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        for p in self.vertices() {
            put(out, p.map(f32::to_le_bytes))?;
        }
        for t in self.triangles() {
            put(out, t.map(u32::to_le_bytes))?;
        }
        Ok(())
    }
}

fn put<const N: usize>(out: &mut impl Write, words: [[u8; 4]; N]) -> std::io::Result<()> {
    words.iter().try_for_each(|w| out.write_all(w))
}

#[allow(clippy::print_stdout, reason = "a bench speaks to whoever runs it")]
fn report(line: &str) {
    println!("{line}");
}
