//! Runs the photon paths of a pass in fixed chunks, in parallel, and keeps
//! their order.

use rayon::prelude::*;

use crate::{sampling::Sequence, scene::Kernel, transport::Context};

use super::{Emitter, Photon, Tally, trace::trace_watched};

/// Paths in a chunk: large enough to hide the scheduling, small enough to
/// balance. The result does not depend on it except through the rounding of
/// the tally.
const CHUNK: u64 = 4096;

/// Paths in a chunk of those that pilots trace, which are fewer.
const PILOT_CHUNK: u64 = 1024;

/// Traces paths `0 .. count` in fixed chunks, in parallel: what each chunk has
/// gathered, in order. `trace` adds the path of an index to its chunk.
pub(super) fn in_chunks<T: Default + Send>(
    count: u64,
    trace: impl Fn(&mut T, u64) + Send + Sync,
) -> Vec<T> {
    (0..count.div_ceil(PILOT_CHUNK))
        .into_par_iter()
        .map(|c| {
            let mut chunk = T::default();
            for index in c * PILOT_CHUNK..((c + 1) * PILOT_CHUNK).min(count) {
                trace(&mut chunk, index);
            }
            chunk
        })
        .collect()
}

/// What a pass's photon paths brought.
#[derive(Clone, Debug, Default)]
pub struct Shot {
    /// Photons in path order.
    pub photons: Vec<Photon>,
    /// Number of paths emitted.
    pub emitted: u64,
    /// Where the flux went.
    pub tally: Tally,
}

impl Shot {
    /// Adds paths that start elsewhere: each set stands for the light of its own
    /// starts, so its photons count by its own number of paths.
    pub fn join(&mut self, other: &Self) {
        let emitted = if self.emitted == 0 {
            other.emitted
        } else {
            self.emitted
        };
        let weight = emitted as f64 / other.emitted as f64;
        self.photons.extend(other.photons.iter().map(|p| Photon {
            flux: p.flux * weight,
            sheet: p.sheet * weight,
            ..*p
        }));
        self.emitted = emitted;
        for (a, b) in self.tally.lights.iter_mut().zip(&other.tally.lights) {
            *a += b.scaled(weight);
        }
    }
}

/// Traces paths `first .. first + count` of a sequence.
pub fn shoot(
    ctx: &Context<'_>,
    emitter: &Emitter,
    sequence: Sequence,
    first: u64,
    count: u64,
) -> Shot {
    shoot_for(Kernel::Footprint, ctx, emitter, sequence, first, count)
}

/// The same for kernels of a kind: photons have footprints where these take
/// their shape from them.
pub(crate) fn shoot_for(
    kernel: Kernel,
    ctx: &Context<'_>,
    emitter: &Emitter,
    sequence: Sequence,
    first: u64,
    count: u64,
) -> Shot {
    let chunks: Vec<(Vec<Photon>, Tally)> = (0..count.div_ceil(CHUNK) as usize)
        .into_par_iter()
        .with_max_len(1)
        .map(|c| {
            let c = c as u64;
            let range = first + c * CHUNK..first + ((c + 1) * CHUNK).min(count);
            shoot_chunk(kernel, ctx, emitter, sequence, range, count as f64)
        })
        .collect();
    let mut shot = Shot {
        photons: Vec::with_capacity(chunks.iter().map(|c| c.0.len()).sum()),
        emitted: count,
        tally: Tally::new(ctx.scene.lights.len()),
    };
    for (photons, tally) in chunks {
        shot.photons.extend_from_slice(&photons);
        shot.tally.merge(&tally);
    }
    shot
}

fn shoot_chunk(
    kernel: Kernel,
    ctx: &Context<'_>,
    emitter: &Emitter,
    sequence: Sequence,
    range: std::ops::Range<u64>,
    paths: f64,
) -> (Vec<Photon>, Tally) {
    // Few paths leave more than one.
    let mut photons = Vec::with_capacity((range.end - range.start) as usize);
    let mut tally = Tally::new(ctx.scene.lights.len());
    for index in range {
        let mut stream = sequence.at(index);
        let (emission, _) = &emitter.emit_from(ctx, &mut stream);
        let ledger = &mut tally.lights[emission.light as usize];
        let (watch, store) = (&mut |_| {}, &mut |photon| photons.push(photon));
        let stream = &mut stream;
        trace_watched(ctx, kernel, emission, paths, stream, ledger, watch, store);
    }
    (photons, tally)
}
