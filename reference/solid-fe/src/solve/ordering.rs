//! Fill-reducing elimination order, computed on the graph of nodes.
//!
//! The unknowns of one node have the same neighbours; taken together they make the graph three times smaller
//! and its edges nine times fewer, and keep a node's columns side by side in the factor. The order is refined
//! to a postorder of the elimination tree (Liu, SIAM J. Matrix Anal. Appl. 11, 1990), so that columns of
//! equal pattern become neighbours; the fill is counted exactly along the row subtrees.

use super::separator::{Graph, Random, SEPARATOR};
use crate::hash::spread;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// An order of elimination and the factor it leads to.
pub struct Order {
    /// Unknown that is eliminated as the i-th.
    pub forward: Vec<usize>,
    /// Place in the order of each unknown.
    pub inverse: Vec<usize>,
    /// Non-zeros of the factor's lower triangle.
    pub nonzeros: usize,
    /// Multiplications and additions of the factorisation.
    pub flops: f64,
}

/// Graph of the nodes: groups of neighbouring unknowns with the same pattern.
struct NodeGraph {
    /// First unknown of each node, and the number of unknowns at the end.
    first: Vec<usize>,
    /// Where the neighbours of each node begin.
    start: Vec<usize>,
    /// Neighbours in both directions, without the node itself.
    neighbours: Vec<u32>,
}

impl NodeGraph {
    fn nodes(&self) -> usize {
        self.first.len() - 1
    }

    fn weight(&self, node: usize) -> usize {
        self.first[node + 1] - self.first[node]
    }

    fn neighbours(&self, node: usize) -> &[u32] {
        &self.neighbours[self.start[node]..self.start[node + 1]]
    }

    /// Returns the graph with vertices weighted by their unknowns.
    fn weighted(&self) -> Graph {
        Graph {
            start: self.start.iter().map(|&s| s as u32).collect(),
            neighbours: self.neighbours.clone(),
            edge_weights: vec![1; self.neighbours.len()],
            weights: (0..self.nodes()).map(|v| self.weight(v) as u32).collect(),
        }
    }

    /// Graph of a lower triangle.
    fn new(pattern: SymbolicSparseColMatRef<'_, usize>) -> Self {
        let unknowns = pattern.ncols();
        // Unknowns are of one node if they see the same unknowns, themselves included. Compared by a hash: a
        // clash would only join two nodes in the graph, which costs fill but no correctness.
        let mut seen = vec![0_u64; unknowns];
        for j in 0..unknowns {
            for &i in pattern.row_idx_of_col_raw(j) {
                seen[j] = seen[j].wrapping_add(spread(i as u64));
                if i != j {
                    seen[i] = seen[i].wrapping_add(spread(j as u64));
                }
            }
        }
        let mut first = Vec::with_capacity(unknowns / 3 + 2);
        let mut node_of = vec![0_u32; unknowns];
        for i in 0..unknowns {
            if i == 0 || seen[i] != seen[i - 1] {
                first.push(i);
            }
            node_of[i] = first.len() as u32 - 1;
        }
        let nodes = first.len();
        first.push(unknowns);

        let mut last_seen = vec![u32::MAX; nodes];
        let mut edges = Vec::with_capacity(pattern.row_idx().len() / 8);
        let mut start = vec![0; nodes + 1];
        for node in 0..nodes {
            last_seen[node] = node as u32;
            for j in first[node]..first[node + 1] {
                for &i in pattern.row_idx_of_col_raw(j) {
                    let other = node_of[i] as usize;
                    if last_seen[other] != node as u32 {
                        last_seen[other] = node as u32;
                        edges.push((node as u32, other as u32));
                        start[node + 1] += 1;
                        start[other + 1] += 1;
                    }
                }
            }
        }
        for node in 0..nodes {
            start[node + 1] += start[node];
        }
        let mut fill = start.clone();
        let mut neighbours = vec![0; 2 * edges.len()];
        for &(a, b) in &edges {
            neighbours[fill[a as usize]] = b;
            fill[a as usize] += 1;
            neighbours[fill[b as usize]] = a;
            fill[b as usize] += 1;
        }
        Self {
            first,
            start,
            neighbours,
        }
    }
}

/// Returns the better of two orders for the pattern of a lower triangle: the one with the cheaper factor.
pub fn best(pattern: SymbolicSparseColMatRef<'_, usize>) -> Order {
    let graph = NodeGraph::new(pattern);
    let by_degree = evaluate(&graph, &minimum_degree_of(&graph.weighted()));
    if graph.nodes() <= LEAF {
        return by_degree;
    }
    let dissected = evaluate(&graph, &dissection(&graph));
    if by_degree.flops <= dissected.flops {
        by_degree
    } else {
        dissected
    }
}

/// Parts of this many nodes are not cut any further.
const LEAF: usize = 150;

