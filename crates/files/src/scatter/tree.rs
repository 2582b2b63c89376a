//! Tensor trees: values over a cube of three or four dimensions that is halved along each where more detail is needed.
//!
//! A node in braces is either 2^n nodes, bit i of whose number says in which half of dimension i they lie, or a grid of 2^(k n)
//! values, the last dimension fastest. Dimensions are the square of Shirley and Chiu of the incident and of the leaving direction; without grain
//! the first one alone is incident, half of one less the sine of the polar angle.

use crate::scatter::data::BsdfMatrix;
use crate::scatter::error::{Violation, value};
use lumiduct_base::math::{DirectionPatches, PatchPairs, RingPatches, square_of_disk};
use std::f64::consts::PI;

/// Deepest halving that is read.
const DEEPEST: u32 = 12;
/// Halvings that are kept: finer values are averaged. By number of dimensions.
const KEPT: [(usize, u32); 2] = [(4, 5), (3, 6)];
/// Points along both axes of a patch at which a tree without grain is read.
const POINTS: usize = 4;

enum TreeNode {
    Leaf(f64),
    Branch(Vec<TreeNode>),
}

/// The matrix of a tree.
pub(super) fn tensor_tree(
    text: &str,
    first_line: usize,
    dimensions: usize,
    remarks: &mut Vec<String>,
) -> Result<BsdfMatrix, Violation> {
    let mut reader = TreeReader { rest: text, line: first_line, dimensions };
    reader.peek();
    let line = reader.line;
    let root = reader.node(0)?;
    if let Some(found) = reader.peek() {
        return Err(reader.wrong(format!("`{found}` follows the tree")));
    }
    let depth = root.depth();
    let most = KEPT.iter().find(|(own, _)| *own == dimensions).map_or(0, |(_, most)| *most);
    if depth > most {
        let side = 1 << most;
        remarks.push(format!(
            "its tree is averaged over squares of 1/{side}: it is divided {depth} times, {most} are kept"
        ));
    }
    let log_side = depth.min(most);
    let mut grid = CubeGrid::new(dimensions, log_side);
    grid.fill(&root, [0; 4], log_side);
    if dimensions == 4 {
        let side = grid.side;
        let squares = DirectionPatches::Squares { side };
        let pairs = PatchPairs::Fixed { incident: squares.clone(), leaving: squares };
        return Ok(BsdfMatrix { pairs, values: grid.values, line });
    }
    remarks.push("its tree without grain is averaged over rings and sectors".to_owned());
    isotropic(&grid, line).ok_or_else(|| Violation::new(line, "the tree has no incident angles"))
}

/// Reads nodes from a text.
struct TreeReader<'a> {
    rest: &'a str,
    line: usize,
    dimensions: usize,
}

impl<'a> TreeReader<'a> {
    fn wrong(&self, problem: impl Into<String>) -> Violation {
        Violation::new(self.line, problem)
    }

    /// The next letter that is neither blank nor a comma.
    fn peek(&mut self) -> Option<char> {
        let blank = |letter: char| letter.is_whitespace() || letter == ',';
        let trimmed = self.rest.trim_start_matches(blank);
        let skipped = &self.rest[..self.rest.len() - trimmed.len()];
        self.line += skipped.matches('\n').count();
        self.rest = trimmed;
        trimmed.chars().next()
    }

    fn expect(&mut self, letter: char) -> Result<(), Violation> {
        match self.peek() {
            Some(found) if found == letter => {
                self.rest = &self.rest[letter.len_utf8()..];
                Ok(())
            }
            Some(found) => Err(self.wrong(format!("`{found}` instead of `{letter}`"))),
            None => Err(self.wrong(format!("the tree ends before `{letter}`"))),
        }
    }

    fn word(&mut self) -> Option<&'a str> {
        self.peek()?;
        let ends = |letter: char| letter.is_whitespace() || matches!(letter, ',' | '{' | '}');
        let length = self.rest.find(ends).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn node(&mut self, depth: u32) -> Result<TreeNode, Violation> {
        if depth > DEEPEST {
            return Err(self.wrong(format!("the tree is divided more than {DEEPEST} times")));
        }
        self.expect('{')?;
        let node = if self.peek() == Some('{') {
            let children = (0..1 << self.dimensions).map(|_| self.node(depth + 1));
            TreeNode::Branch(children.collect::<Result<_, _>>()?)
        } else {
            self.grid(depth)?
        };
        self.expect('}')?;
        Ok(node)
    }

    fn grid(&mut self, depth: u32) -> Result<TreeNode, Violation> {
        let mut values = Vec::new();
        while let Some(word) = self.word() {
            values.push(value(word, self.line)?);
        }
        let n = self.dimensions as u32;
        let count = values.len() as u64;
        let log = (0..=DEEPEST - depth).find(|log| 1u64 << (log * n) == count);
        let log = log.ok_or_else(|| {
            self.wrong(format!("a grid of {count} values, expected a power of {}", 1 << n))
        })?;
        Ok(branch(&values, self.dimensions, log, [0; 4], log))
    }
}

