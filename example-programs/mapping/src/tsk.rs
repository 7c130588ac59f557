//! A height map as a Takagi-Sugeno-Kang system: each cell of a partition of the plane has one rule, whose output is a
//! constant or a plane, fitted to sonar readings by recursive least squares.
//!
//! Source: Gois and Hiller, section 3. Their Eq. 3 omits the division by the sum of the activations, which the weighted
//! average in the text requires; this code includes it.

use std::ops::Range;

use crate::inverse::{Side, SonarModel, SonarPose, cap_point};
use crate::math;
use crate::rls::Rls;

/// Number of sampling points along each side of a cell in the search for its maximum membership.
const SAMPLES: usize = 3;

/// A cell of the unbounded lattice that partitions the plane: column along x, row along y.
pub type CellIndex = (i64, i64);

/// A rectangle of cells of the square lattice that has a cell corner at (0, 0).
///
/// Each cell has a slot, an index computed from its column and row modulo the size. So cells that stay in the rectangle
/// when it moves keep their slots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Partition {
    /// Side of a cell, m.
    pub cell: f64,
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// The cell with the minimum x and y.
    pub low: CellIndex,
}

impl Partition {
    /// The cell of the lattice that contains the point (x, y).
    pub fn cell_index(&self, x: f64, y: f64) -> CellIndex {
        ((x / self.cell).floor() as i64, (y / self.cell).floor() as i64)
    }

    /// The slot of a cell; `None` outside the rectangle.
    pub fn slot(&self, (column, row): CellIndex) -> Option<usize> {
        let is_inside = self.column_range().contains(&column) && self.row_range().contains(&row);
        let (columns, rows) = (self.columns as i64, self.rows as i64);
        is_inside.then(|| (row.rem_euclid(rows) * columns + column.rem_euclid(columns)) as usize)
    }

    /// The centre of a cell, m.
    pub fn centre(&self, (column, row): CellIndex) -> (f64, f64) {
        ((column as f64 + 0.5) * self.cell, (row as f64 + 0.5) * self.cell)
    }

    /// All cells, row by row from the minimum y.
    pub fn cells(&self) -> impl Iterator<Item = CellIndex> + use<> {
        let columns = self.column_range();
        self.row_range().flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }

    /// Cells within `reach` m of (x, y) along each axis.
    pub fn cells_around(&self, x: f64, y: f64, reach: f64) -> impl Iterator<Item = CellIndex> + use<> {
        self.cells_within(x, y, [-reach, reach], [-reach, reach])
    }

    /// Cells within an interval of x (`east`) and one of y (`north`), relative to (x, y), m.
    pub(crate) fn cells_within(
        &self,
        x: f64,
        y: f64,
        east: [f64; 2],
        north: [f64; 2],
    ) -> impl Iterator<Item = CellIndex> + use<> {
        let (from, to) = (self.cell_index(x + east[0], y + north[0]), self.cell_index(x + east[1], y + north[1]));
        let clipped = |range: Range<i64>, from: i64, to: i64| range.start.max(from)..range.end.min(to + 1);
        let (columns, rows) = (clipped(self.column_range(), from.0, to.0), clipped(self.row_range(), from.1, to.1));
        rows.flat_map(move |row| columns.clone().map(move |column| (column, row)))
    }

    fn column_range(&self) -> Range<i64> {
        self.low.0..self.low.0 + self.columns as i64
    }

    fn row_range(&self) -> Range<i64> {
        self.low.1..self.low.1 + self.rows as i64
    }
}

/// Output function of the rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// A constant: f = d.
    Zero,
    /// A plane: f = a x + b y + c.
    One,
}

impl Order {
    /// Number of parameters of a rule.
    pub fn parameters(self) -> usize {
        match self {
            Order::Zero => 1,
            Order::One => 3,
        }
    }
}

