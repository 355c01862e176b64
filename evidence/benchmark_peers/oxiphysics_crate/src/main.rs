//! Formulas of trains of oxiphysics-rigid: one job a line, its name and numbers; one line of numbers for each.

use oxiphysics_rigid::train_rigid::{braking_distance, kalker_linear_coefficients};
use std::io::{self, BufRead};

fn answer(name: &str, n: &[f64]) -> Option<Vec<f64>> {
    match (name, n) {
        // semi-axes along and across [m], shear modulus [Pa]
        ("kalker", &[a, b, modulus]) => {
            let (f11, f22, f23) = kalker_linear_coefficients(a, b, modulus);
            Some(vec![f11, f22, f23])
        }
        // mass [kg], first and last speed [m/s], brake force [N], gradient, resistance [N]
        ("stop", &[mass, first, last, force, gradient, resistance]) => {
            Some(vec![braking_distance(mass, first, last, force, gradient, resistance)])
        }
        _ => None,
    }
}

fn main() {
    for line in io::stdin().lock().lines().map_while(Result::ok) {
        let mut words = line.split_whitespace();
        let name = words.next().unwrap_or("");
        let numbers: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
        match answer(name, &numbers) {
            Some(found) => println!("{}", found.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")),
            None => println!(),
        }
    }
}
