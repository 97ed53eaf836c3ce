//! `sortie evaluate`: the objective for optimisers outside of this program.

use std::io::{self, BufRead, Read, Write};
use std::sync::mpsc::{self, Sender};
use std::thread;

use rayon::prelude::*;

use crate::cli::args;
use crate::cli::print::console::out;
use crate::cli::print::failure::Failure;
use crate::cost::EarlierFlights;
use crate::optimize::Problem;
use crate::path::Flight;
use crate::plan::{Request, objective, objective_specs, plan_fleet};
use crate::spec::{Document, MissionSpec};
use crate::study::Arena;
use crate::world::{self, World};

/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;
/// Candidates of one parallel task.
const ROWS: usize = 64;

pub(in crate::cli) fn run(arguments: &args::Evaluate) -> Result<(), Failure> {
    let (spec, world) = match Document::read_known(&arguments.spec).map_err(world::with_ground)? {
        Document::Mission(file) => {
            let world = world::load(&file)?;
            (file.spec, world)
        }
        Document::Scenario(scenario) => {
            let arena = Arena::of(*scenario);
            (arena.spec, arena.world)
        }
    };
    let known = || {
        let ids: Vec<&str> = spec.vehicles.iter().map(|one| one.id.as_str()).collect();
        ids.join(", ")
    };
    let vehicle = spec
        .vehicles
        .iter()
        .position(|one| one.id == arguments.vehicle)
        .ok_or_else(|| {
            let id = &arguments.vehicle;
            Failure::new(
                Failure::USAGE,
                format!("no vehicle {id} (there are: {})", known()),
            )
        })?;
    let specs = objective_specs(&spec, &world, vehicle);
    if arguments.dimension {
        let samples = spec.planner.samples;
        let problem = objective(&specs, &world, vehicle, EarlierFlights::none(), samples);
        return out(&problem.dimension().to_string());
    }
    let earlier = flights_before(&spec, &world, vehicle).into();
    let samples = arguments.samples.unwrap_or(spec.planner.samples);
    let problem = objective(&specs, &world, vehicle, &earlier, samples);
    let input = io::stdin().lock();
    answering(io::stdout(), |answers| {
        if arguments.binary {
            binary(&problem, input, answers)
        } else {
            text(&problem, input, answers)
        }
    })
}

/// Writes answers in a thread of their own, while `act` reads on: one who sends all before
/// reading would else wait for us as we wait for it. What is not yet read is kept, a few
/// bytes for each candidate.
fn answering(
    mut output: impl Write + Send,
    act: impl FnOnce(&Answers) -> Result<(), Failure>,
) -> Result<(), Failure> {
    thread::scope(|scope| {
        let (sender, answers) = mpsc::channel::<Vec<u8>>();
        let writer = scope.spawn(move || {
            answers.into_iter().try_for_each(|answer| {
                output
                    .write_all(&answer)
                    .and_then(|()| output.flush())
                    .map_err(unwritable)
            })
        });
        let done = act(&Answers(sender));
        let written = writer.join().unwrap_or_else(|_| {
            Err(Failure::new(
                Failure::OUTPUT,
                "the writer of stdout panicked",
            ))
        });
        // Why no more could be written is known to the writer alone.
        written.and(done)
    })
}

/// Where answers go.
struct Answers(Sender<Vec<u8>>);

impl Answers {
    /// An error only if the writer has failed.
    fn send(&self, answer: Vec<u8>) -> Result<(), Failure> {
        let closed = |_| unwritable(io::ErrorKind::BrokenPipe.into());
        self.0.send(answer).map_err(closed)
    }
}

/// The whole flights of the vehicles before this one, planned as `plan` plans first.
fn flights_before(spec: &MissionSpec, world: &World, vehicle: usize) -> Vec<Flight> {
    let mut before = spec.clone();
    before.vehicles.truncate(vehicle);
    let request = Request::new(spec.planner.seed);
    plan_fleet(&before, world, &request).flights(&before, world)
}

/// Costs of rows, in order, on all threads.
fn costs(problem: &impl Problem, rows: &[f64]) -> Vec<f64> {
    let dimension = problem.dimension();
    let mut costs = vec![0.0; rows.len() / dimension];
    rows.par_chunks(ROWS * dimension)
        .zip(costs.par_chunks_mut(ROWS))
        .for_each(|(rows, costs)| {
            problem.evaluate(rows, costs);
            for cost in costs {
                // Squares of numbers from 1e154 on are infinite, and their differences are
                // none; an optimiser compares costs, and a path so far out is the worst.
                if cost.is_nan() {
                    *cost = f64::INFINITY;
                }
            }
        });
    costs
}