/// The part of a grid of 2^`log` lines that begins at `low` and has 2^`part` lines, as nodes.
fn branch(values: &[f64], n: usize, log: u32, low: [usize; 4], part: u32) -> TreeNode {
    if part == 0 {
        let place = low[..n].iter().fold(0, |place, line| (place << log) + line);
        return TreeNode::Leaf(values[place]);
    }
    let child = |number: usize| branch(values, n, log, half(low, number, part), part - 1);
    TreeNode::Branch((0..1 << n).map(child).collect())
}

/// Where a child begins in a part of 2^`part` lines.
fn half(low: [usize; 4], number: usize, part: u32) -> [usize; 4] {
    std::array::from_fn(|axis| low[axis] + ((number >> axis & 1) << (part - 1)))
}

impl TreeNode {
    fn depth(&self) -> u32 {
        match self {
            Self::Leaf(_) => 0,
            Self::Branch(children) => 1 + children.iter().map(Self::depth).max().unwrap_or(0),
        }
    }

    fn mean(&self) -> f64 {
        match self {
            Self::Leaf(value) => *value,
            Self::Branch(children) => {
                children.iter().map(Self::mean).sum::<f64>() / children.len() as f64
            }
        }
    }
}

/// Values over a cube, the last dimension fastest.
struct CubeGrid {
    dimensions: usize,
    log_side: u32,
    side: usize,
    values: Vec<f64>,
}

impl CubeGrid {
    fn new(dimensions: usize, log_side: u32) -> Self {
        let side = 1 << log_side;
        Self { dimensions, log_side, side, values: vec![0.0; side.pow(dimensions as u32)] }
    }

    fn place(&self, at: [usize; 4]) -> usize {
        at[..self.dimensions].iter().fold(0, |place, line| (place << self.log_side) + line)
    }

    /// Fills the part of 2^`part` lines that begins at `low`.
    fn fill(&mut self, node: &TreeNode, low: [usize; 4], part: u32) {
        if part == 0 {
            let place = self.place(low);
            self.values[place] = node.mean();
            return;
        }
        for number in 0..1 << self.dimensions {
            let child = match node {
                TreeNode::Leaf(_) => node,
                TreeNode::Branch(children) => &children[number],
            };
            self.fill(child, half(low, number, part), part - 1);
        }
    }
}

/// A tree without grain over rings of incidence and rings and sectors of leaving light; `None` if it is not divided.
fn isotropic(grid: &CubeGrid, line: usize) -> Option<BsdfMatrix> {
    // One incident half at least.
    let count = (grid.side / 2).max(1);
    let angles: Vec<f64> = (0..=count).map(|ring| (ring as f64 / count as f64).asin()).collect();
    let incident = RingPatches::new(&angles, vec![1; count])?;
    let leaving = RingPatches::new(&angles, (0..count).map(|ring| 8 * (2 * ring + 1)).collect())?;
    let patches = DirectionPatches::Rings(leaving.clone());
    // The squares of the points of each patch, which are the same for all rings of incidence.
    let square_of = |at: usize| {
        let (patch, index) = (at / (POINTS * POINTS), at % (POINTS * POINTS));
        let u = [index / POINTS, index % POINTS].map(|line| (line as f64 + 0.5) / POINTS as f64);
        let square = square_of_disk(patches.direction(patch, u)) * grid.side as f64;
        let [x, y] = [square.x, square.y].map(|at| (at as usize).min(grid.side - 1));
        x * grid.side + y
    };
    let squares: Vec<usize> = (0..patches.count() * POINTS * POINTS).map(square_of).collect();
    let mut values = Vec::with_capacity(count * patches.count());
    for ring in 0..count {
        // The middle of the ring: half of one less the sine, in lines.
        let from = (count - 1 - ring).min(grid.side - 1);
        let slice = &grid.values[from * grid.side * grid.side..][..grid.side * grid.side];
        let mean = |points: &[usize]| {
            points.iter().map(|square| slice[*square]).sum::<f64>() / points.len() as f64
        };
        let means: Vec<f64> = squares.chunks(POINTS * POINTS).map(mean).collect();
        // Points may miss parts of squares; the share of light is that of the tree.
        let share = PI * slice.iter().sum::<f64>() / slice.len() as f64;
        let found = means.iter().zip(0..).map(|(mean, patch)| mean * patches.projected(patch));
        let found: f64 = found.sum();
        let factor = if found > 0.0 { share / found } else { 0.0 };
        values.extend(means.into_iter().map(|mean| factor * mean));
    }
    Some(BsdfMatrix { pairs: PatchPairs::Isotropic { incident, leaving }, values, line })
}
