//! Small vertex separators of a graph: coarsen, cut the coarse graph, refine while going back.
//!
//! The multilevel scheme of Karypis and Kumar (SIAM J. Sci. Comput. 20, 1998): vertices are matched along heavy
//! edges and merged until few remain; the coarse graph is cut by growing a region from several seeds; on the
//! way back each separator is improved by moves in the manner of Fiduccia and Mattheyses: a vertex leaves the
//! separator for one side and pulls its neighbours of the other side in.

use std::collections::BinaryHeap;

/// A graph with weighted vertices and edges; neighbours both ways, without loops.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    pub start: Vec<u32>,
    pub neighbours: Vec<u32>,
    pub edge_weights: Vec<u32>,
    pub weights: Vec<u32>,
}

/// Where a vertex is: on side 0 or 1, or in the separator.
pub(super) const SEPARATOR: u8 = 2;

/// The coarse graph has at most about this many vertices.
const COARSE: usize = 200;
/// Seeds from which the coarse graph of a small part is cut.
const FEW_SEEDS: usize = 3;
/// Seeds for a graph of more than [`MANY`] vertices, where a good cut saves most.
const SEEDS: usize = 10;
/// A side may have this fraction of the weight.
const HEAVIEST_SIDE: f64 = 0.58;
/// Passes of refinement per level, and moves without gain after which a pass ends.
const PASSES: usize = 4;
const FRUITLESS_MOVES: usize = 50;
const MANY: usize = 3000;
const NONE: u32 = u32::MAX;

impl Graph {
    pub fn vertices(&self) -> usize {
        self.weights.len()
    }

    fn edges(&self, v: usize) -> std::ops::Range<usize> {
        self.start[v] as usize..self.start[v + 1] as usize
    }

    pub fn neighbours(&self, v: usize) -> &[u32] {
        &self.neighbours[self.edges(v)]
    }

    /// The graph of the vertices with `part[v] == side`, and their numbers here.
    pub fn side(&self, part: &[u8], side: u8) -> (Self, Vec<u32>) {
        let mut place = vec![NONE; self.vertices()];
        let chosen: Vec<u32> = (0..self.vertices() as u32)
            .filter(|&v| part[v as usize] == side)
            .collect();
        for (i, &v) in chosen.iter().enumerate() {
            place[v as usize] = i as u32;
        }
        let mut graph = Self::default();
        graph.start.push(0);
        for &v in &chosen {
            for e in self.edges(v as usize) {
                let i = place[self.neighbours[e] as usize];
                if i != NONE {
                    graph.neighbours.push(i);
                    graph.edge_weights.push(self.edge_weights[e]);
                }
            }
            graph.start.push(graph.neighbours.len() as u32);
            graph.weights.push(self.weights[v as usize]);
        }
        (graph, chosen)
    }

    /// Merges pairs of vertices along heavy edges; `None` if that no longer shrinks the graph.
    fn coarsened(&self, random: &mut Random) -> Option<(Self, Vec<u32>)> {
        let n = self.vertices();
        let mut visit: Vec<u32> = (0..n as u32).collect();
        random.shuffle(&mut visit);
        let heaviest: u32 = self.weights.iter().sum::<u32>() / COARSE as u32 * 3 + 1;
        let mut mate = vec![NONE; n];
        let mut coarse_count = 0;
        for &v in &visit {
            if mate[v as usize] != NONE {
                continue;
            }
            let mut best = (0, v);
            for e in self.edges(v as usize) {
                let u = self.neighbours[e];
                let light = self.weights[v as usize] + self.weights[u as usize] <= heaviest;
                if mate[u as usize] == NONE && light && self.edge_weights[e] > best.0 {
                    best = (self.edge_weights[e], u);
                }
            }
            mate[v as usize] = best.1;
            mate[best.1 as usize] = v;
            coarse_count += 1;
        }
        if coarse_count * 20 > n * 19 {
            return None;
        }
        let mut coarse_of = vec![NONE; n];
        let mut members = Vec::with_capacity(coarse_count);
        for v in 0..n {
            if coarse_of[v] == NONE {
                coarse_of[v] = members.len() as u32;
                coarse_of[mate[v] as usize] = members.len() as u32;
                members.push(v);
            }
        }
        let mut graph = Self::default();
        graph.start.push(0);
        let mut slot = vec![NONE; members.len()];
        for (c, &v) in members.iter().enumerate() {
            let from = graph.neighbours.len();
            let pair = [v, mate[v] as usize];
            let pair = &pair[..if pair[0] == pair[1] { 1 } else { 2 }];
            for &v in pair {
                for e in self.edges(v) {
                    let other = coarse_of[self.neighbours[e] as usize];
                    if other as usize == c {
                        continue;
                    }
                    let at = slot[other as usize];
                    if at != NONE && at as usize >= from {
                        graph.edge_weights[at as usize] += self.edge_weights[e];
                    } else {
                        slot[other as usize] = graph.neighbours.len() as u32;
                        graph.neighbours.push(other);
                        graph.edge_weights.push(self.edge_weights[e]);
                    }
                }
            }
            graph.start.push(graph.neighbours.len() as u32);
            graph
                .weights
                .push(pair.iter().map(|&v| self.weights[v]).sum());
        }
        Some((graph, coarse_of))
    }

