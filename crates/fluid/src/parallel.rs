//! Loops and sums that give the same bits for any number of threads.

use rayon::prelude::*;

/// Particles per chunk: one task of a parallel loop, and the fixed grain of every sum.
pub const CHUNK: usize = 256;

/// Sums of `term(i)` for i in 0..count, several at once, added in a fixed order: within chunks first, then over chunks.
pub fn sums<const K: usize>(
    count: usize,
    partial: &mut Vec<[f64; K]>,
    term: impl Fn(usize) -> [f64; K] + Sync,
) -> [f64; K] {
    partial.resize(count.div_ceil(CHUNK), [0.0; K]);
    partial.par_iter_mut().enumerate().for_each(|(chunk, slot)| {
        *slot = [0.0; K];
        (chunk * CHUNK..((chunk + 1) * CHUNK).min(count)).for_each(|i| add(slot, &term(i)));
    });
    total(partial)
}

#[inline(always)]
fn add<const K: usize>(sum: &mut [f64; K], term: &[f64; K]) {
    sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += term);
}

/// Sums of what chunks added up to.
pub fn total<const K: usize>(partial: &[[f64; K]]) -> [f64; K] {
    let mut sum = [0.0; K];
    partial.iter().for_each(|term| add(&mut sum, term));
    sum
}

/// Fills `out[i] = value(i)` in parallel.
pub fn fill<T: Send>(out: &mut [T], value: impl Fn(usize) -> T + Sync) {
    out.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, slots)| {
        for (k, slot) in slots.iter_mut().enumerate() {
            *slot = value(chunk * CHUNK + k);
        }
    });
}

/// Whether `is` holds for every i in 0..count.
pub fn all(count: usize, is: impl Fn(usize) -> bool + Sync) -> bool {
    (0..count).into_par_iter().with_min_len(CHUNK).all(&is)
}

/// Replaces every value by `new(i, value)` in parallel.
pub fn update<T: Copy + Send>(values: &mut [T], new: impl Fn(usize, T) -> T + Sync) {
    values.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(i, value)| *value = new(i, *value));
}

/// Largest of `term(i)`, or `least` when there is none larger. The maximum does not depend on the order.
pub fn maximum(count: usize, least: f64, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    (0..count).into_par_iter().with_min_len(CHUNK).map(&term).reduce(|| least, f64::max)
}

/// One list per particle, stored chunk by chunk so that all chunks can be built at once and keep their memory.
#[derive(Debug, Clone)]
pub struct Lists<T> {
    chunks: Vec<ChunkLists<T>>,
}

#[derive(Debug, Clone)]
struct ChunkLists<T> {
    /// Where each list begins, and where the last one ends.
    bounds: Vec<u32>,
    items: Vec<T>,
}

/// Writes the lists of one chunk, particle after particle.
pub struct Writer<'a, T> {
    bounds: &'a mut Vec<u32>,
    /// Where the entries of the particle go.
    pub items: &'a mut Vec<T>,
}

impl<T> Writer<'_, T> {
    /// Ends the list of a particle.
    #[inline(always)]
    pub fn end(&mut self) {
        self.bounds.push(self.items.len() as u32);
    }
}

impl<T> Default for Lists<T> {
    fn default() -> Self {
        Self { chunks: Vec::new() }
    }
}

impl<T: Send + Sync> Lists<T> {
    /// Builds the lists of `count` particles; `collect(i, out)` appends the entries of particle i.
    pub fn build(&mut self, count: usize, collect: impl Fn(usize, &mut Vec<T>) + Sync) {
        self.writers(count).enumerate().for_each(|(chunk, mut writer)| {
            for i in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                collect(i, writer.items);
                writer.end();
            }
        });
    }

    /// Writers of the lists of all chunks, emptied, for loops that write several things at once.
    pub fn writers(&mut self, count: usize) -> impl IndexedParallelIterator<Item = Writer<'_, T>> {
        self.chunks.resize_with(count.div_ceil(CHUNK), || ChunkLists { bounds: vec![0], items: Vec::new() });
        self.chunks.par_iter_mut().map(|ChunkLists { bounds, items }| {
            bounds.truncate(1);
            items.clear();
            Writer { bounds, items }
        })
    }

    /// Takes over whole chunks of `other`, which gets what was here instead.
    pub fn swap_chunks(&mut self, other: &mut Self, taken: impl Fn(usize) -> bool) {
        for (chunk, (own, others)) in self.chunks.iter_mut().zip(&mut other.chunks).enumerate() {
            if taken(chunk) {
                std::mem::swap(own, others);
            }
        }
    }

    /// Changes every entry; `change(i, entry)` gets the particle it belongs to.
    pub fn change(&mut self, change: impl Fn(usize, &mut T) + Sync) {
        self.chunks.par_iter_mut().enumerate().for_each(|(chunk, lists)| {
            for (k, bounds) in lists.bounds.windows(2).enumerate() {
                let of_particle = &mut lists.items[bounds[0] as usize..bounds[1] as usize];
                of_particle.iter_mut().for_each(|entry| change(chunk * CHUNK + k, entry));
            }
        });
    }

    /// All entries, particle after particle.
    pub fn iter_all(&self) -> impl Iterator<Item = &T> {
        self.chunks.iter().flat_map(|lists| &lists.items)
    }

    /// The list of particle i.
    #[inline]
    pub fn of(&self, i: usize) -> &[T] {
        let lists = &self.chunks[i / CHUNK];
        let k = i % CHUNK;
        &lists.items[lists.bounds[k] as usize..lists.bounds[k + 1] as usize]
    }
}