/// Nested dissection (George, SIAM J. Numer. Anal. 10, 1973): a separator is eliminated after the sides it
/// parts, each of which is dissected in turn; small parts by minimum degree.
fn dissection(graph: &NodeGraph) -> Vec<u32> {
    let mut random = Random::new();
    // Filled from the last to the first.
    let mut backwards = Vec::with_capacity(graph.nodes());
    let mut parts = vec![(
        graph.weighted(),
        (0..graph.nodes() as u32).collect::<Vec<_>>(),
    )];
    while let Some((part, nodes)) = parts.pop() {
        if part.vertices() > LEAF {
            let place = part.separated(&mut random);
            let sides = [0, 1].map(|side| {
                let (graph, chosen) = part.side(&place, side);
                (
                    graph,
                    chosen
                        .iter()
                        .map(|&v| nodes[v as usize])
                        .collect::<Vec<_>>(),
                )
            });
            if sides.iter().all(|s| s.0.vertices() > 0) {
                let separator = (0..place.len()).filter(|&v| place[v] == SEPARATOR);
                backwards.extend(separator.map(|v| nodes[v]));
                parts.extend(sides);
                continue;
            }
        }
        let order = minimum_degree_of(&part);
        backwards.extend(order.iter().rev().map(|&v| nodes[v as usize]));
    }
    backwards.reverse();
    backwards
}

/// Approximate minimum degree of a graph.
fn minimum_degree_of(graph: &Graph) -> Vec<u32> {
    let n = graph.vertices();
    let mut column_start = Vec::with_capacity(n + 1);
    let mut rows: Vec<usize> = Vec::new();
    column_start.push(0);
    for v in 0..n {
        let from = rows.len();
        let above = graph
            .neighbours(v)
            .iter()
            .map(|&u| u as usize)
            .filter(|&u| u < v);
        rows.extend(above);
        rows[from..].sort_unstable();
        column_start.push(rows.len());
    }
    let (mut forward, mut inverse) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_scratch::<usize>(n, rows.len()));
    let upper = SymbolicSparseColMatRef::new_checked(n, n, &column_start, None, &rows);
    match amd::order(
        &mut forward,
        &mut inverse,
        upper,
        amd::Control::default(),
        MemStack::new(&mut memory),
    ) {
        Ok(_) => forward.into_iter().map(|v| v as u32).collect(),
        // Out of memory for a few arrays of the graph's size: any order is correct.
        Err(_) => (0..n as u32).collect(),
    }
}

/// Converts an order of nodes into a postordered one of unknowns and counts the fill.
fn evaluate(graph: &NodeGraph, nodes: &[u32]) -> Order {
    let (parent, _) = elimination_tree(graph, nodes);
    let nodes: Vec<u32> = postorder(&parent).into_iter().map(|i| nodes[i]).collect();
    let (_, below) = elimination_tree(graph, &nodes);
    let unknowns = graph.first[graph.nodes()];
    let mut forward = Vec::with_capacity(unknowns);
    let (mut nonzeros, mut flops) = (0, 0.0);
    for (i, &node) in nodes.iter().enumerate() {
        let node = node as usize;
        forward.extend(graph.first[node]..graph.first[node + 1]);
        for inside in 1..=graph.weight(node) {
            let height = below[i] + inside;
            nonzeros += height;
            flops += (height * height) as f64;
        }
    }
    let mut inverse = vec![0; unknowns];
    for (place, &unknown) in forward.iter().enumerate() {
        inverse[unknown] = place;
    }
    Order {
        forward,
        inverse,
        nonzeros,
        flops,
    }
}

const ROOT: usize = usize::MAX;

/// Elimination tree of the ordered nodes, and the unknowns below each node's own in its column of the factor.
fn elimination_tree(graph: &NodeGraph, nodes: &[u32]) -> (Vec<usize>, Vec<usize>) {
    let n = nodes.len();
    let mut place = vec![0_u32; n];
    for (i, &node) in nodes.iter().enumerate() {
        place[node as usize] = i as u32;
    }
    let mut parent = vec![ROOT; n];
    let mut below = vec![0; n];
    let mut visited = vec![ROOT; n];
    for i in 0..n {
        let node = nodes[i] as usize;
        let weight = graph.weight(node);
        visited[i] = i;
        for &other in graph.neighbours(node) {
            let mut j = place[other as usize] as usize;
            while j < i && visited[j] != i {
                if parent[j] == ROOT {
                    parent[j] = i;
                }
                below[j] += weight;
                visited[j] = i;
                j = parent[j];
            }
        }
    }
    (parent, below)
}

/// Postorder of a forest: entry i is the old index of the i-th.
fn postorder(parent: &[usize]) -> Vec<usize> {
    let n = parent.len();
    // Children as linked lists, in ascending order.
    let (mut child, mut sibling) = (vec![ROOT; n], vec![ROOT; n]);
    let mut roots = ROOT;
    for i in (0..n).rev() {
        let head = match parent[i] {
            ROOT => &mut roots,
            p => &mut child[p],
        };
        sibling[i] = *head;
        *head = i;
    }
    let mut order = Vec::with_capacity(n);
    let mut path = Vec::new();
    let mut next = roots;
    loop {
        while next != ROOT {
            path.push(next);
            next = child[next];
        }
        let Some(node) = path.pop() else { break };
        order.push(node);
        next = sibling[node];
    }
    order
}

#[cfg(test)]
pub(super) fn both(pattern: SymbolicSparseColMatRef<'_, usize>) -> [Order; 2] {
    let graph = NodeGraph::new(pattern);
    let by_degree = minimum_degree_of(&graph.weighted());
    [by_degree, dissection(&graph)].map(|nodes| evaluate(&graph, &nodes))
}