/// Conversion of a reading to equations for the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fusion {
    /// One equation for each reading (Eq. 3): the weighted average of the rules' outputs equals the weighted average of
    /// the cap's heights.
    Average,
    /// One equation for each activated rule, weighted by the activation: the rule's output equals the height of the cap
    /// over its cell. This is our choice and more accurate: an average over many cells leaves the differences between
    /// them undetermined.
    ///
    /// The echo comes from the nearest surface in the beam, so the ground touches the cap somewhere and lies below it
    /// everywhere else. The weight of an equation that would raise the height is therefore multiplied by `above`
    /// (asymmetric least squares, Newey and Powell 1987); with 1, both directions have the same weight.
    Cells {
        /// Factor in (0, 1] on the weight of equations that would raise the height.
        above: f64,
    },
}

/// Structure, prior and measurement error of the system: our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Output function of the rules.
    pub order: Order,
    /// Conversion of readings to equations.
    pub fusion: Fusion,
    /// Prior height of a cell, m.
    pub height: f64,
    /// Standard deviation of the prior height, m.
    pub height_sigma: f64,
    /// Prior standard deviation of the slopes of a plane, m/m.
    pub slope_sigma: f64,
    /// Standard deviation of the error of a reading's height, m.
    pub reading_sigma: f64,
    /// Minimum height of the ground, m; lower points of a cap are raised to it. Minus infinity if unknown.
    pub floor: f64,
    /// Forgetting factor, as in [`Rls::new`].
    pub forgetting: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            order: Order::Zero,
            fusion: Fusion::Cells { above: 0.003 },
            height: 0.0,
            height_sigma: 1.0,
            slope_sigma: 0.5,
            reading_sigma: 0.1,
            floor: f64::NEG_INFINITY,
            forgetting: 1.0,
        }
    }
}

/// Activation of one rule by a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Activation {
    /// The cell.
    pub cell_index: CellIndex,
    /// Its slot in the partition.
    pub slot: usize,
    /// Activation w: the maximum membership within the cell.
    pub weight: f64,
    /// x of the cell's point of maximum membership, m.
    pub x: f64,
    /// y of the cell's point of maximum membership, m.
    pub y: f64,
    /// Height of the reading's cap at that point, m.
    pub height: f64,
}

/// Activations of the cells on which the shadow of a reading lies; `side` chooses a point of its cap.
pub fn activations(
    partition: &Partition,
    model: &SonarModel,
    sonar: &SonarPose,
    measured: f64,
    side: Side,
) -> Vec<Activation> {
    // Slightly reduced, so that rounding excludes no point at the edge of the beam.
    let min_cosine = math::cos(model.aperture()) - 1e-9;
    let offset = |sample: usize| ((sample as f64 + 0.5) / SAMPLES as f64 - 0.5) * partition.cell;
    let activation_of = |index: CellIndex| {
        let slot = partition.slot(index)?;
        let centre = partition.centre(index);
        let samples = (0..SAMPLES * SAMPLES)
            .map(|sample| (centre.0 + offset(sample % SAMPLES), centre.1 + offset(sample / SAMPLES)));
        // For a level sonar the membership is greatest in a band at the rim of the cap that may lie between two
        // sampling points.
        let rim = rim(sonar, measured, centre, partition.cell).filter(|(x, y)| partition.cell_index(*x, *y) == index);
        let (mut points, mut count) = ([(0.0, 0.0, 0.0); SAMPLES * SAMPLES + 1], 0);
        let mut max_cosine = 0.0_f64;
        for (x, y) in samples.chain(rim) {
            if let Some((cosine, _)) = cap_point(sonar, measured, x, y, side) {
                points[count] = (x, y, cosine);
                count += 1;
                max_cosine = max_cosine.max(cosine);
            }
        }
        if max_cosine < min_cosine {
            return None;
        }
        // The membership decreases with the angle. So it is computed only for the points with the maximum cosine,
        // within rounding.
        points[..count]
            .iter()
            .copied()
            .filter(|(.., cosine)| *cosine >= max_cosine - 1e-12)
            .filter_map(|(x, y, _)| {
                let shadow = model.shadow(sonar, measured, x, y, side)?;
                Some(Activation { cell_index: index, slot, weight: shadow.membership, x, y, height: shadow.height })
            })
            .max_by(|a, b| a.weight.total_cmp(&b.weight))
    };
    let [east, north] = model.extents(sonar).map(|range| range.map(|fraction| fraction * measured));
    partition.cells_within(sonar.origin.x, sonar.origin.y, east, north).filter_map(activation_of).collect()
}