    /// Parts of a small separator: side 0, side 1 or [`SEPARATOR`] for each vertex.
    pub fn separated(&self, random: &mut Random) -> Vec<u8> {
        let mut levels: Vec<(Self, Vec<u32>)> = Vec::new();
        loop {
            let finest = levels.last().map_or(self, |l| &l.0);
            if finest.vertices() <= COARSE {
                break;
            }
            match finest.coarsened(random) {
                Some(level) => levels.push(level),
                None => break,
            }
        }
        let coarsest = levels.last().map_or(self, |l| &l.0);
        let seeds = if self.vertices() > MANY {
            SEEDS
        } else {
            FEW_SEEDS
        };
        let mut part = coarsest.cut(seeds, random);
        for i in (0..levels.len()).rev() {
            let finer = if i == 0 { self } else { &levels[i - 1].0 };
            part = levels[i].1.iter().map(|&c| part[c as usize]).collect();
            Separator::new(finer, &mut part).refine();
        }
        part
    }

    /// Cuts a small graph by growing regions from several seeds and keeps the best.
    fn cut(&self, seeds: usize, random: &mut Random) -> Vec<u8> {
        let total: u64 = self.weights.iter().map(|&w| u64::from(w)).sum();
        let mut best: Option<(f64, Vec<u8>)> = None;
        for _ in 0..seeds {
            let mut part = self.grown(self.farthest(random.below(self.vertices())), total / 2);
            let mut separator = Separator::new(self, &mut part);
            separator.refine();
            let cost = separator.cost();
            if best.as_ref().is_none_or(|b| cost < b.0) {
                best = Some((cost, part));
            }
        }
        best.map_or_else(Vec::new, |b| b.1)
    }

    /// Returns the last vertex of a breadth-first search from another one.
    fn farthest(&self, from: usize) -> usize {
        let mut queued = vec![false; self.vertices()];
        let mut queue = vec![from];
        queued[from] = true;
        let mut next = 0;
        while next < queue.len() {
            for &u in self.neighbours(queue[next]) {
                if !queued[u as usize] {
                    queued[u as usize] = true;
                    queue.push(u as usize);
                }
            }
            next += 1;
        }
        queue[queue.len() - 1]
    }

    /// Side 0 is everything near the seed up to a weight; the separator are the others that touch it.
    fn grown(&self, seed: usize, weight: u64) -> Vec<u8> {
        let n = self.vertices();
        let mut part = vec![1_u8; n];
        let mut queued = vec![false; n];
        let mut queue = Vec::with_capacity(n);
        let (mut next, mut grown, mut restart) = (0, 0, 0);
        queue.push(seed);
        queued[seed] = true;
        while grown < weight {
            if next == queue.len() {
                // Another component.
                while restart < n && queued[restart] {
                    restart += 1;
                }
                if restart == n {
                    break;
                }
                queued[restart] = true;
                queue.push(restart);
            }
            let v = queue[next];
            next += 1;
            part[v] = 0;
            grown += u64::from(self.weights[v]);
            for &u in self.neighbours(v) {
                if !queued[u as usize] {
                    queued[u as usize] = true;
                    queue.push(u as usize);
                }
            }
        }
        for v in 0..n {
            if part[v] == 1 && self.neighbours(v).iter().any(|&u| part[u as usize] == 0) {
                part[v] = SEPARATOR;
            }
        }
        part
    }
}

/// A separator being improved.
struct Separator<'a> {
    graph: &'a Graph,
    part: &'a mut [u8],
    /// Weights of side 0, side 1 and the separator.
    weights: [i64; 3],
    limit: i64,
}