/// Answers all rows that have come in whole, as soon as they have.
fn binary(problem: &impl Problem, mut input: impl Read, answers: &Answers) -> Result<(), Failure> {
    let row_bytes = 8 * problem.dimension();
    let mut bytes = vec![0; CHUNK.max(row_bytes)];
    let (mut held, mut done) = (0, 0);
    loop {
        let came = input.read(&mut bytes[held..]).map_err(unreadable)?;
        held += came;
        let whole = held - held % row_bytes;
        let rows: Vec<f64> = bytes[..whole]
            .chunks_exact(8)
            .map(|eight| f64::from_le_bytes(std::array::from_fn(|i| eight[i])))
            .collect();
        let bad = rows.iter().position(|value| !value.is_finite());
        let good = bad.unwrap_or(rows.len()) / problem.dimension();
        let answer: Vec<u8> = costs(problem, &rows[..good * problem.dimension()])
            .iter()
            .flat_map(|cost| cost.to_le_bytes())
            .collect();
        answers.send(answer)?;
        done += good;
        if let Some(at) = bad {
            let number = at % problem.dimension() + 1;
            return Err(bad_row(done + 1, &not_finite(number, rows[at])));
        }
        bytes.copy_within(whole..held, 0);
        held -= whole;
        if came == 0 {
            return if held == 0 {
                Ok(())
            } else {
                let message = format!("the input ends within row {}", done + 1);
                Err(Failure::new(Failure::INPUT, message))
            };
        }
    }
}

/// Answers all lines that have come in whole, as soon as they have.
fn text(problem: &impl Problem, input: impl Read, answers: &Answers) -> Result<(), Failure> {
    let mut input = io::BufReader::with_capacity(CHUNK, input);
    let (mut rows, mut done) = (Vec::new(), 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        let came = input.read_until(b'\n', &mut line).map_err(unreadable)?;
        let parsed = match came {
            0 => Ok(()),
            _ => parse(&line, problem.dimension(), &mut rows),
        };
        // More lines are at hand: they belong to the same batch.
        if came > 0 && parsed.is_ok() && input.buffer().contains(&b'\n') {
            continue;
        }
        done += rows.len() / problem.dimension();
        let mut answer = String::new();
        for cost in costs(problem, &rows) {
            answer.push_str(&cost.to_string());
            answer.push('\n');
        }
        rows.clear();
        answers.send(answer.into_bytes())?;
        // What came before a bad row is answered all the same.
        parsed.map_err(|what| bad_row(done + 1, &what))?;
        if came == 0 {
            return Ok(());
        }
    }
}

/// The numbers of a line, apart by blanks or commas, are added to `rows`: all or none.
///
/// # Errors
/// What is wrong with the line.
fn parse(line: &[u8], dimension: usize, rows: &mut Vec<f64>) -> Result<(), String> {
    let before = rows.len();
    let parsed = numbers(line, rows).and_then(|()| match rows.len() - before {
        // Skipping it would give one answer fewer than there are lines.
        0 => Err(format!("a blank line (allowed: {dimension} numbers)")),
        found if found == dimension => Ok(()),
        found => Err(format!("{found} numbers (allowed: {dimension})")),
    });
    if parsed.is_err() {
        rows.truncate(before);
    }
    parsed
}

fn numbers(line: &[u8], rows: &mut Vec<f64>) -> Result<(), String> {
    let before = rows.len();
    let line = std::str::from_utf8(line).map_err(|error| error.to_string())?;
    let words = line.split([',', ' ', '\t', '\r', '\n']);
    for word in words.filter(|word| !word.is_empty()) {
        let number = rows.len() - before + 1;
        let value: f64 = word
            .parse()
            .map_err(|_| format!("number {number}: {} is no number", shown(word)))?;
        if !value.is_finite() {
            return Err(not_finite(number, value));
        }
        rows.push(value);
    }
    Ok(())
}

/// A word out of the input as a terminal may have it: escaped, and not without end.
fn shown(word: &str) -> String {
    const MAX: usize = 40;
    let start: String = word.chars().take(MAX).collect();
    let rest = if start.len() < word.len() { "..." } else { "" };
    format!("{}{rest}", start.escape_debug())
}

fn not_finite(number: usize, value: f64) -> String {
    format!("number {number} is {value} (allowed: finite)")
}

fn bad_row(row: usize, what: &str) -> Failure {
    Failure::new(Failure::INPUT, format!("row {row}: {what}"))
}

fn unwritable(error: io::Error) -> Failure {
    Failure::new(Failure::OUTPUT, format!("stdout: {error}"))
}

fn unreadable(error: io::Error) -> Failure {
    Failure::new(Failure::INPUT, format!("stdin: {error}"))
}
