//! Terrains as forms of a scene.

use glam::{DVec2, DVec3};

use super::number::{degrees, mm};
use super::scene::{place, point, unless};
use crate::scene::form::{
    BlockForm, DiscForm, FunctionForm, FunctionTerrainForm, ImageTerrainForm, PlacedTerrainForm, StairsForm,
    StepsTerrainForm, TerrainForm,
};
use crate::spec::{
    DEFAULT_BOULDERS, DEFAULT_HILL_LENGTH, DEFAULT_RELIEF, DEFAULT_TERRAIN_CELL, DEFAULT_TERRAIN_SCALE, ModelSpec,
    TerrainImage, TerrainShape, TerrainSpec,
};
use sim_core::scene::{Block, Relief, Stairs, Steps, Way};

/// The terrain of a world with this floor.
pub(super) fn terrain_form(terrain: &TerrainSpec, floor: DVec2) -> TerrainForm {
    match &terrain.shape {
        TerrainShape::Mesh { model, scale } => mesh_form(model, *scale),
        TerrainShape::Image(image) => TerrainForm::Image(image_form(image, floor)),
        TerrainShape::Relief(relief) => TerrainForm::Function(function_form(relief, floor)),
        TerrainShape::Steps(steps) => TerrainForm::Steps(steps_form(steps, floor)),
    }
}

fn mesh_form(model: &ModelSpec, scale: f64) -> TerrainForm {
    let placed = PlacedTerrainForm {
        file: model.path.text.clone(),
        offset_mm: unless(model.offset, DVec3::ZERO).map(place),
        turns_deg: unless(model.turns, DVec3::ZERO).map(|turns| turns.to_array().map(degrees)),
        scale_mm: unless(scale, DEFAULT_TERRAIN_SCALE).map(mm),
    };
    match placed {
        PlacedTerrainForm { file, offset_mm: None, turns_deg: None, scale_mm: None } => TerrainForm::File(file),
        placed => TerrainForm::Placed(placed),
    }
}

fn offset(origin: DVec2, base: f64) -> Option<[f64; 3]> {
    unless(origin.extend(base), DVec3::ZERO).map(place)
}

fn image_form(image: &TerrainImage, floor: DVec2) -> ImageTerrainForm {
    ImageTerrainForm {
        image: image.path.text.clone(),
        offset_mm: offset(image.origin, image.base),
        size_mm: unless(image.size, floor).map(point),
        height_mm: mm(image.height),
    }
}

fn function_form(relief: &Relief, floor: DVec2) -> FunctionTerrainForm {
    let boulders = relief.boulders;
    let usual = DEFAULT_BOULDERS;
    FunctionTerrainForm {
        function: if boulders.is_some() { FunctionForm::Boulders } else { FunctionForm::Hills },
        seed: unless(relief.seed, 0),
        offset_mm: offset(relief.origin, relief.base),
        size_mm: unless(relief.size, floor).map(point),
        cell_mm: unless(relief.cell, DEFAULT_TERRAIN_CELL).map(mm),
        relief_mm: unless(relief.relief, DEFAULT_RELIEF).map(mm),
        length_mm: unless(relief.length, DEFAULT_HILL_LENGTH).map(mm),
        boulders: boulders.and_then(|boulders| unless(boulders.count, usual.count)),
        radius_mm: boulders.and_then(|boulders| unless(boulders.radius, usual.radius)).map(|range| range.map(mm)),
        height_mm: boulders.and_then(|boulders| unless(boulders.height, usual.height)).map(|range| range.map(mm)),
        clear: relief
            .clear
            .iter()
            .map(|disc| DiscForm { x_mm: mm(disc.centre.x), y_mm: mm(disc.centre.y), radius_mm: mm(disc.radius) })
            .collect(),
    }
}

fn steps_form(steps: &Steps, floor: DVec2) -> StepsTerrainForm {
    StepsTerrainForm {
        offset_mm: offset(steps.origin, steps.base),
        size_mm: unless(steps.size, floor).map(point),
        // Without blocks it tells what the terrain is made from.
        stairs: (!steps.stairs.is_empty() || steps.blocks.is_empty())
            .then(|| steps.stairs.iter().map(stairs_form).collect()),
        block: steps.blocks.iter().map(block_form).collect(),
    }
}

fn stairs_form(stairs: &Stairs) -> StairsForm {
    let direction = match stairs.way {
        Way::East => 0.0,
        Way::North => 90.0,
        Way::West => 180.0,
        Way::South => 270.0,
    };
    StairsForm {
        from_mm: point(stairs.from),
        direction_deg: unless(direction, 0.0),
        count: stairs.count,
        step_height_mm: mm(stairs.rise),
        step_depth_mm: mm(stairs.depth),
        width_mm: mm(stairs.width),
        landing_mm: unless(stairs.landing, stairs.depth).map(mm),
        down: unless(stairs.goes_down, false),
    }
}

fn block_form(block: &Block) -> BlockForm {
    BlockForm { from_mm: point(block.bounds.min), to_mm: point(block.bounds.max), height_mm: mm(block.height) }
}
