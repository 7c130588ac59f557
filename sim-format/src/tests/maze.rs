//! Mazes in drawing styles other than EyeSim's.

use glam::DVec2;

use super::super::*;
use super::{Memory, codes, wall_ends};

#[test]
fn even_indentation_shifts_the_maze() {
    let (maze, diagnostics) = read_maze("m.maz", "   _\n  |S|\n  |_|\n1000\n");
    assert_eq!((codes(&diagnostics), maze.floor), (vec![], DVec2::new(2.0, 2.0)));
    assert_eq!(maze.starts[0].pose.position, DVec2::new(1.5, 1.5));
}

#[test]
fn odd_indentation_is_removed() {
    let straight = read_maze("m.maz", " ___\n|S| |\n|_x_|\n").0;
    let (mut indented, diagnostics) = read_maze("m.maz", "  ___\n |S| |\n |_x_|\n");
    assert_eq!(codes(&diagnostics), ["maz-indent"]);
    assert_eq!((wall_ends(&indented), indented.floor), (wall_ends(&straight), straight.floor));
    // The letter in a wall column belongs to the cell on its left.
    let positions = |maze: &WorldSpec| maze.objects.iter().map(|object| object.pose.position).collect::<Vec<_>>();
    assert_eq!(positions(&indented), [DVec2::new(0.18, 0.18)]);
    assert_eq!(positions(&indented), positions(&straight));
    assert_eq!(indented.starts.remove(0).pose, straight.starts[0].pose);
}

#[test]
fn cells_two_characters_wide_are_read() {
    let narrow = read_maze("m.maz", " ___\n|U| |\n|___|\n").0;
    let (wide, diagnostics) = read_maze("m.maz", " _____\n| U|  |\n|_____|\n");
    assert_eq!(codes(&diagnostics), ["maz-wide"]);
    assert_eq!((wall_ends(&wide), wide.floor), (wall_ends(&narrow), narrow.floor));
    assert_eq!(wide.starts[0].pose, narrow.starts[0].pose);
}

#[test]
fn a_wall_between_two_columns_closes_its_cell_on_the_right() {
    let (maze, diagnostics) = read_maze("m.maz", " _____\n|  | |\n|_____|\n100\n");
    assert_eq!((codes(&diagnostics), maze.floor.x), (vec!["maz-wall-column"], 3.0 * 0.1));
    assert!(wall_ends(&maze).contains(&[0.2, 0.1, 0.2, 0.2]), "{:?}", wall_ends(&maze));
    // Right border of a maze whose rows have an odd number of characters between the borders.
    let (maze, diagnostics) = read_maze("m.maz", " ___\n|   |\n|  |\n|___|\n100\n");
    assert_eq!(codes(&diagnostics), ["maz-wall-column"]);
    assert!(wall_ends(&maze).contains(&[0.2, 0.0, 0.2, 3.0 * 0.1]), "one border: {:?}", wall_ends(&maze));
}

#[test]
fn a_floor_line_between_two_cells_closes_the_left_one() {
    let (maze, _) = read_maze("m.maz", " ___\n| _ |\n|___|\n100\n");
    assert!(wall_ends(&maze).contains(&[0.0, 0.1, 0.1, 0.1]), "{:?}", wall_ends(&maze));
    let (maze, _) = read_maze("m.maz", "____\n_   |\n|___|\n100\n");
    assert!(!wall_ends(&maze).iter().any(|wall| wall[1] == 0.1 && wall[3] == 0.1), "{:?}", wall_ends(&maze));
}

#[test]
fn gap_in_the_border_is_reported() {
    for (maze, is_gap) in [
        (" ___\n|S  |\n|___|\n", false),
        (" ___\n|   |\n|s _|\n", true),
        (" ___\n|S  \n|___|\n", true),
        (" _\n|S  |\n|___|\n", true),
        // A corridor with two open ends is intended.
        (" ___\n S\n ___\n", false),
    ] {
        let diagnostics = read_maze("m.maz", maze).1;
        assert_eq!(codes(&diagnostics).contains(&"maz-gap"), is_gap, "{maze}: {diagnostics:?}");
    }
}

#[test]
fn notches_beyond_the_border_are_cells() {
    let (maze, diagnostics) = read_maze("m.maz", "   ___\n _|   |_\n|   o   |\n|_     _|\n  |___|\n100\n");
    assert_eq!(diagnostics, []);
    assert_eq!(maze.floor, DVec2::new(0.4, 0.4));
    // The left goal: its back, its lower and its upper edge.
    for wall in [[0.0, 0.1, 0.0, 0.3], [0.0, 0.1, 0.1, 0.1], [0.0, 0.3, 0.1, 0.3]] {
        let is_close = |ends: &[f64; 4]| ends.iter().zip(wall).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(wall_ends(&maze).iter().any(is_close), "no {wall:?} in {:?}", wall_ends(&maze));
    }
}

#[test]
fn a_row_with_a_gap_may_begin_with_a_blank_and_a_dot() {
    let (maze, diagnostics) = read_maze("m.maz", " _____\n|. . .|\n . . .|\n|_____|\n360\n");
    assert_eq!((codes(&diagnostics), maze.floor), (vec!["maz-gap"], DVec2::new(3.0, 3.0) * 0.36));
}

#[test]
fn balls_in_a_row_with_gaps_are_not_posts() {
    let files = Memory::new(&[
        ("balls.maz", " _____\n|     |\n  o o\n|_____|\n"),
        ("posts.maz", "o   o   o\n|   |   |\no   o   o\n"),
    ]);
    let [balls, posts] = ["balls.maz", "posts.maz"].map(|name| load_world(name, &files).scene.world);
    assert_eq!((balls.objects.len(), balls.floor), (2, DVec2::new(3.0, 3.0) * 0.36));
    assert_eq!((posts.objects.len(), posts.floor), (0, DVec2::new(2.0, 1.0) * 0.36));
}