/// Point of the plane at the measured distance from a sonar, in the direction of the point (x, y). `None` if (x, y) is
/// at the sonar, or more than a cell away from the result.
fn rim(sonar: &SonarPose, measured: f64, (x, y): (f64, f64), cell: f64) -> Option<(f64, f64)> {
    let (dx, dy) = (x - sonar.origin.x, y - sonar.origin.y);
    let (square, nearest) = (dx * dx + dy * dy, (measured - cell).max(0.0));
    if square < nearest * nearest || square > (measured + cell) * (measured + cell) {
        return None;
    }
    let length = math::hypot(dx, dy);
    // Slightly reduced, since on the rim itself rounding decides whether the cap is hit.
    let scale = measured * (1.0 - 1e-9) / length;
    (length > 0.0).then(|| (sonar.origin.x + scale * dx, sonar.origin.y + scale * dy))
}

/// The height map.
///
/// The plane of a rule is a x' + b y' + c, with x' and y' in [-1/2, 1/2] relative to the centre of its cell and in
/// units of cells. This is the paper's plane, with coefficients of similar magnitude.
#[derive(Clone, Debug)]
pub struct Tsk {
    partition: Partition,
    settings: Settings,
    estimate: Estimate,
}

/// Parameters of the rules. Those of a slot are adjacent: height, then the rise per cell along x and along y.
#[derive(Clone, Debug)]
enum Estimate {
    /// One estimate for all rules, since averages couple the rules: n^2 numbers for n parameters.
    Joint(Rls),
    /// One estimate for each slot, since equations of single rules do not couple the rules.
    Separate(Vec<Rls>),
}

impl Tsk {
    /// A surface with the prior only, without readings.
    ///
    /// # Panics
    /// If a prior standard deviation is not above 0 and finite, or `forgetting` is not in (0, 1].
    pub fn new(partition: Partition, settings: Settings) -> Self {
        let (slots, count) = (partition.columns * partition.rows, settings.order.parameters());
        let rls = |count: usize| {
            let prior = |index| prior(&partition, &settings, index);
            let (mean, variance): (Vec<f64>, Vec<f64>) = (0..count).map(prior).unzip();
            Rls::new(&mean, &variance, settings.forgetting)
        };
        let estimate = match settings.fusion {
            Fusion::Average => Estimate::Joint(rls(slots * count)),
            Fusion::Cells { .. } => Estimate::Separate(vec![rls(count); slots]),
        };
        Self { partition, settings, estimate }
    }

    /// The cells.
    pub fn partition(&self) -> &Partition {
        &self.partition
    }

    /// Fuses a reading. Returns the number of rules activated.
    ///
    /// # Panics
    /// If a number of the reading is not finite.
    pub fn fuse(&mut self, model: &SonarModel, sonar: &SonarPose, measured: f64) -> usize {
        let side = match self.settings.fusion {
            Fusion::Average => Side::MostPossible,
            Fusion::Cells { .. } => Side::Lower,
        };
        let mut activations = activations(&self.partition, model, sonar, measured, side);
        for activation in &mut activations {
            activation.height = activation.height.max(self.settings.floor);
        }
        match self.settings.fusion {
            Fusion::Average => self.add_average(&activations),
            Fusion::Cells { above } => {
                for activation in &activations {
                    let is_raise = self.output(activation) < activation.height;
                    self.add_height(activation, activation.weight * if is_raise { above } else { 1.0 });
                }
            }
        }
        activations.len()
    }

