//! Forward and backward substitution, front by front, of one or more columns at a time.

use pulp::{Arch, NullaryFnOnce};

use super::dense::{dot, exchange, subtract};
use super::factor::{Factors, Job, Waiting};
use super::front::{Forest, Front};
use super::symbolic::Symbolic;
use super::symmetric;

/// x ← L⁻¹ x for `count` columns x in the order of elimination. The columns of a front follow each other, so that its factors serve
/// all of them while they are at hand.
pub fn forward(symbolic: &Symbolic, factors: &Factors, count: usize, x: &mut [f64]) {
    let run = Substitution { symbolic, factors, count, waiting: Waiting::default() };
    run.parts(x).upwards(&|forest, x| run.forest_forward(forest, x), &|front, x| run.heavy_forward(front, x));
}

/// x ← U⁻¹ x for `count` columns x, as above.
pub fn backward(symbolic: &Symbolic, factors: &Factors, count: usize, x: &mut [f64]) {
    let run = Substitution { symbolic, factors, count, waiting: Waiting::default() };
    run.parts(x).downwards(&|forest, x| run.forest_backward(forest, x), &|front, x| run.heavy_backward(front, x));
}

/// A substitution at work. Fronts pass on what L₂₁ takes from the rows above, and then the values of x there.
struct Substitution<'a> {
    symbolic: &'a Symbolic,
    factors: &'a Factors,
    /// Number of columns
    count: usize,
    waiting: Waiting,
}

impl Substitution<'_> {
    /// Each front owns the part of x that it eliminates.
    fn parts<'a>(&'a self, x: &'a mut [f64]) -> Job<'a, &'a mut [f64]> {
        let mut rest = x;
        Job::new(self.symbolic, |fronts| {
            let pivots: usize = fronts.iter().map(|front| front.pivots).sum();
            rest.split_off_mut(..self.count * pivots).unwrap_or_default()
        })
    }

    fn forest_forward(&self, forest: &Forest, mut rest: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let (mut stack, mut y) = (Vec::new(), Vec::new());
        for front in &fronts[forest.fronts.clone()] {
            let x = rest.split_off_mut(..self.count * front.pivots).unwrap_or_default();
            self.gather(front, x, None, &mut y);
            let children = front.children.iter().map(|&child| &fronts[child as usize]);
            let own = stack.len() - self.count * children.clone().map(|child| child.below).sum::<usize>();
            let mut passed_on = &stack[own..];
            for child in children {
                let values = passed_on.split_off(..self.count * child.below).unwrap_or_default();
                self.add(front, &mut y, values, child);
            }
            stack.truncate(own);
            self.forward(front, &mut y);
            for (x, y) in self.columns(front, x, &y) {
                x.copy_from_slice(&y[..front.pivots]);
                stack.extend_from_slice(&y[front.pivots..]);
            }
        }
        let mut passed_on = &stack[..];
        for &root in &forest.roots {
            let own = passed_on.split_off(..self.count * fronts[root as usize].below).unwrap_or_default();
            self.waiting.put(root, own.to_vec());
        }
    }

    fn heavy_forward(&self, number: u32, x: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[number as usize];
        let (mut y, mut passed_on) = (Vec::new(), Vec::new());
        self.gather(front, x, None, &mut y);
        for &child in &front.children {
            self.add(front, &mut y, &self.waiting.take(child), &fronts[child as usize]);
        }
        self.forward(front, &mut y);
        for (x, y) in self.columns(front, x, &y) {
            x.copy_from_slice(&y[..front.pivots]);
            passed_on.extend_from_slice(&y[front.pivots..]);
        }
        self.waiting.put(number, passed_on);
    }

    fn forest_backward(&self, forest: &Forest, mut rest: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let mut stack: Vec<f64> = forest.roots.iter().flat_map(|&root| self.waiting.take(root)).collect();
        let mut y = Vec::new();
        for front in fronts[forest.fronts.clone()].iter().rev() {
            let first = rest.len() - self.count * front.pivots;
            let x = rest.split_off_mut(first..).unwrap_or_default();
            let own = stack.len() - self.count * front.below;
            self.gather(front, x, Some(&stack[own..]), &mut y);
            stack.truncate(own);
            self.backward(front, &mut y);
            self.columns(front, x, &y).for_each(|(x, y)| x.copy_from_slice(&y[..front.pivots]));
            for &child in &front.children {
                y.chunks_exact(front.size()).for_each(|y| see(y, &fronts[child as usize], &mut stack));
            }
        }
    }

    fn heavy_backward(&self, number: u32, x: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[number as usize];
        let (above, mut y) = (self.waiting.take(number), Vec::new());
        self.gather(front, x, Some(&above), &mut y);
        self.backward(front, &mut y);
        self.columns(front, x, &y).for_each(|(x, y)| x.copy_from_slice(&y[..front.pivots]));
        for &child in &front.children {
            let mut seen = Vec::new();
            y.chunks_exact(front.size()).for_each(|y| see(y, &fronts[child as usize], &mut seen));
            self.waiting.put(child, seen);
        }
    }

    /// All rows of a front in y, column after column: x at its pivots, and the values `below` them, or zeros.
    fn gather(&self, front: &Front, x: &[f64], below: Option<&[f64]>, y: &mut Vec<f64>) {
        y.clear();
        let rows = front.below;
        for (k, pivots) in x.chunks_exact(front.pivots).enumerate() {
            y.extend_from_slice(pivots);
            match below {
                Some(below) => y.extend_from_slice(&below[k * rows..][..rows]),
                None => y.resize(y.len() + rows, 0.0),
            }
        }
    }

    /// The pivots and all rows of a front, by columns.
    fn columns<'a>(
        &self,
        front: &Front,
        x: &'a mut [f64],
        y: &'a [f64],
    ) -> impl Iterator<Item = (&'a mut [f64], &'a [f64])> {
        x.chunks_exact_mut(front.pivots).zip(y.chunks_exact(front.size()))
    }

    /// Add what a child passes on to the rows of its parent.
    fn add(&self, front: &Front, y: &mut [f64], passed_on: &[f64], child: &Front) {
        for (y, passed_on) in y.chunks_exact_mut(front.size()).zip(passed_on.chunks_exact(child.below.max(1))) {
            for run in &child.runs {
                let values = &passed_on[run.from as usize..][..run.length as usize];
                y[run.to as usize..].iter_mut().zip(values).for_each(|(own, value)| *own += value);
            }
        }
    }

    /// y₁ ← L₁₁⁻¹ P y₁, y₂ ← y₂ − L₂₁ y₁ in every column of y
    fn forward(&self, front: &Front, y: &mut [f64]) {
        if front.open {
            return;
        }
        let exchanges = &self.factors.exchanges[front.first..front.first + front.pivots];
        let lower = &self.factors.values[front.values.clone()][..front.size() * front.pivots];
        if front.symmetric {
            return Arch::new().dispatch(symmetric::Forward { lower, exchanges, size: front.size(), y });
        }
        y.chunks_exact_mut(front.size()).for_each(|y| exchange(y, exchanges, 0));
        Arch::new().dispatch(Forward { lower, size: front.size(), y });
    }

    /// y₁ ← U₁₁⁻¹ (y₁ − U₁₂ y₂) in every column of y
    fn backward(&self, front: &Front, y: &mut [f64]) {
        if front.open {
            return;
        }
        if front.symmetric {
            let exchanges = &self.factors.exchanges[front.first..front.first + front.pivots];
            let lower = &self.factors.values[front.values.clone()];
            return Arch::new().dispatch(symmetric::Backward { lower, exchanges, size: front.size(), y });
        }
        let (lower, upper) = self.factors.values[front.values.clone()].split_at(front.size() * front.pivots);
        Arch::new().dispatch(Backward { lower, upper, pivots: front.pivots, size: front.size(), y });
    }
}

