//! The end of a slot allocates no memory once its buffers have grown.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fmt::Write as _;

use sim_core::RobotId;
use sim_core::drive::Command;
use sim_core::pose::Twist;
use sim_core::simulation::{Options, Simulation};
use sim_format::{MemoryFiles, load_scene};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, which counts the calling thread's allocations.
struct Counting;

// SAFETY: both functions forward to the system's allocator; the counter has no destructor and allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's contract is the same.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract is the same.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn slots_of_robots_that_drive_take_no_memory() {
    assert_eq!(allocations(12, "none"), 0);
}

#[test]
fn slots_of_a_robot_alone_take_no_memory_with_noise_either() {
    assert_eq!(allocations(1, "mild"), 0);
}

/// Number of allocations in the last 200 of 400 slots, for `side` x `side` robots that drive apart from each other.
fn allocations(side: usize, noise: &str) -> usize {
    let mut scene = format!("noise = \"{noise}\"\n[world]\nfloor_mm = [{0}, {0}]\n", side * 2000);
    for index in 0..side * side {
        let (x, y) = (index % side * 2000 + 1000, index / side * 2000 + 1000);
        // Writing to a string does not fail.
        let _ = write!(scene, "[[robot]]\ntype = \"S4\"\nx_mm = {x}\ny_mm = {y}\nheading_deg = {}\n", index * 37 % 360);
    }
    let files: MemoryFiles = [("crowd.scene.toml", &*scene)].into_iter().collect();
    let scene = load_scene("crowd.scene.toml", &files).scene;
    let mut simulation = Simulation::new(&scene, &Options::default()).expect("robots");
    let slot = simulation.world().slot();
    let mut allocations = 0;
    for number in 0..400_usize {
        // Circles of two radii, so that every robot stays in its square metre, and some rest.
        for index in (0..side * side).filter(|index| (number + index) % 5 == 0) {
            let command = match (number / 40 + index) % 4 {
                0 => Command::Halt,
                turn => Command::Twist(Twist { vx: 0.1, vy: 0.0, omega: turn as f64 }),
            };
            simulation.command(RobotId::from_index(index), command).expect("a drive that turns");
        }
        let before = ALLOCATIONS.get();
        simulation.advance_to(simulation.now() + slot);
        if number >= 200 {
            allocations += ALLOCATIONS.get() - before;
        }
    }
    let now = simulation.now();
    let mut motions = (0..side * side).map(|index| simulation.robot(RobotId::from_index(index)).motion.clone());
    assert!(motions.all(|mut motion| motion.contacts(now) == 0 && motion.path_length(now) > 0.5), "all drive freely");
    allocations
}
