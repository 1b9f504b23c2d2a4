//! Forward and backward substitution, front by front.

use pulp::{Arch, NullaryFnOnce};

use super::dense::{dot, exchange, subtract};
use super::factor::{Factors, Job, Waiting};
use super::front::{Forest, Front};
use super::symbolic::Symbolic;
use super::symmetric;

/// x ← L⁻¹ x in the order of elimination.
pub fn forward(symbolic: &Symbolic, factors: &Factors, x: &mut [f64]) {
    let run = Substitution { symbolic, factors, waiting: Waiting::default() };
    parts(symbolic, x).upwards(&|forest, x| run.forest_forward(forest, x), &|front, x| run.heavy_forward(front, x));
}

/// x ← U⁻¹ x in the order of elimination.
pub fn backward(symbolic: &Symbolic, factors: &Factors, x: &mut [f64]) {
    let run = Substitution { symbolic, factors, waiting: Waiting::default() };
    parts(symbolic, x).downwards(&|forest, x| run.forest_backward(forest, x), &|front, x| run.heavy_backward(front, x));
}

/// Each front owns the part of x that it eliminates.
fn parts<'a>(symbolic: &'a Symbolic, x: &'a mut [f64]) -> Job<'a, &'a mut [f64]> {
    let mut rest = x;
    Job::new(symbolic, |fronts| {
        let pivots = fronts.iter().map(|front| front.pivots).sum();
        rest.split_off_mut(..pivots).unwrap_or_default()
    })
}

/// A substitution at work. Fronts pass on what L₂₁ takes from the rows above, and then the values of x there.
struct Substitution<'a> {
    symbolic: &'a Symbolic,
    factors: &'a Factors,
    waiting: Waiting,
}

impl Substitution<'_> {
    fn forest_forward(&self, forest: &Forest, mut rest: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let (mut stack, mut y) = (Vec::new(), Vec::new());
        for front in &fronts[forest.fronts.clone()] {
            let x = rest.split_off_mut(..front.pivots).unwrap_or_default();
            y.clear();
            y.extend_from_slice(x);
            y.resize(front.size(), 0.0);
            let children = front.children.iter().map(|&child| &fronts[child as usize]);
            let own = stack.len() - children.clone().map(Front::below).sum::<usize>();
            let mut passed_on = &stack[own..];
            for child in children {
                add(&mut y, passed_on.split_off(..child.below()).unwrap_or_default(), child);
            }
            stack.truncate(own);
            self.forward(front, &mut y);
            x.copy_from_slice(&y[..front.pivots]);
            stack.extend_from_slice(&y[front.pivots..]);
        }
        let mut passed_on = &stack[..];
        for &root in &forest.roots {
            let own = passed_on.split_off(..fronts[root as usize].below()).unwrap_or_default();
            self.waiting.put(root, own.to_vec());
        }
    }

    fn heavy_forward(&self, number: u32, x: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[number as usize];
        let mut y = x.to_vec();
        y.resize(front.size(), 0.0);
        for &child in &front.children {
            add(&mut y, &self.waiting.take(child), &fronts[child as usize]);
        }
        self.forward(front, &mut y);
        x.copy_from_slice(&y[..front.pivots]);
        self.waiting.put(number, y.split_off(front.pivots));
    }

    fn forest_backward(&self, forest: &Forest, mut rest: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let mut stack: Vec<f64> = forest.roots.iter().flat_map(|&root| self.waiting.take(root)).collect();
        let mut y = Vec::new();
        for front in fronts[forest.fronts.clone()].iter().rev() {
            let first = rest.len() - front.pivots;
            let x = rest.split_off_mut(first..).unwrap_or_default();
            y.clear();
            y.extend_from_slice(x);
            y.extend(stack.drain(stack.len() - front.below()..));
            self.backward(front, &mut y);
            x.copy_from_slice(&y[..front.pivots]);
            for &child in &front.children {
                stack.extend(seen(&y, &fronts[child as usize]));
            }
        }
    }

    fn heavy_backward(&self, number: u32, x: &mut [f64]) {
        let fronts = &self.symbolic.fronts;
        let front = &fronts[number as usize];
        let mut y = x.to_vec();
        y.append(&mut self.waiting.take(number));
        self.backward(front, &mut y);
        x.copy_from_slice(&y[..front.pivots]);
        for &child in &front.children {
            self.waiting.put(child, seen(&y, &fronts[child as usize]).collect());
        }
    }

    /// y₁ ← L₁₁⁻¹ P y₁, y₂ ← y₂ − L₂₁ y₁
    fn forward(&self, front: &Front, y: &mut [f64]) {
        if front.open {
            return;
        }
        let exchanges = &self.factors.exchanges[front.first..front.first + front.pivots];
        let lower = &self.factors.values[front.values.clone()][..front.size() * front.pivots];
        if front.symmetric {
            return Arch::new().dispatch(symmetric::Forward { lower, exchanges, y });
        }
        exchange(y, exchanges, 0);
        Arch::new().dispatch(Forward { lower, y });
    }

    /// y₁ ← U₁₁⁻¹ (y₁ − U₁₂ y₂)
    fn backward(&self, front: &Front, y: &mut [f64]) {
        if front.open {
            return;
        }
        if front.symmetric {
            let exchanges = &self.factors.exchanges[front.first..front.first + front.pivots];
            let lower = &self.factors.values[front.values.clone()];
            return Arch::new().dispatch(symmetric::Backward { lower, exchanges, y });
        }
        let (lower, upper) = self.factors.values[front.values.clone()].split_at(front.size() * front.pivots);
        let (own, below) = y.split_at_mut(front.pivots);
        Arch::new().dispatch(Backward { lower, upper, own, below });
    }
}

/// Add what a child passes on to the rows of its parent.
fn add(y: &mut [f64], passed_on: &[f64], child: &Front) {
    for (pair, &place) in passed_on.chunks_exact(2).zip(&child.to_parent) {
        y[place as usize] += pair[0];
        y[place as usize + 1] += pair[1];
    }
}

/// The values at the rows below the child's pivots.
fn seen(y: &[f64], child: &Front) -> impl Iterator<Item = f64> {
    child.to_parent.iter().flat_map(|&place| [y[place as usize], y[place as usize + 1]])
}

struct Forward<'a> {
    lower: &'a [f64],
    y: &'a mut [f64],
}

impl NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (j, column) in self.lower.chunks_exact(self.y.len()).enumerate() {
            let (done, rest) = self.y.split_at_mut(j + 1);
            subtract(rest, &column[j + 1..], done[j]);
        }
    }
}

struct Backward<'a> {
    lower: &'a [f64],
    upper: &'a [f64],
    own: &'a mut [f64],
    below: &'a [f64],
}

impl NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { lower, upper, own, below } = self;
        if !below.is_empty() {
            for (x, row) in own.iter_mut().zip(upper.chunks_exact(below.len())) {
                *x -= dot(row, below);
            }
        }
        for (j, column) in lower.chunks_exact(own.len() + below.len()).enumerate().rev() {
            own[j] /= column[j];
            let (rest, done) = own.split_at_mut(j);
            subtract(rest, column, done[0]);
        }
    }
}
