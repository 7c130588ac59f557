//! Random mazes, in which every cell can be reached from every other.

use sim_core::noise::Stream;

/// Drawing of a maze with a start `S` in its lower left corner, as in a `.maz` file. `cell_size` is the side of a cell
/// in metres.
///
/// The passages form a random spanning tree, found by depth-first search (recursive backtracker). In addition, each
/// remaining inner wall is opened with probability `loops`.
pub(super) fn drawing(columns: usize, rows: usize, loops: f64, cell_size: Option<f64>, stream: &mut Stream) -> String {
    // True if the cell is open to the right, and to the top; row 0 is at the bottom.
    let mut open_right = vec![false; columns * rows];
    let mut open_above = vec![false; columns * rows];
    let mut is_visited = vec![false; columns * rows];
    let mut path = vec![0];
    is_visited[0] = true;
    while let Some(&current) = path.last() {
        let (column, row) = (current % columns, current / columns);
        let neighbours = [
            (column + 1 < columns).then(|| current + 1),
            (row + 1 < rows).then(|| current + columns),
            (column > 0).then(|| current - 1),
            (row > 0).then(|| current - columns),
        ];
        let unvisited: Vec<usize> = neighbours.into_iter().flatten().filter(|cell| !is_visited[*cell]).collect();
        if unvisited.is_empty() {
            path.pop();
            continue;
        }
        let next = unvisited[(stream.unit() * unvisited.len() as f64) as usize % unvisited.len()];
        let openings =
            if next.abs_diff(current) == 1 && next / columns == row { &mut open_right } else { &mut open_above };
        openings[current.min(next)] = true;
        is_visited[next] = true;
        path.push(next);
    }
    for index in 0..columns * rows {
        // Two numbers are drawn for every cell: a smaller `loops` opens a subset of the walls that a larger one opens.
        let [opens_right, opens_above] = [stream.unit(), stream.unit()].map(|number| number < loops);
        open_right[index] |= opens_right && index % columns + 1 < columns;
        open_above[index] |= opens_above && index / columns + 1 < rows;
    }
    let mut text = format!(" {}\n", vec!["_"; columns].join(" "));
    for row in (0..rows).rev() {
        for column in 0..columns {
            let has_left = column == 0 || !open_right[row * columns + column - 1];
            let has_below = row == 0 || !open_above[(row - 1) * columns + column];
            text.push(if has_left { '|' } else { ' ' });
            text.push(match (row + column, has_below) {
                (0, _) => 'S',
                (_, true) => '_',
                _ => ' ',
            });
        }
        text.push_str("|\n");
    }
    if let Some(cell_size) = cell_size {
        text.push_str(&format!("{}\n", crate::print::number::mm(cell_size)));
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use sim_core::RobotId;
    use sim_core::noise::Purpose;

    use super::*;

    /// Number of cells of a drawing that can be reached from the lower left cell.
    fn reachable_cells(text: &str, columns: usize, rows: usize) -> usize {
        let lines: Vec<Vec<char>> = text.lines().skip(1).map(|line| line.chars().collect()).collect();
        let is_open = |row: usize, column: usize| lines[row][2 * column + 1] == ' ';
        let mut visited = BTreeSet::from([(rows - 1, 0)]);
        let mut queue = vec![(rows - 1, 0)];
        while let Some((row, column)) = queue.pop() {
            let neighbours = [
                (column > 0 && lines[row][2 * column] != '|').then(|| (row, column - 1)),
                (column + 1 < columns && lines[row][2 * column + 2] != '|').then(|| (row, column + 1)),
                (row + 1 < rows && is_open(row, column)).then(|| (row + 1, column)),
                (row > 0 && is_open(row - 1, column)).then(|| (row - 1, column)),
            ];
            queue.extend(neighbours.into_iter().flatten().filter(|cell| visited.insert(*cell)));
        }
        visited.len()
    }

    #[test]
    fn every_cell_is_reachable() {
        for (seed, columns, rows) in [(1, 1, 1), (2, 1, 9), (3, 9, 1), (4, 8, 6), (5, 40, 30)] {
            let stream = || Stream::new(seed, RobotId(0), Purpose::Scene, 0, 0);
            let text = drawing(columns, rows, 0.0, None, &mut stream());
            assert_eq!(reachable_cells(&text, columns, rows), columns * rows, "{text}");
            assert_ne!(columns * rows > 9, text == drawing(columns, rows, 0.5, None, &mut stream()), "{text}");
            let open = drawing(columns, rows, 1.0, None, &mut stream());
            let inner = open.lines().skip(1).map(|line| line[1..line.len() - 1].matches('|').count()).sum::<usize>();
            assert_eq!(inner, 0, "{open}");
        }
    }
}