    /// Adds one equation: the weighted average of the rules' outputs equals that of the heights in `activations`,
    /// except for the error of a reading. If each rule has a separate estimate, adds an equation for each of them
    /// instead.
    ///
    /// # Panics
    /// If a number is not finite, or a slot is not one of the partition.
    pub fn add_average(&mut self, activations: &[Activation]) {
        let total: f64 = activations.iter().map(|activation| activation.weight).sum();
        if total <= 0.0 {
            return;
        }
        let count = self.settings.order.parameters();
        let mut regressor = Vec::with_capacity(activations.len() * count);
        let mut height = 0.0;
        for activation in activations {
            let fraction = activation.weight / total;
            height += fraction * activation.height;
            let base = activation.slot * count;
            regressor
                .extend(self.factors(activation).enumerate().map(|(index, factor)| (base + index, fraction * factor)));
        }
        let sigma = self.settings.reading_sigma;
        match &mut self.estimate {
            Estimate::Joint(rls) => rls.update(&regressor, height, sigma * sigma).expect("finite numbers of rules"),
            Estimate::Separate(_) => {
                activations.iter().for_each(|activation| self.add_height(activation, activation.weight / total))
            }
        }
    }

    /// Adds one equation with a weight: the output of a rule equals the height in `activation`, except for the error of
    /// a reading.
    ///
    /// # Panics
    /// If a number is not finite, `weight` is not above 0, or the slot is not one of the partition.
    pub fn add_height(&mut self, activation: &Activation, weight: f64) {
        let sigma = self.settings.reading_sigma;
        let variance = sigma * sigma / weight;
        let base = activation.slot * self.settings.order.parameters();
        let (mut regressor, mut count) = ([(0, 0.0); 3], 0);
        for factor in self.factors(activation) {
            regressor[count] = (count, factor);
            count += 1;
        }
        let regressor = &mut regressor[..count];
        let result = match &mut self.estimate {
            Estimate::Separate(rules) => rules[activation.slot].update(regressor, activation.height, variance),
            Estimate::Joint(rls) => {
                regressor.iter_mut().for_each(|(index, _)| *index += base);
                rls.update(regressor, activation.height, variance)
            }
        };
        result.expect("finite numbers of rules that are there");
    }

    /// Estimated height at (x, y), m; `None` outside the partition.
    ///
    /// A point activates only the rule of its own cell (Gois and Hiller, section 3), so heights jump between cells.
    pub fn height(&self, x: f64, y: f64) -> Option<f64> {
        let index = self.partition.cell_index(x, y);
        let slot = self.partition.slot(index)?;
        Some(self.output(&Activation { cell_index: index, slot, weight: 1.0, x, y, height: 0.0 }))
    }

    /// Standard deviation of the height in the centre of the cell that contains (x, y), m; `None` outside the
    /// partition. It starts at the prior standard deviation and decreases with each reading.
    pub fn sigma(&self, x: f64, y: f64) -> Option<f64> {
        let slot = self.partition.slot(self.partition.cell_index(x, y))?;
        let variance = match &self.estimate {
            Estimate::Joint(rls) => rls.variance(slot * self.settings.order.parameters()),
            Estimate::Separate(rules) => rules[slot].variance(0),
        };
        Some(variance.sqrt())
    }

    /// Moves the partition so that `low` is its cell with the minimum x and y. The estimates of cells that leave it are
    /// discarded; new cells have the prior.
    pub fn move_to(&mut self, low: CellIndex) {
        let before = self.partition;
        self.partition.low = low;
        let count = self.settings.order.parameters();
        for cell_index in self.partition.cells().filter(|cell_index| before.slot(*cell_index).is_none()) {
            let Some(slot) = self.partition.slot(cell_index) else { continue };
            for index in 0..count {
                let (mean, variance) = prior(&self.partition, &self.settings, index);
                match &mut self.estimate {
                    Estimate::Joint(rls) => rls.reset(slot * count + index, mean, variance),
                    Estimate::Separate(rules) => rules[slot].reset(index, mean, variance),
                }
            }
        }
    }