/// Appends the values at the rows below the child's pivots.
fn see(y: &[f64], child: &Front, seen: &mut Vec<f64>) {
    child.runs.iter().for_each(|run| seen.extend_from_slice(&y[run.to as usize..][..run.length as usize]));
}

// Columns of the factors outside, columns of y inside: the steps of one y wait for each other, those of several do not.

struct Forward<'a> {
    lower: &'a [f64],
    size: usize,
    y: &'a mut [f64],
}

impl NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (j, column) in self.lower.chunks_exact(self.size).enumerate() {
            for y in self.y.chunks_exact_mut(self.size) {
                let (done, rest) = y.split_at_mut(j + 1);
                subtract(rest, &column[j + 1..], done[j]);
            }
        }
    }
}

struct Backward<'a> {
    lower: &'a [f64],
    upper: &'a [f64],
    pivots: usize,
    size: usize,
    y: &'a mut [f64],
}

impl NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { lower, upper, pivots, size, y } = self;
        if size > pivots {
            for (j, row) in upper.chunks_exact(size - pivots).enumerate() {
                for y in y.chunks_exact_mut(size) {
                    y[j] -= dot(row, &y[pivots..]);
                }
            }
        }
        for (j, column) in lower.chunks_exact(size).enumerate().rev() {
            for y in y.chunks_exact_mut(size) {
                y[j] /= column[j];
                let (rest, done) = y.split_at_mut(j);
                subtract(rest, column, done[0]);
            }
        }
    }
}