impl<'a> Separator<'a> {
    fn new(graph: &'a Graph, part: &'a mut [u8]) -> Self {
        let mut weights = [0; 3];
        for (p, &w) in part.iter().zip(&graph.weights) {
            weights[*p as usize] += i64::from(w);
        }
        let total: i64 = weights.iter().sum();
        Self {
            graph,
            part,
            weights,
            limit: (HEAVIEST_SIDE * total as f64) as i64,
        }
    }

    /// Weight of the separator, raised where the sides are uneven beyond the limit; ties by balance.
    fn cost(&self) -> f64 {
        let heavier = self.weights[0].max(self.weights[1]);
        let total = self.weights.iter().sum::<i64>().max(1) as f64;
        let excess = (heavier - self.limit).max(0) as f64;
        let uneven = (self.weights[0] - self.weights[1]).abs() as f64 / total;
        self.weights[2] as f64 + 10.0 * excess + 0.3 * uneven * self.weights[2] as f64 + uneven
    }

    /// Returns the decrease of the separator if `v` leaves it for `side`.
    fn gain(&self, v: usize, side: u8) -> i64 {
        let pulled: i64 = self
            .graph
            .neighbours(v)
            .iter()
            .filter(|&&u| self.part[u as usize] == 1 - side)
            .map(|&u| i64::from(self.graph.weights[u as usize]))
            .sum();
        i64::from(self.graph.weights[v]) - pulled
    }

    fn set(&mut self, v: usize, part: u8) {
        let w = i64::from(self.graph.weights[v]);
        self.weights[self.part[v] as usize] -= w;
        self.weights[part as usize] += w;
        self.part[v] = part;
    }

    fn refine(&mut self) {
        for _ in 0..PASSES {
            if !self.pass() {
                break;
            }
        }
    }

    /// Makes one pass of moves and reverts to the best state; returns true if that is an improvement.
    fn pass(&mut self) -> bool {
        let n = self.graph.vertices();
        let mut heap: BinaryHeap<(i64, u32, u8)> = BinaryHeap::new();
        let mut moved = vec![false; n];
        for v in (0..n).filter(|&v| self.part[v] == SEPARATOR) {
            heap.push((self.gain(v, 0), v as u32, 0));
            heap.push((self.gain(v, 1), v as u32, 1));
        }
        // Changes as (vertex, part before).
        let mut log: Vec<(u32, u8)> = Vec::new();
        let before = self.cost();
        let (mut best, mut best_length, mut fruitless) = (before, 0, 0);
        while let Some((gain, v, side)) = heap.pop() {
            let vertex = v as usize;
            if self.part[vertex] != SEPARATOR || moved[vertex] {
                continue;
            }
            let actual = self.gain(vertex, side);
            if actual != gain {
                if actual < gain {
                    heap.push((actual, v, side));
                }
                continue;
            }
            let heavier = self.weights[side as usize] + i64::from(self.graph.weights[vertex]);
            if heavier > self.limit && heavier > self.weights[1 - side as usize] {
                continue;
            }
            moved[vertex] = true;
            log.push((v, SEPARATOR));
            self.set(vertex, side);
            for &u in self.graph.neighbours(vertex) {
                let pulled = u as usize;
                if self.part[pulled] != 1 - side {
                    continue;
                }
                log.push((u, 1 - side));
                self.set(pulled, SEPARATOR);
                if !moved[pulled] {
                    heap.push((self.gain(pulled, side), u, side));
                    heap.push((self.gain(pulled, 1 - side), u, 1 - side));
                }
                for &x in self.graph.neighbours(pulled) {
                    if self.part[x as usize] == SEPARATOR && !moved[x as usize] {
                        heap.push((self.gain(x as usize, side), x, side));
                    }
                }
            }
            let cost = self.cost();
            if cost < best {
                (best, best_length, fruitless) = (cost, log.len(), 0);
            } else {
                fruitless += 1;
                if fruitless > FRUITLESS_MOVES {
                    break;
                }
            }
        }
        for (v, part) in log.drain(best_length..).rev() {
            self.set(v as usize, part);
        }
        best < before
    }
}

/// Numbers that look random and are the same in every run (xorshift64*).
pub(super) struct Random(u64);

impl Random {
    pub fn new() -> Self {
        Self(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 33) as usize % n.max(1)
    }

    fn shuffle(&mut self, items: &mut [u32]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}