    /// Output of a cell's rule at a point of the cell.
    fn output(&self, activation: &Activation) -> f64 {
        let parameters = match &self.estimate {
            Estimate::Joint(rls) => &rls.parameters()[activation.slot * self.settings.order.parameters()..],
            Estimate::Separate(rules) => rules[activation.slot].parameters(),
        };
        self.factors(activation).zip(parameters).map(|(factor, parameter)| parameter * factor).sum()
    }

    /// Factors of a rule's parameters in its output.
    fn factors(&self, activation: &Activation) -> impl Iterator<Item = f64> + use<> {
        let (x, y) = self.partition.centre(activation.cell_index);
        let (x, y) = ((activation.x - x) / self.partition.cell, (activation.y - y) / self.partition.cell);
        [1.0, x, y].into_iter().take(self.settings.order.parameters())
    }
}

/// Prior mean and variance of a parameter.
fn prior(partition: &Partition, settings: &Settings, index: usize) -> (f64, f64) {
    let (mean, sigma) = match index % settings.order.parameters() {
        0 => (settings.height, settings.height_sigma),
        _ => (0.0, settings.slope_sigma * partition.cell),
    };
    (mean, sigma * sigma)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::Vector3;

    use super::*;

    fn partition() -> Partition {
        Partition { cell: 0.5, columns: 8, rows: 6, low: (-3, 2) }
    }

    fn down(x: f64, y: f64) -> SonarPose {
        SonarPose::new(Vector3::new(x, y, 2.0), 0.0, -FRAC_PI_2)
    }

    /// The cap's band of high membership is 2 cm wide here, less than the distance between two sampling points.
    #[test]
    fn level_sonar_activates_the_cell_at_the_rim_of_its_cap() {
        let partition = Partition { cell: 0.5, columns: 12, rows: 3, low: (0, -1) };
        for (pitch, weight) in [(0.0, 1.0), (0.436, 0.32)] {
            let sonar = SonarPose::new(Vector3::new(0.1, 0.25, 0.6), 0.0, pitch);
            for measured in [1.97, 2.03, 2.16] {
                let model = SonarModel { min_membership: 0.25, ..SonarModel::srf08() };
                let found = activations(&partition, &model, &sonar, measured, Side::Lower);
                let ahead = found.iter().find(|one| one.cell_index == (4, 0)).expect("the cell of the echo");
                assert!((ahead.weight - weight).abs() < 0.01, "{measured}: {ahead:?}");
                assert!((ahead.height - 0.6).abs() < 1e-3, "{measured}: {ahead:?}");
            }
        }
    }

    #[test]
    fn cells_keep_their_slots_when_the_partition_moves() {
        let before = partition();
        let after = Partition { low: (-1, 1), ..before };
        let mut slots: Vec<_> = before.cells().map(|index| before.slot(index).unwrap()).collect();
        slots.sort_unstable();
        assert_eq!(slots, (0..48).collect::<Vec<_>>());
        for index in before.cells().filter(|index| after.slot(*index).is_some()) {
            assert_eq!(before.slot(index), after.slot(index));
        }
        assert_eq!((before.slot((-4, 2)), before.slot((5, 2)), before.slot((0, 8))), (None, None, None));
        let (x, y) = before.centre((-3, 4));
        assert_eq!((x, y, before.cell_index(x, y)), (-1.25, 2.25, (-3, 4)));
    }

    #[test]
    fn first_order_fits_a_plane_and_zero_order_its_steps() {
        let plane = |x: f64, y: f64| 0.3 + 0.2 * x - 0.1 * y;
        for (order, max_error) in [(Order::Zero, 0.06), (Order::One, 1e-3)] {
            let settings = Settings { order, reading_sigma: 1e-3, ..Settings::default() };
            let mut tsk = Tsk::new(partition(), settings);
            for index in partition().cells() {
                let (cx, cy) = partition().centre(index);
                for (dx, dy) in [(0.0, 0.0), (0.2, 0.1), (-0.2, 0.15), (0.1, -0.2), (-0.15, -0.1)] {
                    let (x, y) = (cx + dx, cy + dy);
                    let slot = partition().slot(index).unwrap();
                    tsk.add_height(
                        &Activation { cell_index: index, slot, weight: 1.0, x, y, height: plane(x, y) },
                        0.7,
                    );
                }
            }
            let (x, y) = (0.45, 2.85);
            let height = tsk.height(x, y).unwrap();
            assert!((height - plane(x, y)).abs() < max_error, "{order:?} {height}");
            assert!(tsk.sigma(x, y).unwrap() < 0.01);
        }
    }

    /// Eq. 3 with the division: if all activations have one height, the average is that height for any sum of the
    /// activations.
    #[test]
    fn average_is_divided_by_the_sum_of_activations() {
        let settings = Settings { fusion: Fusion::Average, reading_sigma: 1e-3, ..Settings::default() };
        let mut tsk = Tsk::new(partition(), settings);
        let cells = [((0, 4), 0.9), ((1, 4), 0.8), ((0, 5), 0.7)];
        let activations = cells.map(|(index, weight)| {
            let (x, y) = partition().centre(index);
            Activation { cell_index: index, slot: partition().slot(index).unwrap(), weight, x, y, height: 0.4 }
        });
        for _ in 0..3 {
            tsk.add_average(&activations);
        }
        let heights = cells.map(|(index, weight)| {
            let (x, y) = partition().centre(index);
            weight * tsk.height(x, y).unwrap()
        });
        assert!((heights.iter().sum::<f64>() / 2.4 - 0.4).abs() < 1e-5, "{heights:?}");
    }

    #[test]
    fn raising_equations_have_less_weight() {
        let fused = |above: f64| {
            let mut tsk = Tsk::new(partition(), Settings { fusion: Fusion::Cells { above }, ..Settings::default() });
            for step in 0..200 {
                // Level ground at 0 with sonars above it: each cap touches the ground at one point and is higher
                // elsewhere.
                tsk.fuse(&SonarModel::srf08(), &down(-1.0 + 0.02 * f64::from(step), 2.3), 2.0);
            }
            tsk.height(0.75, 2.25).unwrap()
        };
        assert!(fused(0.03) < 0.04, "{}", fused(0.03));
        assert!(fused(1.0) > 1.5 * fused(0.03), "the mean of the caps: {}", fused(1.0));
    }

    #[test]
    fn move_to_discards_only_cells_that_leave() {
        for fusion in [Fusion::Average, Fusion::Cells { above: 0.1 }] {
            check_move(Settings { fusion, order: Order::One, ..Settings::default() });
        }
    }

    /// Checks heights and standard deviations after a move by two cells.
    fn check_move(settings: Settings) {
        let mut tsk = Tsk::new(partition(), settings);
        for step in 0..10 {
            tsk.fuse(&SonarModel::srf08(), &down(-1.0 + 0.3 * f64::from(step), 2.0), 1.5);
        }
        let before = tsk.clone();
        tsk.move_to((-1, 2));
        assert_eq!(tsk.height(-1.25, 2.25), None);
        for index in tsk.partition().cells() {
            let (x, y) = tsk.partition().centre(index);
            let (height, sigma) = match before.height(x, y) {
                Some(height) => (height, before.sigma(x, y).unwrap()),
                None => (0.0, 1.0),
            };
            assert!((tsk.height(x, y).unwrap() - height).abs() < 1e-12, "{index:?}");
            assert!((tsk.sigma(x, y).unwrap() - sigma).abs() < 1e-12, "{index:?}");
        }
    }
}
