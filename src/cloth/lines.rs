//! Lines that edges form.

/// A line of edges: the places along it, and whether its ends are joined, too.
pub(super) struct EdgeLine {
    pub places: Vec<usize>,
    pub is_ring: bool,
}

/// The lines of edges between numbered places, each of which `beside` gives those at the other ends of its edges. A line begins at the
/// end with the lower rank; rings come after those with ends.
pub(super) fn edge_lines(
    beside: &mut [Vec<usize>],
    rank: impl Fn(usize) -> usize,
) -> Vec<EdgeLine> {
    let by_rank = |places: &mut Vec<usize>| places.sort_unstable_by_key(|&place| rank(place));
    beside.iter_mut().for_each(by_rank);
    let mut starts: Vec<usize> = (0..beside.len()).collect();
    starts.sort_by_key(|&place| (beside[place].len() > 1, rank(place)));
    let mut is_known = vec![false; beside.len()];
    let mut lines = Vec::new();
    for start in starts {
        if is_known[start] {
            continue;
        }
        let mut places = vec![start];
        let mut next = Some(start);
        while let Some(here) = next {
            is_known[here] = true;
            next = beside[here].iter().copied().find(|&near| !is_known[near]);
            places.extend(next);
        }
        let last = places[places.len() - 1];
        let is_ring = places.len() > 2 && beside[last].contains(&start);
        lines.push(EdgeLine { places, is_ring });
    }
    lines
}
